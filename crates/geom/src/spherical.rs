use crate::accurate::cross;
use crate::{PdfSolidAngle, Triangle};
use glam::DVec3;

/// The spherical triangle that a triangle covers on the unit sphere around a point, sampled uniformly by
/// solid angle.
///
/// The method is that of Arvo ("Stratified Sampling of Spherical Triangles", 1995): a first random number
/// chooses an arc from the first vertex that cuts off a part of the area, a second one a point of that arc.
/// Arvo computes the part from angles, whose sum cancels for small triangles. This implementation instead
/// solves the formula of Van Oosterom and Strackee (1983) for the solid angle of the part
/// (docs/estimators.md), which does not cancel. All values depend only on the point and the triangle, so the
/// pdf of any direction is available.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphericalTriangle {
    /// The index of the first vertex: that opposite to the longest arc, so that the other two arcs are not
    /// near pi, where their planes are ill-conditioned.
    first: usize,
    /// The unit vectors toward the vertices, from the first one on.
    towards: [DVec3; 3],
    /// The distances of the vertices, in the same order.
    distances: [f64; 3],
    /// One plus the cosine of the arc from the first to the second vertex.
    one_plus_cos: f64,
    /// The sine of the arc from the second to the third vertex; its cosine is `cos_arc`.
    sin_arc: f64,
    cos_arc: f64,
    /// The determinant of the three unit vectors.
    det: f64,
    solid_angle: f64,
}

impl SphericalTriangle {
    /// The smallest solid angle, in steradians, of a triangle that is not elongated. Below it, area sampling has nearly the
    /// same variance (docs/estimators.md has figures).
    pub const MIN_SOLID_ANGLE: f64 = 0.1;

    /// The cosine of the smallest angle, 0.64 radians, under which the longest side of an elongated triangle is seen: from
    /// 1.5 times its length. The solid angle may be small there, but the distances of its points differ.
    pub const MAX_COS_LONGEST: f64 = 0.8;

    /// The squared longest side of an elongated triangle, over its area, is above this. Half a rectangle is elongated if that
    /// is about five times as long as wide.
    pub const ELONGATED: f64 = 10.0;

    /// The smallest determinant of the unit vectors toward the vertices. Rounding displaces a sample by about
    /// `2^-53` over it, in units of the random numbers. The determinant is smaller for small solid angles,
    /// and for points very close to the triangle's plane or to an edge.
    pub const MIN_DETERMINANT: f64 = 1e-8;

    /// The spherical triangle of `triangle` around `origin`, for either side of the triangle.
    ///
    /// `None` if area sampling is preferable: if the solid angle is below [`SphericalTriangle::MIN_SOLID_ANGLE`], unless the
    /// triangle is [elongated](SphericalTriangle::ELONGATED) and its longest side is seen under a
    /// [large angle](SphericalTriangle::MAX_COS_LONGEST); or if the determinant is below
    /// [`SphericalTriangle::MIN_DETERMINANT`]. This includes every `origin` in the triangle's plane.
    pub fn new(triangle: &Triangle, origin: DVec3) -> Option<Self> {
        Self::of_vertices(triangle.vertices.map(|v| v.as_dvec3()), origin)
    }

