//! Parsers of numbers on the command line. Their messages say what is allowed.

use std::fmt::Display;
use std::ops::{Range, RangeInclusive};
use std::str::FromStr;

/// A parser of integers in `range`.
pub(crate) fn integer<T>(range: RangeInclusive<T>) -> impl Fn(&str) -> Result<T, String> + Clone
where
    T: FromStr + PartialOrd + Display + Clone,
{
    move |text| {
        let number = text.parse().ok().filter(|number| range.contains(number));
        number.ok_or_else(|| format!("must be an integer from {} to {}", range.start(), range.end()))
    }
}

/// A positive number.
pub(crate) fn positive(text: &str) -> Result<f64, String> {
    finite(text).ok().filter(|&number| number > 0.0).ok_or_else(|| "must be a number above 0".into())
}

/// A number that is zero or positive.
pub(crate) fn not_negative(text: &str) -> Result<f64, String> {
    finite(text).ok().filter(|&number| number >= 0.0).ok_or_else(|| "must be 0 or a number above".into())
}

/// A number above 0 and below 1.
pub(crate) fn probability(text: &str) -> Result<f64, String> {
    let number = positive(text).ok().filter(|&number| number < 1.0);
    number.ok_or_else(|| "must be a number above 0 and below 1".into())
}

/// A number from 0 to 1.
pub(crate) fn share(text: &str) -> Result<f64, String> {
    let number = finite(text).ok().filter(|number| (0.0..=1.0).contains(number));
    number.ok_or_else(|| "must be a number from 0 to 1".into())
}

/// Any number but infinities and NaN.
pub(crate) fn finite(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| "must be a finite number".into())
}

/// A power of two up to `largest`.
pub(crate) fn power_of_two(largest: u32) -> impl Fn(&str) -> Result<u32, String> + Clone + Send + Sync {
    move |text| {
        let number = text.parse().ok().filter(|&number: &u32| number.is_power_of_two() && number <= largest);
        number.ok_or_else(|| format!("must be a power of two from 1 to {largest}"))
    }
}

/// `A..B`, a range that is not empty.
pub(crate) fn passes(text: &str) -> Result<Range<u32>, String> {
    let parse = || {
        let (start, end) = text.split_once("..")?;
        Some(start.parse().ok()?..end.parse().ok()?)
    };
    let range = parse().filter(|range: &Range<u32>| !range.is_empty());
    range.ok_or_else(|| "must be A..B with integers A < B, such as 0..8".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_have_both_their_ends() {
        let parse = integer(2_u32..=5);
        assert_eq!(["2", "5"].map(&parse), [Ok(2), Ok(5)]);
        for text in ["1", "6", "-1", "2.5", "", "two"] {
            assert_eq!(parse(text), Err("must be an integer from 2 to 5".into()));
        }
    }

    #[test]
    fn numbers_are_finite_and_on_their_side_of_zero() {
        assert_eq!(["0.5", "1e-300"].map(positive), [Ok(0.5), Ok(1e-300)]);
        assert_eq!(["0", "2"].map(not_negative), [Ok(0.0), Ok(2.0)]);
        assert_eq!(["-2", "0"].map(finite), [Ok(-2.0), Ok(0.0)]);
        assert_eq!(["0", "1e-300", "1"].map(share), [Ok(0.0), Ok(1e-300), Ok(1.0)]);
        assert!(["-1e-300", "1.001", "2", "nan", "x"].into_iter().all(|text| share(text).is_err()));
        assert!(["0", "-1", "inf", "nan", "x"].into_iter().all(|text| positive(text).is_err()));
        assert!(["-1", "inf", "nan", "x"].into_iter().all(|text| not_negative(text).is_err()));
        assert!(["inf", "-inf", "nan", "x"].into_iter().all(|text| finite(text).is_err()));
    }

    #[test]
    fn passes_and_powers_of_two() {
        assert_eq!(passes("3..8"), Ok(3..8));
        assert!(["3", "3..", "4..4", "4..2", "0..-1", "a..b"].into_iter().all(|text| passes(text).is_err()));
        let power_of_two = power_of_two(16);
        assert_eq!(["1", "16"].map(&power_of_two), [Ok(1), Ok(16)]);
        assert!(["0", "3", "32"].into_iter().all(|text| power_of_two(text).is_err()));
    }
}
