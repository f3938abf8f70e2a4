//! The tests of a traversal's current child. A node: where the ray enters and leaves the bounds of eight children (slab
//! test; Kay and Kajiya, 1986). A leaf block: the conservative test of its triangles, and what follows from it.

use super::prefilter::{Filtered, Vertices, prefilter};
use super::ray_setup::{RaySetup, ShearSetup};
use super::traversal_state::{MetChildren, Traversal};
use crate::accel::query::Query;
use crate::accel::wide::simd::{Bits, LANES, Simd, SimdBase, SimdFloat};
use crate::accel::wide::tree::Tree;
use crate::accel::wide::tree::node::{Child, Node};
use crate::{QueryCounter, Ray};

/// Visits the current child and all others that are left, and tells `counter` what is done for it.
#[inline(always)]
pub(super) fn visit_all<S: Simd, Q: Query, C: QueryCounter>(
    simd: S,
    tree: &Tree,
    ray: &Ray,
    traversal: &mut Traversal,
    query: &mut Q,
    counter: &mut C,
) {
    while !Child::is_end(traversal.child) {
        if !Child::is_block(traversal.child) {
            counter.visit();
            traversal.descend::<S, Q>(test_node::<S, Q>(simd, &tree.nodes, traversal));
            continue;
        }
        counter.open();
        let block = tree.leaf_block(traversal.child);
        block.indices().for_each(|index| counter.test(index));
        let Traversal { child, limit, setup, excluded, .. } = traversal;
        let filtered = test_leaf(simd, tree, *child, &setup.shear, *limit, *excluded);
        if filtered.possible != 0 {
            record(simd, tree, ray, &filtered, traversal, query);
        }
        traversal.advance();
    }
}

/// Tests the current child, a node: which of its children have bounds that the ray meets, from near to far. An any-hit
/// query needs no order.
#[inline(always)]
pub(super) fn test_node<S: Simd, Q: Query>(simd: S, nodes: &[Node], traversal: &Traversal) -> MetChildren<S> {
    let node = &nodes[traversal.child as usize];
    let setup = &traversal.setup;
    let x = crossings(simd, node, setup, 0);
    let y = crossings(simd, node, setup, 1);
    let z = crossings(simd, node, setup, 2);
    let starts = x[0].max(y[0]).max(z[0].max(setup.start));
    let ends = x[1].min(y[1]).min(z[1].min(traversal.limit));
    let children = S::I::load_array(simd, node.children);
    if Q::ANY_HIT {
        let mask = !simd.lt(ends, starts);
        let nearest = node.children[u32::from(mask).trailing_zeros() as usize % LANES];
        return MetChildren { starts, children, mask, nearest };
    }
    let order = node.orders[usize::from(setup.octant & 7)];
    let lanes = simd.lane_indices(order);
    let (starts, ends) = (simd.permute(starts, lanes), simd.permute(ends, lanes));
    let children = simd.permute(S::F::from_bits(children), lanes).to_bits();
    let mask = !simd.lt(ends, starts);
    // Read from the node: a lane of `children` would have to be stored first.
    let nearest = order.wrapping_shr(3 * u32::from(mask).trailing_zeros());
    MetChildren { starts, children, mask, nearest: node.children[nearest as usize % LANES] }
}

/// Where the ray enters the slabs of the bounds along `axis`, rounded down, and where it leaves them, rounded up.
#[inline(always)]
fn crossings<S: Simd>(simd: S, node: &Node, setup: &RaySetup, axis: usize) -> [S::F; 2] {
    let ([enter, leave], inverse) = (node.slabs(axis, setup.octant), setup.inverse[axis]);
    [simd.load(enter).mul_add(inverse, setup.near[axis]), simd.load(leave).mul_add(inverse, setup.far[axis])]
}

/// Tests a leaf block. Triangles that the ray excludes are missed; hits beyond `limit` cannot matter.
#[inline(always)]
pub(super) fn test_leaf<S: Simd>(
    simd: S,
    tree: &Tree,
    child: u32,
    ray: &ShearSetup,
    limit: f32,
    excluded: [u32; 2],
) -> Filtered {
    let block = tree.leaf_block(child);
    let vertices = Vertices::load(simd, block, ray.axes.map(usize::from));
    let lanes = block.lanes() & !block.lanes_of(simd, excluded);
    prefilter(simd, ray, limit, &vertices).among(lanes)
}

/// Adds the possible hits in the current child, a leaf block, to the candidates, and ends the traversal as soon as a
/// certain one permits.
#[inline(always)]
pub(super) fn record<S: Simd, Q: Query>(
    simd: S,
    tree: &Tree,
    ray: &Ray,
    filtered: &Filtered,
    traversal: &mut Traversal,
    query: &mut Q,
) {
    if Q::ANY_HIT && filtered.certain != 0 {
        *query = query.with_some_hit();
        traversal.clear();
        return;
    }
    let block = tree.leaf_block(traversal.child);
    for lane in Bits(filtered.possible.into()) {
        let index = block.index(lane % LANES);
        tree.triangles.prefetch(index);
        traversal.candidates.add(filtered.start[lane % LANES], index);
        if traversal.candidates.is_full() {
            traversal.candidates.decide(traversal.limit, ray, &tree.triangles, query);
            if Q::ANY_HIT && query.is_answered() {
                traversal.clear();
                return;
            }
        }
    }
    if filtered.certain != 0 {
        let end = simd.min_of(simd.load(&filtered.end), filtered.certain);
        // In a closed scene the ray mostly ends there already, and there is nothing to drop.
        if end < traversal.limit {
            traversal.limit = end;
            traversal.drop_beyond(simd);
        }
    }
}
