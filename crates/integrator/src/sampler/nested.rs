use crate::hash::nth;

/// `N` nested random permutations of binary numbers: each digit is flipped by a random bit that depends on
/// all digits before it (Owen, "Randomly Permuted (t,m,s)-Nets and (t,s)-Sequences", 1995).
///
/// The random bits belong to the nodes of a binary tree in heap order, 64 to a hash. This is exact Owen
/// scrambling at one hash for up to six digits. The loops over `N` are vectorised by the compiler.
#[derive(Clone, Copy)]
pub(super) struct NestedPermutations<const N: usize> {
    keys: [u64; N],
    purpose: u64,
}

impl<const N: usize> NestedPermutations<N> {
    /// A permutation for each key; keys have independent permutations for each `purpose`.
    #[inline(always)]
    pub(super) fn new(keys: [u64; N], purpose: u64) -> Self {
        Self { keys, purpose: purpose << 40 }
    }

    /// The images of `x`, numbers of `digits` binary digits (at most 31).
    #[inline(always)]
    pub(super) fn apply(&self, x: [u64; N], digits: u32) -> [u64; N] {
        let coins = self.hashes([0; N]);
        let mut flips = [0; N];
        for level in 0..digits.min(6) {
            for i in 0..N {
                flips[i] = flips[i] << 1 | coins[i] >> node(x[i], digits, level) & 1;
            }
        }
        for level in 6..digits {
            let mut words = [0; N];
            for i in 0..N {
                words[i] = node(x[i], digits, level) / 64;
            }
            let coins = self.hashes(words);
            for i in 0..N {
                flips[i] = flips[i] << 1 | coins[i] >> (node(x[i], digits, level) % 64) & 1;
            }
        }
        for i in 0..N {
            flips[i] ^= x[i];
        }
        flips
    }

    /// 64 random bits for each image `x`.
    #[inline(always)]
    pub(super) fn below(&self, x: [u64; N]) -> [u64; N] {
        self.hashes(x.map(|x| x + (1 << 32)))
    }

    #[inline(always)]
    fn hashes(&self, mut counters: [u64; N]) -> [u64; N] {
        for (counter, key) in counters.iter_mut().zip(self.keys) {
            *counter = nth(key, self.purpose + *counter);
        }
        counters
    }
}

/// The heap index of a digit's node: a one followed by the digits before it.
#[inline(always)]
fn node(x: u64, digits: u32, level: u32) -> u64 {
    (1 << digits | x) >> (digits - level)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All 128 permutations of three digits, equally often: chi-square with 127 degrees of freedom,
    /// whose normal equivalent (Wilson and Hilferty 1931) is accepted up to 5.85.
    #[test]
    fn every_nested_permutation_is_as_likely() {
        let mut counts = std::collections::HashMap::new();
        let draws = 128 * 400;
        for key in 0..draws {
            let permutation = NestedPermutations::new([crate::hash::mix(key)], 0);
            let images: Vec<_> = (0..8).map(|x| permutation.apply([x], 3)[0]).collect();
            *counts.entry(images).or_insert(0_u32) += 1;
        }
        assert_eq!(counts.len(), 128);
        let chi_sq: f64 = counts.values().map(|&n| (f64::from(n) - 400.0).powi(2) / 400.0).sum();
        let z = ((chi_sq / 127.0).cbrt() - (1.0 - 2.0 / (9.0 * 127.0))) / (2.0_f64 / (9.0 * 127.0)).sqrt();
        assert!(z.abs() < 5.85, "z = {z}");
    }
}
