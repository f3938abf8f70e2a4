use crate::Rgb;
use thiserror::Error;

/// Why a material is invalid.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MaterialError {
    /// A reflectance component is outside `[0, 1]` or not a number.
    #[error("reflectance {0} is not within [0, 1]")]
    Reflectance(Rgb),
    /// A radiance component is negative, not finite, or beyond [`Emission`](crate::Emission)'s range.
    #[error("radiance {0} has a component that is neither 0 nor within [1e-50, 1e50]")]
    Emission(Rgb),
}
