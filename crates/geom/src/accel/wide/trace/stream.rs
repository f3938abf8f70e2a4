//! Stream traversal: many rays are in flight, and each makes one step before any makes its next, so that
//! the memory latency of one is hidden by the others.
//!
//! A round has separate loops, over masks of rays, for tests of nodes, tests of leaf blocks and moves to the next child. So a
//! branch that is predicted wrongly discards little work.

use super::child_test::{record, test_leaf, test_node};
use super::prefilter::Filtered;
use super::ray_setup::RaySetups;
use super::traversal_state::Traversal;
use crate::Ray;
use crate::accel::query::Query;
use crate::accel::wide::simd::{Bits, LANES, PACKET, RayMask, Simd};
use crate::accel::wide::tree::Tree;
use crate::accel::wide::tree::node::Child;
use prefetch_index::prefetch_index;

/// The slots of rays in flight, by what their rays do next.
#[derive(Default)]
struct Waiting {
    nodes: RayMask,
    blocks: RayMask,
    ended: RayMask,
}

struct RayStream<'a, Q, R> {
    tree: &'a Tree,
    rays: &'a [Ray],
    /// Where the sets of [`PACKET`] rays start that are not yet in flight.
    starts: std::slice::Iter<'a, u32>,
    /// The next ray.
    next: usize,
    /// Where the set of the next ray ends.
    end: usize,
    /// The setups of eight rays, of which the next ray is one.
    setups: RaySetups<LANES>,
    traversals: &'a mut [Traversal; PACKET],
    queries: [Option<Q>; PACKET],
    report: R,
}

/// Answers the queries of the sets of [`PACKET`] rays that start at `starts`, and hands each to `report`.
#[inline(always)]
pub(super) fn query_stream<S: Simd, Q: Query>(
    simd: S,
    tree: &Tree,
    rays: &[Ray],
    starts: &[u32],
    traversals: &mut [Traversal; PACKET],
    report: impl FnMut(usize, Q),
) {
    let (starts, setups, queries) = (starts.iter(), RaySetups::idle(), [None; PACKET]);
    RayStream { tree, rays, starts, next: 0, end: 0, setups, traversals, queries, report }.run(simd);
}

impl<Q: Query, R: FnMut(usize, Q)> RayStream<'_, Q, R> {
    #[inline(always)]
    fn run<S: Simd>(&mut self, simd: S) {
        let mut hits = [Filtered::default(); PACKET];
        const { assert!(S::IN_FLIGHT <= PACKET) };
        let mut waiting = Waiting { ended: RayMask::MAX >> (PACKET - S::IN_FLIGHT), ..Waiting::default() };
        loop {
            waiting.nodes |= self.replace_ended(simd, waiting.ended);
            if waiting.nodes | waiting.blocks == 0 {
                break;
            }
            self.test_nodes(simd, waiting.nodes);
            self.test_leaves(simd, waiting.blocks, &mut hits);
            waiting = self.advance(waiting.nodes | waiting.blocks);
        }
    }

    /// Takes the next ray, and sets up eight if it is the first of them; `None` if there is none left.
    #[inline(always)]
    fn next_ray<S: Simd>(&mut self, simd: S) -> Option<usize> {
        if self.next == self.end {
            self.next = *self.starts.next()? as usize;
            self.end = self.rays.len().min(self.next + PACKET);
        }
        if self.next.is_multiple_of(LANES) {
            let Tree { bounds, space, .. } = self.tree;
            let group = self.rays[self.next..].first_chunk::<LANES>();
            let group = group.copied().unwrap_or_else(|| self.last_group());
            // The rays after these, which are needed soon.
            for i in 0..LANES {
                prefetch_index(self.rays, self.next + 2 * LANES + i);
            }
            self.setups.set(&simd.columns(&group), bounds, space);
        }
        self.next += 1;
        Some(self.next - 1)
    }

    /// The last rays, fewer than eight, filled up with the last one.
    #[cold]
    fn last_group(&self) -> [Ray; LANES] {
        std::array::from_fn(|i| self.rays[(self.next + i).min(self.rays.len() - 1)])
    }

    /// Reports the queries in the slots `ended`, and begins others there; returns where it did.
    #[inline(always)]
    fn replace_ended<S: Simd>(&mut self, simd: S, ended: RayMask) -> RayMask {
        let mut begun = 0;
        for slot in Bits(ended) {
            let traversal = &mut self.traversals[slot];
            if let Some(mut query) = self.queries[slot].take() {
                let id = traversal.ray as usize;
                traversal.candidates.decide(
                    traversal.limit,
                    &self.rays[id],
                    &self.tree.triangles,
                    &mut query,
                );
                (self.report)(id, query);
            }
            begun |= RayMask::from(self.begin_next(simd, slot)) << slot;
        }
        begun
    }

    /// Begins the next query that needs a traversal; returns whether there was one.
    #[inline(always)]
    fn begin_next<S: Simd>(&mut self, simd: S, slot: usize) -> bool {
        while let Some(id) = self.next_ray(simd) {
            let ray = &self.rays[id];
            let query = Q::new(ray);
            if let Some(setup) = self.setups.get(id % LANES) {
                self.traversals[slot].begin(setup, id as u32, ray);
                self.queries[slot] = Some(query);
                return true;
            }
            (self.report)(id, query);
        }
        false
    }

    /// Tests the current node of each ray in the slots `nodes`.
    #[inline(always)]
    fn test_nodes<S: Simd>(&mut self, simd: S, nodes: RayMask) {
        for slot in Bits(nodes) {
            let traversal = &mut self.traversals[slot];
            traversal.push::<S, Q>(test_node::<S, Q>(simd, &self.tree.nodes, traversal));
        }
    }

    /// Tests the current leaf block of each ray in the slots `blocks`.
    ///
    /// All are tested before the first hit is recorded: whether a ray hits anything is
    /// unpredictable, and a mispredicted branch discards the tests that have begun after it.
    #[inline(always)]
    fn test_leaves<S: Simd>(&mut self, simd: S, blocks: RayMask, hits: &mut [Filtered; PACKET]) {
        let mut with_hits: RayMask = 0;
        for slot in Bits(blocks) {
            let Traversal { child, limit, setup, excluded, .. } = &self.traversals[slot];
            hits[slot] = test_leaf(simd, self.tree, *child, &setup.shear, *limit, *excluded);
            with_hits |= RayMask::from(hits[slot].possible != 0) << slot;
        }
        for slot in Bits(with_hits) {
            let traversal = &mut self.traversals[slot];
            if let Some(query) = &mut self.queries[slot] {
                record(simd, self.tree, &self.rays[traversal.ray as usize], &hits[slot], traversal, query);
            }
        }
    }

    /// Moves each ray on to its nearest child left, and prefetches that.
    ///
    /// In a loop of its own, where the results of the tests are known and nothing waits.
    #[inline(always)]
    fn advance(&mut self, slots: RayMask) -> Waiting {
        let mut waiting = Waiting::default();
        for slot in Bits(slots) {
            let traversal = &mut self.traversals[slot];
            traversal.advance();
            let child = traversal.child;
            waiting.blocks |= RayMask::from(Child::is_block(child)) << slot;
            waiting.ended |= RayMask::from(Child::is_end(child)) << slot;
            self.tree.prefetch::<6>(child);
        }
        waiting.nodes = slots & !(waiting.blocks | waiting.ended);
        waiting
    }
}
