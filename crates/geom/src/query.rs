//! What a query asks for: the one difference between closest hit and any hit.

use crate::decide::{Intersection, Shear};
use crate::{Hit, Probe, Ray, Triangles};

/// A query in progress. An accelerator has one traversal, generic over this.
pub(crate) trait Query: Copy {
    /// Whether any hit is the answer.
    const ANY_HIT: bool;

    /// The query before it begins, over the ray's range.
    fn new(ray: &Ray) -> Self;

    /// Takes note of an intersection with triangle `index`, wherever on the line it lies.
    fn offer(&mut self, intersection: Intersection, index: u32);

    /// The largest `t` that can still matter: what starts beyond it need not be visited. Negative
    /// infinity once the answer is known.
    fn t_end(&self) -> f64;

    /// The query after some hit in the ray's range has been found to exist. It answers an any-hit
    /// query; a closest-hit query learns nothing from it.
    #[must_use]
    fn with_some_hit(self) -> Self;
}

/// Asks for the hit of smallest `t`, of equals the smallest index.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ClosestHit {
    t_min: f64,
    t_max: f64,
    best: Option<Hit>,
}

/// Asks whether there is any hit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AnyHit {
    t_min: f64,
    t_max: f64,
    found: bool,
}

impl ClosestHit {
    /// The closest hit so far; `None` if nothing lies strictly inside the range.
    pub(crate) fn hit(&self) -> Option<Hit> {
        self.best
    }
}

impl AnyHit {
    /// Whether anything lies strictly inside the range.
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

    #[inline]
    fn with_some_hit(self) -> Self {
        self
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

/// Decides the triangles at `indices` and offers what is met.
#[inline]
pub(crate) fn offer_all<Q: Query, P: Probe>(
    shear: &Shear,
    triangles: &Triangles,
    indices: impl IntoIterator<Item = u32>,
    query: &mut Q,
    probe: &mut P,
) {
    for index in indices {
        probe.test(index);
        if let Some(intersection) = shear.decide(triangles.get(index)) {
            query.offer(intersection, index);
        }
    }
}
