//! The leaf test: the conservative test of a leaf block's triangles, and what follows from it.

use super::prefilter::{Filtered, SplatRay, Vertices, prefilter};
use super::traversal_state::Traversal;
use crate::Ray;
use crate::query::Query;
use crate::wide::simd::{Bits, LANES, Simd};
use crate::wide::tree::Tree;
use crate::wide::tree::node::Child;

/// The triangles of a leaf block that a ray may hit.
#[derive(Clone, Copy)]
pub(super) struct LeafHits<S: Simd> {
    /// The block's first reference.
    first: usize,
    filtered: Filtered<S>,
}

impl<S: Simd> LeafHits<S> {
    pub(super) fn none(simd: S) -> Self {
        let zero = simd.splat(0.0);
        Self { first: 0, filtered: Filtered { possible: 0, certain: 0, start: zero, end: zero } }
    }

    /// Whether any hit is possible.
    #[inline(always)]
    pub(super) fn any(&self) -> bool {
        self.filtered.possible != 0
    }
}

/// Tests the current child, a leaf block.
#[inline(always)]
pub(super) fn test_leaf<S: Simd>(simd: S, tree: &Tree, traversal: &mut Traversal) -> LeafHits<S> {
    let (first, count) = Child::block(traversal.child);
    let rows = tree.leaves.rows(first, count);
    let vertices = Vertices::load(simd, rows, traversal.setup.axes.map(usize::from));
    let ray = SplatRay::new(simd, &traversal.setup, traversal.t_end);
    let mut filtered = prefilter(simd, &ray, &vertices);
    filtered.possible &= rows.lanes();
    filtered.certain &= rows.lanes();
    LeafHits { first, filtered }
}

/// Adds the possible hits to the candidates, and ends the traversal as soon as a certain one permits.
#[inline(always)]
pub(super) fn record<S: Simd, Q: Query>(
    simd: S,
    tree: &Tree,
    ray: &Ray,
    LeafHits { first, filtered }: &LeafHits<S>,
    traversal: &mut Traversal,
    query: &mut Q,
) {
    if Q::ANY_HIT && filtered.certain != 0 {
        *query = query.with_some_hit();
        traversal.clear();
        return;
    }
    let mut starts = [0.0; LANES];
    simd.store(&mut starts, filtered.start);
    for lane in Bits(filtered.possible.into()) {
        let index = tree.leaves.index(*first, lane);
        simd.prefetch(tree.triangles.get(index));
        traversal.candidates.add(starts[lane % LANES], index);
        if traversal.candidates.is_full() {
            traversal.candidates.decide(traversal.t_end, ray, &tree.triangles, query);
            if Q::ANY_HIT && query.is_answered() {
                traversal.clear();
                return;
            }
        }
    }
    if filtered.certain != 0 {
        let end = simd.min_of(filtered.end, filtered.certain);
        // In a closed scene the ray mostly ends there already, and there is nothing to drop.
        if end < traversal.t_end {
            traversal.t_end = end;
            traversal.drop_beyond(simd);
        }
    }
}
