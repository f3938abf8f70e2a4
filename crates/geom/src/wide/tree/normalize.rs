//! Normalised space: the scene moved to the origin and scaled to at most unit size.

use crate::Aabb;
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

    /// A coordinate in this space, with an absolute error of at most `2^-24`. Tiny ones become zero, since
    /// denormal operands are slow.
    pub(crate) fn coordinate(&self, axis: usize, x: f32) -> f32 {
        let x = (f64::from(x) - self.center[axis]) * self.scale;
        if x.abs() < 2.0_f64.powi(-60) { 0.0 } else { x as f32 }
    }

    /// A box in this space, each coordinate with the same error.
    pub(crate) fn map(&self, bounds: &Aabb) -> Aabb {
        let map = |v: Vec3| Vec3::from([0, 1, 2].map(|axis| self.coordinate(axis, v[axis])));
        Aabb { min: map(bounds.min), max: map(bounds.max) }
    }
}

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
