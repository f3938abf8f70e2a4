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
    /// The binary digits of the points of these indices, which are below `2^32`. The first digit is the lowest bit.
    #[inline(always)]
    pub(super) fn digits_of<const N: usize>(self, mut indices: [u64; N]) -> [u64; N] {
        for x in &mut indices {
            *x = match self {
                Self::First => *x,
                Self::Second => skewed(pascal(*x)),
                Self::ThirdSobol => skewed(in_powers::<2>(*x)),
                Self::FourthSobol => {
                    let digits = in_powers::<3>(*x);
                    digits ^ digits >> 1 & const { ones(1, 3) }
                }
                Self::ThirdFaure => times_powers(pascal(times_powers(*x, false)), true),
                Self::FourthFaure => skewed(times_powers(pascal(times_powers(*x, true)), false)),
            };
        }
        indices
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

/// The polynomial modulo two whose coefficients are the digits of `x`, as a sum of powers of `x^DEGREE + x + 1`, for
/// degrees 2 and 3: each `DEGREE` digits of the result are the coefficients of a factor.
///
/// Up to a fixed matrix for the digits of a factor, these are the digits of Sobol's coordinate of this polynomial: for degree
/// 2 with the initial numbers 1 and 3, for degree 3 with 1, 3 and 1 (Joe and Kuo 2008).
#[inline(always)]
fn in_powers<const DEGREE: u32>(x: u64) -> u64 {
    let x = divided::<DEGREE, 8>(x);
    let x = divided::<DEGREE, 4>(x);
    let x = divided::<DEGREE, 2>(x);
    divided::<DEGREE, 1>(x)
}

/// Divides each polynomial of twice as many digits as the divisor `(x^DEGREE + x + 1)^POWER`, which is
/// `x^WIDTH + x^POWER + 1` for a power of two. The quotient follows the remainder.
#[inline(always)]
fn divided<const DEGREE: u32, const POWER: u32>(x: u64) -> u64 {
    let width = DEGREE * POWER;
    let lows = const { ones(DEGREE * POWER, 2 * DEGREE * POWER) };
    let high = x >> width & lows;
    let quotient = high ^ high >> (width - POWER) & const { ones(POWER, 2 * DEGREE * POWER) };
    let remainder = x & lows ^ quotient ^ quotient << POWER & lows;
    remainder | quotient << width
}

/// The first `count` bits of each `period` bits.
const fn ones(count: u32, period: u32) -> u64 {
    let (mut ones, mut first) = (0, 0);
    while first < u64::BITS {
        ones |= ((1 << count) - 1) << first;
        first += period;
    }
    ones
}

#[cfg(test)]
mod tests {
    use super::super::nested::backward;
    use super::*;

    #[test]
    fn the_first_points_are_those_of_sobol() {
        let [first, second, third, fourth] =
            SOBOL.map(|axis| backward(axis.digits_of([0, 1, 2, 3, 4, 5, 6, 7]), 3));
        // In eighths.
        assert_eq!(first, [0, 4, 2, 6, 1, 5, 3, 7]);
        assert_eq!(second, [0, 4, 6, 2, 5, 1, 3, 7]);
        assert_eq!(third, [0, 4, 6, 2, 3, 7, 5, 1]);
        assert_eq!(fourth, [0, 4, 6, 2, 1, 5, 7, 3]);
    }

    /// Digits from direction numbers, by the recurrence of Joe and Kuo (2008), as sums of a column for each digit of the
    /// index.
    #[test]
    fn coordinates_of_powers_are_those_of_direction_numbers() {
        let third = directions([1, 3], |[v0, v1]| [v1, v1 ^ v0 ^ v0 << 2]);
        let fourth = directions([1, 3, 4], |[v0, v1, v2]| [v1, v2, v1 ^ v0 ^ v0 << 3]);
        let many = (0..4096).chain((0..4096).map(|i| crate::hash::mix(i) >> 32));
        for index in many {
            let sum = |directions: &[u64; 32]| {
                directions
                    .iter()
                    .enumerate()
                    .fold(0, |sum, (k, &v)| if index >> k & 1 == 1 { sum ^ v } else { sum })
            };
            assert_eq!(Axis::ThirdSobol.digits_of([index]), [sum(&third)]);
            assert_eq!(Axis::FourthSobol.digits_of([index]), [sum(&fourth)]);
        }
    }

    /// The lowest bit of a direction number is its first digit.
    fn directions<const D: usize>(mut last: [u64; D], next: impl Fn([u64; D]) -> [u64; D]) -> [u64; 32] {
        std::array::from_fn(|_| {
            let direction = last[0];
            last = next(last);
            direction
        })
    }
}
