use crate::{MaterialError, Rgb};

/// A reflectance, with each component in `[0, 1]`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reflectance(Rgb);

impl Reflectance {
    /// All is reflected.
    pub const ONE: Self = Self(Rgb::WHITE);

    /// The reflectance of these components.
    ///
    /// # Errors
    /// [`MaterialError::Reflectance`] for a component outside `[0, 1]` or NaN.
    pub fn new(rgb: Rgb) -> Result<Self, MaterialError> {
        let valid = rgb.to_array().iter().all(|x| (0.0..=1.0).contains(x));
        if valid { Ok(Self(rgb)) } else { Err(MaterialError::Reflectance(rgb)) }
    }

    /// The components.
    #[inline(always)]
    pub const fn rgb(self) -> Rgb {
        self.0
    }
}
