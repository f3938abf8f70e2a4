//! Packet traversal of any-hit queries: 64 coherent rays from anywhere, such as shadow rays to one light.
//!
//! The rays go down the tree together, each child with a mask of the rays that may meet it. A node is tested with
//! bounds of all rays first (interval arithmetic; Boulos, Wald and Shirley, 2006), then its children with the rays that
//! have come there. Nodes that few rays meet, and leaf blocks, are tested as for single rays.

use super::child_test::{record, test_leaf, visit_all};
use super::prefilter::Filtered;
use super::ray_setup::{DEPTH_ERR, RaySetups};
use super::traversal_state::Traversal;
use crate::accel::query::Query;
use crate::accel::wide::simd::{Bits, GROUPS, LANES, PACKET, RayMask, Simd, SimdBase, SimdFloat};
use crate::accel::wide::tree::Tree;
use crate::accel::wide::tree::node::{Child, Node};
use crate::rounding::W;
use crate::{Aabb, Ray};
use fearless_simd::SimdMask;

/// By how much bounds of origins are widened, in units of `W` (docs/numerics.md).
const ORIGIN_ERR: f32 = 20.0;
/// Rays whose parameters are less certain than this are no packet. Beyond the error of a depth, that allows half of `W`.
const MAX_PARAMETER_ERR: f32 = (DEPTH_ERR as f32 + 0.5) * W;

/// Rays that start further apart than this part of the scene's extent are no packet.
const MAX_ORIGIN_SPREAD: f64 = 0.125;
/// The rays of a set by which it is found to be coherent.
const EXAMINED: [usize; 4] = [0, PACKET / 3, 2 * PACKET / 3, PACKET - 1];
/// The most rays that visit a node and all below it each by itself (measured).
const MAX_SINGLE_RAYS: u32 = 4;
/// A packet of which more rays visit nodes by themselves does not pay (measured).
const MAX_ALONE: u32 = 32;
/// The most sets of coherent rays that are left to the stream after a packet that does not pay. The number is
/// one at first. Each packet that does not pay doubles it, and each that does halves it.
const MAX_PAUSE: u32 = 128;

/// The memory of packets, and a record of how they have paid.
#[derive(Debug)]
pub(super) struct GeneralPacketScratch {
    setups: [RaySetups<LANES>; GROUPS],
    /// The children still to be visited, the next one last, with the rays that may meet each.
    stack: Vec<(u32, RayMask)>,
    /// The possible hits of the rays in the current leaf block.
    hits: [Filtered; PACKET],
    /// The number of sets of rays that are left to the stream after the next packet that does not pay.
    next_pause: u32,
    /// The number of sets of rays that are left to the stream from now on.
    pause: u32,
}

impl GeneralPacketScratch {
    pub(super) fn idle() -> Self {
        let setups = [const { RaySetups::idle() }; GROUPS];
        let hits = [Filtered::default(); PACKET];
        Self { setups, stack: Vec::new(), hits, next_pause: 1, pause: 0 }
    }

    /// Answers the query of every ray and reports it. If the rays are not coherent, or packets like this have not paid,
    /// it reports nothing and returns false.
    #[inline(always)]
    pub(super) fn query<S: Simd, Q: Query>(
        &mut self,
        simd: S,
        tree: &Tree,
        rays: &[Ray; PACKET],
        traversals: &mut [Traversal; PACKET],
        mut report: impl FnMut(usize, Q),
    ) -> bool {
        if !may_be_coherent(rays, &tree.bounds) {
            return false;
        }
        if self.pause > 0 {
            self.pause -= 1;
            return false;
        }
        let Self { setups, stack, hits, .. } = self;
        let Some(mut left) = set_up_rays(simd, tree, rays, setups) else { return false };
        let queries = std::array::from_fn(
            #[inline(always)]
            |slot| Q::new(&rays[slot]),
        );
        let (begun, alone) = (0, 0);
        let mut packet =
            GeneralPacket { simd, tree, rays, setups, stack, hits, traversals, queries, left, begun, alone };
        while left != 0 {
            let (octant, of_octant) = first_octant(simd, setups, left);
            left ^= of_octant;
            packet.run(octant, of_octant);
        }
        for (slot, query) in packet.queries.iter_mut().enumerate() {
            if (packet.begun & packet.left) >> slot & 1 != 0 {
                let Traversal { candidates, limit, .. } = &mut packet.traversals[slot];
                candidates.decide(*limit, &rays[slot], &tree.triangles, query);
            }
            report(slot, *query);
        }
        if packet.alone > MAX_ALONE {
            self.pause = self.next_pause;
            self.next_pause = MAX_PAUSE.min(2 * self.next_pause);
        } else {
            self.next_pause = 1.max(self.next_pause / 2);
        }
        true
    }
}

