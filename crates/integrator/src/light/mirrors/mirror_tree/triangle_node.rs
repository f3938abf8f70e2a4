use super::lanes::{Lanes, abs, cross, dot, lane, lanes, max, min, minus, vector_lanes};
use super::node::Query;
use crate::light::child_weights::{WIDTH, child_of};
use glam::DVec3;

/// A lowest node whose facets are triangles: their vertices, by component. Each vector has cache lines of its own.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct TriangleNode {
    corner: [Lanes; 3],
    /// From the corner to the other two vertices, counterclockwise as seen from the front.
    edges: [[Lanes; 3]; 2],
    /// The square of the distance within which a receiver is near.
    near_sq: Lanes,
    /// The bit of each facet's body.
    bodies: [u32; WIDTH],
}

/// A facet that is a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct TriangleFacet {
    /// In the tree's frame, counterclockwise as seen from the front.
    pub(super) vertices: [DVec3; 3],
    pub(super) body: u32,
}

impl TriangleFacet {
    /// The square of the circumradius of an equilateral triangle with the longest side.
    fn near_sq(&self) -> f64 {
        let [a, b, c] = self.vertices;
        (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared()) / 3.0
    }
}

impl TriangleNode {
    /// A node of one to `WIDTH` facets.
    pub(super) fn new(facets: &[TriangleFacet]) -> Self {
        let vectors = |value: &dyn Fn(&[DVec3; 3]) -> DVec3| vector_lanes(facets, &|of| value(&of.vertices));
        Self {
            corner: vectors(&|[a, _, _]| *a),
            edges: [vectors(&|[a, b, _]| b - a), vectors(&|[a, _, c]| c - a)],
            near_sq: lanes(facets, &TriangleFacet::near_sq),
            bodies: std::array::from_fn(|lane| facets.get(child_of(lane)).map_or(0, |facet| facet.body)),
        }
    }

