//! A pencil's way through the tree.

use super::super::WideKdTree;
use super::super::filter::{Filtered, Vertices};
use super::super::goal::Goal;
use super::super::node::Child;
use super::super::packet::GROUPS;
use super::super::scratch::WIDTH;
use super::super::simd::{LANES, Simd};
use super::super::slots::{Each, Slots};
use super::Pencil;
use super::facets::{Facets, Sights};
use super::focus::Focus;
use super::lines::{Lines, bounds};
use super::view::View;
use super::window::{Cell, Window, Windows};
use crate::Ray;
use crate::search::Closest;
use std::marker::PhantomData;

/// What of a block a ray may hit, lane by lane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    starts: [f32; LANES],
    ends: [f32; LANES],
    possible: u8,
    certain: u8,
}

impl Found {
    pub(super) const NOTHING: Self =
        Self { starts: [0.0; LANES], ends: [0.0; LANES], possible: 0, certain: 0 };
}

pub(super) struct Descent<'a, S: Simd, Q> {
    pub(super) simd: S,
    pub(super) tree: &'a WideKdTree,
    pub(super) rays: &'a [[Ray; LANES]],
    pub(super) view: View,
    pub(super) pencil: &'a mut Pencil,
    /// Where the last of the rays ends.
    pub(super) end: f32,
    /// The rays of which any hit will do, and one is certain. They end before everything.
    pub(super) sure: Slots,
    pub(super) goal: PhantomData<Q>,
}