/// Whether three of the rays start near the first one and point within 45 degrees of its direction.
#[inline(always)]
fn may_be_coherent(rays: &[Ray; PACKET], bounds: &Aabb) -> bool {
    let (first, near) = (&rays[0], MAX_ORIGIN_SPREAD * bounds.extent().max_element());
    let is_like_first = |i: usize| {
        let Ray { origin, direction, .. } = rays[i];
        let along = first.direction.dot(direction);
        let square = first.direction.length_squared() * direction.length_squared();
        (origin - first.origin).abs().max_element() <= near && along > 0.0 && 2.0 * along * along >= square
    };
    EXAMINED[1..].iter().all(|&i| is_like_first(i))
}

/// Sets up rays. Returns those that may hit anything; `None` if the parameters of any are too uncertain.
#[inline(always)]
fn set_up_rays<S: Simd>(
    simd: S,
    tree: &Tree,
    rays: &[Ray; PACKET],
    setups: &mut [RaySetups<LANES>; GROUPS],
) -> Option<RayMask> {
    let (mut may_hit, mut certain) = (0, 0);
    for (g, (setups, group)) in setups.iter_mut().zip(rays.as_chunks().0).enumerate() {
        setups.set(&simd.columns(group), &tree.bounds, &tree.space);
        let at = g * LANES;
        for (i, &may_hit_one) in setups.may_hit.iter().enumerate() {
            may_hit |= RayMask::from(may_hit_one) << (at + i);
        }
        certain |= RayMask::from(simd.le(simd.load(&setups.t_err), simd.splat(MAX_PARAMETER_ERR))) << at;
    }
    (may_hit & !certain == 0).then_some(may_hit)
}

/// The octant that the first of `rays` points into, and those of `rays` that do so too.
#[inline(always)]
fn first_octant<S: Simd>(simd: S, setups: &[RaySetups<LANES>; GROUPS], rays: RayMask) -> (u8, RayMask) {
    let (first, mut same) = (rays.trailing_zeros() as usize % PACKET, 0);
    let octant = setups[first / LANES].octant[first % LANES];
    for (g, setups) in setups.iter().enumerate() {
        let lanes = S::I::load_array(simd, setups.octant).simd_eq(octant).to_bitmask() as u8;
        same |= RayMask::from(lanes) << (g * LANES);
    }
    (octant as u8, rays & same)
}

/// The rays of a packet, whose queries `Q` are any-hit queries.
struct GeneralPacket<'a, S, Q> {
    simd: S,
    tree: &'a Tree,
    rays: &'a [Ray; PACKET],
    setups: &'a [RaySetups<LANES>; GROUPS],
    stack: &'a mut Vec<(u32, RayMask)>,
    hits: &'a mut [Filtered; PACKET],
    traversals: &'a mut [Traversal; PACKET],
    queries: [Q; PACKET],
    /// The rays that may hit something and whose query is not answered.
    left: RayMask,
    /// The rays whose traversals have begun.
    begun: RayMask,
    /// How often a ray has visited a node and all below it by itself.
    alone: u32,
}

