//! The intersection of a ray with a triangle without rounding: the reference for ray-triangle tests.
//!
//! Finite floats are rational numbers, and the intersection of a line with a plane takes only the four
//! operations of arithmetic. There is no tolerance. The method is Cramer's rule, which shares nothing with
//! the shear of the tests that are compared with it.

use dashu_ratio::Relaxed;
use glam::DVec3;
use globillum_geom::{Ray, Triangle};

/// An exact number. This type cancels powers of two only, which saves the time for common divisors. Sums and
/// products of floats have powers of two as denominators.
pub type Rational = Relaxed;

/// A vector of exact numbers.
pub type Vector = [Rational; 3];

/// The intersection of a ray's line with a triangle's plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Crossing {
    /// Ray parameter; may be negative.
    pub t: Rational,
    /// Barycentric weight of the second vertex; any sign.
    pub u: Rational,
    /// Barycentric weight of the third vertex; any sign.
    pub v: Rational,
    /// The gradients of `t`, `u` and `v` with respect to the ray's origin, on which they depend linearly.
    pub gradients: [Vector; 3],
}

/// The intersection of the ray's line with the triangle, edges and vertices included. The ray's range is
/// ignored.
///
/// `None` if the line passes the triangle, or is parallel to its plane.
///
/// # Panics
/// If a coordinate is not finite.
pub fn intersect(ray: &Ray, triangle: &Triangle) -> Option<Crossing> {
    Crossing::with_plane(ray, triangle).filter(Crossing::is_inside)
}

impl Crossing {
    /// The intersection of the ray's line with the plane of `triangle`; `None` if they are parallel, or if the
    /// vertices lie on one line.
    ///
    /// # Panics
    /// If a coordinate is not finite.
    pub fn with_plane(ray: &Ray, triangle: &Triangle) -> Option<Self> {
        let [v0, v1, v2] = triangle.vertices.map(|v| vector(v.as_dvec3()));
        let (e1, e2) = (subtract(&v1, &v0), subtract(&v2, &v0));
        // `origin - v0 = t back + u e1 + v e2`, solved by the adjugate of `[back, e1, e2]`.
        let back = vector(-ray.direction);
        let adjugate = [cross(&e1, &e2), cross(&e2, &back), cross(&back, &e1)];
        let det = dot(&back, &adjugate[0]);
        if det.is_zero() {
            return None;
        }
        let offset = subtract(&vector(ray.origin), &v0);
        let [t, u, v] = adjugate.each_ref().map(|row| dot(row, &offset) / &det);
        let gradients = adjugate.map(|row| row.map(|x| x / &det));
        Some(Self { t, u, v, gradients })
    }

    /// Whether the crossing lies in the triangle, edges and vertices included.
    pub fn is_inside(&self) -> bool {
        let zero = Rational::ZERO;
        self.u >= zero && self.v >= zero && &self.u + &self.v <= Rational::ONE
    }

    /// The point `origin + t * direction` of `ray`.
    ///
    /// # Panics
    /// If a coordinate of `ray` is not finite.
    pub fn point(&self, ray: &Ray) -> Vector {
        let (o, d) = (vector(ray.origin), vector(ray.direction));
        [0, 1, 2].map(|k| &o[k] + &self.t * &d[k])
    }
}

/// The value of a float.
///
/// # Panics
/// If `x` is not finite.
pub fn rational(x: f64) -> Rational {
    Rational::try_from(x).unwrap_or_else(|_| panic!("{x} is not a number"))
}

/// The nearest `f64`; ties round to even.
pub fn rounded(x: &Rational) -> f64 {
    x.to_f64().value()
}

/// `|computed - exact|`, computed exactly and rounded once.
///
/// # Panics
/// If `computed` is not finite.
pub fn error(computed: f64, exact: &Rational) -> f64 {
    rounded(&(rational(computed) - exact)).abs()
}

fn vector(v: DVec3) -> Vector {
    v.to_array().map(rational)
}

fn subtract(a: &Vector, b: &Vector) -> Vector {
    [0, 1, 2].map(|k| &a[k] - &b[k])
}

