use crate::{Bsdf, MaterialError, Rgb};

/// A reflectance: each component in `[0, 1]`, so that no surface makes light of nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reflectance(Rgb);

impl Reflectance {
    /// Takes `rgb`.
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

/// From which side of a triangle something happens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sides {
    /// The front, from which the vertices run counter-clockwise.
    Front,
    /// Front and back alike.
    Both,
}

/// Light that a surface emits evenly in all directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emission {
    radiance: Rgb,
    sides: Sides,
}

impl Emission {
    /// No light at all.
    pub const NONE: Self = Self { radiance: Rgb::BLACK, sides: Sides::Front };

    /// The largest radiance: sums and squares of it stay finite.
    pub const MAX_RADIANCE: f64 = 1e100;

    /// Emits `radiance`, in power per area and steradian, from `sides`.
    ///
    /// # Errors
    /// [`MaterialError::Emission`] for a component outside `[0, MAX_RADIANCE]` or NaN.
    pub fn new(radiance: Rgb, sides: Sides) -> Result<Self, MaterialError> {
        let valid = radiance.to_array().iter().all(|x| (0.0..=Self::MAX_RADIANCE).contains(x));
        if valid { Ok(Self { radiance, sides }) } else { Err(MaterialError::Emission(radiance)) }
    }

    /// The radiance emitted toward a direction whose cosine with the front normal is `cos`;
    /// black along the surface.
    #[inline(always)]
    pub fn toward(&self, cos: f64) -> Rgb {
        let emits = match self.sides {
            Sides::Front => cos > 0.0,
            Sides::Both => cos != 0.0,
        };
        if emits { self.radiance } else { Rgb::BLACK }
    }

    /// Radiant exitance: the power that leaves one unit of area, all emitting sides together.
    pub fn exitance(&self) -> Rgb {
        let sides = if self.sides == Sides::Both { 2.0 } else { 1.0 };
        self.radiance * (sides * std::f64::consts::PI)
    }

    /// Whether there is none.
    pub fn is_none(&self) -> bool {
        self.radiance.is_black()
    }
}

/// What a triangle is made of: how it scatters light, and what it emits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// How light is scattered, on both sides.
    pub bsdf: Bsdf,
    /// What is emitted.
    pub emission: Emission,
}

impl Material {
    /// An ideal diffuse surface of that albedo.
    ///
    /// # Errors
    /// [`MaterialError::Reflectance`] unless each component lies in `[0, 1]`.
    pub fn lambert(albedo: Rgb) -> Result<Self, MaterialError> {
        Ok(Self { bsdf: Bsdf::Lambert(Reflectance::new(albedo)?), emission: Emission::NONE })
    }

    /// An ideal mirror of that reflectance.
    ///
    /// # Errors
    /// [`MaterialError::Reflectance`] unless each component lies in `[0, 1]`.
    pub fn mirror(reflectance: Rgb) -> Result<Self, MaterialError> {
        Ok(Self { bsdf: Bsdf::Mirror(Reflectance::new(reflectance)?), emission: Emission::NONE })
    }

    /// A black surface that emits `radiance` from its front.
    ///
    /// # Errors
    /// [`MaterialError::Emission`] for a component outside `[0, Emission::MAX_RADIANCE]` or NaN.
    pub fn lamp(radiance: Rgb) -> Result<Self, MaterialError> {
        let bsdf = Bsdf::Lambert(Reflectance::default());
        Ok(Self { bsdf, emission: Emission::new(radiance, Sides::Front)? })
    }

    /// The same material, emitting.
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
        for bad in [-0.1, 1.1e100, f64::NAN, f64::INFINITY] {
            assert!(Material::lamp(Rgb::new(0.5, bad, 0.5)).is_err(), "{bad}");
        }
        assert!(Material::lamp(Rgb::splat(1000.0)).is_ok());
    }

    #[test]
    fn a_lamp_shines_from_its_front_unless_double_sided() {
        let front = Emission::new(Rgb::WHITE, Sides::Front).unwrap();
        assert_eq!((front.toward(0.1), front.toward(-0.1)), (Rgb::WHITE, Rgb::BLACK));
        let both = Emission::new(Rgb::WHITE, Sides::Both).unwrap();
        assert_eq!((both.toward(0.1), both.toward(-0.1)), (Rgb::WHITE, Rgb::WHITE));
        assert_eq!(both.exitance().r, 2.0 * front.exitance().r);
        assert_eq!(both.toward(0.0), Rgb::BLACK);
    }
}