impl<S: Simd, Q: Query> GeneralPacket<'_, S, Q> {
    /// Visits all that rays toward one octant may meet.
    #[inline(always)]
    fn run(&mut self, octant: u8, rays: RayMask) {
        let bounds = RayBounds::of(self.simd, self.setups, octant, rays);
        self.stack.clear();
        self.stack.push((Child::ROOT, rays));
        while let Some((child, rays)) = self.stack.pop() {
            let rays = rays & self.left;
            if Child::is_block(child) {
                self.test_leaf_block(child, rays);
            } else if rays.count_ones() <= MAX_SINGLE_RAYS {
                self.visit_alone(child, rays);
            } else {
                self.test_node(child, &bounds, octant, rays);
            }
        }
    }

    /// Pushes those of a node's children that any of `rays` may meet.
    #[inline(always)]
    fn test_node(&mut self, child: u32, bounds: &RayBounds, octant: u8, rays: RayMask) {
        let (simd, node) = (self.simd, &self.tree.nodes[child as usize]);
        let (some, all) = bounds.meet(simd, node, octant);
        for lane in Bits(some.into()) {
            let lane = lane % LANES;
            let is_met_by_all = all >> lane & 1 != 0;
            let met = if is_met_by_all { rays } else { self.meet(node, lane, octant, rays) };
            if met != 0 {
                self.stack.push((node.children[lane], met));
                self.tree.prefetch::<4>(node.children[lane]);
            }
        }
    }

    /// The rays that meet the bounds of a child.
    #[inline(always)]
    fn meet(&self, node: &Node, lane: usize, octant: u8, rays: RayMask) -> RayMask {
        let (simd, mut met) = (self.simd, 0);
        let slabs = [node.slabs(0, octant), node.slabs(1, octant), node.slabs(2, octant)];
        for first in Bits(groups_of(rays)) {
            let setups = &self.setups[first / LANES % GROUPS];
            let (mut start, mut end) = (simd.splat(0.0), simd.load(&setups.end));
            for (axis, [enter, leave]) in slabs.iter().enumerate() {
                let inverse = simd.load(&setups.inverse[axis]);
                let (near, far) = (simd.load(&setups.near[axis]), simd.load(&setups.far[axis]));
                start = start.max(inverse.mul_add(enter[lane], near));
                end = end.min(inverse.mul_add(leave[lane], far));
            }
            met |= RayMask::from(simd.le(start, end)) << first;
        }
        met & rays
    }

    /// Tests a leaf block, as the stream does: all rays before the first hit is recorded. A certain hit answers a
    /// query. A possible one becomes a candidate in the traversal of its ray, which begins if need be.
    #[inline(always)]
    fn test_leaf_block(&mut self, child: u32, rays: RayMask) {
        let (mut possible, mut certain) = (0, 0);
        for slot in Bits(rays) {
            let (setups, i) = (&self.setups[slot / LANES % GROUPS], slot % LANES);
            let (end, excluded) = (setups.end[i], self.rays[slot].excluded);
            self.hits[slot] = test_leaf(self.simd, self.tree, child, &setups.shear(i), end, excluded);
            possible |= RayMask::from(self.hits[slot].possible != 0) << slot;
            certain |= RayMask::from(self.hits[slot].certain != 0) << slot;
        }
        self.left &= !certain;
        for slot in Bits(certain) {
            self.queries[slot] = self.queries[slot].with_some_hit();
        }
        for slot in Bits(possible & !certain) {
            self.go_to(slot, child);
            let (traversal, query) = (&mut self.traversals[slot], &mut self.queries[slot]);
            record(self.simd, self.tree, &self.rays[slot], &self.hits[slot], traversal, query);
            self.left &= !(RayMask::from(query.is_answered()) << slot);
        }
    }

    /// Visits a node and all below it, ray by ray.
    #[inline(always)]
    fn visit_alone(&mut self, child: u32, rays: RayMask) {
        for slot in Bits(rays) {
            self.alone += 1;
            self.go_to(slot, child);
            let (traversal, query) = (&mut self.traversals[slot], &mut self.queries[slot]);
            visit_all(self.simd, self.tree, &self.rays[slot], traversal, query, &mut ());
            self.left &= !(RayMask::from(query.is_answered()) << slot);
        }
    }

    /// Moves the traversal of a ray to this child.
    #[inline(always)]
    fn go_to(&mut self, slot: usize, child: u32) {
        let traversal = &mut self.traversals[slot];
        if self.begun >> slot & 1 == 0 {
            self.begun |= 1 << slot;
            if let Some(setup) = self.setups[slot / LANES % GROUPS].get(slot % LANES) {
                traversal.begin(setup, slot as u32, &self.rays[slot]);
            }
        }
        traversal.go_to(child);
    }
}

