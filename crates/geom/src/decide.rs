//! The one decision whether a ray meets a triangle, and where.
//!
//! Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection" (JCGT 2(1), 2013): the ray is
//! sheared onto the z axis, and three edge functions tell whether the origin lies inside the
//! projected triangle. All in `f64`, on `f32` vertices.
//!
//! Why it is watertight: each vertex is projected by the same arithmetic for every triangle that
//! shares it, and the sign of an edge function is never wrong about those projected points, at
//! worst zero, and zero counts as inside. So what a closed mesh covers before rounding, its
//! projected triangles still cover after it, edges and vertices included.
//!
//! Every accelerator calls this routine, so all agree to the bit. It is inlined everywhere, so that a
//! traversal compiled for fused multiply-adds has them here as well; they give the same bits without.

use crate::exact::difference_of_products;
use crate::{Ray, Triangle};
use glam::DVec3;

/// What a ray and a triangle have in common, before any range is considered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intersection {
    /// Ray parameter; may be negative.
    pub t: f64,
    /// Barycentric weight of the second vertex, in `[0, 1]`.
    pub u: f64,
    /// Barycentric weight of the third vertex, in `[0, 1]`.
    pub v: f64,
}

/// A ray made ready for [`Shear::decide`]: the map that takes it to the z axis.
#[derive(Clone, Copy, Debug)]
pub struct Shear {
    /// Components are permuted so that the ray's main axis is z.
    main_axis: usize,
    origin: DVec3,
    slope_x: f64,
    slope_y: f64,
    direction_z: f64,
}

/// A point seen along the ray: offset from the ray's line, and depth along its main axis.
#[derive(Clone, Copy)]
struct Sheared {
    x: f64,
    y: f64,
    z: f64,
}

/// Ratios and origin coordinates below this are zero: no `f32` vertex can tell the difference
/// (its coordinates are multiples of `2^-149`), and no product in [`Shear::decide`] underflows.
const NEGLIGIBLE: f64 = f64::from_bits((1023 - 200) << 52);

impl Shear {
    /// Prepares `ray`; `None` if it is not [traceable](Ray::is_traceable).
    #[inline(always)]
    pub fn new(ray: &Ray) -> Option<Self> {
        if !ray.is_traceable() {
            return None;
        }
        Some(Self::of_traceable(ray))
    }

    /// Prepares a ray that is known to be traceable.
    #[inline(always)]
    pub(crate) fn of_traceable(ray: &Ray) -> Self {
        let main_axis = main_axis(ray.direction);
        Self::of_permuted(main_axis, permute(ray.origin, main_axis), permute(ray.direction, main_axis))
    }

    /// Prepares a traceable ray, given by components in such an order that the one along `main_axis`
    /// comes last.
    #[inline(always)]
    pub(crate) fn of_permuted(main_axis: usize, origin: DVec3, direction: DVec3) -> Self {
        let DVec3 { x, y, z } = direction;
        Self::of_slopes(main_axis, origin, [x / z, y / z], z)
    }

    /// The same for a direction given by what it goes along x and y for each unit along z, and along z.
    #[inline(always)]
    pub(crate) fn of_slopes(main_axis: usize, origin: DVec3, [x, y]: [f64; 2], direction_z: f64) -> Self {
        let origin = origin.map(flush);
        Self { main_axis, origin, slope_x: flush(x), slope_y: flush(y), direction_z }
    }

    /// Where the ray's line meets `triangle`, edges and vertices included.
    ///
    /// `None` if it passes outside, or within the triangle's plane. Meeting means that the three
    /// edge functions of the projected vertices, as exact numbers, do not differ in sign.
    ///
    /// With `u = 2^-53` and `P` the largest coordinate distance from the origin to a vertex, the
    /// answer is that of a parallel ray displaced by at most `6 u P` along each of the two axes
    /// across the main axis, up to `12 u` of the largest depth in `t` and `7 u` in the
    /// barycentrics. Seen edge-on, a small displacement can be a large difference in `t`.
    #[inline(always)]
    pub fn decide(&self, triangle: &Triangle) -> Option<Intersection> {
        let [a, b, c] = self.project_triangle(triangle);
        // A plain difference of rounded products has the right sign or is zero: enough to turn
        // away nearly all triangles before the careful evaluation.
        if differ_in_sign(c.x * b.y - c.y * b.x, a.x * c.y - a.y * c.x, b.x * a.y - b.y * a.x) {
            return None;
        }
        let (intersection, is_met) = self.evaluate([a, b, c]);
        is_met.then_some(intersection)
    }

    /// [`Shear::decide`] for a triangle that is likely met. Nothing is turned away early: that branch would
    /// be mispredicted.
    #[inline(always)]
    pub(crate) fn decide_likely(&self, triangle: &Triangle) -> Option<Intersection> {
        let (intersection, is_met) = self.evaluate(self.project_triangle(triangle));
        is_met.then_some(intersection)
    }

    /// [`Shear::decide`] for vertices whose components are permuted as the ray's are: the intersection,
    /// and whether there is one. Without a branch, so that the compiler decides several at once.
    #[inline(always)]
    pub(crate) fn decide_permuted(&self, vertices: [DVec3; 3]) -> (Intersection, bool) {
        self.evaluate(self.project_all(vertices))
    }

