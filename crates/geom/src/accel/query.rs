//! Closest-hit and any-hit queries, as a parameter of a traversal.

use crate::decide::{Intersection, Shear};
use crate::{Hit, QueryCounter, Ray, Triangles};

/// The state of a query. An accelerator has one traversal, generic over this trait.
pub(crate) trait Query: Copy {
    /// Whether any hit answers the query.
    const ANY_HIT: bool;

    /// What the query returns.
    type Answer: Copy + Default;

    /// A query without a hit yet, over the ray's range.
    fn new(ray: &Ray) -> Self;

    /// Accounts for an intersection of the ray's line with triangle `index`, at any `t`.
    fn offer(&mut self, intersection: Intersection, index: u32);

    /// The largest `t` at which a hit can change the answer; negative infinity if none can. Nodes that start
    /// beyond it are skipped.
    fn t_end(&self) -> f64;

    /// The answer, from the hits offered so far.
    fn answer(&self) -> Self::Answer;

    /// The ray over the part of its range in which other hits can change this answer.
    fn remaining(ray: &Ray, answer: Self::Answer) -> Ray;

    /// The answer over two sets of triangles, from that over each.
    fn merge(a: Self::Answer, b: Self::Answer) -> Self::Answer;

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

impl Query for ClosestHit {
    const ANY_HIT: bool = false;

    /// The closest hit; `None` if there is none strictly inside the range.
    type Answer = Option<Hit>;

    #[inline]
    fn new(ray: &Ray) -> Self {
        Self { t_min: ray.t_min, t_max: ray.t_max, best: None }
    }

    #[inline]
    fn offer(&mut self, Intersection { t, u, v }: Intersection, index: u32) {
        let hit = Hit { t, u, v, triangle: index };
        let inside = self.t_min < t && t < self.t_max;
        if inside && self.best.is_none_or(|best| is_closer(&hit, &best)) {
            self.best = Some(hit);
        }
    }

    #[inline]
    fn t_end(&self) -> f64 {
        self.best.map_or(self.t_max, |b| b.t)
    }

    #[inline]
    fn answer(&self) -> Option<Hit> {
        self.best
    }

    fn remaining(ray: &Ray, answer: Option<Hit>) -> Ray {
        // Ranges are open, and a hit at the same `t` may have a smaller index.
        ray.with_range(ray.t_min, answer.map_or(ray.t_max, |hit| hit.t.next_up()))
    }

    fn merge(a: Option<Hit>, b: Option<Hit>) -> Option<Hit> {
        match (a, b) {
            (Some(a), Some(b)) => Some(if is_closer(&b, &a) { b } else { a }),
            (a, b) => a.or(b),
        }
    }
}

/// Whether `a` is the closer hit of a ray, or of two at equal `t` that of the smaller index.
#[inline]
fn is_closer(a: &Hit, b: &Hit) -> bool {
    a.t < b.t || (a.t == b.t && a.triangle < b.triangle)
}

impl Query for AnyHit {
    const ANY_HIT: bool = true;

    /// Whether there is a hit strictly inside the range.
    type Answer = bool;

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
    fn answer(&self) -> bool {
        self.found
    }

    fn remaining(ray: &Ray, answer: bool) -> Ray {
        ray.with_range(ray.t_min, if answer { ray.t_min } else { ray.t_max })
    }

    fn merge(a: bool, b: bool) -> bool {
        a | b
    }

    #[inline]
    fn with_some_hit(self) -> Self {
        Self { found: true, ..self }
    }
}

/// Tests the triangles of these `indices` that the ray does not exclude, and offers their intersections to `query`.
#[inline]
pub(crate) fn offer_all<Q: Query, C: QueryCounter>(
    ray: &Ray,
    shear: &Shear,
    triangles: &Triangles,
    indices: impl IntoIterator<Item = u32>,
    query: &mut Q,
    counter: &mut C,
) {
    for index in indices {
        counter.test(index);
        if ray.excludes(index) {
            continue;
        }
        if let Some(intersection) = shear.decide(triangles.get(index)) {
            query.offer(intersection, index);
        }
    }
}