/// The groups that hold any of `rays`: the bit of each one's first ray.
#[inline(always)]
fn groups_of(rays: RayMask) -> RayMask {
    let rays = rays | rays >> 4;
    let rays = rays | rays >> 2;
    (rays | rays >> 1) & 0x0101_0101_0101_0101
}

/// Bounds of the origins, the inverse directions and the ranges of rays whose directions lie in one octant.
#[derive(Clone, Copy, Debug)]
struct RayBounds {
    /// Along each axis, the origins from which boxes are entered and left first, and those from which last.
    origin: [[f32; 2]; 3],
    /// The least and the greatest.
    inverse: [[f32; 2]; 3],
    end: [f32; 2],
}

impl RayBounds {
    #[inline(always)]
    fn of<S: Simd>(simd: S, setups: &[RaySetups<LANES>; GROUPS], octant: u8, rays: RayMask) -> Self {
        let (mut origin, mut inverse) = ([[0.0; 2]; 3], [[0.0; 2]; 3]);
        for axis in 0..3 {
            let [low, high] = simd.range(rays, |g| &setups[g].origin[axis]);
            let (low, high) = (low - ORIGIN_ERR * W, high + ORIGIN_ERR * W);
            let descends = octant >> axis & 1 != 0;
            origin[axis] = if descends { [low, high] } else { [high, low] };
            inverse[axis] = simd.range(rays, |g| &setups[g].inverse[axis]);
        }
        Self { origin, inverse, end: simd.range(rays, |g| &setups[g].end) }
    }

    /// The children of a node that any of the rays may meet, and those that all of them seem to meet.
    #[inline(always)]
    fn meet<S: Simd>(&self, simd: S, node: &Node, octant: u8) -> (u8, u8) {
        let (mut first_start, mut last_start) = (simd.splat(0.0), simd.splat(0.0));
        let (mut first_end, mut last_end) = (simd.splat(self.end[0]), simd.splat(self.end[1]));
        for axis in 0..3 {
            let [enter, leave] = node.slabs(axis, octant);
            let [first, last] = self.crossings::<S>(axis, simd.load(enter));
            (first_start, last_start) = (first_start.max(first), last_start.max(last));
            let [first, last] = self.crossings::<S>(axis, simd.load(leave));
            (first_end, last_end) = (first_end.min(first), last_end.min(last));
        }
        (simd.le(first_start, last_end), simd.le(last_start, first_end))
    }

