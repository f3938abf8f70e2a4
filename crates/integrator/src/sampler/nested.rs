/// Nested random permutations of numbers below `2^32`, by 64 random bits each. Their first digit is the lowest bit. A digit
/// of an image depends on this digit and on those before it, and images of numbers that differ in it first do so too.
///
/// With `y = x + a`, an image is `z ^ 2 z` for `z = y (m + K y)`: `a` and the odd `m` are random, `K` is a constant and even.
///
/// The images of two numbers are distributed as by Owen's scrambling ("Randomly Permuted (t,m,s)-Nets and (t,s)-Sequences",
/// 1995). If `k` is the first digit in which `x` and `x'` differ, the difference of their `z` is that of `x` and `x'` times
/// `m + K (y + y')`. This factor is odd and uniform for any `y` and `y'`, so the difference is uniform among the numbers
/// whose lowest bit is bit `k`. For a given factor `z` is a permutation of `y`, which is uniform. A mean of values of the
/// points therefore has the same variance. Matoušek ("On the L2-Discrepancy for Anchored Boxes", 1998) uses random matrices
/// to this end.
///
/// Without `K`, and without the sum modulo two, images of several numbers depend on each other: the mean over a net then has
/// the same variance and a kurtosis of up to 900.
///
/// The images have 64 digits, of which the first 32 are permuted.
#[inline(always)]
pub(super) fn permuted<const N: usize>(mut x: [u64; N], random: [u64; N]) -> [u64; N] {
    for (x, random) in x.iter_mut().zip(random) {
        let y = x.wrapping_add(random) & LOWER;
        let factor = (random >> 32 | 1).wrapping_add(K * y) & LOWER;
        let z = y * factor;
        *x = z ^ z << 1;
    }
    x
}

/// The factors of a product of 64 bits have 32.
const LOWER: u64 = 0xffff_ffff;

/// Twice an odd number below `2^31`, with the bits of the golden ratio.
const K: u64 = 0x3c6e_f372;

/// The lowest `digits` bits in reverse order.
#[inline(always)]
pub(super) fn backward<const N: usize>(mut x: [u64; N], digits: u32) -> [u64; N] {
    for x in &mut x {
        *x = x.reverse_bits() >> (63 - digits) >> 1;
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each pair of images that has as many first digits in common as two numbers of four digits is as likely: chi-square,
    /// whose normal equivalent (Wilson and Hilferty 1931) is accepted up to 5.85. The first digits of 32, and the last.
    #[test]
    fn pairs_of_images_are_those_of_owens_scrambling() {
        for shift in [0, 28] {
            let draws = 1 << 16;
            let mut counts = vec![0_u32; 1 << 16];
            for random in (0..draws).map(crate::hash::mix) {
                let numbers = std::array::from_fn(|x| (x as u64) << shift);
                let images = permuted(numbers, [random; 16]).map(|image| image >> shift & 15);
                for (x, y) in (0..16).flat_map(|x| (0..16).map(move |y| (x, y))) {
                    counts[x << 12 | y << 8 | (images[x] << 4 | images[y]) as usize] += 1;
                }
            }
            for (x, y) in (0..16).flat_map(|x| (0..16).map(move |y| (x, y))).filter(|(x, y)| x != y) {
                let z = z_of_pair([x, y], &counts[x << 12 | y << 8..][..256], draws as f64);
                assert!(z < 5.85, "{x} and {y}, shift {shift}: z = {z}");
            }
        }
    }

    /// The deviate of the counts of pairs of images.
    fn z_of_pair([x, y]: [usize; 2], counts: &[u32], draws: f64) -> f64 {
        let first = (x ^ y).trailing_zeros();
        let pairs = f64::from(16 << (3 - first));
        let mut chi_sq = 0.0;
        for (images, &count) in counts.iter().enumerate() {
            let [a, b] = [images >> 4, images & 15];
            if a != b && (a ^ b).trailing_zeros() == first {
                chi_sq += (f64::from(count) - draws / pairs).powi(2) / (draws / pairs);
            } else {
                assert_eq!(count, 0, "{x} and {y} are not {a} and {b}");
            }
        }
        let spread = 2.0 / (9.0 * (pairs - 1.0));
        ((chi_sq / (pairs - 1.0)).cbrt() - (1.0 - spread)) / spread.sqrt()
    }
}
