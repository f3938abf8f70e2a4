//! The setup of a common-origin packet: the common origin, and the rays by their deviation from a middle one.

use crate::Ray;
use crate::accel::wide::simd::{Aligned, GROUPS, LANES, PACKET, RayMask, Simd};
use crate::accel::wide::trace::deferred_decision::Shears;
use crate::accel::wide::tree::normalize::NormalizedSpace;
use crate::decide::{AXES, main_axis, permute};
use glam::DVec3;

/// An origin further away than this leaves too little of the precision of `f32`; the scene is 2 wide.
const MAX_ORIGIN_DISTANCE: f64 = 64.0;
/// Rays whose slopes are further apart than this visit too few nodes in common.
const MAX_SLOPE_SPREAD: f64 = 0.125;

/// The origin that the rays of a packet share, and a middle ray from it.
///
/// Components are in the order of the [`Shear`](crate::decide::Shear), the main axis last. Depth is measured along
/// the main axis, in the rays' sense; slopes are lengths across for each unit of depth. Rays are given by
/// their *deviation*, which is their slopes minus those of the middle ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct PacketSetup {
    pub(super) main_axis: usize,
    /// The axes x, y and z.
    pub(super) axes: [usize; 3],
    /// 1 if the rays ascend along the main axis, -1 if they descend.
    pub(super) sense: f64,
    /// The origin as the rays have it.
    given: DVec3,
    /// The same in normalised space and in the order of the shear, the last component a depth.
    pub(super) origin: DVec3,
    /// The scale of normalised space.
    scale: f64,
    /// The slopes of the middle ray.
    pub(super) middle: [f32; 2],
    /// The least and the greatest deviations of the rays.
    pub(super) low: [f32; 2],
    pub(super) high: [f32; 2],
    /// The depth at which the first ray's range begins.
    pub(super) begin: f32,
    /// The octant of one ray's direction. Children are visited in its order, which need not be that of all
    /// rays: no answer depends on it.
    pub(super) octant: u8,
}

impl PacketSetup {
    /// The origin of the first ray, and a ray in the middle of the first and the last; `None` if these two
    /// are not from one point, or not coherent. The bounds of the deviations follow in
    /// [`PacketRays::set`].
    #[inline(always)]
    pub(super) fn new(rays: &[Ray; PACKET], space: &NormalizedSpace) -> Option<Self> {
        let (first, last) = (&rays[0], &rays[PACKET - 1]);
        if first.origin != last.origin || !first.is_traceable() {
            return None;
        }
        let main_axis = main_axis(first.direction);
        let direction = permute(first.direction, main_axis);
        let sense = 1.0_f64.copysign(direction.z);
        let mut origin = permute(first.origin - space.center, main_axis) * space.scale;
        origin.z *= sense;
        let other = permute(last.direction, main_axis);
        let (first_slopes, last_slopes) = (direction / direction.z.abs(), other / other.z.abs());
        if origin.abs().max_element() > MAX_ORIGIN_DISTANCE
            || (first_slopes - last_slopes).abs().max_element() > MAX_SLOPE_SPREAD
        {
            return None;
        }
        let DVec3 { x, y, .. } = 0.5 * (first_slopes + last_slopes);
        let middle = [x as f32, y as f32];
        let octant = first.direction.is_negative_bitmask() as u8;
        let axes = AXES[main_axis % 3].map(usize::from);
        let ([low, high], scale, begin) = ([[0.0; 2]; 2], space.scale, 0.0);
        let given = first.origin;
        Some(Self { main_axis, axes, sense, given, origin, scale, middle, low, high, begin, octant })
    }
}

/// A depth beyond the scene.
const DEPTH_BEYOND_SCENE: f64 = 2.0;

/// The rays of a packet, a column for each number.
#[repr(align(64))]
#[derive(Debug, Default)]
pub(super) struct PacketRays {
    /// The deviations along x and y.
    pub(super) deviation: [[[f32; LANES]; GROUPS]; 2],
    /// The depths at which the rays' ranges begin and end.
    pub(super) begin: [[f32; LANES]; GROUPS],
    pub(super) range_end: [[f32; LANES]; GROUPS],
    /// Hits at greater depths cannot matter.
    pub(super) limit: [[f32; LANES]; GROUPS],
    pub(super) shears: [Shears; GROUPS],
}

