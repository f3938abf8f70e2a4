use crate::hash::nth;

/// A random permutation of the numbers of some binary digits that keeps together what shares its
/// leading digits: each digit is flipped, or not, by a coin that depends on all digits before it
/// (Owen, "Randomly Permuted (t,m,s)-Nets and (t,s)-Sequences", 1995).
///
/// The coins are the nodes of a binary tree, numbered as in a heap and kept 64 to a hash, so that
/// the scrambling is Owen's itself and not an approximation, at one hash for up to six digits.
#[derive(Clone, Copy)]
pub(crate) struct NestedPermutation {
    key: u64,
    purpose: u64,
}

impl NestedPermutation {
    /// One of the permutations of `key`, told apart by `purpose`.
    #[inline]
    pub(super) fn new(key: u64, purpose: u64) -> Self {
        Self { key, purpose: purpose << 40 }
    }

    /// The number that `x`, of so many `digits` (at most 31), becomes.
    #[inline]
    pub(super) fn apply(&self, x: u32, digits: u32) -> u32 {
        // The node of a digit is a one and the digits before it.
        let path = (1 << digits) | x;
        let mut flips = 0;
        let coins = self.coins(0);
        for level in 0..digits.min(6) {
            let node = path >> (digits - level);
            flips = flips << 1 | (coins >> (node % 64)) as u32 & 1;
        }
        for level in 6..digits {
            let node = path >> (digits - level);
            flips = flips << 1 | (self.coins(node / 64) >> (node % 64)) as u32 & 1;
        }
        x ^ flips
    }

    /// 64 random bits that belong to the number that `x` has become.
    #[inline]
    pub(super) fn below(&self, x: u32) -> u64 {
        nth(self.key, self.purpose + (1 << 32) + u64::from(x))
    }

    #[inline]
    fn coins(&self, word: u32) -> u64 {
        nth(self.key, self.purpose + u64::from(word))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_permutes_and_keeps_leading_digits_together() {
        for digits in [1, 4, 6, 7, 9] {
            let permutation = NestedPermutation::new(3, 1);
            let images: Vec<_> = (0..1_u32 << digits).map(|x| permutation.apply(x, digits)).collect();
            let mut sorted = images.clone();
            sorted.sort_unstable();
            assert!((0..).zip(&sorted).all(|(i, &x)| i == x), "{digits}");
            for shared in 0..=digits {
                let group = 1 << (digits - shared);
                assert!(
                    images
                        .chunks(group)
                        .all(|c| c.iter().all(|x| x >> (digits - shared) == c[0] >> (digits - shared)))
                );
            }
        }
    }

    /// All 128 permutations of three digits, equally often: chi-square with 127 degrees of freedom,
    /// whose normal equivalent (Wilson and Hilferty 1931) is accepted up to 5.85.
    #[test]
    fn every_nested_permutation_is_as_likely() {
        let mut counts = std::collections::HashMap::new();
        let draws = 128 * 400;
        for key in 0..draws {
            let permutation = NestedPermutation::new(crate::hash::mix(key), 0);
            let images: Vec<_> = (0..8).map(|x| permutation.apply(x, 3)).collect();
            *counts.entry(images).or_insert(0_u32) += 1;
        }
        assert_eq!(counts.len(), 128);
        let chi_sq: f64 = counts.values().map(|&n| (f64::from(n) - 400.0).powi(2) / 400.0).sum();
        let z = ((chi_sq / 127.0).cbrt() - (1.0 - 2.0 / (9.0 * 127.0))) / (2.0_f64 / (9.0 * 127.0)).sqrt();
        assert!(z.abs() < 5.85, "z = {z}");
    }
}
