//! A ray at a leaf's block.

use super::WideKdTree;
use super::filter::{Filtered, Rays, Vertices, filter};
use super::goal::Goal;
use super::node::Child;
use super::simd::{LANES, Simd};
use super::slots::Each;
use super::trace::Trace;
use crate::Ray;

/// What of a block may be hit.
#[derive(Clone, Copy)]
pub(super) struct Found<S: Simd> {
    /// The block's first reference.
    first: usize,
    filtered: Filtered<S>,
}

impl<S: Simd> Found<S> {
    pub(super) fn nothing(simd: S) -> Self {
        let zero = simd.splat(0.0);
        Self { first: 0, filtered: Filtered { possible: 0, certain: 0, start: zero, end: zero } }
    }

    /// Whether there is anything.
    #[inline(always)]
    pub(super) fn is_any(&self) -> bool {
        self.filtered.possible != 0
    }
}

/// Takes the nearest block and filters it.
#[inline(always)]
pub(super) fn open<S: Simd>(simd: S, tree: &WideKdTree, trace: &mut Trace) -> Found<S> {
    let (first, count) = Child::block(trace.child);
    let rows = tree.blocks.rows(first, count);
    let vertices = Vertices::load(simd, rows, trace.course.axes.map(usize::from));
    let rays = Rays::same(simd, &trace.course, trace.t_end);
    let mut filtered = filter(simd, &rays, &vertices);
    filtered.possible &= rows.lanes();
    filtered.certain &= rows.lanes();
    Found { first, filtered }
}

/// Takes note of what was found.
#[inline(always)]
pub(super) fn note<S: Simd, Q: Goal>(
    simd: S,
    tree: &WideKdTree,
    ray: &Ray,
    Found { first, filtered }: &Found<S>,
    trace: &mut Trace,
    search: &mut Q,
) {
    if Q::ANY && filtered.certain != 0 {
        *search = search.sure();
        trace.clear();
        return;
    }
    let mut starts = [0.0; LANES];
    simd.store(&mut starts, filtered.start);
    for lane in Each(filtered.possible.into()) {
        let index = tree.blocks.index(*first, lane);
        simd.prefetch(tree.triangles.get(index));
        trace.candidates.add(starts[lane % LANES], index);
        if trace.candidates.is_full() {
            trace.candidates.decide(trace.t_end, ray, &tree.triangles, search);
        }
    }
    if filtered.certain != 0 {
        let end = simd.min_of(filtered.end, filtered.certain);
        // In a closed scene the ray mostly ends there already, and nothing is to be dropped.
        if end < trace.t_end {
            trace.t_end = end;
            trace.drop_beyond(simd);
        }
    }
}
