//! Exhaustive queries: all triangles of a small tree are tested, each against eight rays at once, and no node is visited.
//! Any-hit queries leave out the triangles outside of the rays' bounds.

mod projected_test;
#[cfg(test)]
mod random_rays;
mod segment_bounds;

use super::deferred_decision::Candidates;
use super::prefilter::Filtered;
use super::ray_setup::RaySetups;
use crate::Ray;
use crate::accel::query::Query;
use crate::accel::wide::simd::{Bits, LANES, PACKET, Simd, SimdBase};
use crate::accel::wide::tree::Tree;
use crate::accel::wide::tree::projected_triangle::MAX_EXHAUSTIVE;
use fearless_simd::SimdMask;
use projected_test::ProjectedTest;
use segment_bounds::SegmentBounds;

/// Candidates are within the final limit already.
const NO_LIMIT: f32 = f32::INFINITY;

/// The memory of exhaustive queries, for eight rays at a time.
#[derive(Debug)]
pub(super) struct ExhaustiveScratch {
    setups: RaySetups<LANES>,
    /// The triangles that any of the rays may hit, and the results of their tests, lane by lane.
    hits: [(u32, Filtered); MAX_EXHAUSTIVE],
    candidates: [Candidates; LANES],
}

impl ExhaustiveScratch {
    pub(super) fn idle() -> Self {
        let hits = [(0, Filtered::default()); MAX_EXHAUSTIVE];
        Self { setups: RaySetups::idle(), hits, candidates: [Candidates::default(); LANES] }
    }

    /// Answers the queries of the sets of [`PACKET`] rays that start at `starts`, and hands each to `report`.
    #[inline(always)]
    pub(super) fn query<S: Simd, Q: Query>(
        &mut self,
        simd: S,
        tree: &Tree,
        rays: &[Ray],
        starts: &[u32],
        mut report: impl FnMut(usize, Q),
    ) {
        for &start in starts {
            let end = rays.len().min(start as usize + PACKET);
            for first in (start as usize..end).step_by(LANES) {
                let rays = &rays[first..end];
                let filled_up;
                let eight = if let Some(eight) = rays.first_chunk() {
                    eight
                } else {
                    filled_up = std::array::from_fn(
                        #[inline(always)]
                        |i| rays[i.min(rays.len() - 1)],
                    );
                    &filled_up
                };
                self.query_eight(simd, tree, eight, |i, query| {
                    if i < rays.len() {
                        report(first + i, query);
                    }
                });
            }
        }
    }

    /// Answers the queries of eight rays, and reports each.
    #[inline(always)]
    fn query_eight<S: Simd, Q: Query>(
        &mut self,
        simd: S,
        tree: &Tree,
        rays: &[Ray; LANES],
        mut report: impl FnMut(usize, Q),
    ) {
        self.setups.set_for_projected(&simd.columns(rays), &tree.bounds, &tree.space);
        let mut may_hit = 0;
        for (i, &may_hit_one) in self.setups.may_hit.iter().enumerate() {
            may_hit |= u8::from(may_hit_one) << i;
        }
        let hits = self.test_all::<S, Q>(simd, tree, may_hit);
        let (limit, answered) = self.apply_certain_hits::<S, Q>(simd, rays, may_hit, hits);
        let mut queries = rays.each_ref().map(
            #[inline(always)]
            |ray| Q::new(ray),
        );
        let Self { hits: all, candidates, .. } = self;
        candidates.iter_mut().for_each(Candidates::clear);
        for (index, hit) in &all[..hits] {
            // Comparisons with NaN are false: such a hit is kept.
            let beyond = simd.lt(limit, simd.load(&hit.start));
            for i in Bits((hit.possible & !beyond & !answered).into()) {
                let i = i % LANES;
                candidates[i].add(hit.start[i], *index);
                if candidates[i].is_full() {
                    candidates[i].decide(NO_LIMIT, &rays[i], &tree.triangles, &mut queries[i]);
                }
            }
        }
        for (i, mut query) in queries.into_iter().enumerate() {
            candidates[i].decide(NO_LIMIT, &rays[i], &tree.triangles, &mut query);
            report(i, if answered >> i & 1 != 0 { query.with_some_hit() } else { query });
        }
    }

    /// Tests all triangles, for any-hit queries without those outside of the rays' bounds. Keeps those that any ray may
    /// hit, and returns how many they are.
    #[inline(always)]
    fn test_all<S: Simd, Q: Query>(&mut self, simd: S, tree: &Tree, may_hit: u8) -> usize {
        // Segments are often short. Rays of closest-hit queries end where they leave the scene, so their bounds hold most
        // of it.
        let bounds = Q::ANY_HIT.then(
            #[inline(always)]
            || SegmentBounds::of(simd, &self.setups, may_hit),
        );
        let mut kept = 0;
        for (axes, of_axis) in tree.projected.by_axes() {
            let test = ProjectedTest::new(simd, &self.setups, axes);
            if let Some(bounds) = &bounds {
                for (of_triangles, triangles) in of_axis.by_64() {
                    for i in Bits(bounds.overlap(simd, of_triangles)) {
                        let Some(triangle) = triangles.get(i) else { break };
                        kept += self.keep(kept, triangle.index, test.filter(simd, triangle));
                    }
                }
            } else {
                for triangle in &of_axis.triangles {
                    kept += self.keep(kept, triangle.index, test.filter(simd, triangle));
                }
            }
        }
        kept.min(MAX_EXHAUSTIVE)
    }

    /// Keeps the result of a test as the one of this number, if a hit is possible. Returns how many are added.
    #[inline(always)]
    fn keep(&mut self, number: usize, index: u32, filtered: Filtered) -> usize {
        // Without a branch, which would be mispredicted, and with a remainder instead of a check of bounds.
        self.hits[number % MAX_EXHAUSTIVE] = (index, filtered);
        usize::from(filtered.possible != 0)
    }

    /// Removes the hits of rays that exclude the triangle or can hit nothing. Returns what certain hits tell: the limits
    /// beyond which other hits cannot matter, and the rays whose any-hit query is answered.
    #[inline(always)]
    fn apply_certain_hits<S: Simd, Q: Query>(
        &mut self,
        simd: S,
        rays: &[Ray; LANES],
        may_hit: u8,
        hits: usize,
    ) -> (S::F, u8) {
        let excluded = |at: usize| {
            S::I::load_array(
                simd,
                rays.each_ref().map(
                    #[inline(always)]
                    |ray| ray.excluded[at],
                ),
            )
        };
        let (excluded, mut limit, mut answered) =
            ([excluded(0), excluded(1)], simd.load(&self.setups.end), 0);
        for (index, hit) in &mut self.hits[..hits] {
            let is_excluded = excluded[0].simd_eq(*index) | excluded[1].simd_eq(*index);
            *hit = hit.among(may_hit & !is_excluded.to_bitmask() as u8);
            if Q::ANY_HIT {
                answered |= hit.certain;
            } else {
                limit = simd.select(hit.certain, simd.load(&hit.end).min(limit), limit);
            }
        }
        (limit, answered)
    }
}
