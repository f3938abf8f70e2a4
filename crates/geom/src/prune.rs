//! Conservative pruning: what may be discarded before a decision.
//!
//! A hit's computed `t` puts the ray's point within `24 u * reach` of a point of the triangle, on
//! every axis, where `u = 2^-53` and `reach` is the largest coordinate distance between the ray's
//! origin and the scene's bounds (docs/numerics.md derives it). Accelerators therefore widen
//! every plane by [`Ray::pruning_slack`], which covers that and the rounding of the plane's own
//! parameter, and visit what the widened planes admit.

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

impl Ray {
    /// By how much an accelerator widens what it prunes by: a length, in the scene's unit, along each axis, for
    /// triangles within `bounds`.
    ///
    /// It is `64 u reach`, with `u = 2^-53` and `reach` the largest coordinate distance between the origin and
    /// `bounds`: infinite for the empty box, not a number for a ray that is not [traceable](Ray::is_traceable).
    ///
    /// A box that holds a triangle, or the part of it that is listed there, may be passed over if the exact line
    /// misses the box once all six faces are moved outward by this length, or meets it only where `t` is out of
    /// the ray's range, or beyond the best hit so far. Of the 64, 24 are what a computed hit needs: the point at
    /// its `t` lies within `24 u reach`, along each axis, of a point of the triangle, however thin the triangle
    /// is and from whatever side it is seen (docs/numerics.md has the proof). The other 40 are for the roundings
    /// of the accelerator: a face relative to the origin, and the parameter at which the ray crosses it, take 4.
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
        SLACK_ULPS * (f64::EPSILON / 2.0) * reach
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

    /// The parameter at which the ray has gone `distance` along `axis`, the slack added if
    /// `later`, subtracted otherwise.
    ///
    /// `distance` is to carry a relative error of a few `u`, or an absolute one of a few
    /// `u * reach`.
    #[inline(always)]
    pub(crate) fn crossing(&self, axis: usize, distance: f64, later: bool) -> f64 {
        let slack = self.slack.copysign(self.inverse[axis]);
        (if later { distance + slack } else { distance - slack }) * self.inverse[axis]
    }

    /// The part of the ray's range that lies within the widened `bounds`.
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

/// The largest component in magnitude, of three numbers. (Without the care for NaN that
/// `max_element` takes, this is three instructions.)
#[inline(always)]
fn largest(v: DVec3) -> f64 {
    let DVec3 { x, y, z } = v.abs();
    let most = if x > y { x } else { y };
    if most > z { most } else { z }
}
