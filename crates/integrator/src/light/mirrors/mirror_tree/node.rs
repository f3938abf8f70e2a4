use super::bounds::Bounds;
use super::lanes::{Lanes, abs, dot, lane, lanes, max, min, minus, vector_lanes};
use crate::light::child_weights::{WIDTH, child_of};
use glam::{DVec3, Vec3};

/// A receiver and the lights, in the tree's frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Query {
    pub(super) from: Vec3,
    /// The unit normal on the side of the surface where mirrors count.
    pub(super) normal: Vec3,
    /// The center of the box around the lights, the distances of its faces from there, and the radius of the sphere
    /// around it.
    pub(super) lights: Vec3,
    pub(super) lights_half_extents: Vec3,
    pub(super) lights_radius: f32,
    /// The bits of the bodies that the receiver may be within, and of mirrors that are in no body.
    pub(super) around: u32,
}

/// A node of the mirror tree: the bounds of its children, by component. Each vector has a cache line of its own.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct Node {
    center: [Lanes; 3],
    radius: Lanes,
    axis: [Lanes; 3],
    /// The two directions orthogonal to the axis, times the cosine of the angle; zero for wide cones.
    cross_axes: [[Lanes; 3]; 2],
    /// The sines of the two angles; 1 for wide cones.
    sines: [Lanes; 2],
    /// The areas; 0 where there is no child.
    area: Lanes,
    /// The bits of the bodies of each child, by lane.
    bodies: [u32; WIDTH],
    /// The index of the first child; the others follow.
    pub(crate) first: u32,
}

impl Node {
    /// The angle, in radians, from which on a cone is wide.
    const MIN_WIDE_ANGLE: f64 = 1.5;

    /// The sine of the angles up to which a child counts as plane.
    const MAX_PLANE_SINE: f32 = 1e-4;

    /// A node of one to `WIDTH` children, of which the first has the index `first`.
    pub(super) fn new(children: &[Bounds], first: u32) -> Self {
        let numbers = |value: &dyn Fn(&Bounds) -> f64| lanes(children, value);
        let vectors = |value: &dyn Fn(&Bounds) -> DVec3| vector_lanes(children, value);
        let is_wide = |bounds: &Bounds| bounds.angles[0].max(bounds.angles[1]) >= Self::MIN_WIDE_ANGLE;
        let cross_axis = |bounds: &Bounds, k: usize| {
            let (sin, cos) = libm::sincos(bounds.angles[k]);
            if is_wide(bounds) { (1.0, DVec3::ZERO) } else { (sin, cos * bounds.frame[1 + k]) }
        };
        // Both sides of a wide cone count.
        let bodies = |bounds: &Bounds| if is_wide(bounds) { u32::MAX } else { bounds.bodies };
        Self {
            center: vectors(&|bounds| bounds.center),
            radius: numbers(&|bounds| bounds.radius),
            axis: vectors(&|bounds| bounds.frame[0]),
            cross_axes: [0, 1].map(|k| vectors(&|bounds| cross_axis(bounds, k).1)),
            sines: [0, 1].map(|k| numbers(&|bounds| cross_axis(bounds, k).0)),
            area: numbers(&|bounds| bounds.area),
            bodies: std::array::from_fn(|lane| children.get(child_of(lane)).map_or(0, bodies)),
            first,
        }
    }

    /// The importance of each child, by lane: the solid angle that it takes up, times the square root of the share of its
    /// normals for which a ray goes on to the lights, times the largest cosine at the receiver.
    ///
    /// Bounds tell the share only on average. Where a child shows lights either with all of its normals or with none, the
    /// root of the mean square of what it shows, by which the variance is least, is the square root of the share.
    ///
    /// A mirror reflects light from its source to the receiver if its normal is parallel to the half vector
    /// `wi + wo`. Normals, positions and lights vary within their bounds; the difference of normal and half vector is
    /// taken as uniform in the interval that follows from this, for each side of the cone by itself. Where the
    /// receiver or a light is within the sphere of a plane child, all of it counts; of a curved one, in which every
    /// direction to the receiver occurs, as much as of any half vector.
    #[inline(always)]
    pub(crate) fn importance(&self, query: &Query) -> [f64; WIDTH] {
        const MIN_LENGTH_SQ: f32 = f32::MIN_POSITIVE;
        let mut all = [0.0; WIDTH];
        // A plain loop in single precision, which the compiler vectorizes.
        for (i, importance) in all.iter_mut().enumerate() {
            let radius = self.radius[i];
            let to_from = minus(query.from.to_array(), lane(&self.center, i));
            let to_lights = minus(query.lights.to_array(), lane(&self.center, i));
            let from_sq = max(dot(to_from, to_from), MIN_LENGTH_SQ);
            let lights_sq = max(dot(to_lights, to_lights), MIN_LENGTH_SQ);
            let (per_from, per_lights) = (1.0 / from_sq.sqrt(), 1.0 / lights_sq.sqrt());
            let half = [
                to_from[0] * per_from + to_lights[0] * per_lights,
                to_from[1] * per_from + to_lights[1] * per_lights,
                to_from[2] * per_from + to_lights[2] * per_lights,
            ];
            let (from_size, lights_size) = (radius * per_from, radius * per_lights);
            let is_near = max(from_size, lights_size) >= 1.0;
            let turn = turn(from_size) + turn(lights_size);
            let lights = LightsFromChild::new(query, to_lights, per_lights);
            let half_width = lights.largest_turn;
            let along = dot(half, lane(&self.axis, i));
            let along_front = if self.bodies[i] & query.around == 0 { along } else { abs(along) };
            let facing = if along_front > -(turn + half_width) { 1.0 } else { 0.0 };
            let along = abs(along);
            let a = self.share(i, 0, half, along, turn, &lights);
            let b = self.share(i, 1, half, along, turn, &lights);
            let is_flat = max(self.sines[0][i], self.sines[1][i]) < Self::MAX_PLANE_SINE;
            let share = if is_near && is_flat { 1.0 } else { facing * a * b };
            let cos = if is_near { 1.0 } else { 0.5 * dot(half, half).sqrt() };
            let cos_from = from_size - dot(query.normal.to_array(), to_from) * per_from;
            let cos_from = min(max(cos_from, 0.0), 1.0);
            // Quotients do not wait for the share.
            let solid_angle = self.area[i] * cos_from / max(from_sq, radius * radius);
            *importance = solid_angle * cos * share.sqrt();
        }
        all.map(f64::from)
    }

