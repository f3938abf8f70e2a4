//! The triangles of a small tree, projected along an axis, for a test that takes few instructions.

use super::normalize::{MIN_MAGNITUDE, NormalizedSpace};
use crate::Triangles;
use crate::accel::wide::simd::LANES;
use crate::decide::{AXES, main_axis};
use crate::ray::power_of_two;
use glam::DVec3;

/// The largest number of triangles of a tree that stores them projected, so that batches test all of them (measured,
/// docs/performance.md).
pub(crate) const MAX_EXHAUSTIVE: usize = 96;

/// The triangles of a tree by the axis along which they are projected; none if the tree has more than [`MAX_EXHAUSTIVE`].
#[derive(Clone, Debug, Default)]
pub(crate) struct ProjectedTriangles {
    by_axis: [OneAxis; 3],
}

/// Triangles that are projected along one axis.
#[derive(Clone, Debug, Default)]
pub(crate) struct OneAxis {
    pub(crate) triangles: Vec<ProjectedTriangle>,
    /// The bounds of each eight of them.
    pub(crate) bounds: Vec<BoundsColumns>,
}

/// The bounds of up to eight triangles in normalised space, a column for each face. Coordinates are off as those of
/// [`NormalizedSpace::position`]. Lanes without a triangle are empty.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BoundsColumns {
    pub(crate) min: [[f32; LANES]; 3],
    pub(crate) max: [[f32; LANES]; 3],
}

impl ProjectedTriangles {
    /// The live triangles, if they are few.
    pub(crate) fn of_few(triangles: &Triangles, space: &NormalizedSpace) -> Self {
        let mut this = Self::default();
        if triangles.live().len() <= MAX_EXHAUSTIVE {
            for &index in triangles.live() {
                let (axis, triangle) = ProjectedTriangle::new(triangles, index, space);
                this.by_axis[axis].triangles.push(triangle);
            }
        }
        for OneAxis { triangles: of_axis, bounds } in &mut this.by_axis {
            of_axis.shrink_to_fit();
            *bounds = of_axis.chunks(LANES).map(|eight| BoundsColumns::of(triangles, eight, space)).collect();
        }
        this
    }

    #[inline(always)]
    pub(crate) fn is_empty(&self) -> bool {
        self.by_axis.iter().all(|of_axis| of_axis.triangles.is_empty())
    }

    /// Those projected along each axis, with the axes x, y and z.
    #[inline(always)]
    pub(crate) fn by_axes(&self) -> impl Iterator<Item = ([u8; 3], &OneAxis)> {
        AXES.into_iter().zip(&self.by_axis)
    }

    pub(crate) fn bytes(&self) -> usize {
        let of_axis = |axis: &OneAxis| size_of_val(&*axis.triangles) + size_of_val(&*axis.bounds);
        self.by_axis.iter().map(of_axis).sum()
    }
}

impl OneAxis {
    /// Up to 64 triangles at a time, and the bounds of each eight of them.
    #[inline(always)]
    pub(crate) fn by_64(&self) -> impl Iterator<Item = (&[BoundsColumns], &[ProjectedTriangle])> {
        self.bounds.chunks(64 / LANES).zip(self.triangles.chunks(64))
    }
}

impl BoundsColumns {
    /// The bounds of at most eight triangles.
    fn of(triangles: &Triangles, projected: &[ProjectedTriangle], space: &NormalizedSpace) -> Self {
        let mut columns = Self { min: [[f32::INFINITY; LANES]; 3], max: [[f32::NEG_INFINITY; LANES]; 3] };
        for (lane, triangle) in projected.iter().enumerate() {
            let bounds = space.map(&triangles.get(triangle.index).bounds());
            for axis in 0..3 {
                columns.min[axis][lane] = bounds.min[axis];
                columns.max[axis][lane] = bounds.max[axis];
            }
        }
        columns
    }
}

/// A triangle projected along the axis of its normal's largest component (Wald, 2004), in normalised space.
///
/// Let `x` and `y` be coordinates across that axis and `z` the coordinate along it. The plane is where `plane[0] x +
/// plane[1] y + plane[2] + z = 0`. The barycentric coordinates of its points are `u[0] x + u[1] y + u[2]` and the same with
/// `v`. All numbers are NaN, and nothing is certain, if the triangle is too thin for them to be accurate.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ProjectedTriangle {
    pub(crate) plane: [f32; 3],
    pub(crate) u: [f32; 3],
    pub(crate) v: [f32; 3],
    /// The sum of the magnitudes of the coefficients of `x` and `y` in `u` and `v`.
    pub(crate) steepness: f32,
    pub(crate) index: u32,
}

/// A normal's largest component relative to the lengths of two edges, below which a triangle is too thin: `2^-21`.
const MIN_NORMAL: f64 = power_of_two(-21);
/// The numbers of a steeper triangle may overflow: `2^100`.
const STEEPEST: f64 = power_of_two(100);

impl ProjectedTriangle {
    /// The triangle, and the axis along which it is projected.
    pub(crate) fn new(triangles: &Triangles, index: u32, space: &NormalizedSpace) -> (usize, Self) {
        let [a, b, c] = triangles.get(index).vertices.map(|vertex| vertex.as_dvec3());
        let (b, c) = ((b - a) * space.scale, (c - a) * space.scale);
        let a = (a - space.center) * space.scale;
        let normal = b.cross(c);
        let axis = main_axis(normal);
        let permuted = |v: DVec3| AXES[axis].map(|axis| v[usize::from(axis)]);
        let ([bx, by, _], [cx, cy, _], [nx, ny, nz]) = (permuted(b), permuted(c), permuted(normal));
        let (plane, u, v) = ([nx / nz, ny / nz], [cy / nz, -cx / nz], [-by / nz, bx / nz]);
        let [ax, ay, az] = permuted(a);
        // The last coefficients make `u` and `v` zero in the first vertex, which lies in the plane.
        let affine = |[x, y]: [f64; 2], z: f64| {
            [x, y, -(x * ax + y * ay + z)].map(|x| if x.abs() < MIN_MAGNITUDE { 0.0 } else { x as f32 })
        };
        let steepness = u.iter().chain(&v).map(|x| x.abs()).sum::<f64>();
        let is_accurate = nz.abs() >= MIN_NORMAL * b.abs().max_element() * c.abs().max_element();
        let triangle = if is_accurate && steepness <= STEEPEST {
            Self {
                plane: affine(plane, az),
                u: affine(u, 0.0),
                v: affine(v, 0.0),
                steepness: steepness as f32,
                index,
            }
        } else {
            let unknown = [f32::NAN; 3];
            Self { plane: unknown, u: unknown, v: unknown, steepness: f32::NAN, index }
        };
        (axis, triangle)
    }
}

#[cfg(test)]
mod tests {
    use crate::accel::wide::build::build_quickly;
    use crate::{Triangles, conformance::shapes::statue};

    #[test]
    fn trees_of_at_most_96_triangles_are_small() {
        for (count, expected) in [(0, false), (1, true), (96, true), (97, false)] {
            let triangles =
                Triangles::new(statue(2000).triangles()[..count].to_vec()).expect("valid triangles");
            let trees = build_quickly(&triangles).expect("the tree can be built");
            assert_eq!(trees[0].tests_exhaustively(), expected, "{count} triangles");
        }
    }
}