impl PacketRays {
    /// Sets up the rays, and bounds their deviations in `setup`. Returns false if they are not coherent, or
    /// not all from its origin.
    #[inline(always)]
    pub(super) fn set<S: Simd>(&mut self, simd: S, setup: &mut PacketSetup, groups: &[[Ray; LANES]]) -> bool {
        let mut fit: RayMask = 0;
        for (g, group) in groups.iter().enumerate() {
            fit |= RayMask::from(self.set_group(simd, g, setup, group)) << (g * LANES);
        }
        if fit != RayMask::MAX {
            return false;
        }
        let range = |numbers: &[[f32; LANES]; GROUPS]| simd.range(RayMask::MAX, |g| &numbers[g]);
        let [x, y] = [range(&self.deviation[0]), range(&self.deviation[1])];
        [setup.low, setup.high] = [[x[0], y[0]], [x[1], y[1]]];
        setup.begin = range(&self.begin)[0];
        [x, y].iter().all(|[least, greatest]| f64::from(greatest - least) <= MAX_SLOPE_SPREAD)
    }

    /// Sets up eight rays; returns which of them belong to the packet: none if one of them excludes a triangle.
    #[inline(always)]
    fn set_group<S: Simd>(&mut self, simd: S, g: usize, setup: &PacketSetup, group: &[Ray; LANES]) -> u8 {
        // `NO_TRIANGLE` has all bits set.
        let excluded =
            group.iter().fold(Ray::NO_TRIANGLE, |all, ray| all & ray.excluded[0] & ray.excluded[1]);
        if excluded != Ray::NO_TRIANGLE {
            return 0;
        }
        let columns = simd.columns(group);
        let Aligned([ox, oy, oz, .., t_min, t_max]) = &columns;
        let [dx, dy, dz] = setup.axes.map(|axis| &columns.0[3 + axis % 3]);
        let shears = &mut self.shears[g];
        let origin = permute(setup.given, setup.main_axis);
        shears.main_axis = setup.main_axis;
        shears.origin = [[origin.x; LANES], [origin.y; LANES], [origin.z; LANES]];
        shears.direction_z = *dz;
        // Without branches, so that the compiler vectorises the loops.
        for (axis, across) in [dx, dy].into_iter().enumerate() {
            let (mut slopes, mut deviation) = ([0.0; LANES], [0.0; LANES]);
            let middle = f64::from(setup.middle[axis]);
            for i in 0..LANES {
                slopes[i] = across[i] / dz[i];
                deviation[i] = (slopes[i] * setup.sense - middle) as f32;
            }
            shears.slopes[axis] = slopes;
            self.deviation[axis][g] = deviation;
        }
        let (mut begins, mut ends) = ([0.0; LANES], [0.0; LANES]);
        for i in 0..LANES {
            let rate = dz[i].abs() * setup.scale;
            let (begin, end) = (setup.origin.z + t_min[i] * rate, setup.origin.z + t_max[i] * rate);
            begins[i] = begin as f32;
            ends[i] = (if end < DEPTH_BEYOND_SCENE { end } else { DEPTH_BEYOND_SCENE }) as f32;
        }
        (self.begin[g], self.range_end[g], self.limit[g]) = (begins, ends, ends);
        let domain = Ray::DIRECTION_DOMAIN;
        let mut fits = [0.0; LANES];
        for i in 0..LANES {
            let along = dz[i] * setup.sense;
            // Comparisons with NaN are false. A ray with two largest components does not fit.
            let fit = (along > dx[i].abs())
                & (along > dy[i].abs())
                & (along >= *domain.start())
                & (along <= *domain.end())
                & (t_min[i] >= 0.0)
                & (t_min[i] < t_max[i])
                & (ox[i].to_bits() == setup.given.x.to_bits())
                & (oy[i].to_bits() == setup.given.y.to_bits())
                & (oz[i].to_bits() == setup.given.z.to_bits());
            fits[i] = if fit { 1.0 } else { 0.0 };
        }
        simd.lt(simd.splat(0.0), simd.load(&fits))
    }
}
