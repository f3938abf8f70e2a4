//! The conservative ray/triangle test in `f32`: which triangles are certainly missed, and which certainly hit.
//!
//! The arithmetic is that of [`Shear::decide`](crate::decide::Shear::decide), with a bound for the
//! error of each number (docs/numerics.md). Eight triangles are tested at once.

use super::ray_setup::ShearSetup;
use crate::wide::simd::{LANES, Simd, SimdBase, SimdFloat};
use crate::wide::tree::leaf::LeafBlock;

/// The coordinates of eight triangles' vertices along the axes x, y and z of Woop's shear.
pub(super) struct Vertices<S: Simd> {
    pub(super) x: [S::F; 3],
    pub(super) y: [S::F; 3],
    pub(super) z: [S::F; 3],
}

impl<S: Simd> Vertices<S> {
    /// The vertices of a leaf block's triangles.
    #[inline(always)]
    pub(super) fn load(simd: S, block: LeafBlock<'_>, [x, y, z]: [usize; 3]) -> Self {
        let (x, y, z) = (block.along(x), block.along(y), block.along(z));
        Self {
            x: [simd.load(x[0]), simd.load(x[1]), simd.load(x[2])],
            y: [simd.load(y[0]), simd.load(y[1]), simd.load(y[2])],
            z: [simd.load(z[0]), simd.load(z[1]), simd.load(z[2])],
        }
    }
}

/// The result of the conservative test, lane by lane.
#[repr(align(32))]
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Filtered {
    /// Where a hit is possible.
    pub(super) possible: u8,
    /// Where a hit in the ray's range is certain.
    pub(super) certain: u8,
    /// Bounds of the hit's `t`.
    pub(super) start: [f32; LANES],
    pub(super) end: [f32; LANES],
}

impl Filtered {
    /// The result for these lanes only.
    #[inline(always)]
    pub(super) fn among(self, lanes: u8) -> Self {
        Self { possible: self.possible & lanes, certain: self.certain & lanes, ..self }
    }
}

/// Tests eight triangles. Hits beyond `limit` cannot matter.
#[inline(always)]
pub(super) fn prefilter<S: Simd>(simd: S, ray: &ShearSetup, limit: f32, v: &Vertices<S>) -> Filtered {
    let (zero, limit) = (simd.splat(0.0), simd.splat(limit));
    let [x0, x1, x2] = shear::<S>(ray, 0, &v.x, &v.z);
    let [y0, y1, y2] = shear::<S>(ray, 1, &v.y, &v.z);
    let e0 = x2.mul_sub(y1, y2 * x1);
    let e1 = x0.mul_sub(y2, y0 * x2);
    let e2 = x1.mul_sub(y0, y1 * x0);
    let size = simd.max_abs(simd.max_abs(simd.max_abs(x0, y0), simd.max_abs(x1, y1)), simd.max_abs(x2, y2));
    let err = size.mul_add(ray.edge_err[0], ray.edge_err[1]);
    let low = e0.min(e1).min(e2);
    let high = e0.max(e1).max(e2);
    let outside = simd.lt(low, -err) & simd.lt(err, high);
    let inside = simd.lt(err, low) | simd.lt(high, -err);

    // The depth of vertex 0, plus the weighted differences of the other vertices' depths.
    let (z1, z2) = (v.z[1] - v.z[0], v.z[2] - v.z[0]);
    let inverse = simd.splat(1.0) / (e0 + e1 + e2);
    let depth = e1.mul_add(z1, e2 * z2).mul_add(inverse, v.z[0]);
    let t = depth.mul_add(ray.depth_scale, ray.depth_offset);
    let t_err = (err * 8.0 * inverse.abs()).mul_add(simd.max_abs(z1, z2), ray.t_err);
    let (start, end) = (t - t_err, t + t_err);
    // Comparisons with NaN are false: where an error is unbounded, a hit is possible.
    let beyond = simd.lt(limit, start) | simd.lt(end, zero);
    let possible = !(outside | beyond);
    let certain = possible & inside & simd.lt(zero, start) & simd.lt(end, simd.splat(ray.range_end));
    Filtered { possible, certain, start: start.to_array(), end: end.to_array() }
}

/// The vertices' offsets from the ray's line, along axis x or y.
#[inline(always)]
fn shear<S: Simd>(ray: &ShearSetup, axis: usize, x: &[S::F; 3], z: &[S::F; 3]) -> [S::F; 3] {
    let (slope, offset) = (ray.slope[axis], ray.offset[axis]);
    [
        z[0].mul_add(slope, x[0]) - offset,
        z[1].mul_add(slope, x[1]) - offset,
        z[2].mul_add(slope, x[2]) - offset,
    ]
}
