//! Split clipping: the part of a triangle within a cell ("perfect splits").
//!
//! A triangle's box may overlap a cell that the triangle misses, and is usually larger than the part of the
//! triangle within the cell. Clipping the triangle to the cell saves references and gives better planes
//! (Havran and Bittner, "On improving kd-trees for ray shooting", 2002). The traversal of the k-d tree does
//! not depend on it, since whole triangles are tested; the boxes of the wide BVH do (docs/numerics.md).

use super::plane::Plane;
use crate::accel::prim_ref::PrimRef;
use crate::{Aabb, Triangle, Triangles};
use arrayvec::ArrayVec;
use glam::DVec3;

/// A clipped triangle: at most 3 + 7 vertices after clipping at the six faces of a cell and at a plane.
type Polygon = ArrayVec<DVec3, 10>;

impl PrimRef {
    /// The parts in the lower and the upper half of `cell`, split by `plane`; `None` for an empty part.
    ///
    /// The new bounds are conservative: they contain every point of the triangle in their half. For this,
    /// `slack` is far above the rounding error of a coordinate in `f64`.
    pub(super) fn halves(
        &self,
        cell: &Aabb,
        plane: &Plane,
        triangles: &Triangles,
        slack: f64,
    ) -> [Option<Self>; 2] {
        let whole = cut_at_faces(triangles.get(self.index), cell, slack);
        let (axis, at) = (plane.axis, f64::from(plane.position));
        let lower = cut(&whole, |p| at + slack - p[axis]);
        let upper = cut(&whole, |p| p[axis] - (at - slack));
        let [below, above] = plane.halves(cell);
        [self.around(&lower, &below, slack), self.around(&upper, &above, slack)]
    }

    /// The reference with the bounds of `polygon`, its part in `cell`; `None` if that is empty.
    fn around(&self, polygon: &Polygon, cell: &Aabb, slack: f64) -> Option<Self> {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for corner in polygon {
            (low, high) = (low.min(*corner), high.max(*corner));
        }
        // The next number outward compensates for rounding to nearest.
        let min = (low - slack).as_vec3().map(f32::next_down);
        let max = (high + slack).as_vec3().map(f32::next_up);
        let bounds = Aabb { min, max }.intersection(cell).intersection(&self.bounds);
        (!bounds.is_empty()).then_some(Self { bounds, ..*self })
    }
}

/// The triangle clipped to `cell` widened by `slack` (Sutherland and Hodgman, 1974).
fn cut_at_faces(triangle: &Triangle, cell: &Aabb, slack: f64) -> Polygon {
    let mut polygon: Polygon = triangle.vertices.iter().map(|v| v.as_dvec3()).collect();
    let bounds = triangle.bounds();
    for axis in 0..3 {
        // The triangle lies inside most faces.
        if bounds.min[axis] < cell.min[axis] {
            let min = f64::from(cell.min[axis]) - slack;
            polygon = cut(&polygon, |p| p[axis] - min);
        }
        if bounds.max[axis] > cell.max[axis] {
            let max = f64::from(cell.max[axis]) + slack;
            polygon = cut(&polygon, |p| max - p[axis]);
        }
    }
    polygon
}

/// The polygon clipped to where `height` is not negative.
fn cut(polygon: &Polygon, height: impl Fn(&DVec3) -> f64) -> Polygon {
    let mut kept = Polygon::new();
    for (i, a) in polygon.iter().enumerate() {
        let b = &polygon[(i + 1) % polygon.len()];
        let (above_a, above_b) = (height(a), height(b));
        if above_a >= 0.0 {
            kept.push(*a);
        }
        if (above_a < 0.0) != (above_b < 0.0) {
            kept.push(a.lerp(*b, above_a / (above_a - above_b)));
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::super::plane::Side;
    use super::*;
    use glam::Vec3;
    use proptest::prelude::*;

    fn halves(triangle: Triangle, cell: Aabb, axis: usize, position: f32) -> [Option<Aabb>; 2] {
        let triangles = Triangles::new(vec![triangle]).unwrap();
        let plane = Plane { axis, position, within: Side::Lower };
        PrimRef::new(&triangles, 0)
            .halves(&cell, &plane, &triangles, 1e-12)
            .map(|part| part.map(|reference| reference.bounds))
    }

    #[test]
    fn a_box_is_cut_to_what_the_triangle_needs() {
        let corner = Triangle::new(Vec3::ZERO, Vec3::X, Vec3::Y);
        let [lower, upper] = halves(corner, corner.bounds(), 0, 0.75);
        assert_eq!(lower.unwrap().max, Vec3::new(0.75, 1.0, 0.0));
        let upper = upper.unwrap();
        assert!((upper.max.y - 0.25).abs() < 1e-6 && upper.min.x == 0.75 && upper.max.x == 1.0);
        // The upper half of this cell overlaps the box, not the triangle.
        let cell = Aabb { min: Vec3::new(0.5, 0.5, -1.0), max: Vec3::ONE };
        let [lower, upper] = halves(corner, cell, 0, 0.75);
        assert!(lower.is_some() && upper.is_none());
    }

    proptest! {
        /// On a lattice, contact at a face, an edge or a corner is frequent.
        #[test]
        fn no_point_of_the_triangle_in_the_cell_is_lost(
            c in prop::array::uniform9(-4i8..=4), low in prop::array::uniform3(-4i8..=4),
            size in prop::array::uniform3(0u8..=4), along in prop::array::uniform2(0u8..=8), scale in -1.0..1.0f32,
            axis in 0usize..3, share in 0u8..=4,
        ) {
            let at = |i: usize| Vec3::new(f32::from(c[i]), f32::from(c[i + 1]), f32::from(c[i + 2])) * scale;
            let triangle = Triangle::new(at(0), at(3), at(6));
            let min = Vec3::from(low.map(f32::from)) * scale.abs();
            let cell = Aabb { min, max: min + Vec3::from(size.map(f32::from)) * scale.abs() };
            let position = cell.min[axis] + (cell.max[axis] - cell.min[axis]) * f32::from(share) / 4.0;
            let [u, v] = along.map(|i| f64::from(i) / 8.0);
            let [a, b, c] = triangle.vertices.map(|v| v.as_dvec3());
            let point = a.lerp(b, u).lerp(c, v);
            let inside = |b: &Aabb| b.min.as_dvec3().cmple(point).all() && point.cmple(b.max.as_dvec3()).all();
            if inside(&cell) {
                let [lower, upper] = halves(triangle, cell, axis, position);
                let at = f64::from(position);
                prop_assert!(point[axis] > at || lower.is_some_and(|b| inside(&b)));
                prop_assert!(point[axis] < at || upper.is_some_and(|b| inside(&b)));
            }
        }
    }
}