    /// The importance of each facet, by lane, like that of [`Node`](super::node::Node): the solid angle that it takes up, times
    /// the square root of the share of it that shows lights, times the largest cosine at the receiver. It is 0 where
    /// the lights are behind the facet or, as seen from the receiver's image, all beyond one of its sides.
    ///
    /// From the image, the lights' box is projected onto the plane. There, each barycentric coordinate of the facet has an
    /// interval of the box. The share is taken as that of the parallelogram where the two coordinates that the box limits
    /// most are in their intervals.
    #[inline(always)]
    pub(crate) fn importance(&self, query: &Query) -> [f64; WIDTH] {
        let (side, half_extents) = (query.side.to_array(), query.lights_half_extents.to_array());
        let mut all = [0.0; WIDTH];
        // A plain loop in single precision, which the compiler vectorizes.
        for (i, importance) in all.iter_mut().enumerate() {
            let corner = lane(&self.corner, i);
            let (left, right) = (lane(&self.edges[0], i), lane(&self.edges[1], i));
            let from = minus(query.from.to_array(), corner);
            let lights = minus(query.lights.to_array(), corner);
            // Its length is twice the area.
            let normal = cross(left, right);
            let height = dot(normal, from);
            let facing = 1.0_f32.copysign(height);
            let bodies = self.bodies[i];
            let reach = |direction: [f32; 3]| dot(direction.map(abs), half_extents);
            let largest_height = facing * dot(normal, lights) + reach(normal);
            let per_normal = 2.0 * height / max(dot(normal, normal), f32::MIN_POSITIVE);
            let image = [0, 1, 2].map(|k| from[k] - per_normal * normal[k]);
            // The normals of the planes through the image and each side.
            let (to_corner, to_lights) = (image.map(|x| -x), minus(lights, image));
            let (a, c) = (cross(to_corner, left), cross(right, to_corner));
            let b = minus(minus(normal, a), c);
            // Barycentric coordinates times the lights' largest distance from the image along the normal.
            let whole = largest_height + abs(height);
            let overlap = |inward: [f32; 3]| {
                let (middle, reach) = (facing * dot(inward, to_lights), reach(inward));
                max(min(min(2.0 * reach, whole), reach + min(middle, whole - middle)), 0.0)
            };
            let (a, b, c) = (overlap(a), overlap(b), overlap(c));
            let (least, next) = (min(min(a, b), c), max(min(a, b), min(max(a, b), c)));
            let share = min(2.0 * least * next / max(whole * whole, f32::MIN_POSITIVE), 1.0);
            let to_center = [0, 1, 2].map(|k| (left[k] + right[k]) * (1.0 / 3.0) - from[k]);
            let per_distance_sq = 1.0 / max(dot(to_center, to_center), self.near_sq[i]);
            let highest = max(max(dot(side, left), dot(side, right)), 0.0) - dot(side, from);
            let is_shown = (largest_height > 0.0) & ((height > 0.0) | (bodies & query.around != 0));
            let cosines = (max(highest, 0.0) * per_distance_sq) * (0.5 * abs(height) * per_distance_sq);
            *importance = if is_shown { cosines * share.sqrt() } else { 0.0 };
        }
        all.map(f64::from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Stream;
    use globillum_geom::Triangle;

    /// Whether a ray meets the box around `center`.
    fn hits_box(origin: DVec3, direction: DVec3, center: DVec3, half_extents: DVec3) -> bool {
        let (a, b) =
            ((center - half_extents - origin) / direction, (center + half_extents - origin) / direction);
        a.min(b).max_element().max(0.0) <= a.max(b).min_element()
    }

    /// A facet of which a point reflects a ray to the lights has an importance. The mean share in it is 4.4 times that of
    /// points that do, since boxes and intervals cover more than the lights' projection; it would be 6.2 times if any facet
    /// with an importance counted as a whole.
    #[test]
    fn importance_follows_the_share_that_shows_lights() {
        let (mut shares, mut shown, mut facets_shown) = (0.0, 0.0, 0);
        for i in 0..2000 {
            let numbers = Stream::new(22, 0, i);
            let vector =
                |k: u32| DVec3::from_array([0, 1, 2].map(|axis| 2.0 * numbers.uniform(k + axis) - 1.0));
            let (from, lights, half_extents) = (3.0 * vector(0), 3.0 * vector(3), 0.4 * vector(6).abs());
            let size = 10.0_f64.powf(-2.0 * numbers.uniform(9));
            let facet = |k: u32| {
                let center = 0.5 * vector(12 * k);
                let vertices = [3, 6, 9].map(|j| center + size * vector(12 * k + j));
                TriangleFacet { vertices, body: 1 }
            };
            let facets: Vec<_> = (1..=WIDTH as u32).map(facet).collect();
            let side = -from.normalize();
            let query = Query {
                from: from.as_vec3(),
                side: side.as_vec3(),
                lights: lights.as_vec3(),
                lights_half_extents: half_extents.as_vec3(),
                lights_radius: half_extents.length() as f32,
                around: u32::MAX,
            };
            let importance = TriangleNode::new(&facets).importance(&query);
            for (lane, importance) in importance.into_iter().enumerate() {
                let [a, b, c] = facets[child_of(lane)].vertices;
                let normal = (b - a).cross(c - a);
                let shows = |k: u32| {
                    let (u, v) = Triangle::sample_uniform(Stream::new(23, i.into(), k).uniform_pair(0));
                    let point = a + u * (b - a) + v * (c - a);
                    let (wi, n) = (point - from, normal.normalize());
                    hits_box(point, wi - 2.0 * wi.dot(n) * n, lights, half_extents)
                };
                let share = f64::from((0..256).map(|k| u32::from(shows(k))).sum::<u32>()) / 256.0;
                let to_center = (a + b + c) / 3.0 - from;
                let highest = [a, b, c].map(|v| (v - from).dot(side)).into_iter().fold(0.0, f64::max);
                let whole = 0.5 * normal.dot(to_center).abs() * highest / to_center.length_squared().powi(2);
                let is_near = to_center.length_squared() < facets[child_of(lane)].near_sq();
                assert!(share == 0.0 || importance > 0.0 || highest == 0.0, "{i}, {lane}: {share}");
                if highest > 0.0 && !is_near {
                    (shares, shown) = (shares + (importance / whole).powi(2), shown + share);
                    facets_shown += i32::from(share > 0.0);
                }
            }
        }
        assert!(
            facets_shown > 300 && shares > shown && shares < 5.0 * shown,
            "{facets_shown}, {shares}, {shown}"
        );
    }
}
