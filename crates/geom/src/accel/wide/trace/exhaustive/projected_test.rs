//! The conservative test of one triangle and eight rays: where each ray crosses the triangle's plane, and the barycentric
//! coordinates of that point, with bounds of their errors (docs/numerics.md).

use crate::accel::wide::simd::{LANES, Simd, SimdBase, SimdFloat};
use crate::accel::wide::trace::prefilter::Filtered;
use crate::accel::wide::trace::ray_setup::RaySetups;
use crate::accel::wide::tree::projected_triangle::ProjectedTriangle;

/// The error of a parameter, in units of a ray's `t_err` divided by the rate at which it approaches the plane.
const PLANE_ERR: f32 = 7.0;
/// The error of a barycentric coordinate at a known parameter, in units of `t_err` times the steepness.
const POINT_ERR: f32 = 4.0;
/// What an error of the parameter adds to that of a coordinate, in units of it times the steepness. 2 is a bound; with 2.5
/// the error becomes infinite before a coordinate does.
const PLANE_TO_POINT: f32 = 2.5;

/// Eight rays, ready for triangles that are projected along one axis.
pub(super) struct ProjectedTest<S: Simd> {
    origin: [S::F; 3],
    direction: [S::F; 3],
    plane_err: S::F,
    point_err: S::F,
    limit: S::F,
    range_end: S::F,
}

/// Where rays cross the plane of a triangle.
struct Crossing<S: Simd> {
    t: S::F,
    t_err: S::F,
    /// The least of the three barycentric coordinates.
    least: S::F,
    err: S::F,
}

impl<S: Simd> ProjectedTest<S> {
    /// Prepares the rays for triangles with these `axes`: two across, and last the one along which they are projected.
    #[inline(always)]
    pub(super) fn new(simd: S, rays: &RaySetups<LANES>, axes: [u8; 3]) -> Self {
        let [x, y, z] = axes.map(|axis| usize::from(axis) % 3);
        let along = |numbers: &[[f32; LANES]; 3]| {
            [simd.load(&numbers[x]), simd.load(&numbers[y]), simd.load(&numbers[z])]
        };
        let t_err = simd.load(&rays.t_err);
        Self {
            origin: along(&rays.origin),
            direction: along(&rays.direction),
            plane_err: t_err * PLANE_ERR,
            point_err: t_err * POINT_ERR,
            limit: simd.load(&rays.end),
            range_end: simd.load(&rays.range_end),
        }
    }

    /// Which of the rays may hit the triangle, and which certainly do.
    #[inline(always)]
    pub(super) fn filter(&self, simd: S, triangle: &ProjectedTriangle) -> Filtered {
        let Crossing { t, t_err, least, err } = self.crossing(simd, triangle);
        let (start, end, zero) = (t - t_err, t + t_err, simd.splat(0.0));
        // Comparisons with NaN are false: where an error is unbounded, a hit is possible.
        let missed = simd.lt(least, -err) | simd.lt(self.limit, start) | simd.lt(end, zero);
        let inside = simd.lt(err, least) & simd.lt(zero, start) & simd.lt(end, self.range_end);
        let (start, end) = (start.to_array(), end.to_array());
        Filtered { possible: !missed, certain: inside & !missed, start, end }
    }

    #[inline(always)]
    fn crossing(&self, simd: S, triangle: &ProjectedTriangle) -> Crossing<S> {
        let [distance, rate] = self.along(simd, triangle.plane);
        let inverse = simd.splat(-1.0) / (rate + self.direction[2]);
        let t = (distance + self.origin[2]) * inverse;
        let t_err = self.plane_err * inverse.abs();
        let ([u, u_rate], [v, v_rate]) = (self.along(simd, triangle.u), self.along(simd, triangle.v));
        let (u, v) = (t.mul_add(u_rate, u), t.mul_add(v_rate, v));
        let least = u.min(v).min(simd.splat(1.0) - u - v);
        let err = (t_err * PLANE_TO_POINT + self.point_err) * triangle.steepness;
        Crossing { t, t_err, least, err }
    }