impl<S: Simd, Q: Goal> Descent<'_, S, Q> {
    #[inline(always)]
    pub(super) fn run(&mut self) {
        self.shorten();
        self.pencil.cells.clear();
        self.enter(Child::ROOT);
        while let Some(cell) = self.pencil.cells.pop() {
            if cell.near > self.end {
                continue;
            }
            if Child::is_block(cell.child) == 1 {
                self.open(&cell);
            } else {
                self.enter(cell.child);
            }
        }
    }

    /// Puts those of a node's cells that are in sight before all others.
    #[inline(always)]
    fn enter(&mut self, index: u32) {
        let node = &self.tree.nodes[index as usize];
        let (windows, met) = Windows::of(self.simd, node, &self.view, self.end);
        let order = node.orders[usize::from(self.view.octant & 7)];
        let mut places = Windows::places(self.simd, met, order);
        while places != 0 {
            // The furthest of them.
            let place = places.ilog2();
            places ^= 1 << place;
            let lane = (order >> (3 * place)) as usize % LANES;
            let (child, near, window) = (node.children[lane], windows.near[lane], windows.get(lane));
            self.pencil.cells.push(Cell { child, near, window });
            let address = self.tree.address(child);
            for line in 0..4 {
                self.simd.prefetch(address.wrapping_add(64 * line));
            }
        }
    }

    /// Filters a block for the rays in its window, in whichever way is less work.
    #[inline(always)]
    fn open(&mut self, cell: &Cell) {
        let met = self.within(&cell.window, cell.near);
        if met == 0 {
            return;
        }
        let simd = self.simd;
        let groups = (0..GROUPS).filter(|g| group_of(met, *g) != 0).count();
        let (first, count) = Child::block(cell.child);
        let rows = self.tree.blocks.rows(first, count);
        simd.prefetch(self.tree.blocks.indices(first, count).as_ptr());
        let focus = Focus::new(&self.view, &cell.window);
        let facets = Facets::new(simd, &focus, &Vertices::load(simd, rows, self.view.axes));
        let seen = facets.in_sight(simd, &focus) & rows.lanes();
        if seen == 0 {
            return;
        }
        let is_shorter = if seen.count_ones() as usize * groups < met.count_ones() as usize {
            self.filter_rays(first, seen, met, &focus, &facets)
        } else {
            self.filter_triangles(first, seen, met, &focus, &facets)
        };
        if is_shorter {
            self.shorten();
        }
    }

    /// The rays in a window that reach so far ahead.
    #[inline(always)]
    fn within(&self, window: &Window, near: f32) -> Slots {
        let (simd, mut met) = (self.simd, 0);
        let Lines { aside, end, .. } = &self.pencil.lines;
        let low = [simd.splat(window.low[0]), simd.splat(window.low[1])];
        let high = [simd.splat(window.high[0]), simd.splat(window.high[1])];
        let near = simd.splat(near);
        for g in 0..GROUPS {
            let (x, y) = (simd.load(&aside[0][g]), simd.load(&aside[1][g]));
            let across = simd.le(low[0], x) & simd.le(x, high[0]) & simd.le(low[1], y) & simd.le(y, high[1]);
            met |= Slots::from(across & simd.le(near, simd.load(&end[g]))) << (g * LANES);
        }
        met
    }

    /// The triangles `seen`, eight at once, for each of the rays `met`. Returns whether any has become shorter.
    ///
    /// What is found is looked at when all rays have been filtered: which of them find something can not be
    /// guessed.
    #[inline(always)]
    fn filter_triangles(
        &mut self,
        first: usize,
        seen: u8,
        met: Slots,
        focus: &Focus,
        facets: &Facets<S::F>,
    ) -> bool {
        let (simd, lines) = (self.simd, &self.pencil.lines);
        let (mut found, mut sure) = (0, 0);
        for slot in Each(met) {
            let (g, i) = (slot / LANES % GROUPS, slot % LANES);
            let (x, y) = (lines.aside[0][g][i] - focus.aside[0], lines.aside[1][g][i] - focus.aside[1]);
            let sights = Sights {
                aside: [simd.splat(x), simd.splat(y)],
                begin: simd.splat(lines.begin[g][i]),
                range_end: simd.splat(lines.range_end[g][i]),
                end: simd.splat(lines.end[g][i]),
            };
            let Filtered { possible, certain, start, end } = facets.filter(simd, &sights);
            let (possible, certain) = (possible & seen, certain & seen);
            let to = &mut self.pencil.found[slot % WIDTH];
            simd.store(&mut to.starts, start);
            simd.store(&mut to.ends, end);
            (to.possible, to.certain) = (possible, certain);
            found |= Slots::from(possible != 0) << slot;
            sure |= Slots::from(certain != 0) << slot;
        }
        for slot in Each(found) {
            let (g, i) = (slot / LANES % GROUPS, slot % LANES);
            let Found { starts, ends, possible, certain } = self.pencil.found[slot % WIDTH];
            if Q::ANY && certain != 0 {
                self.finish(g, i);
                continue;
            }
            for lane in Each(possible.into()) {
                self.add(g, i, starts[lane % LANES], self.tree.blocks.index(first, lane));
            }
            if certain != 0 {
                let nearest = simd.min_of(simd.load(&ends), certain);
                let end = &mut self.pencil.lines.end[g][i];
                *end = if nearest < *end { nearest } else { *end };
            }
        }
        sure != 0
    }

    /// Eight of the rays `met` at once, for each of the triangles `seen`. Returns whether any has become shorter.
    #[inline(always)]
    fn filter_rays(
        &mut self,
        first: usize,
        seen: u8,
        met: Slots,
        focus: &Focus,
        facets: &Facets<S::F>,
    ) -> bool {
        let (simd, mut is_shorter) = (self.simd, false);
        let stored = facets.store(simd);
        for at in Each(seen.into()) {
            let index = self.tree.blocks.index(first, at);
            let facet = stored.lane(simd, at);
            let (mut found, mut sure) = (0, 0);
            for g in 0..GROUPS {
                let group = group_of(met & !self.sure, g);
                if group != 0 {
                    let (possible, certain) = self.filter_group(g, group, focus, &facet);
                    found |= Slots::from(possible) << (g * LANES);
                    sure |= Slots::from(certain) << (g * LANES);
                }
            }
            is_shorter |= sure != 0;
            if Q::ANY {
                found &= !sure;
                for slot in Each(sure) {
                    self.finish(slot / LANES % GROUPS, slot % LANES);
                }
            }
            for slot in Each(found) {
                let (g, i) = (slot / LANES % GROUPS, slot % LANES);
                self.add(g, i, self.pencil.found[g].starts[i], index);
            }
        }
        is_shorter
    }

    /// Group `g` of the rays, those in the lanes `group` of it, and one triangle. Returns for which of them a
    /// hit is possible, and for which certain.
    #[inline(always)]
    fn filter_group(&mut self, g: usize, group: u8, focus: &Focus, facet: &Facets<S::F>) -> (u8, u8) {
        let (simd, lines) = (self.simd, &self.pencil.lines);
        let x = simd.sub(simd.load(&lines.aside[0][g]), simd.splat(focus.aside[0]));
        let y = simd.sub(simd.load(&lines.aside[1][g]), simd.splat(focus.aside[1]));
        let before = simd.load(&lines.end[g]);
        let (begin, range_end) = (simd.load(&lines.begin[g]), simd.load(&lines.range_end[g]));
        let sights = Sights { aside: [x, y], begin, range_end, end: before };
        let Filtered { possible, certain, start, end } = facet.filter(simd, &sights);
        let (possible, certain) = (possible & group, certain & group);
        let nearer = simd.select(certain, simd.min(end, before), before);
        simd.store(&mut self.pencil.lines.end[g], nearer);
        simd.store(&mut self.pencil.found[g].starts, start);
        (possible, certain)
    }

    /// Finds where the last of the rays ends.
    #[inline(always)]
    fn shorten(&mut self) {
        self.end = bounds(self.simd, &self.pencil.lines.end)[1];
    }

    /// Ends the search for a ray of which any hit will do, and one is certain.
    #[inline(always)]
    fn finish(&mut self, g: usize, i: usize) {
        self.sure |= 1 << (g * LANES + i);
        self.pencil.candidates[g][i].clear();
        self.pencil.lines.end[g][i] = f32::NEG_INFINITY;
    }

    /// Adds a candidate, and decides when there are many.
    #[inline(always)]
    fn add(&mut self, g: usize, i: usize, start: f32, index: u32) {
        let triangles = &self.tree.triangles;
        self.simd.prefetch(triangles.get(index));
        let candidates = &mut self.pencil.candidates[g][i];
        candidates.add(start, index);
        if candidates.is_full() {
            self.settle(g, i);
        }
    }

    /// Leaves of a ray's candidates the one that is hit, if any.
    #[cold]
    fn settle(&mut self, g: usize, i: usize) {
        let (end, ray) = (self.pencil.lines.end[g][i], &self.rays[g][i]);
        let mut search = Closest::begin(ray);
        let candidates = &mut self.pencil.candidates[g][i];
        candidates.decide(end, ray, &self.tree.triangles, &mut search);
        let Some(hit) = search.hit() else { return };
        if Q::ANY {
            self.finish(g, i);
        } else {
            // Where it begins is not known any more, and it is never beyond.
            candidates.add(f32::NEG_INFINITY, hit.triangle);
        }
    }
}

/// Those of the rays that are in group `g`.
#[inline(always)]
fn group_of(slots: Slots, g: usize) -> u8 {
    (slots >> (g * LANES)) as u8
}
