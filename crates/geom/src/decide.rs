//! The exact decision whether a ray intersects a triangle, and where.
//!
//! The method is that of Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection" (JCGT 2(1), 2013): a
//! shear maps the ray to the z axis, and the signs of three edge functions decide whether the projected
//! triangle contains the origin. All arithmetic is in `f64`, on `f32` vertices.
//!
//! The test is watertight. A vertex is projected by the same arithmetic for every triangle that shares it.
//! The sign of an edge function of projected vertices is correct or zero, and zero counts as inside. So the
//! projected triangles of a closed mesh leave no gap, not even at edges and vertices.
//!
//! Whatever is not certain in `f32`, every accelerator decides by this routine, so all give the same answers to the bit. It
//! is always inlined, so that a traversal compiled for FMA instructions uses them here too; the bits are the same without.

use crate::accurate::difference_of_products;
use crate::ray::power_of_two;
use crate::{Ray, Triangle};
use glam::DVec3;

/// The intersection of a ray's line with a triangle, at any `t`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intersection {
    /// The ray parameter; may be negative.
    pub t: f64,
    /// The barycentric coordinate of the second vertex, in `[0, 1]`.
    pub u: f64,
    /// The barycentric coordinate of the third vertex, in `[0, 1]`.
    pub v: f64,
}

/// A ray prepared for [`Shear::decide`]: the shear that maps it to the z axis.
#[derive(Clone, Copy, Debug)]
pub struct Shear {
    /// The axis of the largest direction component. Components are permuted so that it becomes z.
    main_axis: usize,
    origin: DVec3,
    slope_x: f64,
    slope_y: f64,
    direction_z: f64,
}

/// A sheared point: its offset from the ray's line, and its depth along the main axis.
#[derive(Clone, Copy)]
struct Sheared {
    x: f64,
    y: f64,
    z: f64,
}

/// Slopes and origin coordinates below this become zero, so that no product in [`Shear::decide`] underflows.
/// The difference is far below `2^-149`, the spacing of the smallest `f32` coordinates.
const NEGLIGIBLE: f64 = power_of_two(-200);

impl Shear {
    /// Prepares `ray`; `None` if it is not [traceable](Ray::is_traceable).
    #[inline(always)]
    pub fn new(ray: &Ray) -> Option<Self> {
        if ray.is_traceable() { Some(Self::of_traceable(ray)) } else { None }
    }

    /// Prepares a traceable ray.
    #[inline(always)]
    pub(crate) fn of_traceable(ray: &Ray) -> Self {
        let main_axis = main_axis(ray.direction);
        let DVec3 { x, y, z } = permute(ray.direction, main_axis);
        Self::of_slopes(main_axis, permute(ray.origin, main_axis), [x / z, y / z], z)
    }

    /// Prepares a traceable ray, given by components [permuted](permute) for `main_axis`: its origin, its slopes `x / z`
    /// and `y / z`, and the `z` of its direction.
    #[inline(always)]
    pub(crate) fn of_slopes(main_axis: usize, origin: DVec3, [x, y]: [f64; 2], direction_z: f64) -> Self {
        let origin = origin.map(flush);
        Self { main_axis, origin, slope_x: flush(x), slope_y: flush(y), direction_z }
    }

    /// The intersection of the ray's line with `triangle`, edges and vertices included.
    ///
    /// `None` if the line misses the triangle, or if the projected vertices lie on one line. Since they are
    /// rounded, a triangle whose plane contains the line may be hit. The line intersects the triangle if the
    /// exact edge functions of the projected vertices do not differ in sign, and are not all zero.
    ///
    /// Let `eps = 2^-53` and `P` be the largest coordinate distance from the ray's origin to a vertex. The
    /// answer is that of a parallel ray, displaced by at most `6 eps P` along each of the two other axes, up to
    /// an error of `12 eps` times the largest depth in `t` and `7 eps` in the barycentrics. For a triangle seen
    /// edge-on, a small displacement can change `t` much (docs/numerics.md).
    #[inline(always)]
    pub fn decide(&self, triangle: &Triangle) -> Option<Intersection> {
        let [a, b, c] = self.project_triangle(triangle);
        // The difference of rounded products has the correct sign or is zero. This rejects nearly all
        // triangles before the accurate evaluation.
        if differ_in_sign(c.x * b.y - c.y * b.x, a.x * c.y - a.y * c.x, b.x * a.y - b.y * a.x) {
            return None;
        }
        let (intersection, is_hit) = self.evaluate([a, b, c]);
        is_hit.then_some(intersection)
    }

    /// [`Shear::decide`] for a triangle that is likely hit. There is no early rejection, whose branch would
    /// be mispredicted.
    #[inline(always)]
    pub(crate) fn decide_likely(&self, triangle: &Triangle) -> Option<Intersection> {
        let (intersection, is_hit) = self.evaluate(self.project_triangle(triangle));
        is_hit.then_some(intersection)
    }

    /// [`Shear::decide`] for vertices permuted like the ray: the intersection, and whether there is one. It
    /// has no branch, so that loops over it vectorize.
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
        let is_hit = !differ_in_sign(e0, e1, e2) & (det != 0.0);
        let depth = (e0 * a.z + e1 * b.z + e2 * c.z) / det;
        // Adding zero makes a negative zero positive, so that the bits do not depend on its sign.
        let t = depth / self.direction_z + 0.0;
        (Intersection { t, u: e1 / det + 0.0, v: e2 / det + 0.0 }, is_hit)
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

/// The axes of the components that [`permute`] returns, by main axis.
pub(crate) const AXES: [[u8; 3]; 3] = [[1, 2, 0], [2, 0, 1], [0, 1, 2]];

/// The components in cyclic order, that along `main_axis` last.
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

/// The axis of the component of largest magnitude, the first of equal ones.
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
    // Adding zero makes a negative zero positive.
    if x.abs() < NEGLIGIBLE { 0.0 } else { x + 0.0 }
}