    /// The same for a triangle with these vertices, such as a part of another one.
    pub fn of_vertices(vertices: [DVec3; 3], origin: DVec3) -> Option<Self> {
        let edges = edges(vertices);
        let longest_sq = longest_side_sq(edges);
        let to_vertex = vertices[0] - origin;
        // Every point is more than twice the longest side away: less than 0.1 sr, and no side of 0.5 radians.
        if to_vertex.length_squared() > 10.0 * longest_sq {
            return None;
        }
        let vertices = vertices.map(|v| v - origin);
        let distances = vertices.map(DVec3::length);
        let area_vector = cross(edges[0], edges[1]);
        let det = vertices[0].dot(area_vector).abs() / distances.iter().product::<f64>();
        let unit: [DVec3; 3] = std::array::from_fn(|i| vertices[i] / distances[i]);
        let first = opposite_to_longest_arc(&unit);
        let from_first = |i: usize| (first + i) % 3;
        let towards = [0, 1, 2].map(|i| unit[from_first(i)]);
        let [a, b, c] = towards;
        // The sum of one and a cosine would cancel near an edge.
        let one_plus_cos = 0.5 * (a + b).length_squared();
        let below = one_plus_cos + c.dot(a + b);
        let cos_arc = b.dot(c);
        let is_long = cos_arc <= Self::MAX_COS_LONGEST && is_elongated(longest_sq, area_vector.length());
        // The tangent of half the solid angle is `det / below`, and is larger than its argument.
        if !is_long && below > 0.0 && det < 0.5 * Self::MIN_SOLID_ANGLE * below {
            return None;
        }
        let solid_angle = 2.0 * libm::atan2(det, below);
        let is_large = is_long || solid_angle >= Self::MIN_SOLID_ANGLE;
        (is_large && det >= Self::MIN_DETERMINANT).then(|| Self {
            first,
            towards,
            distances: [0, 1, 2].map(|i| distances[from_first(i)]),
            one_plus_cos,
            sin_arc: b.cross(c - b).length(),
            cos_arc,
            det,
            solid_angle,
        })
    }

    /// A distance from the centroid of `triangle`, in units of length, beyond which
    /// [`SphericalTriangle::new`] returns `None`. Comparing with it saves most of the work for distant
    /// points.
    ///
    /// From a distance of at least `r` to the triangle, the solid angle of its area `A` is at most `A / r^2`, and a side of
    /// length `l` is seen under an angle of at most `2 atan(l / 2 r)`, whose cosine is above 0.8 from `r = 1.5 l` on. Each
    /// vertex is within two thirds of a median of the centroid, and a median is at most as long as the longest side.
    pub fn reach(triangle: &Triangle) -> f64 {
        Self::reach_of_vertices(triangle.vertices.map(|v| v.as_dvec3()))
    }

    /// The same for a triangle with these vertices.
    pub fn reach_of_vertices(vertices: [DVec3; 3]) -> f64 {
        let edges = edges(vertices);
        let (longest_sq, area) = (longest_side_sq(edges), 0.5 * cross(edges[0], edges[1]).length());
        let (longest, large) = (longest_sq.sqrt(), (area / Self::MIN_SOLID_ANGLE).sqrt());
        let r = if is_elongated(longest_sq, 2.0 * area) { large.max(1.5 * longest) } else { large };
        // The factor exceeds all rounding errors, here and in `new`.
        1.001 * (r + longest * (2.0 / 3.0))
    }

    /// The solid angle, in steradians, above 0.
    pub fn solid_angle(&self) -> f64 {
        self.solid_angle
    }

    /// The pdf of [`SphericalTriangle::sample`] per steradian: one over the solid angle.
    pub fn pdf(&self) -> PdfSolidAngle {
        PdfSolidAngle(1.0 / self.solid_angle)
    }

    /// A point sampled uniformly by solid angle from random numbers `u` in `[0, 1)^2`, as barycentrics `(u,
    /// v)`, both in `[0, 1]` with `u + v <= 1` up to rounding.
    pub fn sample(&self, u: [f64; 2]) -> (f64, f64) {
        let (on_second, on_third) = self.cut(u[0]);
        let [a, b, c] = self.towards;
        let (on_first, on_end) = along_arc(a, on_second * b + on_third * c, u[1]);
        // The direction is a linear combination of the directions of the vertices. Dividing its coefficients
        // by the distances gives those of the point.
        let on_vertices = [on_first, on_end * on_second, on_end * on_third];
        let weights: [f64; 3] = std::array::from_fn(|i| on_vertices[i] / self.distances[i]);
        let sum = weights[0] + weights[1] + weights[2];
        let of_vertex = |i: usize| weights[(3 + i - self.first) % 3] / sum;
        (of_vertex(1), of_vertex(2))
    }

