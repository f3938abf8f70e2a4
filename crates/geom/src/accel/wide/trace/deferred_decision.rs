//! The exact decision in `f64` of what the conservative test leaves: a ray's candidates are kept until it has
//! been traversed, or until there are eight, and then decided.

use crate::accel::query::Query;
use crate::accel::wide::simd::{LANES, Simd};
use crate::decide::{AXES, Intersection, Shear};
use crate::{Ray, Triangles};
use glam::DVec3;

/// How many candidates are kept before they are decided.
pub(super) const CAPACITY: usize = 8;

/// The triangles that a ray may hit, each with a lower bound of its `t`.
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

    /// Adds a triangle. The candidates must not be full.
    #[inline(always)]
    pub(super) fn add(&mut self, start: f32, index: u32) {
        let at = self.count % CAPACITY;
        // A triangle that straddles cells of the k-d tree is found in several leaf blocks.
        let is_new = (at == 0) | (self.indices[at.wrapping_sub(1) % CAPACITY] != index);
        self.starts[at] = start;
        self.indices[at] = index;
        self.count = at + usize::from(is_new);
    }

    /// Those that do not begin beyond `limit`, a bit each.
    #[inline(always)]
    fn left<S: Simd>(&self, simd: S, limit: f32) -> u8 {
        // Comparisons with NaN are false: such a candidate is kept.
        let beyond = simd.lt(simd.splat(limit), simd.load(&self.starts));
        !beyond & !(0xff_u32 << self.count) as u8
    }

    /// Decides those that do not begin beyond `limit`, and clears all. The ray must be traceable.
    #[inline(always)]
    pub(super) fn decide<Q: Query>(&mut self, limit: f32, ray: &Ray, triangles: &Triangles, query: &mut Q) {
        let count = std::mem::take(&mut self.count).min(CAPACITY);
        if count == 0 {
            return;
        }
        let shear = Shear::of_traceable(ray);
        for (&start, &index) in self.starts.iter().zip(&self.indices).take(count) {
            // Comparisons with NaN are false: such a candidate is decided.
            if start > limit {
                continue;
            }
            if let Some(intersection) = shear.decide_likely(triangles.get(index)) {
                query.offer(intersection, index);
            }
        }
    }
}

/// Vectors of eight rays, component by component.
type Columns = [[f64; LANES]; 3];

#[inline(always)]
fn get(columns: &Columns, lane: usize) -> DVec3 {
    DVec3::new(columns[0][lane], columns[1][lane], columns[2][lane])
}

/// The [`Shear`]s of eight rays with one main axis, a column for each number. Components are in its order.
#[repr(align(64))]
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Shears {
    pub(super) main_axis: usize,
    pub(super) origin: Columns,
    /// The directions along x and y, divided by that along z.
    pub(super) slopes: [[f64; LANES]; 2],
    pub(super) direction_z: [f64; LANES],
}

/// The decisions about one candidate of each of eight rays.
#[repr(align(64))]
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Decisions {
    t: [f64; LANES],
    u: [f64; LANES],
    v: [f64; LANES],
    indices: [u32; LANES],
    is_hit: [bool; LANES],
}

impl Shears {
    /// Decides those of each ray's candidates that do not begin beyond `limit`, in their order, one of each ray at a time.
    /// Returns how many of `decisions` were made.
    #[inline(always)]
    pub(super) fn decide<S: Simd>(
        &self,
        simd: S,
        candidates: &[Candidates; LANES],
        limit: &[f32; LANES],
        triangles: &Triangles,
        decisions: &mut [Decisions],
    ) -> usize {
        let mut left = [0; LANES];
        for (i, left) in left.iter_mut().enumerate() {
            *left = candidates[i].left(simd, limit[i]);
        }
        let mut rounds = 0;
        for decisions in decisions {
            if left == [0; LANES] {
                break;
            }
            self.decide_next(simd, candidates, &mut left, triangles, decisions);
            rounds += 1;
        }
        rounds
    }

    /// Decides the first of the candidates that are `left` of each ray, and removes it from these.
    #[inline(always)]
    fn decide_next<S: Simd>(
        &self,
        simd: S,
        candidates: &[Candidates; LANES],
        left: &mut [u8; LANES],
        triangles: &Triangles,
        decisions: &mut Decisions,
    ) {
        let mut chosen = [triangles.get(0); LANES];
        let mut is_candidate = [false; LANES];
        for (i, is_candidate) in is_candidate.iter_mut().enumerate() {
            *is_candidate = left[i] != 0;
            // Where there is none, any triangle will do.
            let index = candidates[i].indices[left[i].trailing_zeros() as usize % CAPACITY];
            decisions.indices[i] = if *is_candidate { index } else { 0 };
            left[i] &= left[i].wrapping_sub(1);
            chosen[i] = triangles.get(decisions.indices[i]);
        }
        let corners = simd.corners(chosen);
        let axes = AXES[self.main_axis % 3];
        let mut permuted = [[[0.0; LANES]; 3]; 3];
        for (permuted, vertices) in permuted.iter_mut().zip(corners.0.as_chunks::<3>().0) {
            for (to, axis) in permuted.iter_mut().zip(axes) {
                for (to, x) in to.iter_mut().zip(&vertices[usize::from(axis) % 3]) {
                    *to = f64::from(*x);
                }
            }
        }
        for i in 0..LANES {
            let slopes = [self.slopes[0][i], self.slopes[1][i]];
            let shear = Shear::of_slopes(self.main_axis, get(&self.origin, i), slopes, self.direction_z[i]);
            let [a, b, c] = &permuted;
            let (at, is_hit) = shear.decide_permuted([get(a, i), get(b, i), get(c, i)]);
            (decisions.t[i], decisions.u[i], decisions.v[i]) = (at.t, at.u, at.v);
            decisions.is_hit[i] = is_hit;
        }
        for (is_hit, is_candidate) in decisions.is_hit.iter_mut().zip(is_candidate) {
            *is_hit &= is_candidate;
        }
    }
}

impl Decisions {
    /// Offers ray `i` its candidate, if it is hit.
    #[inline(always)]
    pub(super) fn offer<Q: Query>(&self, i: usize, query: &mut Q) {
        if self.is_hit[i] {
            query.offer(Intersection { t: self.t[i], u: self.u[i], v: self.v[i] }, self.indices[i]);
        }
    }
}
