//! One ray's search: what is still to be visited, and what may be hit.

use super::candidates::Candidates;
use super::course::Course;
use super::node::Child;
use super::simd::{LANES, Simd};

/// Most entries of a stack: 7 that each of 31 levels leaves behind, and 8 that are written at once.
/// (A binary tree has 60 levels at most, a third of which are the wide one's; a leaf with too many
/// triangles for a block has 10 more at most.)
const STACK: usize = 248;

/// The stack's entries are cells, the nearest on top, with the part of the ray that lies in them.
#[repr(C, align(64))]
#[derive(Debug)]
pub(super) struct Trace {
    // A cache line holds what steps need: these three and the first of the course.
    /// What begins beyond this can not matter.
    pub(super) t_end: f32,
    /// Which of the rays it is.
    pub(super) ray: u32,
    depth: usize,
    pub(super) course: Course,
    pub(super) candidates: Candidates,
    starts: [f32; STACK],
    ends: [f32; STACK],
    children: [u32; STACK],
}

impl Trace {
    pub(super) fn idle() -> Self {
        Self {
            course: Course::default(),
            t_end: 0.0,
            ray: 0,
            depth: 0,
            candidates: Candidates::default(),
            starts: [0.0; STACK],
            ends: [0.0; STACK],
            children: [0; STACK],
        }
    }

    /// Starts at the root.
    #[inline(always)]
    pub(super) fn begin(&mut self, course: Course, ray: u32) {
        (self.course, self.ray, self.t_end) = (course, ray, course.end);
        (self.starts[0], self.ends[0], self.children[0]) = (f32::NEG_INFINITY, 0.0, Child::END);
        (self.starts[1], self.ends[1], self.children[1]) = (course.start, course.end, Child::ROOT);
        self.depth = 2;
        self.candidates.clear();
    }

    /// Leaves nothing to be visited.
    #[inline(always)]
    pub(super) fn finish(&mut self) {
        self.depth = 1;
        self.candidates.clear();
    }

    /// Pushes the children in the lanes of `mask`, the first deepest.
    #[inline(always)]
    pub(super) fn push<S: Simd>(&mut self, simd: S, start: S::F, end: S::F, child: S::I, mask: u8) {
        let depth = self.depth;
        simd.compress(chunk(&mut self.starts, depth), start, mask);
        simd.compress(chunk(&mut self.ends, depth), end, mask);
        simd.compress_i(chunk(&mut self.children, depth), child, mask);
        self.depth = depth + mask.count_ones() as usize;
    }

    /// The nearest child.
    #[inline(always)]
    pub(super) fn top(&self) -> u32 {
        self.children[(self.depth - 1).min(STACK - 1)]
    }

    /// Takes the nearest child, with where it starts and ends.
    #[inline(always)]
    pub(super) fn pop(&mut self) -> (u32, f32, f32) {
        self.depth -= 1;
        let top = self.depth.min(STACK - 1);
        (self.children[top], self.starts[top], self.ends[top])
    }

    /// Drops what begins beyond `t_end`.
    #[inline(always)]
    pub(super) fn drop_beyond<S: Simd>(&mut self, simd: S) {
        let limit = simd.splat(self.t_end);
        let (depth, mut at) = (self.depth, 0);
        self.depth = 0;
        while at < depth {
            let start = simd.load(chunk(&mut self.starts, at));
            let end = simd.load(chunk(&mut self.ends, at));
            let child = simd.load_i(chunk(&mut self.children, at));
            let filled = 0xff_u32 >> (LANES - (depth - at).min(LANES));
            let mask = simd.le(start, limit) & filled as u8;
            self.push(simd, start, end, child, mask);
            at += LANES;
        }
    }
}

#[inline(always)]
fn chunk<T>(array: &mut [T; STACK], at: usize) -> &mut [T; LANES] {
    array[at..].first_chunk_mut().expect("the stack is deep enough")
}
