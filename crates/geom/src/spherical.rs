use crate::{PdfSolidAngle, Triangle};
use glam::DVec3;

/// A triangle as it is seen from a point: the part of the sphere of directions that it covers.
///
/// Points of it can be chosen so that their directions are uniform per solid angle. Arvo
/// ("Stratified Sampling of Spherical Triangles", 1995) showed how: a first number cuts off a part of
/// the area by an arc from the first vertex, a second one takes a point of that arc. His cut goes by
/// angles, whose sum cancels for small triangles; this one solves Van Oosterom and Strackee's formula
/// for the part's area (docs/estimators.md), which does not. It is a function of the point
/// and the triangle alone, so a density can be asked for as well as sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphericalTriangle {
    /// The vertex opposite to the longest arc comes first, so that the other two arcs are not near
    /// half a turn, where their ends tell little of the plane in which they lie.
    first: usize,
    /// Unit vectors toward the vertices, from the first one on.
    towards: [DVec3; 3],
    distances: [f64; 3],
    /// Of the first and the second vertex: one plus the cosine of the angle between them.
    one_plus_cos: f64,
    /// Of the arc from the second vertex to the third.
    sin_arc: f64,
    cos_arc: f64,
    /// Determinant of the three unit vectors.
    det: f64,
    solid_angle: f64,
}

impl SphericalTriangle {
    /// The least solid angle, in steradians, that is worth the trouble: from so far away, points chosen
    /// by area have nearly uniform directions too (docs/estimators.md has figures).
    pub const MIN_SOLID_ANGLE: f64 = 0.1;

    /// The least determinant of the unit vectors toward the vertices. Rounding displaces a sample by
    /// about `2^-53` over it, in units of the random numbers. Below are, beside small solid angles, the
    /// points all but in the triangle or on one of its edges.
    pub const MIN_DETERMINANT: f64 = 1e-8;

    /// `triangle` as it is seen from `origin`, from either side.
    ///
    /// `None` where points are better chosen by area: where the solid angle is below
    /// [`SphericalTriangle::MIN_SOLID_ANGLE`], or the vectors' determinant below
    /// [`SphericalTriangle::MIN_DETERMINANT`]. That includes every `origin` in the triangle's plane.
    pub fn new(triangle: &Triangle, origin: DVec3) -> Option<Self> {
        let [e1, e2] = triangle.edges();
        let longest_sq = e1.length_squared().max(e2.length_squared()).max(e1.distance_squared(e2));
        let to_vertex = triangle.vertices[0].as_dvec3() - origin;
        // All of it is more than twice its longest side away: less than a tenth of a steradian.
        if to_vertex.length_squared() > 10.0 * longest_sq {
            return None;
        }
        let vertices = triangle.vertices.map(|v| v.as_dvec3() - origin);
        let distances = vertices.map(DVec3::length);
        let det = vertices[0].dot(triangle.area_vector()).abs() / distances.iter().product::<f64>();
        let unit: [DVec3; 3] = std::array::from_fn(|i| vertices[i] / distances[i]);
        let first = opposite_to_longest_arc(&unit);
        let from_first = |i: usize| (first + i) % 3;
        let towards = [0, 1, 2].map(|i| unit[from_first(i)]);
        let [a, b, c] = towards;
        // Not the sum of one and a cosine, which cancels beside an edge.
        let one_plus_cos = 0.5 * (a + b).length_squared();
        let below = one_plus_cos + c.dot(a + b);
        // The tangent of half the solid angle is `det / below`, and larger than that half.
        if below > 0.0 && det < 0.5 * Self::MIN_SOLID_ANGLE * below {
            return None;
        }
        let solid_angle = 2.0 * libm::atan2(det, below);
        let sound = solid_angle >= Self::MIN_SOLID_ANGLE && det >= Self::MIN_DETERMINANT;
        sound.then(|| Self {
            first,
            towards,
            distances: [0, 1, 2].map(|i| distances[from_first(i)]),
            one_plus_cos,
            sin_arc: b.cross(c - b).length(),
            cos_arc: b.dot(c),
            det,
            solid_angle,
        })
    }

    /// How far from the middle of `triangle` (the mean of its vertices) a point may at most be that has a
    /// `Some` of it: known before, this spares most of the work for points further off.
    ///
    /// From a point at the distance `r` of the triangle or more, its area `A` covers at most `A / r^2`, and no
    /// vertex is further from the middle than two thirds of a median, which is no longer than the longest
    /// side.
    pub fn reach(triangle: &Triangle) -> f64 {
        let [e1, e2] = triangle.edges();
        let longest = e1.length().max(e2.length()).max(e1.distance(e2));
        // One part in a thousand is more than all that is rounded, here and in `new`.
        1.001 * ((triangle.area() / Self::MIN_SOLID_ANGLE).sqrt() + longest * (2.0 / 3.0))
    }

