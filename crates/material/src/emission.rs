use crate::{MaterialError, Rgb};

/// The sides of a triangle that emit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sides {
    /// The front, from where the vertices run counter-clockwise.
    Front,
    /// Front and back.
    Both,
}

/// The emission of a surface: constant radiance in all directions.
///
/// Each component is 0 or within [`Emission::MIN_RADIANCE`] and [`Emission::MAX_RADIANCE`], as every finite
/// `f32` above zero is. Errors are estimated from fourth powers of radiance, which stay within the range of
/// `f64` (docs/numerics.md).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emission {
    radiance: Rgb,
    sides: Sides,
}

impl Emission {
    /// No emission.
    pub const NONE: Self = Self { radiance: Rgb::BLACK, sides: Sides::Front };

    /// The smallest radiance above zero of a component.
    pub const MIN_RADIANCE: f64 = 1e-50;

    /// The largest radiance of a component.
    pub const MAX_RADIANCE: f64 = 1e50;

    /// Emission of `radiance`, in power per area and steradian, from `sides`.
    ///
    /// # Errors
    /// [`MaterialError::Emission`] for a component that is neither 0 nor within
    /// `[MIN_RADIANCE, MAX_RADIANCE]`, or NaN.
    pub fn new(radiance: Rgb, sides: Sides) -> Result<Self, MaterialError> {
        if Self::allows(radiance) {
            Ok(Self { radiance, sides })
        } else {
            Err(MaterialError::Emission(radiance))
        }
    }

    /// Whether each component is 0 or within `[MIN_RADIANCE, MAX_RADIANCE]`. Point, spot and directional lights have the
    /// same range of intensity or irradiance.
    pub fn allows(radiance: Rgb) -> bool {
        let range = Self::MIN_RADIANCE..=Self::MAX_RADIANCE;
        radiance.to_array().iter().all(|x| *x == 0.0 || range.contains(x))
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

    /// The radiant exitance: emitted power per area, of all emitting sides.
    pub fn exitance(&self) -> Rgb {
        let sides = if self.sides == Sides::Both { 2.0 } else { 1.0 };
        self.radiance * (sides * std::f64::consts::PI)
    }

    /// Whether the radiance is black.
    pub fn is_black(&self) -> bool {
        self.radiance.is_black()
    }
}
