use super::light_moments::LightMoments;
use crate::light::receiver::Receiver;
use crate::light::unit_of_length::units_per_length;
use glam::DVec3;
use globillum_geom::Aabb;

/// The frame of a tree, in which the centers of the lights, each with the standard deviation of its points, lie within
/// `[-1, 1]`. Single precision has enough range for offsets there, though not the precision for positions: offsets are
/// differences in double precision. No unit of length matters.
#[derive(Clone, Copy, Debug)]
pub(super) struct TreeFrame {
    origin: DVec3,
    /// A power of two.
    scale: f64,
}

impl TreeFrame {
    /// The largest distance of a receiver. Points beyond count as if they were at this distance, in the same direction.
    const FARTHEST: f64 = 1e15;

    /// Around `lights` in a scene with these bounds.
    pub(super) fn around(lights: impl Iterator<Item = LightMoments>, scene: &Aabb) -> Self {
        let corners = |light: LightMoments| {
            let extent = light.variance.map(f64::sqrt);
            (light.center - extent, light.center + extent)
        };
        let all = lights.map(corners).reduce(|(min, max), (a, b)| (min.min(a), max.max(b)));
        let (min, max) = all.unwrap_or_default();
        let (size, origin) = (0.5 * (max - min).max_element(), 0.5 * (min + max));
        Self { origin, scale: units_per_length(size, origin, scene) }
    }

    /// A receiver in the world.
    #[inline(always)]
    pub(super) fn receiver(&self, Receiver { position, normal }: Receiver) -> Receiver {
        Receiver { position: self.position(position), normal }
    }

    /// A position in the world.
    #[inline(always)]
    pub(super) fn position(&self, position: DVec3) -> DVec3 {
        let in_frame = (position - self.origin) * self.scale;
        let distance_sq = in_frame.length_squared();
        if distance_sq <= Self::FARTHEST * Self::FARTHEST {
            in_frame
        } else {
            in_frame * (Self::FARTHEST / distance_sq.sqrt())
        }
    }

    /// Variances of coordinates in the world.
    pub(super) fn variance(&self, variance: DVec3) -> DVec3 {
        variance * (self.scale * self.scale)
    }

    /// The intensity that brings the irradiance of `intensity` at the same places in this frame.
    pub(super) fn intensity(&self, intensity: f64) -> f64 {
        intensity * self.scale * self.scale
    }
}
