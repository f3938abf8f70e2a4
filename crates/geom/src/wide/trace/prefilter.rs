//! The conservative ray/triangle test in `f32`: which triangles are certainly missed, and which certainly hit.
//!
//! The arithmetic is that of [`Shear::decide`](crate::decide::Shear::decide), with a bound for the
//! error of each number (docs/numerics.md). Eight triangles are tested at once.

use super::ray_setup::RaySetup;
use crate::wide::simd::{Rows, Simd};

/// A [`RaySetup`], with each number in all lanes.
pub(super) struct SplatRay<S: Simd> {
    slope: [S::F; 2],
    offset: [S::F; 2],
    depth_scale: S::F,
    depth_offset: S::F,
    edge_err: [S::F; 2],
    t_err: S::F,
    certain_end: S::F,
    /// Hits beyond this cannot matter.
    t_end: S::F,
}

impl<S: Simd> SplatRay<S> {
    #[inline(always)]
    pub(super) fn new(simd: S, setup: &RaySetup, t_end: f32) -> Self {
        Self {
            slope: [simd.splat(setup.slope[0]), simd.splat(setup.slope[1])],
            offset: [simd.splat(setup.offset[0]), simd.splat(setup.offset[1])],
            depth_scale: simd.splat(setup.depth_scale),
            depth_offset: simd.splat(setup.depth_offset),
            edge_err: [simd.splat(setup.edge_err[0]), simd.splat(setup.edge_err[1])],
            t_err: simd.splat(setup.t_err),
            certain_end: simd.splat(setup.certain_end),
            t_end: simd.splat(t_end),
        }
    }
}

/// The coordinates of eight triangles' vertices along the axes x, y and z of Woop's shear.
pub(super) struct Vertices<S: Simd> {
    pub(super) x: [S::F; 3],
    pub(super) y: [S::F; 3],
    pub(super) z: [S::F; 3],
}

impl<S: Simd> Vertices<S> {
    /// The vertices of a leaf block's triangles.
    #[inline(always)]
    pub(super) fn load(simd: S, rows: Rows<'_>, [x, y, z]: [usize; 3]) -> Self {
        let (x, y, z) = (rows.along(x), rows.along(y), rows.along(z));
        Self {
            x: [simd.load(x[0]), simd.load(x[1]), simd.load(x[2])],
            y: [simd.load(y[0]), simd.load(y[1]), simd.load(y[2])],
            z: [simd.load(z[0]), simd.load(z[1]), simd.load(z[2])],
        }
    }
}

/// The result of the conservative test, lane by lane.
#[derive(Clone, Copy)]
pub(super) struct Filtered<S: Simd> {
    /// Where a hit is possible.
    pub(super) possible: u8,
    /// Where a hit in the ray's range is certain.
    pub(super) certain: u8,
    /// Bounds of the hit's `t`.
    pub(super) start: S::F,
    pub(super) end: S::F,
}

/// Tests eight triangles.
#[inline(always)]
pub(super) fn prefilter<S: Simd>(simd: S, ray: &SplatRay<S>, v: &Vertices<S>) -> Filtered<S> {
    let zero = simd.splat(0.0);
    let (x0, x1, x2) = (shear(simd, ray, v, 0, 0), shear(simd, ray, v, 0, 1), shear(simd, ray, v, 0, 2));
    let (y0, y1, y2) = (shear(simd, ray, v, 1, 0), shear(simd, ray, v, 1, 1), shear(simd, ray, v, 1, 2));
    let e0 = simd.mul_sub(x2, y1, simd.mul(y2, x1));
    let e1 = simd.mul_sub(x0, y2, simd.mul(y0, x2));
    let e2 = simd.mul_sub(x1, y0, simd.mul(y1, x0));
    let size = simd.max_abs(simd.max_abs(simd.max_abs(x0, y0), simd.max_abs(x1, y1)), simd.max_abs(x2, y2));
    let err = simd.mul_add(size, ray.edge_err[0], ray.edge_err[1]);
    let minus_err = simd.sub(zero, err);
    let low = simd.min(simd.min(e0, e1), e2);
    let high = simd.max(simd.max(e0, e1), e2);
    let outside = simd.lt(low, minus_err) & simd.lt(err, high);
    let inside = simd.lt(err, low) | simd.lt(high, minus_err);

    // The depth of vertex 0, plus the weighted differences of the other vertices' depths.
    let (z1, z2) = (simd.sub(v.z[1], v.z[0]), simd.sub(v.z[2], v.z[0]));
    let inverse = simd.div(simd.splat(1.0), simd.add(simd.add(e0, e1), e2));
    let depth = simd.mul_add(simd.mul_add(e1, z1, simd.mul(e2, z2)), inverse, v.z[0]);
    let t = simd.mul_add(depth, ray.depth_scale, ray.depth_offset);
    let weight_err = simd.mul(simd.mul(err, simd.splat(8.0)), simd.abs(inverse));
    let t_err = simd.mul_add(weight_err, simd.max_abs(z1, z2), ray.t_err);
    let (start, end) = (simd.sub(t, t_err), simd.add(t, t_err));
    // Comparisons with NaN are false: where an error is unbounded, a hit is possible.
    let beyond = simd.lt(ray.t_end, start) | simd.lt(end, zero);
    let possible = !(outside | beyond);
    let certain = possible & inside & simd.lt(zero, start) & simd.lt(end, ray.certain_end);
    Filtered { possible, certain, start, end }
}

/// A vertex's offset from the ray's line, along axis x or y.
#[inline(always)]
fn shear<S: Simd>(simd: S, ray: &SplatRay<S>, v: &Vertices<S>, axis: usize, vertex: usize) -> S::F {
    let x = if axis == 0 { v.x[vertex] } else { v.y[vertex] };
    simd.sub(simd.mul_add(ray.slope[axis], v.z[vertex], x), ray.offset[axis])
}
