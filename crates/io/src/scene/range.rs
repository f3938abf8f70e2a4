use globillum_geom::Triangle;
use std::fmt::LowerExp;
use std::ops::Neg;

/// Checks that numbers are within [`Triangle::MAX_COORDINATE`] in magnitude. The error names the first
/// that is not, as a `what`. NaN is out of range.
pub(crate) fn check_range<T>(what: &str, numbers: impl IntoIterator<Item = T>) -> Result<(), String>
where
    T: Copy + PartialOrd + From<f32> + Neg<Output = T> + LowerExp,
{
    let limit = T::from(Triangle::MAX_COORDINATE);
    match numbers.into_iter().find(|x| !(-limit..=limit).contains(x)) {
        Some(x) => Err(format!("{what} {x:e} exceeds {limit:e} in magnitude")),
        None => Ok(()),
    }
}
