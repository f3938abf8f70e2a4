//! The traversal of a common-origin packet: nodes are tested by bounds of the slopes of all its rays, leaf blocks by
//! single rays.

use super::child_slope_bounds::{ChildBounds, SlopeBounds};
use super::edge_functions::{CentralRay, EdgeFunctions, RayLanes};
use super::setup::{PacketRays, PacketSetup};
use crate::Ray;
use crate::accel::query::{ClosestHit, Query};
use crate::accel::wide::simd::{Bits, GROUPS, LANES, PACKET, RayMask, Simd, SimdBase};
use crate::accel::wide::trace::deferred_decision::{CAPACITY, Candidates, Decisions};
use crate::accel::wide::trace::prefilter::{Filtered, HitRange, Vertices};
use crate::accel::wide::tree::Tree;
use crate::accel::wide::tree::leaf::LeafBlock;
use crate::accel::wide::tree::node::Child;
use std::marker::PhantomData;

/// The memory of packet traversal, reused between packets to avoid reallocation.
#[derive(Debug)]
pub(crate) struct CommonOriginScratch {
    pub(super) rays: PacketRays,
    pub(super) candidates: [[Candidates; LANES]; GROUPS],
    pub(super) decisions: [Decisions; CAPACITY],
    filtered: [Filtered; PACKET],
    /// The children still to be visited, the nearest last.
    stack: Vec<StackEntry>,
}

/// A child that rays of the packet may meet.
#[derive(Clone, Copy, Debug)]
struct StackEntry {
    child: u32,
    /// The depth at which it begins.
    near: f32,
    /// The slope bounds of the rays that may meet it.
    bounds: SlopeBounds,
}

impl CommonOriginScratch {
    pub(crate) fn idle() -> Self {
        Self {
            rays: PacketRays::default(),
            candidates: [[Candidates::default(); LANES]; GROUPS],
            decisions: [Decisions::default(); CAPACITY],
            filtered: [Filtered::default(); PACKET],
            stack: Vec::new(),
        }
    }
}

pub(super) struct PacketTraversal<'a, S: Simd, Q> {
    pub(super) simd: S,
    pub(super) tree: &'a Tree,
    pub(super) rays: &'a [[Ray; LANES]],
    pub(super) setup: PacketSetup,
    pub(super) scratch: &'a mut CommonOriginScratch,
    /// The depth of the farthest limit of a ray.
    pub(super) limit: f32,
    /// The rays whose any-hit query is answered. They end before everything.
    pub(super) finished: RayMask,
    pub(super) query: PhantomData<Q>,
}

/// The triangles of a leaf block that a ray of the packet may hit, and the rays that may meet the block.
struct LeafTest<'a, S: Simd> {
    block: LeafBlock<'a>,
    triangles: u8,
    rays: RayMask,
    center: CentralRay,
    edges: EdgeFunctions<S>,
}

