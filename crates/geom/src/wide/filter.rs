//! Ray and triangle in `f32`: what certainly is no hit, and what certainly is one.
//!
//! The arithmetic is that of [`Shear::decide`](crate::decide::Shear::decide), with a bound for the
//! error of each number (docs/numerics.md). Eight triangles meet one ray, or eight rays one
//! triangle.

use super::course::{Course, Courses};
use super::simd::{LANES, Rows, Simd};

/// What [`Course`] says of a ray, in each lane.
pub(super) struct Rays<S: Simd> {
    pub(super) slope: [S::F; 2],
    pub(super) offset: [S::F; 2],
    pub(super) depth_scale: S::F,
    pub(super) depth_offset: S::F,
    pub(super) edge_err: [S::F; 2],
    pub(super) t_err: S::F,
    pub(super) certain_end: S::F,
    /// What begins beyond this can not matter.
    pub(super) t_end: S::F,
}

impl<S: Simd> Rays<S> {
    /// The same ray in all lanes.
    #[inline(always)]
    pub(super) fn same(simd: S, course: &Course, t_end: f32) -> Self {
        Self {
            slope: [simd.splat(course.slope[0]), simd.splat(course.slope[1])],
            offset: [simd.splat(course.offset[0]), simd.splat(course.offset[1])],
            depth_scale: simd.splat(course.depth_scale),
            depth_offset: simd.splat(course.depth_offset),
            edge_err: [simd.splat(course.edge_err[0]), simd.splat(course.edge_err[1])],
            t_err: simd.splat(course.t_err),
            certain_end: simd.splat(course.certain_end),
            t_end: simd.splat(t_end),
        }
    }

    /// One of eight rays, in all lanes.
    #[inline(always)]
    pub(super) fn lane(simd: S, courses: &Courses<LANES>, lane: usize, t_end: f32) -> Self {
        let i = lane % LANES;
        Self {
            slope: [simd.splat(courses.slope[0][i]), simd.splat(courses.slope[1][i])],
            offset: [simd.splat(courses.offset[0][i]), simd.splat(courses.offset[1][i])],
            depth_scale: simd.splat(courses.depth_scale[i]),
            depth_offset: simd.splat(courses.depth_offset[i]),
            edge_err: [simd.splat(courses.edge_err[0][i]), simd.splat(courses.edge_err[1][i])],
            t_err: simd.splat(courses.t_err[i]),
            certain_end: simd.splat(courses.certain_end[i]),
            t_end: simd.splat(t_end),
        }
    }

    /// Eight rays.
    #[inline(always)]
    pub(super) fn each(simd: S, courses: &Courses<LANES>, t_end: &[f32; LANES]) -> Self {
        Self {
            slope: [simd.load(&courses.slope[0]), simd.load(&courses.slope[1])],
            offset: [simd.load(&courses.offset[0]), simd.load(&courses.offset[1])],
            depth_scale: simd.load(&courses.depth_scale),
            depth_offset: simd.load(&courses.depth_offset),
            edge_err: [simd.load(&courses.edge_err[0]), simd.load(&courses.edge_err[1])],
            t_err: simd.load(&courses.t_err),
            certain_end: simd.load(&courses.certain_end),
            t_end: simd.load(t_end),
        }
    }
}

/// Coordinates of three vertices along the ray's axes x, y and z.
pub(super) struct Vertices<S: Simd> {
    pub(super) x: [S::F; 3],
    pub(super) y: [S::F; 3],
    pub(super) z: [S::F; 3],
}

impl<S: Simd> Vertices<S> {
    /// Those of a block's triangles.
    #[inline(always)]
    pub(super) fn load(simd: S, rows: Rows<'_>, [x, y, z]: [usize; 3]) -> Self {
        let (x, y, z) = (rows.along(x), rows.along(y), rows.along(z));
        Self {
            x: [simd.load(x[0]), simd.load(x[1]), simd.load(x[2])],
            y: [simd.load(y[0]), simd.load(y[1]), simd.load(y[2])],
            z: [simd.load(z[0]), simd.load(z[1]), simd.load(z[2])],
        }
    }