    /// What the triangle covers of the sphere, in steradians.
    pub fn solid_angle(&self) -> f64 {
        self.solid_angle
    }

    /// Density of [`SphericalTriangle::sample`] per steradian: one over the solid angle.
    pub fn pdf(&self) -> PdfSolidAngle {
        PdfSolidAngle(1.0 / self.solid_angle)
    }

    /// A point chosen uniformly by solid angle from `u` in `[0, 1)^2`, as barycentrics `(u, v)`.
    /// `u + v <= 1` but for rounding, both in `[0, 1]`.
    pub fn sample(&self, u: [f64; 2]) -> (f64, f64) {
        let (on_second, on_third) = self.cut(u[0]);
        let [a, b, c] = self.towards;
        let (on_first, on_end) = along_arc(a, on_second * b + on_third * c, u[1]);
        // The direction is a sum of the vertices' directions; divided by their distances, its
        // coefficients are those of the point.
        let on_vertices = [on_first, on_end * on_second, on_end * on_third];
        let weights: [f64; 3] = std::array::from_fn(|i| on_vertices[i] / self.distances[i]);
        let sum = weights[0] + weights[1] + weights[2];
        let of_vertex = |i: usize| weights[(3 + i - self.first) % 3] / sum;
        (of_vertex(1), of_vertex(2))
    }

    /// The unit vector on the arc from the second to the third vertex that cuts off `share` of the
    /// solid angle, on the second's side, as coefficients of these two vertices.
    ///
    /// With `T` the tangent of half the part's solid angle, `B'` the unit vector orthogonal to `B`
    /// toward `C`, and `t` the tangent of half the arc cut off, the formula is
    /// `T = t det(A, B, B') / (1 + A . B + t A . B')`.
    fn cut(&self, share: f64) -> (f64, f64) {
        let [a, b, c] = self.towards;
        let (sin, cos) = libm::sincos(0.5 * share * self.solid_angle);
        // `t = y / x`, both times the sine of the whole arc.
        let a_toward_c = a.dot(c) - self.cos_arc * a.dot(b);
        let y = sin * self.one_plus_cos * self.sin_arc;
        let x = (self.det * cos - sin * a_toward_c).max(0.0);
        let square = x * x + y * y;
        let (sin, cos) = (2.0 * x * y / square, (x - y) * (x + y) / square);
        ((cos - sin * self.cos_arc / self.sin_arc).max(0.0), sin / self.sin_arc)
    }

    /// The random numbers from which [`SphericalTriangle::sample`] makes the barycentrics `(u, v)`.
    pub fn invert(&self, u: f64, v: f64) -> [f64; 2] {
        let [a, b, c] = self.towards;
        let barycentrics = [1.0 - u - v, u, v];
        let [first, second, third] =
            [0, 1, 2].map(|i| barycentrics[(self.first + i) % 3] * self.distances[i]);
        let on_edge = second * b + third * c;
        if on_edge == DVec3::ZERO {
            return [0.0, 0.0];
        }
        let end = on_edge.normalize();
        let to = (first * a + on_edge).normalize();
        // The determinant of A, B and the end is that of A, B and C by the share of C in it.
        let det = self.det * third / on_edge.length();
        let part = 2.0 * libm::atan2(det, self.one_plus_cos + end.dot(a + b));
        [part / self.solid_angle, a.distance_squared(to) / a.distance_squared(end)]
    }
}

/// The index of that one of three unit vectors whose opposite arc is the longest.
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

/// The unit vector on the arc between two unit vectors at which `share` of the arc's height over the
/// plane orthogonal to `from` is reached, as coefficients of `from` and `to`.
fn along_arc(from: DVec3, to: DVec3, share: f64) -> (f64, f64) {
    // One minus and one plus the cosine of the arc; neither cancels.
    let (height, rest) = (0.5 * from.distance_squared(to), 0.5 * (from + to).length_squared());
    let down = share * height;
    let on_to = if height > 0.0 { (share * (2.0 - down) / rest).sqrt() } else { 0.0 };
    ((1.0 - down - (1.0 - height) * on_to).max(0.0), on_to)
}
