//! Normalised space: the scene moved to the origin and scaled to at most unit size.

use crate::Aabb;
use crate::ray::power_of_two;
use glam::{DVec3, Vec3};

/// A map from the scene to `[-1, 1]^3`. Scaling is by a power of two, so it rounds nothing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NormalizedSpace {
    pub(crate) center: DVec3,
    pub(crate) scale: f64,
}

impl NormalizedSpace {
    /// The space of a scene within `bounds`; the identity if they are empty.
    pub(crate) fn new(bounds: &Aabb) -> Self {
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        if bounds.is_empty() {
            return Self { center: DVec3::ZERO, scale: 1.0 };
        }
        let center = 0.5 * (min + max);
        let half = (max - center).max(center - min).max_element();
        Self { center, scale: power_of_two_below(half).recip() * 0.5 }
    }

    /// A position in this space, each coordinate with an absolute error of at most `2^-24`. Tiny coordinates become
    /// zero, since denormal operands are slow.
    #[inline]
    pub(crate) fn position(&self, position: Vec3) -> Vec3 {
        let position = (position.as_dvec3() - self.center) * self.scale;
        position.map(|x| if x.abs() < MIN_MAGNITUDE { 0.0 } else { x }).as_vec3()
    }

    /// A box in this space, each coordinate with the same error.
    pub(crate) fn map(&self, bounds: &Aabb) -> Aabb {
        Aabb { min: self.position(bounds.min), max: self.position(bounds.max) }
    }
}

/// Coordinates and coefficients of smaller magnitude become zero, since denormal operands are slow.
pub(super) const MIN_MAGNITUDE: f64 = power_of_two(-60);

/// The power of two with the exponent of `x`, a normal number.
#[inline]
pub(crate) fn power_of_two_below(x: f64) -> f64 {
    f64::from_bits(x.to_bits() & f64::INFINITY.to_bits())
}

/// `1 / x` for a power of two within `2^-1022..=2^1022`; anything for other numbers.
#[inline]
pub(crate) fn power_of_two_inverse(x: f64) -> f64 {
    f64::from_bits((2046_u64 << 52).wrapping_sub(x.to_bits()))
}