    /// Those of one of a block's triangles, in all lanes.
    #[inline(always)]
    pub(super) fn one(simd: S, rows: Rows<'_>, axes: [usize; 3], lane: usize) -> Self {
        let [x, y, z] = axes.map(
            #[inline(always)]
            |axis| {
                let [a, b, c] = rows.along(axis);
                [simd.splat(a[lane % LANES]), simd.splat(b[lane % LANES]), simd.splat(c[lane % LANES])]
            },
        );
        Self { x, y, z }
    }
}

/// What the filter leaves.
#[derive(Clone, Copy)]
pub(super) struct Filtered<S: Simd> {
    /// The lanes where a hit is possible.
    pub(super) possible: u8,
    /// Those of them where there certainly is one, within the ray's range.
    pub(super) certain: u8,
    /// Bounds of its `t`.
    pub(super) start: S::F,
    pub(super) end: S::F,
}

/// What of eight triangles a ray may hit.
#[inline(always)]
pub(super) fn filter<S: Simd>(simd: S, rays: &Rays<S>, v: &Vertices<S>) -> Filtered<S> {
    let zero = simd.splat(0.0);
    let (x0, x1, x2) = (shear(simd, rays, v, 0, 0), shear(simd, rays, v, 0, 1), shear(simd, rays, v, 0, 2));
    let (y0, y1, y2) = (shear(simd, rays, v, 1, 0), shear(simd, rays, v, 1, 1), shear(simd, rays, v, 1, 2));
    let e0 = simd.mul_sub(x2, y1, simd.mul(y2, x1));
    let e1 = simd.mul_sub(x0, y2, simd.mul(y0, x2));
    let e2 = simd.mul_sub(x1, y0, simd.mul(y1, x0));
    let size = simd.max_abs(simd.max_abs(simd.max_abs(x0, y0), simd.max_abs(x1, y1)), simd.max_abs(x2, y2));
    let err = simd.mul_add(size, rays.edge_err[0], rays.edge_err[1]);
    let minus_err = simd.sub(zero, err);
    let low = simd.min(simd.min(e0, e1), e2);
    let high = simd.max(simd.max(e0, e1), e2);
    let outside = simd.lt(low, minus_err) & simd.lt(err, high);
    let inside = simd.lt(err, low) | simd.lt(high, minus_err);

    // The depth is that of vertex 0 and the weighted differences of the others'.
    let (z1, z2) = (simd.sub(v.z[1], v.z[0]), simd.sub(v.z[2], v.z[0]));
    let inverse = simd.div(simd.splat(1.0), simd.add(simd.add(e0, e1), e2));
    let depth = simd.mul_add(simd.mul_add(e1, z1, simd.mul(e2, z2)), inverse, v.z[0]);
    let t = simd.mul_add(depth, rays.depth_scale, rays.depth_offset);
    let weight_err = simd.mul(simd.mul(err, simd.splat(8.0)), simd.abs(inverse));
    let t_err = simd.mul_add(weight_err, simd.max_abs(z1, z2), rays.t_err);
    let (start, end) = (simd.sub(t, t_err), simd.add(t, t_err));
    // Comparisons with NaN are false: where an error is unbounded, a hit is possible.
    let beyond = simd.lt(rays.t_end, start) | simd.lt(end, zero);
    let possible = !(outside | beyond);
    let certain = possible & inside & simd.lt(zero, start) & simd.lt(end, rays.certain_end);
    Filtered { possible, certain, start, end }
}

/// A vertex's offset from the ray's line, along axis x or y.
#[inline(always)]
fn shear<S: Simd>(simd: S, rays: &Rays<S>, v: &Vertices<S>, axis: usize, vertex: usize) -> S::F {
    let x = if axis == 0 { v.x[vertex] } else { v.y[vertex] };
    simd.sub(simd.mul_add(rays.slope[axis], v.z[vertex], x), rays.offset[axis])
}
