use super::lanes::{Lanes, abs, cross, dot, lane, lanes, length, max, min, minus, vector_lanes};
use super::node::Query;
use crate::light::child_weights::{WIDTH, child_of, sum};
use glam::DVec3;

/// A leaf whose mirrors are triangles: their vertices, by component. Each vector has cache lines of its own.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct TriangleLeaf {
    corner: [Lanes; 3],
    /// From the corner to the other two vertices, counterclockwise as seen from the front.
    edges: [[Lanes; 3]; 2],
    /// The cross products of the edges: single precision would lose those of needles.
    normal: [Lanes; 3],
    /// The square of the distance within which a receiver is near.
    near_sq: Lanes,
    /// The bit of each mirror's body.
    bodies: [u32; WIDTH],
}

/// A mirror that is a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct TriangleMirror {
    /// In the tree's frame, counterclockwise as seen from the front.
    pub(super) vertices: [DVec3; 3],
    pub(super) body: u32,
}

impl TriangleMirror {
    /// The square of the circumradius of an equilateral triangle with the longest side.
    fn near_sq(&self) -> f64 {
        let [a, b, c] = self.vertices;
        (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared()) / 3.0
    }
}

impl TriangleLeaf {
    /// A leaf of one to `WIDTH` mirrors.
    pub(super) fn new(mirrors: &[TriangleMirror]) -> Self {
        let vectors = |value: &dyn Fn(&[DVec3; 3]) -> DVec3| vector_lanes(mirrors, &|of| value(&of.vertices));
        Self {
            corner: vectors(&|[a, _, _]| *a),
            edges: [vectors(&|[a, b, _]| b - a), vectors(&|[a, _, c]| c - a)],
            normal: vectors(&|[a, b, c]| (b - a).cross(c - a)),
            near_sq: lanes(mirrors, &TriangleMirror::near_sq),
            bodies: std::array::from_fn(|lane| mirrors.get(child_of(lane)).map_or(0, |mirror| mirror.body)),
        }
    }

    /// The importance of each mirror, by lane, like that of [`Node`](super::node::Node): the solid angle that it takes up, times
    /// the square root of the share of it that shows lights, times the largest cosine at the receiver. It is 0 where
    /// the lights are behind the mirror or, as seen from the receiver's image, all beyond one of its sides.
    #[inline(always)]
    pub(crate) fn importance(&self, query: &Query) -> [f64; WIDTH] {
        self.importance_to(query, Receivers::Point)
    }

    /// About the largest sum of the mirrors' importances to any receiver within `radius` of that of `query`, on surfaces that
    /// face them. Above zero if any mirror has an importance there.
    #[inline(always)]
    pub(crate) fn largest_importance(&self, query: &Query, radius: f32) -> f64 {
        let front = sum(self.importance_to(query, Receivers::InFront(radius)));
        if !self.may_be_behind(query, radius) {
            return front;
        }
        front + sum(self.importance_to(query, Receivers::Behind(radius)))
    }

    /// Whether a receiver within `radius` of that of `query` is behind a mirror whose back reflects.
    #[inline(always)]
    fn may_be_behind(&self, query: &Query, radius: f32) -> bool {
        let mut is_behind = 0;
        // A plain loop, which the compiler vectorizes.
        for i in 0..WIDTH {
            let normal = lane(&self.normal, i);
            let height = dot(normal, minus(query.from.to_array(), lane(&self.corner, i)));
            let has_back = self.bodies[i] & query.around != 0;
            is_behind |= u32::from(has_back & (height < radius * length(normal)));
        }
        is_behind != 0
    }

