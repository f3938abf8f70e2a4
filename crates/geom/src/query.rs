//! Closest-hit and any-hit queries, as a parameter of a traversal.

use crate::decide::{Intersection, Shear};
use crate::{Hit, Probe, Ray, Triangles};

/// The state of a query. An accelerator has one traversal, generic over this trait.
pub(crate) trait Query: Copy {
    /// Whether any hit answers the query.
    const ANY_HIT: bool;

    /// A query without a hit yet, over the ray's range.
    fn new(ray: &Ray) -> Self;

    /// Accounts for an intersection of the ray's line with triangle `index`, at any `t`.
    fn offer(&mut self, intersection: Intersection, index: u32);

    /// The largest `t` at which a hit can change the answer; negative infinity if none can. Nodes that start
    /// beyond it are skipped.
    fn t_end(&self) -> f64;

    /// Whether no other hit can change the answer.
    #[inline]
    fn is_answered(&self) -> bool {
        self.t_end() == f64::NEG_INFINITY
    }

    /// The query after an unknown hit in the ray's range. This answers an any-hit query and does not change a
    /// closest-hit query.
    #[must_use]
    #[inline]
    fn with_some_hit(self) -> Self {
        self
    }
}

/// The hit of smallest `t`, of equal `t` that of the smallest triangle index.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ClosestHit {
    t_min: f64,
    t_max: f64,
    best: Option<Hit>,
}

/// Whether there is any hit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AnyHit {
    t_min: f64,
    t_max: f64,
    found: bool,
}

impl ClosestHit {
    /// The closest hit so far; `None` if there is none strictly inside the range.
    pub(crate) fn hit(&self) -> Option<Hit> {
        self.best
    }
}

impl AnyHit {
    /// Whether there is a hit strictly inside the range so far.
    pub(crate) fn found(&self) -> bool {
        self.found
    }
}

impl Query for ClosestHit {
    const ANY_HIT: bool = false;

    #[inline]
    fn new(ray: &Ray) -> Self {
        Self { t_min: ray.t_min, t_max: ray.t_max, best: None }
    }

    #[inline]
    fn offer(&mut self, Intersection { t, u, v }: Intersection, index: u32) {
        let inside = self.t_min < t && t < self.t_max;
        let better = self.best.is_none_or(|b| t < b.t || (t == b.t && index < b.triangle));
        if inside && better {
            self.best = Some(Hit { t, u, v, triangle: index });
        }
    }

    #[inline]
    fn t_end(&self) -> f64 {
        self.best.map_or(self.t_max, |b| b.t)
    }
}

impl Query for AnyHit {
    const ANY_HIT: bool = true;

    #[inline]
    fn new(ray: &Ray) -> Self {
        Self { t_min: ray.t_min, t_max: ray.t_max, found: false }
    }

    #[inline]
    fn offer(&mut self, Intersection { t, .. }: Intersection, _index: u32) {
        self.found |= self.t_min < t && t < self.t_max;
    }

    #[inline]
    fn t_end(&self) -> f64 {
        if self.found { f64::NEG_INFINITY } else { self.t_max }
    }

    #[inline]
    fn with_some_hit(self) -> Self {
        Self { found: true, ..self }
    }
}

/// Tests the triangles of these `indices` that the ray does not exclude, and offers their intersections to `query`.
#[inline]
pub(crate) fn offer_all<Q: Query, P: Probe>(
    ray: &Ray,
    shear: &Shear,
    triangles: &Triangles,
    indices: impl IntoIterator<Item = u32>,
    query: &mut Q,
    probe: &mut P,
) {
    for index in indices {
        probe.test(index);
        if ray.excludes(index) {
            continue;
        }
        if let Some(intersection) = shear.decide(triangles.get(index)) {
            query.offer(intersection, index);
        }
    }
}
