//! What a search looks for: the one difference between closest hit and occlusion.

use crate::decide::{Intersection, Shear};
use crate::{Hit, Probe, Ray, Triangles};

/// A search in progress. An accelerator has one traversal, generic over this.
pub(crate) trait Search {
    /// Takes note of an intersection with triangle `index`, wherever on the line it lies.
    fn offer(&mut self, intersection: Intersection, index: u32);

    /// The largest `t` that can still matter: what starts beyond it need not be visited. Negative
    /// infinity once the answer is known.
    fn t_end(&self) -> f64;
}

/// Looks for the hit of smallest `t`, of equals the smallest index.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Closest {
    t_min: f64,
    t_max: f64,
    best: Option<Hit>,
}

/// Looks for any hit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Any {
    t_min: f64,
    t_max: f64,
    found: bool,
}

impl Closest {
    /// A search over the ray's range.
    pub(crate) fn new(ray: &Ray) -> Self {
        Self { t_min: ray.t_min, t_max: ray.t_max, best: None }
    }

    /// What was found; `None` if nothing lies strictly inside the range.
    pub(crate) fn hit(&self) -> Option<Hit> {
        self.best
    }
}

impl Any {
    /// A search over the ray's range.
    pub(crate) fn new(ray: &Ray) -> Self {
        Self { t_min: ray.t_min, t_max: ray.t_max, found: false }
    }

    /// The search after something was found by other means.
    pub(crate) fn found_one(self) -> Self {
        Self { found: true, ..self }
    }

    /// Whether anything lies strictly inside the range.
    pub(crate) fn found(&self) -> bool {
        self.found
    }
}

impl Search for Closest {
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

impl Search for Any {
    #[inline]
    fn offer(&mut self, Intersection { t, .. }: Intersection, _index: u32) {
        self.found |= self.t_min < t && t < self.t_max;
    }

    #[inline]
    fn t_end(&self) -> f64 {
        if self.found { f64::NEG_INFINITY } else { self.t_max }
    }
}

/// Decides the triangles at `indices` and offers what is met.
#[inline]
pub(crate) fn offer_all<S: Search, P: Probe>(
    shear: &Shear,
    triangles: &Triangles,
    indices: impl IntoIterator<Item = u32>,
    search: &mut S,
    probe: &mut P,
) {
    for index in indices {
        probe.test(index);
        if let Some(intersection) = shear.decide(triangles.get(index)) {
            search.offer(intersection, index);
        }
    }
}