    /// The importance of each mirror to `receivers`, by lane.
    ///
    /// From the image of the receiver in the mirror's plane, the lights' box is projected onto the plane. There, each barycentric
    /// coordinate of the mirror has an interval of the box. The share is taken as that of the parallelogram where the two
    /// coordinates that the box limits most are in their intervals. As the receiver moves by a distance, so does its image, and
    /// the volume of a side's two ends, the image and a point of the box, by which coordinates are computed, changes by at most
    /// the distance times the area that side and point span.
    #[inline(always)]
    fn importance_to(&self, query: &Query, receivers: Receivers) -> [f64; WIDTH] {
        let (receiver_normal, half_extents) = (query.normal.to_array(), query.lights_half_extents.to_array());
        let mut all = [0.0; WIDTH];
        // A plain loop in single precision, which the compiler vectorizes.
        for (i, importance) in all.iter_mut().enumerate() {
            let corner = lane(&self.corner, i);
            let (left, right) = (lane(&self.edges[0], i), lane(&self.edges[1], i));
            let from = minus(query.from.to_array(), corner);
            let lights = minus(query.lights.to_array(), corner);
            // Its length is twice the area.
            let normal = lane(&self.normal, i);
            let height = dot(normal, from);
            let height_change = receivers.change(|| length(normal));
            let has_back = self.bodies[i] & query.around != 0;
            let (facing, is_on_side) = match receivers {
                Receivers::Point => (1.0_f32.copysign(height), has_back | (height > 0.0)),
                Receivers::InFront(_) => (1.0, height > -height_change),
                Receivers::Behind(_) => (-1.0, has_back & (height < height_change)),
            };
            let reach = |direction: [f32; 3]| dot(direction.map(abs), half_extents);
            let largest_height = facing * dot(normal, lights) + reach(normal);
            let per_normal = 2.0 * height / max(dot(normal, normal), f32::MIN_POSITIVE);
            let image = [0, 1, 2].map(|k| from[k] - per_normal * normal[k]);
            // The normals of the planes through the image and each side.
            let to_corner = image.map(|x| -x);
            let (a, c) = (cross(to_corner, left), cross(right, to_corner));
            let b = minus(minus(normal, a), c);
            // Barycentric coordinates times the lights' largest distance from the image along the normal.
            let whole = max(largest_height + facing * height, 0.0) + height_change;
            // A coordinate is divided by the depth of its point, which varies over the box. Where the image is in the plane
            // of a flat box, that alone gives it an interval.
            let depth = min(2.0 * reach(normal), largest_height) / max(whole, f32::MIN_POSITIVE);
            let overlap = |middle: f32, inward: [f32; 3], along: [f32; 3], to_lights: [f32; 3]| {
                let change = receivers
                    .change(|| length(cross(along, to_lights)) + length(along) * query.lights_radius);
                let reach = reach(inward) + 0.5 * depth * max(min(middle, whole), 0.0) + change;
                max(min(min(2.0 * reach, whole), reach + min(middle, whole - middle)), 0.0)
            };
            // The corner is in the planes of two sides.
            let (at_a, at_c) = (facing * dot(a, lights), facing * dot(c, lights));
            let at_b = facing * (dot(normal, lights) + height) - at_a - at_c;
            let a = overlap(at_a, a, left, lights);
            let b = overlap(at_b, b, minus(right, left), minus(lights, left));
            let c = overlap(at_c, c, right, lights);
            let (least, next) = (min(min(a, b), c), max(min(a, b), min(max(a, b), c)));
            let share = min(2.0 * least * next / max(whole * whole, f32::MIN_POSITIVE), 1.0);
            let to_center = [0, 1, 2].map(|k| (left[k] + right[k]) * (1.0 / 3.0) - from[k]);
            let per_distance_sq = 1.0 / max(dot(to_center, to_center), self.near_sq[i]);
            let highest = match receivers {
                Receivers::Point => {
                    max(max(dot(receiver_normal, left), dot(receiver_normal, right)), 0.0)
                        - dot(receiver_normal, from)
                }
                _ => 1.0 / per_distance_sq.sqrt(),
            };
            let height = abs(height) + height_change;
            let cosines = (max(highest, 0.0) * per_distance_sq) * (0.5 * height * per_distance_sq);
            *importance = if is_on_side & (largest_height > 0.0) { cosines * share.sqrt() } else { 0.0 };
        }
        all.map(f64::from)
    }
}

/// Where the receivers of mirrors are.
#[derive(Clone, Copy)]
enum Receivers {
    /// At the point of the query, on its surface.
    Point,
    /// Within this distance from there and on the front of a mirror, on surfaces that face it.
    InFront(f32),
    /// The same, on the back.
    Behind(f32),
}

impl Receivers {
    /// How much a number may change whose rate of change `rate` returns.
    #[inline(always)]
    fn change(self, rate: impl FnOnce() -> f32) -> f32 {
        match self {
            Self::Point => 0.0,
            Self::InFront(radius) | Self::Behind(radius) => radius * rate(),
        }
    }
}

#[cfg(test)]
mod tests;