    /// The unit vector on the arc from the second to the third vertex that cuts off the fraction `share` of
    /// the solid angle on the side of the second vertex, as coefficients of these two vertices.
    ///
    /// It solves `T = t det(A, B, B') / (1 + A . B + t A . B')` for `t`, the tangent of half the arc cut off.
    /// `T` is the tangent of half the solid angle cut off, and `B'` the unit vector orthogonal to `B` toward
    /// `C`.
    fn cut(&self, share: f64) -> (f64, f64) {
        let [a, b, c] = self.towards;
        let (sin, cos) = libm::sincos(0.5 * share * self.solid_angle);
        // `t = y / x`, both multiplied by the sine of the whole arc.
        let a_toward_c = a.dot(c) - self.cos_arc * a.dot(b);
        let y = sin * self.one_plus_cos * self.sin_arc;
        let x = (self.det * cos - sin * a_toward_c).max(0.0);
        let square = x * x + y * y;
        let (sin, cos) = (2.0 * x * y / square, (x - y) * (x + y) / square);
        ((cos - sin * self.cos_arc / self.sin_arc).max(0.0), sin / self.sin_arc)
    }

    /// The inverse of [`SphericalTriangle::sample`]: the random numbers, in `[0, 1]` up to rounding, that give
    /// the barycentrics `(u, v)`.
    pub fn invert(&self, u: f64, v: f64) -> [f64; 2] {
        let [a, b, c] = self.towards;
        let barycentrics = [1.0 - u - v, u, v];
        let [first, second, third] =
            [0, 1, 2].map(|i| barycentrics[(self.first + i) % 3] * self.distances[i]);
        let on_edge = second * b + third * c;
        if on_edge == DVec3::ZERO {
            return [0.0, 0.0];
        }
        // Its square may underflow.
        let end = (on_edge / on_edge.abs().max_element()).normalize();
        let to = (first * a + on_edge).normalize();
        // The determinant of A, B and the end of the arc is that of A, B and C times the coefficient of C.
        let det = self.det * third / on_edge.length();
        let part = 2.0 * libm::atan2(det, self.one_plus_cos + end.dot(a + b));
        [part / self.solid_angle, a.distance_squared(to) / a.distance_squared(end)]
    }
}

/// The edges from the first vertex.
#[inline(always)]
fn edges([a, b, c]: [DVec3; 3]) -> [DVec3; 2] {
    [b - a, c - a]
}

/// The squared length of the longest side, by the edges from the first vertex.
#[inline(always)]
fn longest_side_sq([e1, e2]: [DVec3; 2]) -> f64 {
    e1.length_squared().max(e2.length_squared()).max(e1.distance_squared(e2))
}

/// Of a triangle with this squared longest side and twice the area.
fn is_elongated(longest_sq: f64, twice_area: f64) -> bool {
    2.0 * longest_sq > SphericalTriangle::ELONGATED * twice_area
}

/// The index of the unit vector whose opposite arc is the longest.
fn opposite_to_longest_arc(unit: &[DVec3; 3]) -> usize {
    let cos = [unit[1].dot(unit[2]), unit[2].dot(unit[0]), unit[0].dot(unit[1])];
    let shorter = |i: usize, j: usize| cos[i] > cos[j];
    if shorter(0, 1) {
        if shorter(1, 2) { 2 } else { 1 }
    } else if shorter(0, 2) {
        2
    } else {
        0
    }
}

/// The unit vector on the arc between two unit vectors at the fraction `share` of `1 - cos`, where `cos` is
/// the cosine of the arc, as coefficients of `from` and `to`.
fn along_arc(from: DVec3, to: DVec3, share: f64) -> (f64, f64) {
    // One minus and one plus the cosine of the arc, without cancellation.
    let (height, rest) = (0.5 * from.distance_squared(to), 0.5 * (from + to).length_squared());
    let down = share * height;
    let on_to = if height > 0.0 { (share * (2.0 - down) / rest).sqrt() } else { 0.0 };
    ((1.0 - down - (1.0 - height) * on_to).max(0.0), on_to)
}
