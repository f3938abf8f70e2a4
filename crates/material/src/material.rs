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

    /// A light: a black surface that emits `radiance` from its front.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impossible_materials_are_refused() {
        for bad in [-0.1, 1.1, f64::NAN, f64::INFINITY] {
            assert!(Material::lambert(Rgb::new(0.5, bad, 0.5)).is_err(), "{bad}");
            assert!(Material::mirror(Rgb::new(bad, 0.5, 0.5)).is_err(), "{bad}");
        }
        for bad in [-0.1, 5e-324, 1e-300, 0.9e-50, 1.1e50, 1e300, f64::NAN, f64::INFINITY] {
            let error = Material::light(Rgb::new(0.5, bad, 0.5)).unwrap_err().to_string();
            assert!(
                error.contains(") has a component that is neither 0 nor within [1e-50, 1e50]"),
                "{error}"
            );
        }
        let extremes = [f32::from_bits(1), f32::MAX].map(f64::from);
        for good in [0.0, -0.0, 1e-50, 1000.0, 1e50].into_iter().chain(extremes) {
            assert!(Material::light(Rgb::new(0.5, good, 0.5)).is_ok(), "{good}");
        }
    }

    #[test]
    fn a_light_shines_from_its_front_unless_double_sided() {
        let front = Emission::new(Rgb::WHITE, Sides::Front).unwrap();
        assert_eq!((front.toward(0.1), front.toward(-0.1)), (Rgb::WHITE, Rgb::BLACK));
        let both = Emission::new(Rgb::WHITE, Sides::Both).unwrap();
        assert_eq!((both.toward(0.1), both.toward(-0.1)), (Rgb::WHITE, Rgb::WHITE));
        assert_eq!(both.exitance().r, 2.0 * front.exitance().r);
        assert_eq!(both.toward(0.0), Rgb::BLACK);
    }
}
