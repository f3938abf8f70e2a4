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
///
/// ```
/// use globillum_material::{Emission, Rgb, Sides};
///
/// let lamp = Emission::new(Rgb::new(3.0, 2.0, 1.0), Sides::Both)?;
/// assert_eq!((lamp.radiance(), lamp.sides()), (Rgb::new(3.0, 2.0, 1.0), Sides::Both));
/// assert_eq!(lamp.toward(-0.5), lamp.radiance());
/// # Ok::<(), globillum_material::MaterialError>(())
/// ```
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

    /// Emission of `radiance`, in power per area and steradian (W/(m^2 sr), or the unit of all other lights), from
    /// `sides`.
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

    /// The radiance from each emitting side, in power per area and steradian; black if nothing is emitted.
    #[inline(always)]
    pub const fn radiance(self) -> Rgb {
        self.radiance
    }

    /// The sides that emit the [radiance](Emission::radiance), also if it is black.
    #[inline(always)]
    pub const fn sides(self) -> Sides {
        self.sides
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
