use crate::accurate::cross;
use crate::{Aabb, GeomError, PdfArea};
use glam::{DAffine3, DVec3, Vec3};

/// A triangle with `f32` vertices.
///
/// Seen from its front, the vertices are in counter-clockwise order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    /// The three vertices, in world space or in that of the mesh.
    pub vertices: [Vec3; 3],
}

impl Triangle {
    /// The largest magnitude of a coordinate: `2^60`, about `1.15e18`. Within it no product in a decision
    /// overflows.
    pub const MAX_COORDINATE: f32 = (1_u64 << 60) as f32;

    /// The triangle with these vertices, not validated.
    pub const fn new(v0: Vec3, v1: Vec3, v2: Vec3) -> Self {
        Self { vertices: [v0, v1, v2] }
    }

    /// The quadrilateral `a b c d` as the triangles `a b c` and `a c d`. Seen from its front, the vertices are in
    /// counter-clockwise order. One that is not flat is folded along `a c`; of one that is not convex, the triangles may
    /// overlap.
    pub const fn quad(a: Vec3, b: Vec3, c: Vec3, d: Vec3) -> [Self; 2] {
        [Self::new(a, b, c), Self::new(a, c, d)]
    }

    /// The triangles of a mesh, in the order of `faces`, each three indices of `vertices`.
    ///
    /// ```
    /// use glam::Vec3;
    /// use globillum_geom::Triangle;
    ///
    /// let vertices = [Vec3::ZERO, Vec3::X, Vec3::ONE, Vec3::Y];
    /// let triangles: Vec<_> = Triangle::indexed(&vertices, &[[0, 1, 2], [0, 2, 3]]).collect();
    /// assert_eq!(triangles, Triangle::quad(Vec3::ZERO, Vec3::X, Vec3::ONE, Vec3::Y));
    /// ```
    ///
    /// # Panics
    /// The iterator panics at an index that is not below the number of vertices.
    pub fn indexed(vertices: &[Vec3], faces: &[[u32; 3]]) -> impl ExactSizeIterator<Item = Self> {
        faces.iter().map(|face| Self { vertices: face.map(|index| vertices[index as usize]) })
    }

    /// The triangle with the vertices `corners` after `transform`, computed in `f64` and rounded once.
    ///
    /// The front stays the front: if the determinant of `transform` is negative, which reverses the
    /// orientation, the second and the third vertex are swapped.
    pub fn transformed(corners: [DVec3; 3], transform: &DAffine3) -> Self {
        let [a, b, c] = corners.map(|corner| transform.transform_point3(corner).as_vec3());
        let mirrors = transform.matrix3.determinant() < 0.0;
        if mirrors { Self::new(a, c, b) } else { Self::new(a, b, c) }
    }

    /// Checks that all coordinates are finite and at most [`Triangle::MAX_COORDINATE`] in magnitude.
    ///
    /// # Errors
    /// [`GeomError::NonFinite`] or [`GeomError::Domain`] for the first invalid vertex; `index` becomes the
    /// error's triangle.
    pub fn validate(&self, index: usize) -> Result<(), GeomError> {
        for (vertex, v) in self.vertices.iter().enumerate() {
            if !v.is_finite() {
                return Err(GeomError::NonFinite { triangle: index, vertex });
            }
            if let Some(value) = v.to_array().into_iter().find(|x| x.abs() > Self::MAX_COORDINATE) {
                return Err(GeomError::Domain { triangle: index, vertex, value });
            }
        }
        Ok(())
    }

    /// The bounds of the vertices.
    pub fn bounds(&self) -> Aabb {
        Aabb::around(self.vertices)
    }

    /// The edges `v1 - v0` and `v2 - v0` in `f64`, each component within half an ulp.
    #[inline(always)]
    pub fn edges(&self) -> [DVec3; 2] {
        // `map` over the array would spill it to memory.
        let [v0, v1, v2] = &self.vertices;
        let v0 = v0.as_dvec3();
        [v1.as_dvec3() - v0, v2.as_dvec3() - v0]
    }

    /// The area, in squared units of length, `>= 0`.
    pub fn area(&self) -> f64 {
        0.5 * self.area_vector().length()
    }

    /// The unit geometric normal, which points to the front.
    ///
    /// NaN if the cross product of the edges is zero in `f64`. Such a triangle is
    /// [degenerate](Triangle::is_degenerate).
    #[inline(always)]
    pub fn normal(&self) -> DVec3 {
        let n = self.area_vector();
        // Dividing by the largest component first keeps the square in range at any scale.
        let n = n / n.abs().max_element();
        n / n.length()
    }

    /// The cross product of the edges: twice the area times the normal.
    #[inline(always)]
    pub(crate) fn area_vector(&self) -> DVec3 {
        let [e1, e2] = self.edges();
        cross(e1, e2)
    }

    /// Whether the vertices are collinear, decided by exact predicates (Shewchuk 1997), or so nearly
    /// collinear that the cross product of the edges is zero in `f64`.
    pub fn is_degenerate(&self) -> bool {
        let v = self.vertices.map(|v| v.as_dvec3());
        let projected_area = |i: usize, j: usize| {
            let [a, b, c] = v.map(|p| robust::Coord { x: p[i], y: p[j] });
            robust::orient2d(a, b, c)
        };
        let collinear =
            projected_area(0, 1) == 0.0 && projected_area(1, 2) == 0.0 && projected_area(2, 0) == 0.0;
        collinear || self.area_vector() == DVec3::ZERO
    }

    /// A point sampled uniformly by area from random numbers `u` in `[0, 1)^2`, as barycentrics `(u, v)`,
    /// both in `[0, 1]`, with `u + v <= 1` up to rounding: the square-root warp (Turk, Graphics Gems, 1990).
    pub fn sample_uniform(u: [f64; 2]) -> (f64, f64) {
        let root = (1.0 - u[0]).sqrt();
        (1.0 - root, u[1] * root)
    }

    /// The inverse of [`Triangle::sample_uniform`]: the random numbers, in `[0, 1)`, that give the barycentrics `(u, v)`.
    pub fn invert_uniform(u: f64, v: f64) -> [f64; 2] {
        let root = 1.0 - u;
        let numbers = [1.0 - root * root, if root > 0.0 { v / root } else { 0.0 }];
        numbers.map(|x| x.clamp(0.0, 1.0_f64.next_down()))
    }

    /// The pdf of [`Triangle::sample_uniform`] per unit of area: one over the area.
    pub fn pdf_uniform(&self) -> PdfArea {
        PdfArea(1.0 / self.area())
    }
}
