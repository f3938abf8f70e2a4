//! Slope bounds of a box: bounds of the slopes of rays from one origin that may meet it, less the slope of the middle ray.

use super::setup::PacketSetup;
use crate::accel::wide::simd::{LANES, Simd, SimdBase};
use crate::accel::wide::tree::node::Node;
use crate::rounding::W;

/// Half the thickness of faces, in units of `W`; where the origin is subtracted from them, times 1 plus its distance from the
/// scene's middle.
const FACE_ERR: f32 = 8.0;
/// By how much the bounds are widened, in units of `W`.
const SIDE_ERR: f32 = 16.0;
/// The depth from the origin at which boxes begin that begin nearer, or behind it.
const NEAREST: f32 = 1.0 / (1_u64 << 60) as f32;

/// Bounds of rays' deviations, `low..=high` along x and along y.
#[derive(Clone, Copy, Debug)]
pub(super) struct SlopeBounds {
    pub(super) low: [f32; 2],
    pub(super) high: [f32; 2],
}

/// The slope bounds of a node's children, lane by lane, and the depths at which the children begin.
pub(super) struct ChildBounds {
    low: [[f32; LANES]; 2],
    high: [[f32; LANES]; 2],
    pub(super) near: [f32; LANES],
}

impl ChildBounds {
    /// Those of the children that a ray may meet before depth `limit`, and the lanes of these.
    ///
    /// Boxes and slope bounds are widened by more than all rounding errors (docs/numerics.md).
    #[inline(always)]
    pub(super) fn of<S: Simd>(simd: S, node: &Node, setup: &PacketSetup, limit: f32) -> (Self, u8) {
        let origin = setup.origin.as_vec3();
        let thick = FACE_ERR * W * (1.0 + origin.abs().max_element());
        let [low, high] = faces(simd, node, setup, 2);
        let (near, far) = if setup.sense < 0.0 { (-high, -low) } else { (low, high) };
        let (near, far) = (near - FACE_ERR * W, far + FACE_ERR * W);
        let mut met = simd.le(near, simd.splat(limit)) & simd.le(simd.splat(setup.begin), far);
        let (near_inverse, far_inverse) =
            (inverse(simd, near, origin.z + thick), inverse(simd, far, origin.z - thick));
        let mut bounds = Self { low: [[0.0; LANES]; 2], high: [[0.0; LANES]; 2], near: [0.0; LANES] };
        near.store_array(&mut bounds.near);
        for axis in 0..2 {
            let [low, high] = faces(simd, node, setup, axis);
            let (low, high) = (low - (origin[axis] + thick), high - (origin[axis] - thick));
            // Each side at the depth where its slope is further out.
            let low = (low * near_inverse).min(low * far_inverse) - (setup.middle[axis] + SIDE_ERR * W);
            let high = (high * near_inverse).max(high * far_inverse) - (setup.middle[axis] - SIDE_ERR * W);
            let (low, high) = (low.max(setup.low[axis]), high.min(setup.high[axis]));
            met &= simd.le(low, high);
            low.store_array(&mut bounds.low[axis]);
            high.store_array(&mut bounds.high[axis]);
        }
        (bounds, met)
    }

    /// The positions in `order` of the lanes `met`, a bit each.
    #[inline(always)]
    pub(super) fn places<S: Simd>(simd: S, met: u8, order: u32) -> u8 {
        let (yes, no) = (simd.splat(1.0), simd.splat(0.0));
        simd.lt(no, simd.permute(simd.select(met, yes, no), simd.lane_indices(order)))
    }

    #[inline(always)]
    pub(super) fn get(&self, lane: usize) -> SlopeBounds {
        let lane = lane % LANES;
        let low = [self.low[0][lane], self.low[1][lane]];
        let high = [self.high[0][lane], self.high[1][lane]];
        SlopeBounds { low, high }
    }
}

/// The lower and upper faces of a node's children along one of the packet's axes.
#[inline(always)]
fn faces<S: Simd>(simd: S, node: &Node, setup: &PacketSetup, axis: usize) -> [S::F; 2] {
    let axis = setup.axes[axis] % 3;
    [simd.load(&node.faces[2 * axis]), simd.load(&node.faces[2 * axis + 1])]
}

/// The inverse of the depth from `from`.
#[inline(always)]
fn inverse<S: Simd>(simd: S, place: S::F, from: f32) -> S::F {
    simd.splat(1.0) / (place - from).max(NEAREST)
}

#[cfg(test)]
mod tests {
    use super::super::setup::PacketRays;
    use super::super::tests::packet;
    use super::*;
    use crate::Aabb;
    use crate::accel::wide::simd::PACKET;
    use crate::accel::wide::tree::node::Child;
    use crate::accel::wide::tree::normalize::NormalizedSpace;
    use crate::conformance::{Seeded, Source};
    use crate::cpu::portable;
    use glam::DVec3;

    /// A point on one of the rays, before its end, is met, and the ray is within its slope bounds; so no ray of a
    /// packet can miss what it would have found alone.
    #[test]
    fn what_lies_on_a_ray_has_it_within_its_slope_bounds() {
        let space = NormalizedSpace { center: DVec3::ZERO, scale: 1.0 };
        let (mut source, mut met, mut others) = (Seeded::new(8), 0, 0);
        while met < 50_000 {
            let rays = packet(&mut source);
            let (mut origin, mut packet_rays) =
                (PacketSetup::new(&rays, &space).unwrap(), PacketRays::default());
            let (groups, _) = rays.as_chunks();
            assert!(packet_rays.set(portable(), &mut origin, groups));
            for _ in 0..16 {
                let slot = source.below(PACKET);
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
                let end = packet_rays.limit[g][i];
                let (bounds, lanes) = ChildBounds::of(portable(), &node, &origin, end);
                let SlopeBounds { low, high } = bounds.get(3);
                let is_in = |axis: usize| {
                    let x = packet_rays.deviation[axis][g][i];
                    low[axis] <= x && x <= high[axis]
                };
                assert!(lanes & 0b1000 != 0 && is_in(0) && is_in(1), "{:?} at {at:?}", rays[slot]);
                assert!(bounds.near[3] <= end);
                met += 1;
                others += i32::from(lanes & 0b10_0000 != 0);
            }
        }
        // It does not meet just anything.
        assert!(others < met / 10, "{others}");
    }
}