    #[inline(always)]
    fn evaluate(&self, [a, b, c]: [Sheared; 3]) -> (Intersection, bool) {
        let e0 = difference_of_products(c.x, b.y, c.y, b.x);
        let e1 = difference_of_products(a.x, c.y, a.y, c.x);
        let e2 = difference_of_products(b.x, a.y, b.y, a.x);
        let det = e0 + e1 + e2;
        let is_met = !differ_in_sign(e0, e1, e2) & (det != 0.0);
        let depth = (e0 * a.z + e1 * b.z + e2 * c.z) / det;
        // Adding zero turns a negative zero positive, so that its sign carries no accident.
        let t = depth / self.direction_z + 0.0;
        (Intersection { t, u: e1 / det + 0.0, v: e2 / det + 0.0 }, is_met)
    }

    #[inline(always)]
    fn project_triangle(&self, triangle: &Triangle) -> [Sheared; 3] {
        self.project_all(triangle.vertices.map(|v| permute(v.as_dvec3(), self.main_axis)))
    }

    #[inline(always)]
    fn project_all(&self, [a, b, c]: [DVec3; 3]) -> [Sheared; 3] {
        [self.project(a), self.project(b), self.project(c)]
    }

    #[inline(always)]
    fn project(&self, vertex: DVec3) -> Sheared {
        let DVec3 { x, y, z } = vertex - self.origin;
        Sheared { x: x - self.slope_x * z, y: y - self.slope_y * z, z }
    }
}

/// The components in cyclic order, so that the one along `main_axis` comes last.
#[inline(always)]
pub(crate) fn permute(v: DVec3, main_axis: usize) -> DVec3 {
    let pick = |if_0: f64, if_1: f64, if_2: f64| {
        let otherwise = if main_axis == 1 { if_1 } else { if_2 };
        if main_axis == 0 { if_0 } else { otherwise }
    };
    DVec3::new(pick(v.y, v.z, v.x), pick(v.z, v.x, v.y), pick(v.x, v.y, v.z))
}

#[inline(always)]
fn differ_in_sign(a: f64, b: f64, c: f64) -> bool {
    ((a < 0.0) | (b < 0.0) | (c < 0.0)) & ((a > 0.0) | (b > 0.0) | (c > 0.0))
}

/// The axis of the largest component in magnitude, the first of equals.
#[inline(always)]
pub(crate) fn main_axis(d: DVec3) -> usize {
    let d = d.abs();
    if d.x >= d.y && d.x >= d.z {
        0
    } else if d.y >= d.z {
        1
    } else {
        2
    }
}

#[inline(always)]
fn flush(x: f64) -> f64 {
    // The sum turns a negative zero positive.
    if x.abs() < NEGLIGIBLE { 0.0 } else { x + 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use proptest::prelude::*;

    fn decide(origin: DVec3, direction: DVec3, triangle: &Triangle) -> Option<Intersection> {
        Shear::new(&Ray::new(origin, direction))?.decide(triangle)
    }

    const CORNER: Triangle = Triangle::new(Vec3::ZERO, Vec3::X, Vec3::Y);

    #[test]
    fn both_sides_edges_and_vertices_are_met() {
        for (x, y) in [(0.25, 0.25), (0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.5, 0.5), (0.5, 0.0)] {
            let front = decide(DVec3::new(x, y, 2.0), -DVec3::Z, &CORNER).unwrap();
            assert_eq!((front.t, front.u, front.v), (2.0, x, y));
            let back = decide(DVec3::new(x, y, -2.0), DVec3::Z, &CORNER).unwrap();
            assert_eq!(back, front);
        }
        assert_eq!(decide(DVec3::new(-1e-300, 0.5, 1.0), -DVec3::Z, &CORNER).map(|i| i.t), Some(1.0));
        assert_eq!(decide(DVec3::new(-1e-50, 0.5, 1.0), -DVec3::Z, &CORNER), None);
    }

    #[test]
    fn an_edge_on_triangle_is_missed() {
        assert_eq!(decide(DVec3::new(-1.0, 0.25, 0.0), DVec3::X, &CORNER), None);
        assert_eq!(decide(DVec3::ZERO, DVec3::new(1.0, 0.3, 0.0), &CORNER), None);
    }

    proptest! {
        #[test]
        fn scaling_the_direction_scales_t_exactly(
            o in prop::array::uniform3(-2.0..2.0f64), u in 0.0..0.5f64, v in 0.0..0.5f64, k in -500..=500i32,
        ) {
            let origin = DVec3::from(o);
            let direction = DVec3::new(u, v, 0.0) - origin;
            let scale = 2.0_f64.powi(k);
            let plain = decide(origin, direction, &CORNER);
            let scaled = decide(origin, direction * scale, &CORNER);
            prop_assert_eq!(plain.map(|i| Intersection { t: i.t / scale, ..i }), scaled);
        }

        /// The order in which a triangle's vertices are named changes no verdict.
        #[test]
        fn relabelling_vertices_changes_no_verdict(
            c in prop::array::uniform9(-3i8..=3), o in prop::array::uniform3(-3i8..=3), d in prop::array::uniform3(-2i8..=2),
        ) {
            let c = c.map(f32::from);
            let [v0, v1, v2] = [0, 3, 6].map(|i| Vec3::new(c[i], c[i + 1], c[i + 2]));
            let (o, d) = (DVec3::from(o.map(f64::from)), DVec3::from(d.map(f64::from)));
            let verdicts = [[v0, v1, v2], [v1, v2, v0], [v2, v1, v0]]
                .map(|[a, b, c]| decide(o, d, &Triangle::new(a, b, c)).is_some());
            prop_assert!(verdicts[0] == verdicts[1] && verdicts[1] == verdicts[2]);
            let triangle = Triangle::new(v0, v1, v2);
            let likely = Shear::new(&Ray::new(o, d)).and_then(|shear| shear.decide_likely(&triangle));
            prop_assert_eq!(decide(o, d, &triangle), likely);
        }
    }
}
