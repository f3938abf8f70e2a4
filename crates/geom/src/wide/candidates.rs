//! What a ray may hit, kept until the search in `f32` is over, and then decided in `f64`.

use crate::decide::Shear;
use crate::search::Search;
use crate::{Ray, Triangles};

/// How many are kept before they are decided.
pub(super) const CAPACITY: usize = 8;

/// Triangles, each with a lower bound of its `t`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Candidates {
    count: usize,
    starts: [f32; CAPACITY],
    indices: [u32; CAPACITY],
}

impl Candidates {
    #[inline(always)]
    pub(super) fn clear(&mut self) {
        self.count = 0;
    }

    #[inline(always)]
    pub(super) fn is_full(&self) -> bool {
        self.count == CAPACITY
    }

    /// Adds a triangle to those that are there; they are not to be full.
    #[inline(always)]
    pub(super) fn add(&mut self, start: f32, index: u32) {
        let at = self.count % CAPACITY;
        // A triangle that straddles cells comes up again and again.
        let is_new = (at == 0) | (self.indices[at.wrapping_sub(1) % CAPACITY] != index);
        self.starts[at] = start;
        self.indices[at] = index;
        self.count = at + usize::from(is_new);
    }

    #[inline(always)]
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// One of them, unless it begins beyond `t_end`; `None` if there are not that many.
    #[inline(always)]
    pub(super) fn get(&self, at: usize, t_end: f32) -> Option<u32> {
        // NaN bounds nothing.
        let is_beyond = at >= self.count || self.starts[at % CAPACITY] > t_end;
        (!is_beyond).then_some(self.indices[at % CAPACITY])
    }

    /// Decides for a traceable ray those that do not begin beyond `t_end`, and clears all.
    #[inline(always)]
    pub(super) fn decide<Q: Search>(&mut self, t_end: f32, ray: &Ray, triangles: &Triangles, search: &mut Q) {
        let count = std::mem::take(&mut self.count).min(CAPACITY);
        if count == 0 {
            return;
        }
        let shear = Shear::of_traceable(ray);
        for (&start, &index) in self.starts.iter().zip(&self.indices).take(count) {
            // NaN bounds nothing.
            if start > t_end {
                continue;
            }
            if let Some(intersection) = shear.decide_likely(triangles.get(index)) {
                search.offer(intersection, index);
            }
        }
    }
}
