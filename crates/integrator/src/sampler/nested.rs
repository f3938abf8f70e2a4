use crate::hash::nth;

/// `N` nested random permutations of binary numbers: each digit is flipped by a random bit that depends on
/// all digits before it (Owen, "Randomly Permuted (t,m,s)-Nets and (t,s)-Sequences", 1995).
///
/// The random bits belong to the nodes of a binary tree. A hash has those of the six levels that begin at a node, in
/// heap order: this is exact Owen scrambling at one hash for every six digits. The loops over `N` are vectorised by
/// the compiler.
#[derive(Clone, Copy)]
pub(super) struct NestedPermutations<const N: usize> {
    keys: [u64; N],
    purpose: u64,
}

/// Digits whose random bits are in one hash.
pub(super) const LEVELS: u32 = 6;

impl<const N: usize> NestedPermutations<N> {
    /// A permutation for each key; keys have independent permutations for each `purpose`.
    #[inline(always)]
    pub(super) fn new(keys: [u64; N], purpose: u64) -> Self {
        Self { keys, purpose: purpose << 40 }
    }

    /// The images of `x`, numbers of `digits` binary digits (at most 31).
    #[inline(always)]
    pub(super) fn apply(&self, x: [u64; N], digits: u32) -> [u64; N] {
        let mut flips = [0; N];
        for root in (0..digits).step_by(LEVELS as usize) {
            let mut words = [0; N];
            if root > 0 {
                for i in 0..N {
                    words[i] = tail_after_one(x[i], digits) >> (digits - root);
                }
            }
            let coins = self.hashes(words);
            append_flips(&mut flips, coins, x, root, digits);
        }
        flipped(x, flips)
    }

    /// 64 random bits for each image `x`.
    #[inline(always)]
    pub(super) fn random_after(&self, x: [u64; N]) -> [u64; N] {
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

/// The images of `x`, numbers of up to six binary digits, by permutations whose random bits are `coins`: those of `k`
/// digits are the bits 1 to `2^k - 1`.
#[inline(always)]
pub(super) fn permuted<const N: usize>(coins: [u64; N], x: [u64; N], digits: u32) -> [u64; N] {
    let mut flips = [0; N];
    append_flips(&mut flips, coins, x, 0, digits);
    flipped(x, flips)
}

/// Appends to `flips` the random bits of the levels from `root` on that are in one word.
#[inline(always)]
fn append_flips<const N: usize>(flips: &mut [u64; N], coins: [u64; N], x: [u64; N], root: u32, digits: u32) {
    let mut tails = x;
    for tail in &mut tails {
        *tail = tail_after_one(*tail, digits - root);
    }
    for level in root..digits.min(root + LEVELS) {
        for i in 0..N {
            flips[i] = flips[i] << 1 | coins[i] >> (tails[i] >> (digits - level)) & 1;
        }
    }
}

#[inline(always)]
fn flipped<const N: usize>(mut x: [u64; N], flips: [u64; N]) -> [u64; N] {
    for (x, flips) in x.iter_mut().zip(flips) {
        *x ^= flips;
    }
    x
}

/// A one followed by the last `digits` of `x`. Without its own last digits it is the heap index of the node of a digit,
/// in the tree below the digits that are left out.
#[inline(always)]
fn tail_after_one(x: u64, digits: u32) -> u64 {
    let first = 1 << digits;
    first | x & (first - 1)
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
