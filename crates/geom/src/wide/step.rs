//! A step through a node: where a ray enters and leaves eight boxes at once.

use super::course::Course;
use super::node::Node;
use super::simd::Simd;
use super::trace::Trace;

/// Opens the node at hand: pushes those of its cells that the ray meets.
#[inline(always)]
pub(super) fn step<S: Simd>(simd: S, nodes: &[Node], trace: &mut Trace) {
    let node = &nodes[trace.child as usize];
    let course = &trace.course;
    let x = crossings(simd, node, course, 0);
    let y = crossings(simd, node, course, 1);
    let z = crossings(simd, node, course, 2);
    let start = simd.max(simd.max(x[0], y[0]), simd.max(z[0], simd.splat(course.start)));
    let end = simd.min(simd.min(x[1], y[1]), simd.min(z[1], simd.splat(trace.t_end)));

    let order = simd.lane_indices(node.orders[usize::from(course.octant & 7)]);
    let missed = simd.signs(simd.permute(simd.sub(end, start), order));
    let children = simd.permute_i(simd.load_i(&node.children), order);
    trace.push(simd, simd.permute(start, order), children, !missed);
}

/// Where a ray enters the boxes' slabs along `axis`, early, and where it leaves them, late.
#[inline(always)]
fn crossings<S: Simd>(simd: S, node: &Node, course: &Course, axis: usize) -> [S::F; 2] {
    let [enter, leave] = node.slabs(axis, course.octant);
    let inverse = simd.splat(course.inverse[axis]);
    [
        simd.mul_add(simd.load(enter), inverse, simd.splat(course.near[axis])),
        simd.mul_add(simd.load(leave), inverse, simd.splat(course.far[axis])),
    ]
}
