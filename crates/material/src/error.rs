use crate::Rgb;
use thiserror::Error;

/// Why a material could not be made.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MaterialError {
    /// A reflectance component is outside `[0, 1]` or not a number.
    #[error("reflectance {0} is not within [0, 1]")]
    Reflectance(Rgb),
    /// A radiance component is negative, too large or not finite.
    #[error("radiance {0} is not within [0, 1e100]")]
    Emission(Rgb),
}