impl<S: Simd, Q: Query> PacketTraversal<'_, S, Q> {
    /// Visits all that rays of the packet may meet. What is left to decide is in the memory's candidates;
    /// returns the rays that need no decision.
    #[inline(always)]
    pub(super) fn run(&mut self) -> RayMask {
        self.shorten();
        self.scratch.stack.clear();
        self.test_node(Child::ROOT);
        while let Some(entry) = self.scratch.stack.pop() {
            if entry.near > self.limit {
                continue;
            }
            if Child::is_block(entry.child) {
                self.test_leaf(&entry);
            } else {
                self.test_node(entry.child);
            }
        }
        self.finished
    }

    /// Pushes those of a node's children that rays may meet.
    #[inline(always)]
    fn test_node(&mut self, index: u32) {
        let node = &self.tree.nodes[index as usize];
        let (bounds, met) = ChildBounds::of(self.simd, node, &self.setup, self.limit);
        let order = node.orders[usize::from(self.setup.octant & 7)];
        let mut places = ChildBounds::places(self.simd, met, order);
        while places != 0 {
            // The furthest of them.
            let place = places.ilog2();
            places ^= 1 << place;
            let lane = (order >> (3 * place)) as usize % LANES;
            let (child, near, bounds) = (node.children[lane], bounds.near[lane], bounds.get(lane));
            self.scratch.stack.push(StackEntry { child, near, bounds });
            self.tree.prefetch::<4>(child);
        }
    }

    /// Tests a leaf block's triangles and the rays within its slope bounds, in the order that takes fewer tests.
    #[inline(always)]
    fn test_leaf(&mut self, entry: &StackEntry) {
        let rays = self.within(&entry.bounds, entry.near);
        if rays == 0 {
            return;
        }
        let simd = self.simd;
        let groups = (0..GROUPS).filter(|g| group_of(rays, *g) != 0).count();
        let block = self.tree.leaf_block(entry.child);
        let center = CentralRay::new(&self.setup, &entry.bounds);
        let edges = EdgeFunctions::new(simd, &center, &Vertices::load(simd, block, self.setup.axes));
        let triangles = edges.may_hit(simd, &center) & block.lanes();
        if triangles == 0 {
            return;
        }
        let test = LeafTest { block, triangles, rays, center, edges };
        let is_shorter = if triangles.count_ones() as usize * groups < rays.count_ones() as usize {
            self.test_by_triangle(&test)
        } else {
            self.test_by_ray(&test)
        };
        if is_shorter {
            self.shorten();
        }
    }

    /// The rays within slope bounds whose limit is not before depth `near`.
    #[inline(always)]
    fn within(&self, bounds: &SlopeBounds, near: f32) -> RayMask {
        let (simd, mut met) = (self.simd, 0);
        let PacketRays { deviation, limit, .. } = &self.scratch.rays;
        let low = [simd.splat(bounds.low[0]), simd.splat(bounds.low[1])];
        let high = [simd.splat(bounds.high[0]), simd.splat(bounds.high[1])];
        let near = simd.splat(near);
        for g in 0..GROUPS {
            let (x, y) = (simd.load(&deviation[0][g]), simd.load(&deviation[1][g]));
            let across = simd.le(low[0], x) & simd.le(x, high[0]) & simd.le(low[1], y) & simd.le(y, high[1]);
            met |= RayMask::from(across & simd.le(near, simd.load(&limit[g]))) << (g * LANES);
        }
        met
    }

    /// All triangles at once, for each ray. Returns whether any ray has become shorter.
    ///
    /// Results are recorded when all rays have been tested: which of them hit something is unpredictable.
    #[inline(always)]
    fn test_by_ray(&mut self, test: &LeafTest<'_, S>) -> bool {
        let (simd, rays) = (self.simd, &self.scratch.rays);
        let (mut with_possible, mut with_certain) = (0, 0);
        for slot in Bits(test.rays) {
            let (g, i) = (slot / LANES % GROUPS, slot % LANES);
            let from_center = |axis: usize| rays.deviation[axis][g][i] - test.center.deviation[axis];
            let (x, y) = (from_center(0), from_center(1));
            let range = HitRange {
                begin: simd.splat(rays.begin[g][i]),
                end: simd.splat(rays.range_end[g][i]),
                limit: simd.splat(rays.limit[g][i]),
            };
            let lanes = RayLanes { deviation: [simd.splat(x), simd.splat(y)], range };
            let filtered = test.edges.prefilter(simd, &lanes).among(test.triangles);
            self.scratch.filtered[slot % PACKET] = filtered;
            with_possible |= RayMask::from(filtered.possible != 0) << slot;
            with_certain |= RayMask::from(filtered.certain != 0) << slot;
        }
        for slot in Bits(with_possible) {
            let (g, i) = (slot / LANES % GROUPS, slot % LANES);
            let Filtered { possible, certain, start, end } = self.scratch.filtered[slot % PACKET];
            if Q::ANY_HIT && certain != 0 {
                self.finish(g, i);
                continue;
            }
            for lane in Bits(possible.into()) {
                self.add(g, i, start[lane % LANES], test.block.index(lane % LANES));
            }
            if certain != 0 {
                let nearest = simd.min_of(simd.load(&end), certain);
                let limit = &mut self.scratch.rays.limit[g][i];
                *limit = if nearest < *limit { nearest } else { *limit };
            }
        }
        with_certain != 0
    }

    /// Eight rays at once, for each triangle. Returns whether any ray has become shorter.
    #[inline(always)]
    fn test_by_triangle(&mut self, test: &LeafTest<'_, S>) -> bool {
        let (simd, mut is_shorter) = (self.simd, false);
        for at in Bits(test.triangles.into()) {
            let index = test.block.index(at % LANES);
            let edges = test.edges.lane(simd, at);
            let (mut possible, mut certain) = (0, 0);
            for g in 0..GROUPS {
                let group = group_of(test.rays & !self.finished, g);
                if group != 0 {
                    let of_group = self.test_group(g, group, &test.center, &edges);
                    possible |= RayMask::from(of_group.0) << (g * LANES);
                    certain |= RayMask::from(of_group.1) << (g * LANES);
                }
            }
            is_shorter |= certain != 0;
            if Q::ANY_HIT {
                possible &= !certain;
                for slot in Bits(certain) {
                    self.finish(slot / LANES % GROUPS, slot % LANES);
                }
            }
            for slot in Bits(possible) {
                let (g, i) = (slot / LANES % GROUPS, slot % LANES);
                self.add(g, i, self.scratch.filtered[g].start[i], index);
            }
        }
        is_shorter
    }

    /// One triangle, and the rays of group `g` in the lanes `group`. Returns for which of them a hit is
    /// possible, and for which it is certain.
    #[inline(always)]
    fn test_group(&mut self, g: usize, group: u8, center: &CentralRay, edges: &EdgeFunctions<S>) -> (u8, u8) {
        let (simd, rays) = (self.simd, &self.scratch.rays);
        let x = simd.load(&rays.deviation[0][g]) - center.deviation[0];
        let y = simd.load(&rays.deviation[1][g]) - center.deviation[1];
        let before = simd.load(&rays.limit[g]);
        let (begin, end) = (simd.load(&rays.begin[g]), simd.load(&rays.range_end[g]));
        let lanes = RayLanes { deviation: [x, y], range: HitRange { begin, end, limit: before } };
        let Filtered { possible, certain, start, end } = edges.prefilter(simd, &lanes).among(group);
        let nearer = simd.select(certain, simd.load(&end).min(before), before);
        nearer.store_array(&mut self.scratch.rays.limit[g]);
        self.scratch.filtered[g].start = start;
        (possible, certain)
    }

    /// Finds the farthest limit of a ray.
    #[inline(always)]
    fn shorten(&mut self) {
        self.limit = self.simd.range(RayMask::MAX, |g| &self.scratch.rays.limit[g])[1];
    }

    /// Ends an any-hit query that is answered.
    #[inline(always)]
    fn finish(&mut self, g: usize, i: usize) {
        self.finished |= 1 << (g * LANES + i);
        self.scratch.candidates[g][i].clear();
        self.scratch.rays.limit[g][i] = f32::NEG_INFINITY;
    }

    /// Adds a candidate, and decides when there are eight.
    #[inline(always)]
    fn add(&mut self, g: usize, i: usize, start: f32, index: u32) {
        let triangles = &self.tree.triangles;
        triangles.prefetch(index);
        let candidates = &mut self.scratch.candidates[g][i];
        candidates.add(start, index);
        if candidates.is_full() {
            self.decide_candidates(g, i);
        }
    }

    /// Decides a ray's candidates, and keeps the one that is hit, if any.
    #[cold]
    fn decide_candidates(&mut self, g: usize, i: usize) {
        let (limit, ray) = (self.scratch.rays.limit[g][i], &self.rays[g][i]);
        let (candidates, triangles) = (&mut self.scratch.candidates[g][i], &self.tree.triangles);
        // A cold function does not inherit the instructions of its caller.
        let hit = self.simd.vectorize(
            #[inline(always)]
            || {
                let mut query = ClosestHit::new(ray);
                candidates.decide(limit, ray, triangles, &mut query);
                query.answer()
            },
        );
        let Some(hit) = hit else { return };
        if Q::ANY_HIT {
            self.finish(g, i);
        } else {
            // Its lower bound is not known any more, so it is always decided.
            self.scratch.candidates[g][i].add(f32::NEG_INFINITY, hit.triangle);
        }
    }
}

/// The lanes of group `g`.
#[inline(always)]
fn group_of(rays: RayMask, g: usize) -> u8 {
    (rays >> (g * LANES)) as u8
}