    /// When the first and the last of the rays cross planes across `axis`.
    #[inline(always)]
    fn crossings<S: Simd>(&self, axis: usize, planes: S::F) -> [S::F; 2] {
        let ([least, greatest], [first, last]) = (self.inverse[axis], self.origin[axis]);
        let (first, last) = (planes - first, planes - last);
        [(first * least).min(first * greatest), (last * least).max(last * greatest)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::query::AnyHit;
    use crate::accel::wide::build::build_by_kd_tree;
    use crate::accel::wide::tree::normalize::NormalizedSpace;
    use crate::conformance::shapes::icosphere;
    use crate::conformance::{Seeded, Source};
    use crate::cpu::portable;
    use crate::{KdOptions, Triangles};
    use glam::{DVec3, Vec3};

    fn vector(source: &mut Seeded) -> DVec3 {
        DVec3::new(source.signed(), source.signed(), source.signed())
    }

    /// Segments between two places of some width.
    fn beam(source: &mut Seeded, [from, to]: [DVec3; 2], width: f64) -> [Ray; PACKET] {
        std::array::from_fn(|_| Ray::segment(from + width * vector(source), to + width * vector(source)))
    }

    /// The pencils of the conformance suite keep rays traceable whose number is a multiple of 21.
    #[test]
    fn the_conformance_suite_has_packets_with_untraceable_rays() {
        assert_eq!(EXAMINED.map(|i| i % 21), [0; 4]);
    }

    /// Each ray of a packet is reported once, and packets that do not pay are followed by a pause.
    #[test]
    fn only_coherent_rays_are_a_packet() {
        let triangles = Triangles::new(icosphere(5).triangles()).unwrap();
        let tree = build_by_kd_tree(&triangles, &KdOptions::default()).unwrap();
        let mut traversals = (0..PACKET).map(|_| Traversal::idle()).collect::<Vec<_>>();
        let mut query = |packet: &mut GeneralPacketScratch, rays: &[Ray; PACKET]| {
            let (mut reported, traversals) = ([0; PACKET], traversals.as_mut_slice().try_into().unwrap());
            let is_packet =
                packet.query(portable(), &tree, rays, traversals, |i, _: AnyHit| reported[i] += 1);
            assert_eq!(reported, [i32::from(is_packet); PACKET]);
            is_packet
        };
        let (mut source, mut packet) = (Seeded::new(24), GeneralPacketScratch::idle());
        let through = [DVec3::new(-0.3, 0.2, 3.0), DVec3::new(0.4, 0.6, -3.0)];
        let narrow = beam(&mut source, through, 0.001);
        assert!((0..3).all(|_| query(&mut packet, &narrow)));
        assert!(!query(&mut packet, &beam(&mut source, through, 4.0)));
        // Along the silhouette they share too few nodes.
        let along = [DVec3::new(0.7, 0.68, 2.0), DVec3::new(0.72, 0.69, -2.0)];
        let grazing = beam(&mut source, along, 0.12);
        assert_eq!([(); 5].map(|()| query(&mut packet, &grazing)), [true, false, true, false, false]);
    }

    /// A point on one of the rays is met by their bounds.
    #[test]
    fn what_lies_on_a_ray_is_met() {
        let (mut source, mut met, mut others) = (Seeded::new(31), 0, 0);
        let bounds = Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE };
        let space = NormalizedSpace::new(&bounds);
        while met < 30_000 {
            let ends = [vector(&mut source), vector(&mut source)];
            let rays = beam(&mut source, ends, 0.05);
            let mut setups = [const { RaySetups::idle() }; GROUPS];
            for (setups, group) in setups.iter_mut().zip(rays.as_chunks().0) {
                setups.set(&portable().columns(group), &bounds, &space);
            }
            let octant = setups[0].octant[0];
            let of_octant = |slot: usize| {
                let setups = &setups[slot / LANES];
                setups.octant[slot % LANES] == octant && setups.may_hit[slot % LANES]
            };
            let all = (0..PACKET).filter(|slot| of_octant(*slot)).fold(0, |rays, slot| rays | 1 << slot);
            let of_rays = RayBounds::of(portable(), &setups, octant as u8, all);
            for slot in Bits(all) {
                let at = rays[slot].at(source.unit());
                if at.abs().max_element() > 1.0 {
                    continue;
                }
                let mut node = Node::empty();
                for (lane, at) in [(2, at), (6, at + 0.4 * vector(&mut source))] {
                    let at = space.position(at.as_vec3());
                    node.set(lane, &Aabb { min: at, max: at }, Child::Node(1));
                }
                let (lanes, _) = of_rays.meet(portable(), &node, octant as u8);
                assert!(lanes & 0b100 != 0, "{:?} at {at:?}", rays[slot]);
                met += 1;
                others += i32::from(lanes & 0b100_0000 != 0);
            }
        }
        // They do not meet just anything.
        assert!(others < met / 3, "{others} of {met}");
    }
}
