//! A pyramid's stump around the rays of a packet: finds the cells that any of them may meet.

use super::course::AXES;
use super::node::Node;
use super::packet::{GROUPS, Packet, range};
use super::simd::{LANES, Simd};
use super::slots::Slots;

/// Rays further apart than this, where they enter or for each unit along the main axis, have too few cells
/// in common. The scene is 2 wide.
const WIDEST: f32 = 0.125;

/// A bound of the rays' coordinates along one axis: `at + slope * z` at depth `z`.
#[derive(Clone, Copy, Debug)]
struct Side {
    at: f32,
    slope: f32,
}

/// Bounds of rays that share their main axis and the sense in which they follow it: four sides, and
/// the depths at which the first begins and the last ends.
///
/// All are pushed outward, by more than the rays' own slack and all that is rounded
/// (docs/numerics.md).
#[derive(Clone, Copy, Debug)]
pub(super) struct Frustum {
    /// The axes x, y and z of Woop's shear; depth is measured along z, the main axis.
    pub(super) axes: [usize; 3],
    /// Whether depth falls along the rays.
    descends: bool,
    /// Below and above all rays along x, and along y.
    sides: [[Side; 2]; 2],
    start: f32,
    end: f32,
    thick: f32,
    /// That of one ray's direction. Cells come in its order, which need not be that of all others: no
    /// ray's answer depends on it.
    octant: u8,
}

impl Frustum {
    /// Around the rays `live`; `None` if there are none, or they are not coherent.
    #[inline(always)]
    pub(super) fn around<S: Simd>(simd: S, packet: &Packet, live: Slots) -> Option<Self> {
        let slot = live.trailing_zeros() as usize;
        let (first, lane) = (packet.courses.get(slot / LANES)?, slot % LANES);
        let (main_axis, descends) = (first.main_axis[lane], first.depth_scale[lane] < 0.0);
        if live & turning(packet, main_axis, descends) != 0 {
            return None;
        }
        let zero = simd.splat(0.0);
        let (mut errs, mut depths) = ([zero; GROUPS], [zero; GROUPS]);
        for (g, courses) in packet.courses.iter().enumerate() {
            errs[g] = simd.load(&courses.t_err);
            let along = simd.sub(zero, simd.load(&courses.depth_offset));
            depths[g] = simd.mul(along, simd.load(&packet.rates[g]));
        }
        let [_, err] = range(simd, &errs, live);
        let thick = 2.0 * err;
        // Of a lost ray nothing is known.
        if thick > WIDEST {
            return None;
        }
        let [lowest, highest] = range(simd, &depths, live);
        let (start, outward) = if descends { (highest, thick) } else { (lowest, -thick) };
        let mut sides =
            [sides(simd, packet, live, 0, start, descends)?, sides(simd, packet, live, 1, start, descends)?];
        for [below, above] in &mut sides {
            below.at -= thick;
            above.at += thick;
        }
        let axes = AXES[main_axis as usize % 3].map(usize::from);
        let (start, octant) = (start + outward, first.octant[lane] as u8);
        Some(Self { axes, descends, sides, start, end: start, thick, octant })
    }

    /// Ends it around depths from `lowest` to `highest`.
    #[inline(always)]
    pub(super) fn end_within(&mut self, [lowest, highest]: [f32; 2]) {
        self.end = if self.descends { lowest - self.thick } else { highest + self.thick };
    }

    /// The lanes of a node whose boxes any of the rays may meet.
    #[inline(always)]
    pub(super) fn meets<S: Simd>(&self, simd: S, node: &Node) -> u8 {
        let [low, high] = self.faces(node, 2);
        let (first, last) = if self.descends { (self.end, self.start) } else { (self.start, self.end) };
        let mut met = simd.le(simd.load(low), simd.splat(last)) & simd.le(simd.splat(first), simd.load(high));
        for (axis, [below, above]) in self.sides.iter().enumerate() {
            let [lower, upper] = self.faces(node, axis);
            // Each side at the depth of the box where it is furthest out.
            let below_at = if below.slope < 0.0 { high } else { low };
            let above_at = if above.slope < 0.0 { low } else { high };
            let below = simd.mul_add(simd.load(below_at), simd.splat(below.slope), simd.splat(below.at));
            let above = simd.mul_add(simd.load(above_at), simd.splat(above.slope), simd.splat(above.at));
            met &= simd.le(below, simd.load(upper)) & simd.le(simd.load(lower), above);
        }
        met
    }

    /// The lanes of a node from near to far, three bits each.
    #[inline(always)]
    pub(super) fn order(&self, node: &Node) -> u32 {
        node.orders[usize::from(self.octant & 7)]
    }

    /// The depth at which the box of a node's lane begins.
    #[inline(always)]
    pub(super) fn near(&self, node: &Node, lane: usize) -> f32 {
        let [low, high] = self.faces(node, 2);
        if self.descends { high[lane] } else { low[lane] }
    }

    /// Whether what begins at depth `near` does so beyond all rays' ends.
    #[inline(always)]
    pub(super) fn is_beyond(&self, near: f32) -> bool {
        if self.descends { near < self.end } else { near > self.end }
    }