fn dot(a: &Vector, b: &Vector) -> Rational {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

fn cross(a: &Vector, b: &Vector) -> Vector {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| &a[i] * &b[j] - &a[j] * &b[i])
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    const CORNER: Triangle = Triangle::new(Vec3::ZERO, Vec3::X, Vec3::Y);

    fn fraction(numerator: i32, denominator: i32) -> Rational {
        Rational::from(numerator) / Rational::from(denominator)
    }

    fn ray(origin: [f64; 3], direction: [f64; 3]) -> Ray {
        Ray::new(DVec3::from(origin), DVec3::from(direction))
    }

    #[test]
    fn thirds_are_exact() {
        let triangle =
            Triangle::new(Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0));
        let ray = ray([0.0; 3], [1.0; 3]);
        let hit = intersect(&ray, &triangle).unwrap();
        assert_eq!([&hit.t, &hit.u, &hit.v], [&fraction(1, 3); 3]);
        assert_eq!(hit.point(&ray), [1, 1, 1].map(|n| fraction(n, 3)));
        // For the plane x + y + z = 1 each unit of displacement lowers t by a third.
        assert_eq!(hit.gradients[0], [-1, -1, -1].map(|n| fraction(n, 3)));
    }

    #[test]
    fn a_slanted_ray_worked_by_hand() {
        // (1, 2, 3) + t (2, -1, -4) meets z = 0 at t = 3/4, in (5/2, 5/4, 0).
        let triangle = Triangle::new(Vec3::ZERO, Vec3::new(4.0, 0.0, 0.0), Vec3::new(0.0, 5.0, 0.0));
        let hit = intersect(&ray([1.0, 2.0, 3.0], [2.0, -1.0, -4.0]), &triangle).unwrap();
        assert_eq!((hit.t, hit.u, hit.v), (fraction(3, 4), fraction(5, 8), fraction(1, 4)));
        assert_eq!(
            hit.gradients,
            [
                [fraction(0, 1), fraction(0, 1), fraction(1, 4)],
                [fraction(1, 4), fraction(0, 1), fraction(1, 8)],
                [fraction(0, 1), fraction(1, 5), fraction(-1, 20)],
            ]
        );
    }

    #[test]
    fn the_triangle_includes_its_edges_and_vertices_and_nothing_beyond() {
        let down = [0.0, 0.0, -1.0];
        for (x, y) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.5, 0.5), (0.5, 0.0), (0.0, 0.5)] {
            let hit = intersect(&ray([x, y, 1.0], down), &CORNER).unwrap();
            assert_eq!((hit.u, hit.v), (rational(x), rational(y)));
        }
        let tiny = f64::from_bits(1);
        for (x, y) in [(-tiny, 0.5), (0.5, -tiny), (0.5, 0.5_f64.next_up())] {
            assert_eq!(intersect(&ray([x, y, 1.0], down), &CORNER), None);
            assert!(Crossing::with_plane(&ray([x, y, 1.0], down), &CORNER).is_some());
        }
    }

    #[test]
    fn a_line_in_or_along_the_plane_does_not_cross_it() {
        assert_eq!(Crossing::with_plane(&ray([-1.0, 0.25, 0.0], [1.0, 0.0, 0.0]), &CORNER), None);
        assert_eq!(Crossing::with_plane(&ray([-1.0, 0.25, 2.0], [1.0, 3.0, 0.0]), &CORNER), None);
        let line = Triangle::new(Vec3::ZERO, Vec3::ONE, Vec3::splat(3.0));
        assert_eq!(Crossing::with_plane(&ray([0.0; 3], [1.0, 2.0, 3.0]), &line), None);
    }

    #[test]
    fn every_float_survives_the_round_trip() {
        for x in [0.0, 1.0, -0.1, f64::MAX, f64::MIN_POSITIVE, f64::from_bits(1), -f64::from_bits(0xf_ffff)] {
            assert_eq!(rounded(&rational(x)), x);
            assert_eq!(error(x, &rational(x)), 0.0);
        }
        assert_eq!(rounded(&fraction(1, 3)), 1.0 / 3.0);
        assert_eq!(error(1.0, &fraction(1, 3)), 2.0 / 3.0);
    }
}
