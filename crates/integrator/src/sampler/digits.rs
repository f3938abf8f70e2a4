//! Coordinates of digital sequences: their binary digits are sums modulo two of digits of the index.

/// A coordinate. Its number tells its scrambling from those of the others.
#[derive(Clone, Copy, Debug)]
pub(super) enum Axis {
    First = 2,
    Second = 3,
    ThirdSobol = 4,
    FourthSobol = 5,
    ThirdFaure = 6,
    FourthFaure = 7,
}

/// Sobol's sequence (1967). In base 2, two coordinates are a (0, 2)-sequence, three a (1, 3)-sequence, and all a
/// (3, 4)-sequence.
pub(super) const SOBOL: [Axis; 4] = [Axis::First, Axis::Second, Axis::ThirdSobol, Axis::FourthSobol];

/// A (0, 4)-sequence in base 4, after Faure (1982) with the field of four elements (Niederreiter 1987): of `4^m` points,
/// each box of volume `4^-m` whose sides are powers of 1/4 holds one. The first two coordinates and the last two are
/// (0, 2)-sequences in base 2 (Ahmed, Pharr, Ostromoukhov and Huang 2025).
pub(super) const FAURE: [Axis; 4] = [Axis::First, Axis::Second, Axis::ThirdFaure, Axis::FourthFaure];

impl Axis {
    /// The first `digits` binary digits of the points of these indices, which have as many.
    #[inline(always)]
    pub(super) fn digits_of<const N: usize>(self, mut indices: [u64; N], digits: u32) -> [u64; N] {
        for x in &mut indices {
            *x = match self {
                Self::First | Self::ThirdSobol | Self::FourthSobol => *x,
                Self::Second => skewed(pascal(*x)),
                Self::ThirdFaure => times_powers(pascal(times_powers(*x, false)), true),
                Self::FourthFaure => skewed(times_powers(pascal(times_powers(*x, true)), false)),
            };
        }
        match self {
            Self::ThirdSobol => {
                sobol(indices, digits, [1 << 31, 3 << 30], |[m0, m1]| [m1, m1 ^ m0 ^ (m0 >> 2)])
            }
            Self::FourthSobol => sobol(indices, digits, [1 << 31, 3 << 30, 1 << 29], |[m0, m1, m2]| {
                [m1, m2, m1 ^ m0 ^ (m0 >> 3)]
            }),
            _ => backward(indices, digits),
        }
    }
}

/// The first binary digit of each digit of base 4.
const FIRST: u64 = 0x5555_5555;

/// The digits of base 4 at the places that are 0, 1 and 2 modulo three.
const PLACES: [u64; 3] = [0xc30c_30c3, 0x0c30_c30c, 0x30c3_0c30];

/// Pascal's triangle modulo two: of the digits of base 4, digit `k` becomes the sum of those whose place has all binary
/// digits of `k` (Lucas 1878).
#[inline(always)]
fn pascal(mut x: u64) -> u64 {
    x ^= x >> 2 & 0x3333_3333;
    x ^= x >> 4 & 0x0f0f_0f0f;
    x ^= x >> 8 & 0x00ff_00ff;
    x ^ x >> 16
}

/// Adds the second binary digit of each digit of base 4 to the first. With [`pascal`] it is Pascal's triangle of binary
/// digits.
#[inline(always)]
fn skewed(x: u64) -> u64 {
    x ^ x >> 1 & FIRST
}

/// Multiplies the digit of base 4 at place `k`, an element of the field, by `a^k`, or by `a^-k` if `inverse`; `a` is the
/// element with `a^2 = a + 1`.
#[inline(always)]
fn times_powers(x: u64, inverse: bool) -> u64 {
    let (first, second) = (x & FIRST, x >> 1 & FIRST);
    let sum = first ^ second;
    let (times_a, times_square) = (sum | first << 1, second | sum << 1);
    let (one, two) = if inverse { (times_square, times_a) } else { (times_a, times_square) };
    x & PLACES[0] | one & PLACES[1] | two & PLACES[2]
}

/// The first `digits` binary digits of a Sobol' dimension, given by its first direction numbers and by how each follows
/// from those before it: the third from the polynomial x^2 + x + 1 with initial numbers 1 and 3, the fourth from
/// x^3 + x + 1 with 1, 3 and 1 (Joe and Kuo 2008).
#[inline(always)]
fn sobol<const N: usize, const D: usize>(
    mut indices: [u64; N],
    digits: u32,
    mut directions: [u64; D],
    next: impl Fn([u64; D]) -> [u64; D],
) -> [u64; N] {
    let mut sums = [0; N];
    for _ in 0..digits {
        for (sum, index) in sums.iter_mut().zip(&mut indices) {
            *sum ^= directions[0] & (*index & 1).wrapping_neg();
            *index >>= 1;
        }
        directions = next(directions);
    }
    sums.map(|sum| sum << digits >> 32)
}

/// The last `digits` binary digits in reverse order.
#[inline(always)]
pub(super) fn backward<const N: usize>(mut indices: [u64; N], digits: u32) -> [u64; N] {
    for index in &mut indices {
        *index = index.reverse_bits() >> (63 - digits) >> 1;
    }
    indices
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_points_are_those_of_sobol() {
        let [first, second, third, fourth] = SOBOL.map(|axis| axis.digits_of([0, 1, 2, 3, 4, 5, 6, 7], 3));
        // In eighths.
        assert_eq!(first, [0, 4, 2, 6, 1, 5, 3, 7]);
        assert_eq!(second, [0, 4, 6, 2, 5, 1, 3, 7]);
        assert_eq!(third, [0, 4, 6, 2, 3, 7, 5, 1]);
        assert_eq!(fourth, [0, 4, 6, 2, 1, 5, 7, 3]);
    }
}