    pub(super) fn main_axis(&self) -> usize {
        self.axes[2]
    }

    /// The faces of a node's boxes along one of its axes.
    #[inline(always)]
    fn faces<'a>(&self, node: &'a Node, axis: usize) -> [&'a [f32; LANES]; 2] {
        let axis = self.axes[axis] % 3;
        [&node.faces[2 * axis], &node.faces[2 * axis + 1]]
    }
}

/// The rays that have another main axis, or follow it in the other sense.
#[inline(always)]
fn turning(packet: &Packet, main_axis: u32, descends: bool) -> Slots {
    let mut turning = 0;
    for (g, courses) in packet.courses.iter().enumerate() {
        for i in 0..LANES {
            let turns = (courses.depth_scale[i] < 0.0) != descends;
            turning |= Slots::from((courses.main_axis[i] != main_axis) | turns) << (g * LANES + i);
        }
    }
    turning
}

/// What bounds the rays along `axis` from depth `start` on; `None` if they are far apart.
#[inline(always)]
fn sides<S: Simd>(
    simd: S,
    packet: &Packet,
    live: Slots,
    axis: usize,
    start: f32,
    descends: bool,
) -> Option<[Side; 2]> {
    let zero = simd.splat(0.0);
    let (mut slopes, mut places) = ([zero; GROUPS], [zero; GROUPS]);
    for (g, courses) in packet.courses.iter().enumerate() {
        slopes[g] = simd.sub(zero, simd.load(&courses.slope[axis]));
        places[g] = simd.mul_add(slopes[g], simd.splat(start), simd.load(&courses.offset[axis]));
    }
    let [least, greatest] = range(simd, &slopes, live);
    let [lowest, highest] = range(simd, &places, live);
    let is_narrow = greatest - least <= WIDEST && highest - lowest <= WIDEST;
    let (below, above) = if descends { (greatest, least) } else { (least, greatest) };
    let below = Side { at: lowest - below * start, slope: below };
    let above = Side { at: highest - above * start, slope: above };
    is_narrow.then_some([below, above])
}

#[cfg(test)]
mod tests {
    use super::super::simd::Portable;
    use super::super::{Child, WideKdTree};
    use super::*;
    use crate::conformance::{Seeded, Source};
    use crate::{Aabb, Ray, Triangle, Triangles};
    use glam::{DVec3, Vec3};

    /// A box as small as a point, on one of the rays before its end, is met; so no ray of a packet
    /// can miss what it would have found alone.
    #[test]
    fn whatever_lies_on_a_ray_is_met() {
        let corners = [Vec3::NEG_ONE, Vec3::ONE, Vec3::new(1.0, -1.0, 0.5)];
        let triangles = Triangles::new(vec![Triangle { vertices: corners }]).unwrap();
        let tree = WideKdTree::build(&triangles).unwrap();
        let mut source = Seeded::new(7);
        let (mut packet, mut met, mut others) = (Packet::idle(), 0, 0);
        while met < 100_000 {
            let mut vector = || DVec3::new(source.signed(), source.signed(), source.signed());
            let (origin, direction) = (3.0 * vector(), vector());
            let spread = 10.0_f64.powf(-1.0 - 8.0 * source.unit());
            let rays: [Ray; GROUPS * LANES] = std::array::from_fn(|_| {
                let mut vector = || DVec3::new(source.signed(), source.signed(), source.signed());
                Ray::new(origin + spread * vector(), direction + spread * vector())
            });
            let (groups, _) = rays.as_chunks();
            let live = packet.set(Portable, &tree, groups);
            let Some(mut frustum) = Frustum::around(Portable, &packet, live) else { continue };
            frustum.end_within([-2.0, 2.0]);
            for _ in 0..16 {
                let i = source.below(rays.len());
                if live >> i & 1 == 0 {
                    continue;
                }
                let (course, ray) = (packet.courses[i / LANES].get(i % LANES).unwrap(), &rays[i]);
                let along = f64::from(course.end) * source.unit();
                let unit = super::super::space::power_of_two_below(ray.direction.abs().max_element());
                let entry =
                    crate::prune::Pruner::new(ray, &triangles.bounds()).clip(ray, &triangles.bounds()).start;
                let at = (ray.origin + (entry + along / (unit * tree.space.scale)) * ray.direction
                    - tree.space.center)
                    * tree.space.scale;
                let aside = at + 0.3 * DVec3::new(source.signed(), source.signed(), source.signed());
                let [at, aside] = [at, aside].map(|p| Aabb { min: p.as_vec3(), max: p.as_vec3() });
                let mut node = Node::empty();
                node.set(3, &at, Child::Node(1));
                node.set(5, &aside, Child::Node(1));
                let lanes = frustum.meets(Portable, &node);
                assert!(lanes & 0b1000 != 0, "{ray:?} at {at:?}, spread {spread}");
                met += 1;
                others += i32::from(lanes & 0b10_0000 != 0);
            }
        }
        // It does not meet just anything.
        assert!(others < met / 10, "{others}");
    }
}
