//! The middle of the rays that may meet a block, around which its triangles are seen.

use super::super::simd::Simd;
use super::view::View;
use super::window::Window;

/// Unit roundoff of `f32`.
const U: f32 = f32::EPSILON / 2.0;
/// Error of a vertex projected along the focus, beyond that of the offset, in units of `U`.
const VERTEX_ERR: f32 = 8.0;
/// Error of an edge function of vertices up to `m` across from the focus and `b - 1` ahead of the origin, for
/// rays whose slopes deviate by up to `d` from those of the focus, in units of `U`: that of `m * m`, of `m * b`
/// and of `m * b * d`.
const ACROSS_ERR: f32 = 13.0;
const DEPTH_ERR: f32 = 0.5;
const ASIDE_ERR: f32 = 37.0;

/// The middle of the rays that may meet a block.
pub(super) struct Focus {
    /// What its slopes deviate from the middle ray's.
    pub(super) aside: [f32; 2],
    /// What other rays' slopes deviate from its own at most.
    pub(super) reach: [f32; 2],
    slope: [f32; 2],
    offset: [f32; 2],
    pub(super) sense: f32,
    pub(super) start: f32,
    /// An edge function's error is at most `m * (err[0] + b * err[1] + m * err[2]) + b * err[3] + err[4]`.
    pub(super) err: [f32; 5],
}

impl Focus {
    #[inline(always)]
    pub(super) fn new(view: &View, window: &Window) -> Self {
        let Window { low, high } = *window;
        let (mut aside, mut slope, mut offset) = ([0.0; 2], [0.0; 2], [0.0; 2]);
        let (mut reach, mut furthest) = ([0.0; 2], 0.0_f32);
        for axis in 0..2 {
            aside[axis] = 0.5 * (low[axis] + high[axis]);
            let exact = f64::from(view.middle[axis]) + f64::from(aside[axis]);
            slope[axis] = exact as f32;
            offset[axis] = (view.origin[axis] - exact * view.origin.z) as f32;
            reach[axis] = larger(high[axis] - aside[axis], aside[axis] - low[axis]);
            furthest = larger(furthest, offset[axis].abs());
        }
        let deviation = larger(reach[0], reach[1]);
        let vertex_err = (VERTEX_ERR + furthest) * U;
        let err = [
            4.0 * vertex_err,
            (DEPTH_ERR + ASIDE_ERR * deviation) * U,
            ACROSS_ERR * U,
            4.1 * deviation * vertex_err,
            2.2 * vertex_err * vertex_err,
        ];
        Self { aside, reach, slope, offset, sense: view.sense as f32, start: view.origin.z as f32, err }
    }

    /// Where vertices lie across, from the focus, along axis x or y.
    #[inline(always)]
    pub(super) fn project<S: Simd>(
        &self,
        simd: S,
        axis: usize,
        x: &[S::F; 3],
        places: &[S::F; 3],
    ) -> [S::F; 3] {
        let (slope, offset) = (simd.splat(-self.slope[axis]), simd.splat(self.offset[axis]));
        [
            simd.sub(simd.mul_add(slope, places[0], x[0]), offset),
            simd.sub(simd.mul_add(slope, places[1], x[1]), offset),
            simd.sub(simd.mul_add(slope, places[2], x[2]), offset),
        ]
    }
}

#[inline(always)]
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}
