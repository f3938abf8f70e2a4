//! Conservative pruning: what may be discarded before a decision.
//!
//! A hit's computed `t` puts the ray's point within `24 u * reach` of a point of the triangle, on
//! every axis, where `u = 2^-53` and `reach` is the largest coordinate distance between the ray's
//! origin and the scene's bounds (docs/numerics.md derives it). Accelerators therefore widen
//! every plane by [`Pruner::slack`], which covers that and the rounding of the plane's own
//! parameter, and visit what the widened planes admit.

use crate::decide::main_axis;
use crate::{Aabb, Ray};
use glam::DVec3;

/// An interval of the ray parameter, both ends included; empty if `start > end`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Span {
    pub(crate) start: f64,
    pub(crate) end: f64,
}

/// A ray made ready for comparing with axis-parallel planes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pruner {
    pub(crate) origin: DVec3,
    pub(crate) direction: DVec3,
    pub(crate) inverse: DVec3,
    /// Half the thickness of every plane, in units of length.
    pub(crate) slack: f64,
}

/// Slack in units of `u * reach`: 24 for the hit point, the rest for what accelerators compute.
const SLACK_ULPS: f64 = 64.0;

/// Direction components below this fraction of the largest count as this fraction, so that no
/// quotient is NaN. Over any distance at which the scene lies, the difference is far below the
/// slack.
pub(crate) const PARALLEL: f64 = f64::from_bits((1023 - 200) << 52);

impl Pruner {
    /// Prepares a [traceable](Ray::is_traceable) ray for a scene within `bounds`.
    pub(crate) fn new(ray: &Ray, bounds: &Aabb) -> Self {
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let reach = (min - ray.origin).abs().max((max - ray.origin).abs()).max_element();
        let smallest = PARALLEL * ray.direction[main_axis(ray.direction)].abs();
        let direction = ray.direction.map(|d| if d.abs() < smallest { smallest } else { d });
        Self {
            origin: ray.origin,
            direction,
            inverse: direction.recip(),
            slack: SLACK_ULPS * (f64::EPSILON / 2.0) * reach,
        }
    }

    /// The parameter at which the ray has gone `distance` along `axis`, the slack added if
    /// `later`, subtracted otherwise.
    ///
    /// `distance` is to carry a relative error of a few `u`, or an absolute one of a few
    /// `u * reach`.
    #[inline]
    pub(crate) fn crossing(&self, axis: usize, distance: f64, later: bool) -> f64 {
        let slack = self.slack.copysign(self.inverse[axis]);
        (if later { distance + slack } else { distance - slack }) * self.inverse[axis]
    }

    /// The part of the ray's range that lies within the widened `bounds`.
    pub(crate) fn clip(&self, ray: &Ray, bounds: &Aabb) -> Span {
        let (min, max) = (bounds.min.as_dvec3() - self.origin, bounds.max.as_dvec3() - self.origin);
        let mut span = Span { start: ray.t_min, end: ray.t_max };
        for axis in 0..3 {
            let forward = self.direction[axis] > 0.0;
            let (enter, leave) = if forward { (min, max) } else { (max, min) };
            span.start = span.start.max(self.crossing(axis, enter[axis], false));
            span.end = span.end.min(self.crossing(axis, leave[axis], true));
        }
        span
    }
}
