//! Bounds of the segments in which eight rays may hit anything. Triangles outside are left out.

use crate::accel::wide::simd::{LANES, Simd, SimdBase, SimdFloat};
use crate::accel::wide::trace::ray_setup::RaySetups;
use crate::accel::wide::tree::projected_triangle::BoundsColumns;

/// By how much bounds are widened, in units of a ray's `t_err` (docs/numerics.md).
const BOUNDS_ERR: f32 = 2.0;
/// At this parameter a ray has left the scene, which is 2 wide.
const PARAMETER_OUTSIDE_SCENE: f32 = 3.0;

/// A box that holds whatever eight rays may hit.
pub(super) struct SegmentBounds<S: Simd> {
    min: [S::F; 3],
    max: [S::F; 3],
}

impl<S: Simd> SegmentBounds<S> {
    /// The bounds of the rays in the mask `may_hit`: empty if there are none, and infinite if the error of one is.
    #[inline(always)]
    pub(super) fn of(simd: S, rays: &RaySetups<LANES>, may_hit: u8) -> Self {
        let err = simd.load(&rays.t_err) * BOUNDS_ERR;
        // Finite: infinity times a component of zero would be NaN.
        let end = simd.load(&rays.end).min(simd.splat(PARAMETER_OUTSIDE_SCENE));
        let (mut min, mut max) = ([simd.splat(0.0); 3], [simd.splat(0.0); 3]);
        for axis in 0..3 {
            let from = simd.load(&rays.origin[axis]);
            let to = end.mul_add(simd.load(&rays.direction[axis]), from);
            min[axis] = simd.splat(simd.min_of(from.min(to) - err, may_hit));
            max[axis] = simd.splat(-simd.min_of(-(from.max(to) + err), may_hit));
        }
        Self { min, max }
    }

