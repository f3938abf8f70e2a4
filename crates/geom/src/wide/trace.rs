//! One ray's search: what is still to be visited, and what may be hit.

use super::candidates::Candidates;
use super::course::Course;
use super::node::Child;
use super::simd::{LANES, Simd};
use super::subtrees::MAX_LEVELS;
use crate::KdTree;

/// Most nodes with cells still to be visited, one for each level at most, and one that is never left.
const DEPTH: usize = 128;
const _: () = assert!((KdTree::MAX_DEPTH + MAX_LEVELS) as usize + 2 <= DEPTH);

/// The cells of a node, from near to far, and where the ray enters them.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug)]
struct Cells {
    starts: [f32; LANES],
    children: [u32; LANES],
}

impl Cells {
    /// Ends every search.
    const END: Self = Self { starts: [0.0; LANES], children: [Child::END; LANES] };
}

/// The search for a ray: the cell at hand, and a stack of those still to be visited.
#[repr(C, align(64))]
#[derive(Debug)]
pub(super) struct Trace {
    // A cache line holds what steps need: these and the first of the course.
    /// The nearest cell.
    pub(super) child: u32,
    /// What begins beyond this can not matter.
    pub(super) t_end: f32,
    pub(super) course: Course,
    pub(super) candidates: Candidates,
    /// Which of the rays it is.
    pub(super) ray: u32,
    depth: usize,
    /// The cells of each node that are still to be visited, a bit each.
    left: [u8; DEPTH],
    cells: [Cells; DEPTH],
}

impl Trace {
    pub(super) fn idle() -> Self {
        Self {
            child: Child::END,
            t_end: 0.0,
            course: Course::default(),
            candidates: Candidates::default(),
            ray: 0,
            depth: 0,
            left: [0; DEPTH],
            cells: [Cells::END; DEPTH],
        }
    }

    /// Starts at the root.
    #[inline(always)]
    pub(super) fn begin(&mut self, course: Course, ray: u32) {
        (self.child, self.course, self.ray, self.t_end) = (Child::ROOT, course, ray, course.end);
        self.clear();
    }

    /// Leaves nothing to be visited but what is at hand.
    #[inline(always)]
    pub(super) fn clear(&mut self) {
        self.left[0] = 1;
        self.depth = 1;
        self.candidates.clear();
    }

    /// Puts a node's cells in the lanes of `mask` before all others.
    #[inline(always)]
    pub(super) fn push<S: Simd>(&mut self, simd: S, starts: S::F, children: S::I, mask: u8) {
        let top = self.depth % DEPTH;
        simd.store(&mut self.cells[top].starts, starts);
        simd.store_i(&mut self.cells[top].children, children);
        self.left[top] = mask;
        self.depth = top + usize::from(mask != 0);
    }

    /// Takes the nearest cell in hand.
    #[inline(always)]
    pub(super) fn advance(&mut self) {
        let top = self.depth.wrapping_sub(1) % DEPTH;
        let left = self.left[top];
        self.child = self.cells[top].children[left.trailing_zeros() as usize % LANES];
        let left = left & left.wrapping_sub(1);
        self.left[top] = left;
        self.depth = top + usize::from(left != 0);
    }

    /// Drops what begins beyond `t_end`.
    #[inline(always)]
    pub(super) fn drop_beyond<S: Simd>(&mut self, simd: S) {
        let limit = simd.splat(self.t_end);
        let depth = self.depth.min(DEPTH);
        self.depth = 1;
        for at in 1..depth {
            let left = self.left[at] & simd.le(simd.load(&self.cells[at].starts), limit);
            if left != 0 {
                let to = self.depth % DEPTH;
                self.left[to] = left;
                self.cells[to] = self.cells[at];
                self.depth += 1;
            }
        }
    }
}