    /// The value of `a x + b y + c` at the rays' origins, and the rates at which it changes along them.
    #[inline(always)]
    fn along(&self, simd: S, [a, b, c]: [f32; 3]) -> [S::F; 2] {
        let (a, b) = (simd.splat(a), simd.splat(b));
        let ([x, y, _], [dx, dy, _]) = (self.origin, self.direction);
        [a.mul_add(x, b.mul_add(y, simd.splat(c))), a.mul_add(dx, b * dy)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::wide::simd::Bits;
    use crate::accel::wide::trace::exhaustive::random_rays::{ray, triangle, vector};
    use crate::accel::wide::tree::normalize::NormalizedSpace;
    use crate::conformance::Seeded;
    use crate::cpu::portable;
    use crate::decide::{AXES, Shear};
    use crate::{Aabb, Ray, Triangle, Triangles};
    use glam::{DVec3, Vec3};

    /// The exact decision agrees where the test is certain of a hit or a miss, which is often.
    #[test]
    fn what_is_certain_is_true() {
        let (mut source, mut counts) = (Seeded::new(77), [0; 3]);
        for (scale, center) in [(1.0, DVec3::ZERO), (1e-6, DVec3::ZERO), (2e6, DVec3::new(-4e6, 1e6, 2e6))] {
            let placed = |v: Vec3| (scale * v.as_dvec3() + center).as_vec3();
            let bounds = Aabb { min: placed(Vec3::NEG_ONE), max: placed(Vec3::ONE) };
            let space = NormalizedSpace::new(&bounds);
            for _ in 0..20_000 {
                let here = triangle(&mut source);
                let there = Triangle { vertices: here.vertices.map(placed) };
                let rays: [Ray; LANES] = std::array::from_fn(|_| {
                    let ray = ray(&mut source, &here);
                    Ray { origin: scale * ray.origin + center, direction: scale * ray.direction, ..ray }
                });
                let mut setups = RaySetups::idle();
                setups.set_for_projected(&portable().columns(&rays), &bounds, &space);
                let triangles = Triangles::new(vec![there]).expect("a valid triangle");
                let (axis, projected) = ProjectedTriangle::new(&triangles, 0, &space);
                let filtered =
                    ProjectedTest::new(portable(), &setups, AXES[axis]).filter(portable(), &projected);
                for i in Bits(0xff).filter(|&i| setups.may_hit[i]) {
                    let decided = Shear::new(&rays[i]).and_then(|shear| shear.decide(&there));
                    let is_hit = decided.is_some_and(|hit| rays[i].t_min < hit.t && hit.t < rays[i].t_max);
                    let (is_possible, is_certain) = (filtered.possible >> i & 1, filtered.certain >> i & 1);
                    assert!(is_possible == 1 || !is_hit, "missed: {there:?} {:?}", rays[i]);
                    assert!(is_certain == 0 || is_hit, "certain: {there:?} {:?}", rays[i]);
                    counts[usize::from(is_possible + is_certain)] += 1;
                }
            }
        }
        assert!(counts.iter().all(|count| *count > 30_000), "missed, possible and certain: {counts:?}");
    }

    /// Random errors reach a thirtieth of the bound of a parameter and a ninetieth of that of a coordinate.
    #[test]
    fn errors_are_within_their_bounds() {
        let (bounds, mut source) = (Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE }, Seeded::new(78));
        let (space, mut most) = (NormalizedSpace::new(&bounds), [0.0_f64; 2]);
        for _ in 0..20_000 {
            let triangle = triangle(&mut source);
            let rays: [Ray; LANES] = std::array::from_fn(|_| {
                let (origin, toward) =
                    (vector(&mut source), triangle.vertices[0].as_dvec3() + 0.3 * vector(&mut source));
                Ray::new(origin, toward - origin)
            });
            let mut setups = RaySetups::idle();
            setups.set_for_projected(&portable().columns(&rays), &bounds, &space);
            let triangles = Triangles::new(vec![triangle]).expect("a valid triangle");
            let (axis, projected) = ProjectedTriangle::new(&triangles, 0, &space);
            let test = ProjectedTest::new(portable(), &setups, AXES[axis]);
            let Crossing { t, t_err, least, err } = test.crossing(portable(), &projected);
            let [a, b, c] = triangle.vertices.map(|vertex| vertex.as_dvec3());
            let normal = (b - a).cross(c - a);
            for (i, ray) in rays.iter().enumerate() {
                let exact = (a - ray.origin).dot(normal) / ray.direction.dot(normal);
                let at = ray.at(exact);
                if !(0.0..1e3).contains(&exact) || at.abs().max_element() > 1.0 {
                    continue;
                }
                let area = |p: DVec3, q: DVec3| (p - at).cross(q - at).dot(normal) / normal.length_squared();
                let coordinate = area(a, b).min(area(b, c)).min(area(c, a));
                // Parameters of normalised space: the origin is in the scene, where ranges begin.
                let largest = ray.direction.abs().max_element();
                let gain = space.scale * 2.0_f64.powf(largest.log2().floor());
                let number = |x: &[f32; LANES]| f64::from(x[i]);
                let t_ratio = (number(&t.to_array()) - exact * gain).abs() / number(&t_err.to_array());
                let ratio = (number(&least.to_array()) - coordinate).abs() / number(&err.to_array());
                most = [most[0].max(t_ratio), most[1].max(ratio)];
            }
        }
        assert!(
            most.iter().all(|ratio| (0.01..1.0).contains(ratio)),
            "the largest errors, in units of bounds: {most:?}"
        );
    }

    /// Triangles that are too thin or too steep for `f32`, with rays that hit them.
    #[test]
    fn unknown_triangles_may_be_hit() {
        let needle = Triangle::new(
            Vec3::new(1.4135782e15, 1.3727165e16, -4.2575255e16),
            Vec3::new(1.0, -8.315656e-12, 1.0),
            Vec3::new(-1.3404871e-33, 0.008066259, -7.8628056e-38),
        );
        let steep = Triangle::new(
            Vec3::new(6.373298e-29, -6.943522e-22, 1.3613988e-36),
            Vec3::new(1.0, 2.383237e-7, -3.843551e-21),
            Vec3::new(1.6816788e-22, 1.0773531e-29, 9.1448824e-26),
        );
        let through_needle = Ray::new(
            DVec3::new(75268219549132.88, 730924774890415.0, -2266987228978740.0),
            DVec3::new(-59255101501415.734, -730924774890414.4, 1908668033843464.0),
        );
        let through_steep = Ray::new(
            DVec3::new(0.8666541292961818, 2.065442128422412e-7, -3.3310255499864105e-21),
            DVec3::new(-0.45266754114991736, 1.5084136153808248e16, 0.9264963921858683),
        );
        let far = Aabb { min: Vec3::splat(-1e18), max: Vec3::splat(1e18) };
        let tall = Aabb { min: Vec3::splat(-1e-16), max: Vec3::new(1.0, 2.0521627e17, 1.0) };
        for (triangle, ray, bounds) in [(needle, through_needle, far), (steep, through_steep, tall)] {
            let is_hit =
                Shear::new(&ray).and_then(|shear| shear.decide(&triangle)).is_some_and(|hit| hit.t > 0.0);
            assert!(is_hit, "{triangle:?}");
            let space = NormalizedSpace::new(&bounds);
            let mut setups = RaySetups::idle();
            setups.set_for_projected(&portable().columns(&[ray; LANES]), &bounds, &space);
            let (axis, projected) =
                ProjectedTriangle::new(&Triangles::new(vec![triangle]).unwrap(), 0, &space);
            let filtered = ProjectedTest::new(portable(), &setups, AXES[axis]).filter(portable(), &projected);
            assert_eq!((filtered.possible, filtered.certain), (0xff, 0), "{triangle:?}");
        }
    }
}
