//! What a box is to rays from one point: a window of slopes.

use super::super::node::Node;
use super::super::simd::{LANES, Simd};
use super::view::View;

/// Unit roundoff of `f32`.
const U: f32 = f32::EPSILON / 2.0;
/// Thickness of faces, in units of `U` and of how far the origin is from the scene's middle, and 1.
const FACE_ERR: f32 = 8.0;
/// Thickness of a window's sides, in units of `U`.
const SIDE_ERR: f32 = 16.0;
/// Where boxes begin that begin no further ahead than the origin.
const NEAREST: f32 = 1.0 / (1_u64 << 60) as f32;

/// Deviations of rays from the middle one, `low..=high` along x and along y.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    pub(super) low: [f32; 2],
    pub(super) high: [f32; 2],
}

/// A cell of a node, in sight of the pencil.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    pub(super) child: u32,
    /// Where its box begins, ahead.
    pub(super) near: f32,
    /// The rays that may meet its box are in here.
    pub(super) window: Window,
}

/// The windows of a node's boxes, lane by lane.
pub(super) struct Windows {
    low: [[f32; LANES]; 2],
    high: [[f32; LANES]; 2],
    pub(super) near: [f32; LANES],
}

impl Windows {
    /// Those of the boxes that a ray of the view may meet before `end`, and the lanes of these.
    ///
    /// Boxes are larger by more than all that is rounded, and so are windows (docs/numerics.md).
    #[inline(always)]
    pub(super) fn of<S: Simd>(simd: S, node: &Node, view: &View, end: f32) -> (Self, u8) {
        let origin = view.origin.as_vec3();
        let thick = FACE_ERR * U * (1.0 + origin.abs().max_element());
        let [low, high] = faces(simd, node, view, 2);
        let zero = simd.splat(0.0);
        let (near, far) =
            if view.descends() { (simd.sub(zero, high), simd.sub(zero, low)) } else { (low, high) };
        let slack = simd.splat(FACE_ERR * U);
        let (near, far) = (simd.sub(near, slack), simd.add(far, slack));
        let mut met = simd.le(near, simd.splat(end)) & simd.le(simd.splat(view.begin), far);
        let (near_inverse, far_inverse) =
            (inverse(simd, near, origin.z + thick), inverse(simd, far, origin.z - thick));
        let mut windows = Self { low: [[0.0; LANES]; 2], high: [[0.0; LANES]; 2], near: [0.0; LANES] };
        simd.store(&mut windows.near, near);
        for axis in 0..2 {
            let [low, high] = faces(simd, node, view, axis);
            let low = simd.sub(low, simd.splat(origin[axis] + thick));
            let high = simd.sub(high, simd.splat(origin[axis] - thick));
            // Of a side, the end that is seen further out.
            let low = simd.min(simd.mul(low, near_inverse), simd.mul(low, far_inverse));
            let high = simd.max(simd.mul(high, near_inverse), simd.mul(high, far_inverse));
            let low = simd.sub(low, simd.splat(view.middle[axis] + SIDE_ERR * U));
            let high = simd.sub(high, simd.splat(view.middle[axis] - SIDE_ERR * U));
            let low = simd.max(low, simd.splat(view.low[axis]));
            let high = simd.min(high, simd.splat(view.high[axis]));
            met &= simd.le(low, high);
            simd.store(&mut windows.low[axis], low);
            simd.store(&mut windows.high[axis], high);
        }
        (windows, met)
    }

    /// Which places of an order, three bits each, hold one of the lanes `met`.
    #[inline(always)]
    pub(super) fn places<S: Simd>(simd: S, met: u8, order: u32) -> u8 {
        let (yes, no) = (simd.splat(1.0), simd.splat(0.0));
        simd.lt(no, simd.permute(simd.select(met, yes, no), simd.lane_indices(order)))
    }

    #[inline(always)]
    pub(super) fn get(&self, lane: usize) -> Window {
        let lane = lane % LANES;
        let low = [self.low[0][lane], self.low[1][lane]];
        let high = [self.high[0][lane], self.high[1][lane]];
        Window { low, high }
    }
}

/// The lower and upper faces of a node's boxes along one of the view's axes.
#[inline(always)]
fn faces<S: Simd>(simd: S, node: &Node, view: &View, axis: usize) -> [S::F; 2] {
    let axis = view.axes[axis] % 3;
    [simd.load(&node.faces[2 * axis]), simd.load(&node.faces[2 * axis + 1])]
}

/// One divided by how far it is ahead of `from`.
#[inline(always)]
fn inverse<S: Simd>(simd: S, place: S::F, from: f32) -> S::F {
    let distance = simd.max(simd.sub(place, simd.splat(from)), simd.splat(NEAREST));
    simd.div(simd.splat(1.0), distance)
}

#[cfg(test)]
mod tests {
    use super::super::super::node::Child;
    use super::super::super::scratch::WIDTH;
    use super::super::super::simd::Portable;
    use super::super::super::space::Space;
    use super::super::lines::Lines;
    use super::super::tests::pencil;
    use super::*;
    use crate::Aabb;
    use crate::conformance::{Seeded, Source};
    use glam::DVec3;

    /// A box as small as a point, on one of the rays before its end, is met, and the ray is in its window; so
    /// no ray of a pencil can miss what it would have found alone.
    #[test]
    fn whatever_lies_on_a_ray_is_in_its_window() {
        let space = Space { center: DVec3::ZERO, scale: 1.0 };
        let (mut source, mut met, mut others) = (Seeded::new(8), 0, 0);
        while met < 50_000 {
            let rays = pencil(&mut source);
            let (mut view, mut lines) = (View::new(&rays, &space).unwrap(), Lines::idle());
            let (groups, _) = rays.as_chunks();
            assert!(lines.set(Portable, &mut view, groups));
            for _ in 0..16 {
                let slot = source.below(WIDTH);
                let (g, i) = (slot / LANES, slot % LANES);
                let at = rays[slot].at(2.0 * source.unit());
                if at.abs().max_element() > 1.0 {
                    continue;
                }
                let aside = at + 0.3 * DVec3::new(source.signed(), source.signed(), source.signed());
                let mut node = Node::empty();
                for (lane, at) in [(3, at), (5, aside)] {
                    let at = at.as_vec3();
                    node.set(lane, &Aabb { min: at, max: at }, Child::Node(1));
                }
                let end = lines.end[g][i];
                let (windows, lanes) = Windows::of(Portable, &node, &view, end);
                let Window { low, high } = windows.get(3);
                let is_in = |axis: usize| {
                    let x = lines.aside[axis][g][i];
                    low[axis] <= x && x <= high[axis]
                };
                assert!(lanes & 0b1000 != 0 && is_in(0) && is_in(1), "{:?} at {at:?}", rays[slot]);
                assert!(windows.near[3] <= end);
                met += 1;
                others += i32::from(lanes & 0b10_0000 != 0);
            }
        }
        // It does not meet just anything.
        assert!(others < met / 10, "{others}");
    }
}
