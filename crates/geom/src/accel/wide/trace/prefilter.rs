//! The conservative ray/triangle test in `f32`: which triangles are certainly missed, and which certainly hit.
//!
//! The arithmetic is that of [`Shear::decide`](crate::decide::Shear::decide), with a bound for the
//! error of each number (docs/numerics.md). Eight triangles are tested at once.

use super::ray_setup::ShearSetup;
use crate::accel::wide::simd::{LANES, Simd, SimdBase, SimdFloat};
use crate::accel::wide::tree::leaf::LeafBlock;

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
    let x = shear::<S>(ray.slope[0], ray.offset[0], &v.x, &v.z);
    let y = shear::<S>(ray.slope[1], ray.offset[1], &v.y, &v.z);
    let edges = [cross::<S>(&x, &y, 2, 1), cross::<S>(&x, &y, 0, 2), cross::<S>(&x, &y, 1, 0)];
    let err = simd.max_abs(largest(simd, x), largest(simd, y)).mul_add(ray.edge_err[0], ray.edge_err[1]);
    let depths = [v.z[0], v.z[1] - v.z[0], v.z[2] - v.z[0]];
    let (depth, inverse) = hit_depth(simd, edges, depths);
    let t = depth.mul_add(ray.depth_scale, ray.depth_offset);
    let t_err = (err * 8.0 * inverse.abs()).mul_add(simd.max_abs(depths[1], depths[2]), ray.t_err);
    let range = HitRange { begin: simd.splat(0.0), end: simd.splat(ray.range_end), limit: simd.splat(limit) };
    classify(simd, edges, err, [t - t_err, t + t_err], &range)
}

/// The ranges of rays, lane by lane.
pub(super) struct HitRange<S: Simd> {
    pub(super) begin: S::F,
    pub(super) end: S::F,
    /// Hits beyond this cannot matter.
    pub(super) limit: S::F,
}

/// The result for edge functions that are off by at most `err`, and hits within `start..=end`.
#[inline(always)]
pub(super) fn classify<S: Simd>(
    simd: S,
    [e0, e1, e2]: [S::F; 3],
    err: S::F,
    [start, end]: [S::F; 2],
    range: &HitRange<S>,
) -> Filtered {
    let (low, high) = (e0.min(e1).min(e2), e0.max(e1).max(e2));
    let outside = simd.lt(low, -err) & simd.lt(err, high);
    let inside = simd.lt(err, low) | simd.lt(high, -err);
    // Comparisons with NaN are false: where an error is unbounded, a hit is possible.
    let beyond = simd.lt(range.limit, start) | simd.lt(end, range.begin);
    let possible = !(outside | beyond);
    let certain = possible & inside & simd.lt(range.begin, start) & simd.lt(end, range.end);
    Filtered { possible, certain, start: start.to_array(), end: end.to_array() }
}

/// The depth of a hit: that of vertex 0, plus the weighted differences `z1` and `z2` of the other vertices' depths. The
/// weights are edge functions times the inverse of their sum, which comes second.
#[inline(always)]
pub(super) fn hit_depth<S: Simd>(simd: S, [e0, e1, e2]: [S::F; 3], [z0, z1, z2]: [S::F; 3]) -> (S::F, S::F) {
    let inverse = simd.splat(1.0) / (e0 + e1 + e2);
    (e1.mul_add(z1, e2 * z2).mul_add(inverse, z0), inverse)
}

/// The vertices' offsets from a ray's line, along axis x or y.
#[inline(always)]
pub(super) fn shear<S: Simd>(slope: f32, offset: f32, x: &[S::F; 3], z: &[S::F; 3]) -> [S::F; 3] {
    [
        z[0].mul_add(-slope, x[0]) - offset,
        z[1].mul_add(-slope, x[1]) - offset,
        z[2].mul_add(-slope, x[2]) - offset,
    ]
}

/// `a[i] * b[j] - b[i] * a[j]`.
#[inline(always)]
pub(super) fn cross<S: Simd>(a: &[S::F; 3], b: &[S::F; 3], i: usize, j: usize) -> S::F {
    a[i].mul_sub(b[j], b[i] * a[j])
}

/// The largest magnitude.
#[inline(always)]
pub(super) fn largest<S: Simd>(simd: S, [a, b, c]: [S::F; 3]) -> S::F {
    simd.max_abs(simd.max_abs(a, b), c)
}
