//! Conservative pruning of nodes and cells.
//!
//! At the computed `t` of a hit, the ray's point is within `24 eps * reach` of a point of the triangle along
//! each axis, where `eps = 2^-53` and `reach` is the largest coordinate distance between the ray's origin and
//! the scene's bounds (docs/numerics.md has the proof). Accelerators therefore widen every plane by
//! [`Ray::pruning_slack`], which also covers the rounding of the parameter at which the ray crosses the
//! plane.

use crate::ray::power_of_two;
use crate::rounding::EPS;
use crate::{Aabb, Ray};
use glam::DVec3;

/// A closed interval of the ray parameter; empty if `start > end`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Span {
    pub(crate) start: f64,
    pub(crate) end: f64,
}

/// A ray prepared for tests against axis-aligned planes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pruner {
    pub(crate) origin: DVec3,
    pub(crate) direction: DVec3,
    pub(crate) inverse: DVec3,
    /// The distance by which planes are moved, in units of length.
    pub(crate) slack: f64,
}

/// The slack in units of `eps * reach`: 24 for the hit point, the rest for the rounding of accelerators.
const SLACK_ULPS: f64 = 64.0;

/// Direction components smaller in magnitude than this fraction of the largest become that fraction, so that no quotient is
/// NaN. The effect within the scene is far below the slack.
pub(crate) const PARALLEL: f64 = power_of_two(-200);

impl Ray {
    /// The length, in units of the scene, by which an accelerator over triangles within `bounds` widens its
    /// boxes along each axis.
    ///
    /// It is `64 eps reach`, with `eps = 2^-53` and `reach` the largest coordinate distance between the origin
    /// and `bounds`. It is infinite for the empty box, and may be NaN for a ray that is not
    /// [traceable](Ray::is_traceable).
    ///
    /// Let a box contain a triangle, or the part of it that is referenced there, and move all six faces
    /// outward by this length. A query may skip the box if the exact line misses it, or intersects it only at
    /// `t` outside the ray's range or beyond the closest hit so far. A computed hit takes 24 of the 64 units:
    /// the point at its `t` is within `24 eps reach` of a point of the triangle along each axis, for triangles
    /// of any shape seen from any side (docs/numerics.md has the proof). The other 40 are for the rounding of
    /// the accelerator, which takes 4 for the offset of a face from the origin and for the parameter at which
    /// the ray crosses it.
    ///
    /// ```
    /// use glam::{DVec3, Vec3};
    /// use globillum_geom::{Aabb, Ray};
    ///
    /// let bounds = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
    /// let ray = Ray::new(DVec3::new(0.5, 0.5, 8.0), -DVec3::Z);
    /// assert_eq!(ray.pruning_slack(&bounds), 64.0 * 2.0_f64.powi(-53) * 8.0);
    /// ```
    #[inline(always)]
    pub fn pruning_slack(&self, bounds: &Aabb) -> f64 {
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let (below, above) = (largest(min - self.origin), largest(max - self.origin));
        let reach = if below > above { below } else { above };
        SLACK_ULPS * EPS * reach
    }
}

impl Pruner {
    /// Prepares a [traceable](Ray::is_traceable) ray for a scene within `bounds`.
    #[inline(always)]
    pub(crate) fn new(ray: &Ray, bounds: &Aabb) -> Self {
        let smallest = PARALLEL * largest(ray.direction);
        let lifted = |d: f64| if d.abs() < smallest { smallest } else { d };
        let DVec3 { x, y, z } = ray.direction;
        let direction = DVec3::new(lifted(x), lifted(y), lifted(z));
        Self { origin: ray.origin, direction, inverse: 1.0 / direction, slack: ray.pruning_slack(bounds) }
    }

    /// The parameter at which the ray crosses the plane at the signed `distance` from its origin along
    /// `axis`. The slack increases it if `later`, and decreases it otherwise.
    ///
    /// `distance` may have a relative error of a few `eps`, or an absolute one of a few `eps * reach`.
    #[inline(always)]
    pub(crate) fn crossing(&self, axis: usize, distance: f64, later: bool) -> f64 {
        let slack = self.slack.copysign(self.inverse[axis]);
        (if later { distance + slack } else { distance - slack }) * self.inverse[axis]
    }

    /// The part of the ray's range within the widened `bounds`.
    #[inline(always)]
    pub(crate) fn clip(&self, ray: &Ray, bounds: &Aabb) -> Span {
        let (min, max) = (bounds.min.as_dvec3() - self.origin, bounds.max.as_dvec3() - self.origin);
        let slab = |axis: usize, span: Span| {
            let forward = self.direction[axis] > 0.0;
            let start = self.crossing(axis, if forward { min[axis] } else { max[axis] }, false);
            let end = self.crossing(axis, if forward { max[axis] } else { min[axis] }, true);
            Span {
                start: if start > span.start { start } else { span.start },
                end: if end < span.end { end } else { span.end },
            }
        };
        slab(2, slab(1, slab(0, Span { start: ray.t_min, end: ray.t_max })))
    }
}

/// The largest magnitude of a component. Unlike `max_element` it does not handle NaN, which saves
/// instructions.
#[inline(always)]
fn largest(v: DVec3) -> f64 {
    let DVec3 { x, y, z } = v.abs();
    let most = if x > y { x } else { y };
    if most > z { most } else { z }
}
