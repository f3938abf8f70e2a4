use super::cluster::Cluster;
use crate::light::receiver::Receiver;
use glam::DVec3;

/// The frame of a tree, in which the centers of the lights, each with the standard deviation of its points, lie within
/// `[-1, 1]`. Single precision has enough range there, and no unit of length matters.
#[derive(Clone, Copy, Debug)]
pub(super) struct TreeFrame {
    origin: DVec3,
    /// A power of two.
    scale: f64,
}

impl TreeFrame {
    /// The largest coordinate of a shading point. Points beyond count as if they were at this distance.
    const FARTHEST: f64 = 1e15;

    /// Around `lights`; the world frame without any.
    pub(super) fn around(lights: impl Iterator<Item = Cluster>) -> Self {
        let corners = |light: Cluster| {
            let extent = light.variance.map(f64::sqrt);
            (light.center - extent, light.center + extent)
        };
        let all = lights.map(corners).reduce(|(min, max), (a, b)| (min.min(a), max.max(b)));
        let (min, max) = all.unwrap_or_default();
        let (_, exponent) = libm::frexp(0.5 * (max - min).max_element());
        Self { origin: 0.5 * (min + max), scale: libm::ldexp(1.0, -exponent) }
    }

    /// A receiver in the world.
    #[inline(always)]
    pub(super) fn receiver(&self, Receiver { position, side }: Receiver) -> Receiver {
        Receiver { position: self.position(position), side }
    }

    /// The place of a position in the world.
    #[inline(always)]
    pub(super) fn position(&self, position: DVec3) -> DVec3 {
        let farthest = DVec3::splat(Self::FARTHEST);
        ((position - self.origin) * self.scale).max(-farthest).min(farthest)
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
