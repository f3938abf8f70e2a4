use crate::{Bsdf, Emission, MaterialError, Reflectance, Rgb, Sides};

/// The material of a triangle: scattering and emission.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Scattering, the same on both sides.
    pub bsdf: Bsdf,
    /// Emission.
    pub emission: Emission,
}

impl Material {
    /// An ideal diffuse surface.
    ///
    /// # Errors
    /// [`MaterialError::Reflectance`] unless each component lies in `[0, 1]`.
    pub fn lambert(albedo: Rgb) -> Result<Self, MaterialError> {
        Ok(Self { bsdf: Bsdf::Lambert(Reflectance::new(albedo)?), emission: Emission::NONE })
    }

    /// An ideal mirror.
    ///
    /// # Errors
    /// [`MaterialError::Reflectance`] unless each component lies in `[0, 1]`.
    pub fn mirror(reflectance: Rgb) -> Result<Self, MaterialError> {
        Ok(Self { bsdf: Bsdf::Mirror(Reflectance::new(reflectance)?), emission: Emission::NONE })
    }

    /// A light: a black surface that emits `radiance` from its front, the side from which its vertices run
    /// counter-clockwise.
    ///
    /// The radiance is in W/(m^2 sr), or in any unit as long as all lights have the same one; the result then has
    /// it, too. It is not a power: a light of twice the area has twice the power. [`Emission::exitance`] is the
    /// power per area.
    ///
    /// # Errors
    /// Those of [`Emission::new`].
    pub fn light(radiance: Rgb) -> Result<Self, MaterialError> {
        let bsdf = Bsdf::Lambert(Reflectance::default());
        Ok(Self { bsdf, emission: Emission::new(radiance, Sides::Front)? })
    }

    /// The same material with this emission.
    #[must_use]
    pub const fn emitting(self, emission: Emission) -> Self {
        Self { emission, ..self }
    }
}
