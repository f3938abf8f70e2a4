//! Many rays in turn: each makes one step before any makes the next, so that what one waits for,
//! the others hide.
//!
//! A step ends before its outcome is known, and nothing but the outcome of an earlier round is
//! waited for or branched upon: it decides in which round's set of rays a ray is.

use super::WideKdTree;
use super::course::Courses;
use super::goal::Goal;
use super::leaf::{Found, note, open};
use super::node::Child;
use super::scratch::WIDTH;
use super::simd::{LANES, Simd};
use super::slots::{Each, Slots};
use super::step::step;
use super::trace::Trace;
use crate::Ray;

/// So many rays are in hand: enough that none waits, and few enough that what they need stays in the first
/// cache (measured, docs/performance.md).
const IN_HAND: usize = 40;
const _: () = assert!(IN_HAND <= WIDTH);

/// What rays in hand are waiting for.
#[derive(Default)]
struct Waiting {
    nodes: Slots,
    blocks: Slots,
    ended: Slots,
}

struct Wave<'a, Q, R> {
    tree: &'a WideKdTree,
    rays: &'a [Ray],
    /// Where the sets of [`WIDTH`] rays start that are not yet in hand.
    starts: std::slice::Iter<'a, u32>,
    /// The next ray to be taken in hand.
    next: usize,
    /// Where its set ends.
    end: usize,
    /// Of the group of rays that it belongs to.
    courses: Courses<LANES>,
    traces: &'a mut [Trace; WIDTH],
    searches: [Option<Q>; WIDTH],
    report: R,
}

/// Searches for the rays of the sets that start at `starts`, and hands each finished search to `report`.
#[inline(always)]
pub(super) fn search_in_turn<S: Simd, Q: Goal>(
    simd: S,
    tree: &WideKdTree,
    rays: &[Ray],
    starts: &[u32],
    traces: &mut [Trace; WIDTH],
    report: impl FnMut(usize, Q),
) {
    let (starts, courses, searches) = (starts.iter(), Courses::idle(), [None; WIDTH]);
    Wave { tree, rays, starts, next: 0, end: 0, courses, traces, searches, report }.run(simd);
}

impl<Q: Goal, R: FnMut(usize, Q)> Wave<'_, Q, R> {
    #[inline(always)]
    fn run<S: Simd>(&mut self, simd: S) {
        let mut found = [Found::nothing(simd); WIDTH];
        let mut waiting = Waiting { ended: Slots::MAX >> (64 - IN_HAND), ..Waiting::default() };
        loop {
            waiting.nodes |= self.turn_over(simd, waiting.ended);
            if waiting.nodes | waiting.blocks == 0 {
                break;
            }
            self.step(simd, waiting.nodes);
            self.open(simd, waiting.blocks, &mut found);
            waiting = self.advance(simd, waiting.nodes | waiting.blocks);
        }
    }

    /// The next ray to be taken in hand.
    #[inline(always)]
    fn next_ray<S: Simd>(&mut self, simd: S) -> Option<usize> {
        if self.next == self.end {
            self.next = *self.starts.next()? as usize;
            self.end = self.rays.len().min(self.next + WIDTH);
        }
        if self.next.is_multiple_of(LANES) {
            let WideKdTree { triangles, space, .. } = self.tree;
            let group = self.rays[self.next..].first_chunk::<LANES>();
            let group = group.copied().unwrap_or_else(|| self.last_group());
            // They are needed soon, and not at hand yet.
            for i in 0..LANES {
                simd.prefetch(self.rays.as_ptr().wrapping_add(self.next + 2 * LANES + i));
            }
            self.courses.set(&simd.columns(&group), &triangles.bounds(), space);
        }
        self.next += 1;
        Some(self.next - 1)
    }

    /// The rays that are too few for a group, and the last of them again.
    #[cold]
    fn last_group(&self) -> [Ray; LANES] {
        std::array::from_fn(|i| self.rays[(self.next + i).min(self.rays.len() - 1)])
    }

    /// Ends the searches of the slots `ended`, and begins others there; returns where it did.
    #[inline(always)]
    fn turn_over<S: Simd>(&mut self, simd: S, ended: Slots) -> Slots {
        let mut begun = 0;
        for slot in Each(ended) {
            let trace = &mut self.traces[slot];
            if let Some(mut search) = self.searches[slot].take() {
                let id = trace.ray as usize;
                trace.candidates.decide(trace.t_end, &self.rays[id], &self.tree.triangles, &mut search);
                (self.report)(id, search);
            }
            begun |= Slots::from(self.begin_next(simd, slot)) << slot;
        }
        begun
    }

    /// Begins a search, unless there is none left.
    #[inline(always)]
    fn begin_next<S: Simd>(&mut self, simd: S, slot: usize) -> bool {
        while let Some(id) = self.next_ray(simd) {
            let ray = &self.rays[id];
            let search = Q::begin(ray);
            if let Some(course) = self.courses.get(id % LANES) {
                self.traces[slot].begin(course, id as u32);
                self.searches[slot] = Some(search);
                return true;
            }
            (self.report)(id, search);
        }
        false
    }

    /// One step through a node for each of the rays that wait for one.
    #[inline(always)]
    fn step<S: Simd>(&mut self, simd: S, nodes: Slots) {
        for slot in Each(nodes) {
            step(simd, &self.tree.nodes, &mut self.traces[slot]);
        }
    }

    /// One block for each of the rays that wait for one.
    ///
    /// All are filtered before the first hit is looked at: whether there is one can not be
    /// predicted, and a wrong guess costs all that was begun after it.
    #[inline(always)]
    fn open<S: Simd>(&mut self, simd: S, blocks: Slots, found: &mut [Found<S>; WIDTH]) {
        let mut hits: Slots = 0;
        for slot in Each(blocks) {
            found[slot] = open(simd, self.tree, &mut self.traces[slot]);
            hits |= Slots::from(found[slot].is_any()) << slot;
        }
        for slot in Each(hits) {
            let trace = &mut self.traces[slot];
            if let Some(search) = &mut self.searches[slot] {
                note(simd, self.tree, &self.rays[trace.ray as usize], &found[slot], trace, search);
            }
        }
    }

    /// Takes each ray's nearest cell in hand, and asks for its memory.
    ///
    /// Not at the end of a step or a block: by now its outcome is known, and nothing waits.
    #[inline(always)]
    fn advance<S: Simd>(&mut self, simd: S, slots: Slots) -> Waiting {
        let mut waiting = Waiting::default();
        for slot in Each(slots) {
            let trace = &mut self.traces[slot];
            trace.advance();
            let child = trace.child;
            waiting.blocks |= Slots::from(Child::is_block(child)) << slot;
            waiting.ended |= Slots::from(Child::is_end(child)) << slot;
            let address = self.tree.address(child);
            for line in 0..5 {
                simd.prefetch(address.wrapping_add(64 * line));
            }
        }
        waiting.nodes = slots & !(waiting.blocks | waiting.ended);
        waiting
    }
}
