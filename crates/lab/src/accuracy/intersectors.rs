//! The library's exact decision and two well-known tests in `f32`, behind one trait.
//!
//! All accept edges and vertices, have no epsilon and ignore the ray's range.

use glam::Vec3;
use globillum::geom::decide::{Intersection, Shear};
use globillum::geom::{Ray, Triangle};
use globillum_testkit::precision::Precision;

/// A ray prepared for intersection tests with many triangles.
pub(crate) trait Intersector: Sized {
    /// The name in tables.
    const NAME: &'static str;
    /// The precision of the arithmetic; the ray is rounded to it.
    const PRECISION: Precision;

    /// The precomputation per ray; `None` if the ray cannot hit anything.
    fn prepare(ray: &Ray) -> Option<Self>;

    /// The intersection of the ray's line with `triangle`.
    fn intersect(&self, triangle: &Triangle) -> Option<Intersection>;
}

impl Intersector for Shear {
    const NAME: &'static str = "globillum, f64";
    const PRECISION: Precision = Precision::Double;

    fn prepare(ray: &Ray) -> Option<Self> {
        Self::new(ray)
    }

    #[inline]
    fn intersect(&self, triangle: &Triangle) -> Option<Intersection> {
        self.decide(triangle)
    }
}

/// Möller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection" (JGT 2(1), 1997), both
/// sides, in `f32`: Cramer's rule. Only a determinant of exactly zero is rejected.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MoellerTrumbore {
    origin: Vec3,
    direction: Vec3,
}

impl Intersector for MoellerTrumbore {
    const NAME: &'static str = "Möller-Trumbore, f32";
    const PRECISION: Precision = Precision::Single;

    fn prepare(ray: &Ray) -> Option<Self> {
        Some(Self { origin: ray.origin.as_vec3(), direction: ray.direction.as_vec3() })
    }

    #[inline]
    fn intersect(&self, triangle: &Triangle) -> Option<Intersection> {
        let [v0, v1, v2] = triangle.vertices;
        let (e1, e2) = (v1 - v0, v2 - v0);
        let p = self.direction.cross(e2);
        let det = e1.dot(p);
        if det == 0.0 {
            return None;
        }
        let inverse = 1.0 / det;
        let s = self.origin - v0;
        let u = s.dot(p) * inverse;
        if !(0.0..=1.0).contains(&u) {
            return None;
        }
        let q = s.cross(e1);
        let v = self.direction.dot(q) * inverse;
        if v < 0.0 || u + v > 1.0 {
            return None;
        }
        Some(widen(e2.dot(q) * inverse, u, v))
    }
}

/// Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection" (JCGT 2(1), 2013), both sides,
/// in `f32`, without the paper's second evaluation in `f64` where an edge function is zero.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Woop {
    origin: [f32; 3],
    axes: [usize; 3],
    shear: [f32; 3],
}

impl Intersector for Woop {
    const NAME: &'static str = "Woop et al., f32";
    const PRECISION: Precision = Precision::Single;

    fn prepare(ray: &Ray) -> Option<Self> {
        let d = ray.direction.as_vec3();
        let kz = d.abs().max_position();
        let (kx, ky) = ((kz + 1) % 3, (kz + 2) % 3);
        // A direction against the axis swaps left and right.
        let [kx, ky] = if d[kz] < 0.0 { [ky, kx] } else { [kx, ky] };
        let shear = [d[kx] / d[kz], d[ky] / d[kz], 1.0 / d[kz]];
        Some(Self { origin: ray.origin.as_vec3().to_array(), axes: [kx, ky, kz], shear })
    }

    #[inline]
    fn intersect(&self, triangle: &Triangle) -> Option<Intersection> {
        let [a, b, c] = triangle.vertices.map(|v| self.project(v.to_array()));
        let (u, v, w) = (c.x * b.y - c.y * b.x, a.x * c.y - a.y * c.x, b.x * a.y - b.y * a.x);
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let det = u + v + w;
        if det == 0.0 {
            return None;
        }
        let inverse = 1.0 / det;
        Some(widen((u * a.z + v * b.z + w * c.z) * inverse, v * inverse, w * inverse))
    }
}

impl Woop {
    #[inline]
    fn project(&self, vertex: [f32; 3]) -> Vec3 {
        let [sx, sy, sz] = self.shear;
        let [x, y, z] = self.axes.map(|k| vertex[k] - self.origin[k]);
        Vec3::new(x - sx * z, y - sy * z, sz * z)
    }
}

fn widen(t: f32, u: f32, v: f32) -> Intersection {
    Intersection { t: f64::from(t), u: f64::from(u), v: f64::from(v) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn meet<I: Intersector>(ray: &Ray, triangle: &Triangle) -> Option<[f64; 3]> {
        I::prepare(ray)?.intersect(triangle).map(|i| [i.t, i.u, i.v])
    }

    /// Coordinates are small integers and quarters, so that no operation rounds.
    fn assert_exact<I: Intersector>() {
        let corner = Triangle::new(Vec3::ZERO, Vec3::X * 4.0, Vec3::Y * 4.0);
        for (x, y, z) in [(1.0, 2.0, 2.0), (0.0, 0.0, 2.0), (4.0, 0.0, -2.0), (2.0, 2.0, -4.0)] {
            let ray = Ray::new(DVec3::new(x, y, z), DVec3::new(0.0, 0.0, -z));
            assert_eq!(meet::<I>(&ray, &corner), Some([1.0, x / 4.0, y / 4.0]), "{}", I::NAME);
            let away = Ray::new(ray.origin, -2.0 * ray.direction);
            assert_eq!(meet::<I>(&away, &corner), Some([-0.5, x / 4.0, y / 4.0]), "{}", I::NAME);
        }
        let slanted = Ray::new(DVec3::new(-1.0, 3.0, 8.0), DVec3::new(0.5, -0.25, -1.0) * 2.0);
        assert_eq!(meet::<I>(&slanted, &corner), Some([4.0, 0.75, 0.25]), "{}", I::NAME);
        for outside in [DVec3::new(-0.25, 1.0, 1.0), DVec3::new(1.0, -0.25, 1.0), DVec3::new(2.0, 2.25, 1.0)]
        {
            assert_eq!(meet::<I>(&Ray::new(outside, -DVec3::Z), &corner), None, "{}", I::NAME);
        }
        assert_eq!(meet::<I>(&Ray::new(DVec3::new(-1.0, 1.0, 0.0), DVec3::X), &corner), None, "{}", I::NAME);
    }

    #[test]
    fn all_agree_where_nothing_rounds() {
        assert_exact::<MoellerTrumbore>();
        assert_exact::<Woop>();
        assert_exact::<Shear>();
    }
}
