//! The triangles of a small tree, projected along an axis, for a test that takes few instructions.

use super::normalize::{NormalizedSpace, TINY};
use crate::Triangles;
use crate::decide::{AXES, main_axis};
use crate::ray::power_of_two;
use glam::DVec3;

/// The largest number of triangles of a tree that stores them projected (measured, docs/performance.md).
pub(crate) const MOST_PROJECTED: usize = 96;

/// The triangles of a tree by the axis along which they are projected; none if the tree has more than [`MOST_PROJECTED`].
#[derive(Clone, Debug, Default)]
pub(crate) struct ProjectedTriangles {
    by_axis: [Vec<ProjectedTriangle>; 3],
}

impl ProjectedTriangles {
    /// The live triangles, if they are few.
    pub(crate) fn of_few(triangles: &Triangles, space: &NormalizedSpace) -> Self {
        let mut this = Self::default();
        if triangles.live().len() <= MOST_PROJECTED {
            for &index in triangles.live() {
                let (axis, triangle) = ProjectedTriangle::new(triangles, index, space);
                this.by_axis[axis].push(triangle);
            }
        }
        this.by_axis.iter_mut().for_each(Vec::shrink_to_fit);
        this
    }

    pub(crate) fn len(&self) -> usize {
        self.by_axis.iter().map(Vec::len).sum()
    }

    /// Those projected along each axis, with the axes x, y and z.
    #[inline(always)]
    pub(crate) fn by_axes(&self) -> impl Iterator<Item = ([u8; 3], &Vec<ProjectedTriangle>)> {
        AXES.into_iter().zip(&self.by_axis)
    }

    pub(crate) fn bytes(&self) -> usize {
        self.by_axis.iter().map(|triangles| size_of_val(&**triangles)).sum()
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
const THIN: f64 = power_of_two(-21);
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
            [x, y, -(x * ax + y * ay + z)].map(|x| if x.abs() < TINY { 0.0 } else { x as f32 })
        };
        let steepness = u.iter().chain(&v).map(|x| x.abs()).sum::<f64>();
        let is_accurate = nz.abs() >= THIN * b.abs().max_element() * c.abs().max_element();
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