    /// The share of the normals of child `i` along cross axis `k` of its cone for which a ray goes on to the lights.
    #[inline(always)]
    fn share(
        &self,
        i: usize,
        k: usize,
        half: [f32; 3],
        along: f32,
        turn: f32,
        lights: &LightsFromChild,
    ) -> f32 {
        let (cross_axis, sin) = (lane(&self.cross_axes[k], i), self.sines[k][i]);
        let half_width = if sin < 1.0 { lights.turn_along(cross_axis) } else { lights.largest_turn };
        overlap(dot(half, cross_axis), sin * along + turn, half_width)
    }
}

/// The directions from the center of a child to the lights.
struct LightsFromChild {
    /// That to the center of the lights, a unit vector.
    middle: [f32; 3],
    /// The half extents of the lights, and the radius around them, over the distance of their center.
    half_extents: [f32; 3],
    size: f32,
    /// A lower bound of the depths of the lights along `middle`, over the distance of their center. Bounds of a single
    /// component are not valid unless it is positive.
    nearest: f32,
    /// An upper bound of the difference between `middle` and the direction to any point of the lights.
    largest_turn: f32,
}

impl LightsFromChild {
    /// Below this depth, bounds of single components are too wide to help.
    const TOO_NEAR: f32 = 1e-3;

    #[inline(always)]
    fn new(query: &Query, to_lights: [f32; 3], per_distance: f32) -> Self {
        let [x, y, z] = to_lights;
        let middle = [x * per_distance, y * per_distance, z * per_distance];
        let Vec3 { x, y, z } = query.lights_half_extents;
        let half_extents = [x * per_distance, y * per_distance, z * per_distance];
        let size = query.lights_radius * per_distance;
        let nearest = 1.0 - dot(half_extents, middle.map(abs));
        Self { middle, half_extents, size, nearest, largest_turn: turn(size) }
    }

    /// An upper bound of the component along `cross_axis`, a vector of length up to 1, of the difference between `middle` and
    /// the direction to any point of the lights.
    ///
    /// In units of the distance of the center, a point is `middle + d`, where `d` has the component `d_m` along `middle`
    /// and the rest `d_r`. Its distance is at least `1 + d_m`, and exceeds that by at most `d_r^2 / (2 (1 + d_m))`. So
    /// the component along `c` is at most `(|c . d_r| + |c . middle| d_r^2 / (2 (1 + d_m))) / (1 + d_m)`.
    #[inline(always)]
    fn turn_along(&self, cross_axis: [f32; 3]) -> f32 {
        let along = dot(cross_axis, self.middle);
        let middle = self.middle;
        let across = [0, 1, 2].map(|k| abs(cross_axis[k] - along * middle[k]));
        let per_nearest = 1.0 / max(self.nearest, Self::TOO_NEAR);
        let excess = 0.5 * abs(along) * self.size * self.size * per_nearest;
        let bound = (dot(self.half_extents, across) + excess) * per_nearest;
        if self.nearest > Self::TOO_NEAR { min(bound, self.largest_turn) } else { self.largest_turn }
    }
}

/// The share of the interval of half width `spread` around `middle` that is within `[-half_width, half_width]`.
#[inline(always)]
fn overlap(middle: f32, spread: f32, half_width: f32) -> f32 {
    let (middle, spread) = (abs(middle), max(spread, f32::MIN_POSITIVE));
    let common = min(2.0 * min(spread, half_width), spread + half_width - middle);
    min(max(common * (0.5 / spread), 0.0), 1.0)
}

/// An upper bound of `2 s / (2 - s)` for `s` up to 1, and of 2 from there on: the largest difference of the unit
/// vectors from a point to two others, whose distance is `s` times that of the first (Dunkl and Williams 1964).
#[inline(always)]
fn turn(s: f32) -> f32 {
    let s = min(s, 1.0);
    s + s * s * (0.5 + 0.5 * s)
}
