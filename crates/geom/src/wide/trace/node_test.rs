//! The node test: where a ray enters and leaves the bounds of eight children (slab test; Kay and Kajiya, 1986).

use super::ray_setup::RaySetup;
use super::traversal_state::Traversal;
use crate::query::Query;
use crate::wide::simd::Simd;
use crate::wide::tree::node::Node;

/// Tests the current child, a node: pushes those of its children whose bounds the ray meets, from near to far. An
/// any-hit query needs no order.
#[inline(always)]
pub(super) fn test_node<S: Simd, Q: Query>(simd: S, nodes: &[Node], traversal: &mut Traversal) {
    let node = &nodes[traversal.child as usize];
    let setup = &traversal.setup;
    let x = crossings(simd, node, setup, 0);
    let y = crossings(simd, node, setup, 1);
    let z = crossings(simd, node, setup, 2);
    let start = simd.max(simd.max(x[0], y[0]), simd.max(z[0], simd.splat(setup.start)));
    let end = simd.min(simd.min(x[1], y[1]), simd.min(z[1], simd.splat(traversal.t_end)));
    let (missed, children) = (simd.sub(end, start), simd.load_i(&node.children));
    if Q::ANY_HIT {
        traversal.push(simd, start, children, !simd.signs(missed));
        return;
    }
    let order = simd.lane_indices(node.orders[usize::from(setup.octant & 7)]);
    let missed = simd.signs(simd.permute(missed, order));
    traversal.push(simd, simd.permute(start, order), simd.permute_i(children, order), !missed);
}

/// Where the ray enters the slabs of the bounds along `axis`, rounded down, and where it leaves them, rounded up.
#[inline(always)]
fn crossings<S: Simd>(simd: S, node: &Node, setup: &RaySetup, axis: usize) -> [S::F; 2] {
    let [enter, leave] = node.slabs(axis, setup.octant);
    let inverse = simd.splat(setup.inverse[axis]);
    [
        simd.mul_add(simd.load(enter), inverse, simd.splat(setup.near[axis])),
        simd.mul_add(simd.load(leave), inverse, simd.splat(setup.far[axis])),
    ]
}