    /// Which of up to 64 triangles overlap these bounds, a bit each, by the triangles' bounds.
    #[inline(always)]
    pub(super) fn overlap(&self, simd: S, of_triangles: &[BoundsColumns]) -> u64 {
        let mut overlap = 0;
        for (i, bounds) in of_triangles.iter().enumerate() {
            let mut apart = 0;
            for axis in 0..3 {
                apart |= simd.lt(self.max[axis], simd.load(&bounds.min[axis]));
                apart |= simd.lt(simd.load(&bounds.max[axis]), self.min[axis]);
            }
            overlap |= u64::from(!apart) << (i * LANES % 64);
        }
        overlap
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::wide::simd::Bits;
    use crate::accel::wide::trace::exhaustive::random_rays::{ray, triangle};
    use crate::accel::wide::tree::normalize::NormalizedSpace;
    use crate::accel::wide::tree::projected_triangle::ProjectedTriangles;
    use crate::conformance::{Seeded, Source};
    use crate::cpu::portable;
    use crate::decide::Shear;
    use crate::{Aabb, Ray, Triangle, Triangles};
    use glam::{DVec3, Vec3};

    /// The setups of eight rays, and the mask of those that may hit anything.
    fn set(rays: &[Ray; LANES], bounds: &Aabb, space: &NormalizedSpace) -> (RaySetups<LANES>, u8) {
        let mut setups = RaySetups::idle();
        setups.set_for_projected(&portable().columns(rays), bounds, space);
        let may_hit = (0..LANES).map(|i| u8::from(setups.may_hit[i]) << i).sum();
        (setups, may_hit)
    }

    /// The bounds of each triangle, in lane 0 of columns of its own.
    fn columns(triangles: &[Triangle], space: &NormalizedSpace) -> Vec<BoundsColumns> {
        let of_one = |triangle: &Triangle| {
            let projected = ProjectedTriangles::of_few(&Triangles::new(vec![*triangle]).unwrap(), space);
            *projected.by_axes().find_map(|(_, of_axis)| of_axis.bounds.first()).unwrap()
        };
        triangles.iter().map(of_one).collect()
    }

    /// Rays that hit a triangle by the exact decision, some at the very end of their range, and triangles that are parallel
    /// to an axis plane, whose bounds are flat. Most other triangles are left out.
    #[test]
    fn what_is_left_out_is_not_hit() {
        let (mut source, mut hits, mut kept, mut tests) = (Seeded::new(79), 0, 0, 0);
        for (scale, center) in [(1.0, DVec3::ZERO), (1e-6, DVec3::ZERO), (2e6, DVec3::new(-4e6, 1e6, 2e6))] {
            let placed = |v: Vec3| (scale * v.as_dvec3() + center).as_vec3();
            let bounds = Aabb { min: placed(Vec3::NEG_ONE), max: placed(Vec3::ONE) };
            let space = NormalizedSpace::new(&bounds);
            for _ in 0..10_000 {
                let mut here = triangle(&mut source);
                let flat = source.below(4);
                if flat < 3 {
                    let height = here.vertices[0][flat];
                    here.vertices.iter_mut().for_each(|vertex| vertex[flat] = height);
                }
                let there = Triangle { vertices: here.vertices.map(placed) };
                let Some(first) = aimed(&mut source, &here, &there, |ray| Ray {
                    origin: scale * ray.origin + center,
                    direction: scale * ray.direction,
                    ..ray
                }) else {
                    continue;
                };
                let (setups, may_hit) = set(&[first; LANES], &bounds, &space);
                let others = [0, 1, 2].map(|_| triangle(&mut source).vertices.map(placed));
                let others = others.map(|vertices| Triangle { vertices });
                let columns = columns(&[&[there][..], &others].concat(), &space);
                let overlap = SegmentBounds::of(portable(), &setups, may_hit).overlap(portable(), &columns);
                assert!(overlap & 1 != 0, "{there:?} {first:?}");
                hits += 1;
                kept += Bits(overlap & 0x0101_0100).count();
                tests += others.len();
            }
        }
        assert!(hits > 10_000 && kept > 0 && 2 * kept < tests, "{hits} hits, {kept} of {tests} others kept");
    }

    /// A ray that hits `there`, the image of `here`. Its range ends there with a probability of a half.
    fn aimed(
        source: &mut Seeded,
        here: &Triangle,
        there: &Triangle,
        image: impl Fn(Ray) -> Ray,
    ) -> Option<Ray> {
        let ray = image(ray(source, here));
        let t = Shear::new(&ray)?.decide(there)?.t;
        let is_hit = ray.t_min < t && t < ray.t_max;
        is_hit.then(|| if source.below(2) == 0 { ray.with_range(0.0, t.next_up()) } else { ray })
    }

    /// A triangle at the far side of the scene, and bounds of rays that hit it, miss it, or are not known well enough.
    #[test]
    fn bounds_end_where_rays_do() {
        // Nearly as large in normalised space as a scene can be.
        let bounds = Aabb { min: Vec3::splat(-1.9), max: Vec3::splat(1.9) };
        let space = NormalizedSpace::new(&bounds);
        let [a, b, c] = [Vec3::new(1.8, -0.5, -0.5), Vec3::new(1.8, 0.5, -0.5), Vec3::new(1.8, 0.0, 0.5)];
        let columns = columns(&[Triangle::new(a, b, c)], &space);
        let across = Ray::new(DVec3::new(-1.9, 0.0, 0.0), DVec3::X);
        // It ends before the triangle, and passes below: it brings the bounds to the triangle along no axis but z.
        let short = Ray::new(DVec3::new(-1.9, -0.8, 0.0), DVec3::X).with_range(0.0, 3.6);
        let untraceable = Ray::new(DVec3::splat(f64::NAN), DVec3::X);
        let aside = Ray::new(DVec3::splat(3.0), DVec3::NEG_X);
        // Rounding moves it by more than the scene.
        let far = Ray::new(DVec3::new(-1e17, 0.0, 0.0), DVec3::X);
        let overlap = |others: [Ray; 2]| {
            let mut rays = [short; LANES];
            (rays[2], rays[5]) = (others[0], others[1]);
            let (setups, may_hit) = set(&rays, &bounds, &space);
            SegmentBounds::of(portable(), &setups, may_hit).overlap(portable(), &columns) & 1
        };
        assert_eq!(overlap([short, short]), 0);
        assert_eq!(overlap([short, across]), 1);
        assert_eq!(overlap([untraceable, aside]), 0, "rays that hit nothing have no bounds");
        assert_eq!(overlap([untraceable, far]), 1);
        let (setups, may_hit) = set(&[aside; LANES], &bounds, &space);
        assert_eq!(may_hit, 0);
        assert_eq!(SegmentBounds::of(portable(), &setups, may_hit).overlap(portable(), &columns), 0);
    }
}
