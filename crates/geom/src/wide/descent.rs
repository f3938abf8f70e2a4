//! A packet's way through the tree: the frustum meets nodes, each ray meets boxes of blocks.

use super::WideKdTree;
use super::filter::{Filtered, Rays, Vertices, filter};
use super::frustum::Frustum;
use super::goal::Goal;
use super::node::{Child, Node};
use super::packet::{Cell, GROUPS, Packet, range};
use super::simd::{LANES, Rows, Simd};
use super::slots::{Each, Slots};
use crate::Ray;

pub(super) struct Descent<'a, S: Simd, Q> {
    pub(super) simd: S,
    pub(super) tree: &'a WideKdTree,
    pub(super) rays: &'a [[Ray; LANES]],
    pub(super) packet: &'a mut Packet,
    pub(super) frustum: Frustum,
    /// The rays that are still searched for.
    pub(super) live: Slots,
    pub(super) searches: &'a mut [[Q; LANES]; GROUPS],
}

impl<S: Simd, Q: Goal> Descent<'_, S, Q> {
    #[inline(always)]
    pub(super) fn run(&mut self) {
        self.shorten();
        self.packet.cells.clear();
        self.enter(Child::ROOT);
        while self.live != 0 {
            let Some(cell) = self.packet.cells.pop() else { break };
            if self.frustum.is_beyond(cell.near) {
                continue;
            }
            if Child::is_block(cell.child) == 1 {
                self.open(cell);
            } else {
                self.enter(cell.child);
            }
        }
    }

    /// Puts those of a node's cells that the frustum meets before all others.
    #[inline(always)]
    fn enter(&mut self, index: u32) {
        let node = &self.tree.nodes[index as usize];
        let met = self.frustum.meets(self.simd, node);
        let order = self.frustum.order(node);
        for place in (0..LANES).rev() {
            let lane = (order >> (3 * place)) as usize % LANES;
            if met >> lane & 1 == 0 {
                continue;
            }
            let (child, near) = (node.children[lane], self.frustum.near(node, lane));
            self.packet.cells.push(Cell { child, node: index, lane: lane as u32, near });
            let address = self.tree.address(child);
            for line in 0..4 {
                self.simd.prefetch(address.wrapping_add(64 * line));
            }
        }
    }

    /// Filters a block for the rays that meet its box, in whichever way is less work.
    #[inline(always)]
    fn open(&mut self, cell: Cell) {
        let met = self.meeting(&self.tree.nodes[cell.node as usize], cell.lane as usize % LANES);
        let groups = (0..GROUPS).filter(|g| group_of(met, *g) != 0).count();
        let (first, count) = Child::block(cell.child);
        let rows = self.tree.blocks.rows(first, count);
        let is_shorter = if count * groups < met.count_ones() as usize {
            self.filter_rays(first, rows, count, met)
        } else {
            self.filter_triangles(first, rows, met)
        };
        if is_shorter {
            self.shorten();
        }
    }

    /// The rays that meet the box of a node's lane.
    #[inline(always)]
    fn meeting(&self, node: &Node, lane: usize) -> Slots {
        let (simd, mut met) = (self.simd, 0);
        for (g, courses) in self.packet.courses.iter().enumerate() {
            let mut start = simd.load(&courses.start);
            let mut end = simd.load(&self.packet.t_end[g]);
            for axis in 0..3 {
                // A box that is entered here may be left there by a ray that goes the other way.
                let inverse = simd.load(&courses.inverse[axis]);
                let lower = simd.mul(simd.splat(node.faces[2 * axis][lane]), inverse);
                let upper = simd.mul(simd.splat(node.faces[2 * axis + 1][lane]), inverse);
                let (enter, leave) = (simd.min(lower, upper), simd.max(lower, upper));
                start = simd.max(start, simd.add(enter, simd.load(&courses.near[axis])));
                end = simd.min(end, simd.add(leave, simd.load(&courses.far[axis])));
            }
            met |= Slots::from(simd.le(start, end)) << (g * LANES);
        }
        met & self.live
    }

    /// Eight triangles for each of the rays `met`. Returns whether any has become shorter.
    #[inline(always)]
    fn filter_triangles(&mut self, first: usize, rows: Rows<'_>, met: Slots) -> bool {
        let (simd, mut is_shorter) = (self.simd, false);
        let vertices = Vertices::load(simd, rows, self.frustum.axes);
        for slot in Each(met) {
            let (g, i) = (slot / LANES % GROUPS, slot % LANES);
            let ray = Rays::lane(simd, &self.packet.courses[g], i, self.packet.t_end[g][i]);
            let Filtered { possible, certain, start, end } = filter(simd, &ray, &vertices);
            let (possible, certain) = (possible & rows.lanes(), certain & rows.lanes());
            if possible == 0 {
                continue;
            }
            is_shorter |= certain != 0;
            if Q::ANY && certain != 0 {
                self.finish(g, i);
                continue;
            }
            let mut starts = [0.0; LANES];
            simd.store(&mut starts, start);
            for lane in Each(possible.into()) {
                self.add(g, i, starts[lane % LANES], self.tree.blocks.index(first, lane));
            }
            if certain != 0 {
                let (end, t_end) = (simd.min_of(end, certain), &mut self.packet.t_end[g][i]);
                *t_end = if end < *t_end { end } else { *t_end };
            }
        }
        is_shorter
    }

    /// Eight of the rays `met` for each triangle. Returns whether any has become shorter.
    #[inline(always)]
    fn filter_rays(&mut self, first: usize, rows: Rows<'_>, count: usize, met: Slots) -> bool {
        let (simd, mut is_shorter) = (self.simd, false);
        for at in 0..count {
            let index = self.tree.blocks.index(first, at);
            let vertices = Vertices::one(simd, rows, self.frustum.axes, at);
            for g in 0..GROUPS {
                let group = group_of(met & self.live, g);
                if group != 0 {
                    is_shorter |= self.filter_group(g, group, index, &vertices);
                }
            }
        }
        is_shorter
    }

    /// Group `g` of the rays, those in the lanes `group` of it, and one triangle.
    #[inline(always)]
    fn filter_group(&mut self, g: usize, group: u8, index: u32, vertices: &Vertices<S>) -> bool {
        let simd = self.simd;
        let rays = Rays::each(simd, &self.packet.courses[g], &self.packet.t_end[g]);
        let Filtered { possible, certain, start, end } = filter(simd, &rays, vertices);
        let (mut possible, certain) = (possible & group, certain & group);
        if Q::ANY {
            possible &= !certain;
            for i in Each(certain.into()) {
                self.finish(g, i % LANES);
            }
        }
        let mut starts = [0.0; LANES];
        simd.store(&mut starts, start);
        for i in Each(possible.into()) {
            self.add(g, i % LANES, starts[i % LANES], index);
        }
        let t_end = simd.load(&self.packet.t_end[g]);
        let nearer = simd.select(certain, simd.min(end, t_end), t_end);
        simd.store(&mut self.packet.t_end[g], nearer);
        certain != 0
    }

    /// Lets the frustum end where the last of the rays does.
    #[inline(always)]
    fn shorten(&mut self) {
        let simd = self.simd;
        let Packet { courses, t_end, rates, .. } = &*self.packet;
        let mut depths = [simd.splat(0.0); GROUPS];
        for g in 0..GROUPS {
            let along = simd.sub(simd.load(&t_end[g]), simd.load(&courses[g].depth_offset));
            depths[g] = simd.mul(along, simd.load(&rates[g]));
        }
        self.frustum.end_within(range(simd, &depths, self.live));
    }

    /// Ends the search for a ray of which any hit will do, and one is certain.
    #[inline(always)]
    fn finish(&mut self, g: usize, i: usize) {
        self.live &= !(1 << (g * LANES + i));
        self.packet.candidates[g][i].clear();
        self.searches[g][i] = self.searches[g][i].sure();
    }

    /// Adds a candidate, and decides when there are many.
    #[inline(always)]
    fn add(&mut self, g: usize, i: usize, start: f32, index: u32) {
        let triangles = &self.tree.triangles;
        self.simd.prefetch(triangles.get(index));
        let candidates = &mut self.packet.candidates[g][i];
        candidates.add(start, index);
        if candidates.is_full() {
            candidates.decide(self.packet.t_end[g][i], &self.rays[g][i], triangles, &mut self.searches[g][i]);
        }
    }
}

/// Those of a packet's rays that are in group `g`.
#[inline(always)]
fn group_of(slots: Slots, g: usize) -> u8 {
    (slots >> (g * LANES)) as u8
}
