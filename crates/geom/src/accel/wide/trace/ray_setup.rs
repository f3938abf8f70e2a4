//! Ray setup: a ray in normalised space, in `f32`, with bounds of its errors (docs/numerics.md).

use crate::accel::prune::Pruner;
use crate::accel::wide::simd::RayColumns;
use crate::accel::wide::tree::normalize::{NormalizedSpace, power_of_two_below, power_of_two_inverse};
use crate::decide::{AXES, main_axis, permute};
use crate::rounding::W_F64;
use crate::{Aabb, Ray};
use glam::DVec3;

/// Half the thickness of a box's faces, in units of `W_F64`.
const FACE_ERR: f64 = 8.0;
/// Error of a projected vertex, in units of `W_F64`.
const VERTEX_ERR: f64 = 7.0;
/// Error of a depth beyond that of the weights, in units of `W_F64`. The errors of tests of projected triangles are
/// multiples of it, too: a smaller number needs other multiples.
pub(super) const DEPTH_ERR: f64 = 20.0;
/// A ray is lost if it comes from so far away that rounding moves it by this: nothing is known of its hits.
const LOST_RAY_ERR: f64 = 0.25;
/// Larger inverse direction components are clamped to this; the scene is 2 wide.
const MAX_INVERSE: f64 = (1_u64 << 60) as f64;

/// A ray that starts where it enters the scene, with its main direction component in `1..2`.
///
/// Its parameter `t'` is `(t - entry) * gain`, with a power of two for a gain; here, `t` means `t'`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RaySetup {
    /// The plane at `x` across axis `a` is crossed between `x * inverse[a] + near[a]` and
    /// `x * inverse[a] + far[a]`.
    pub(super) inverse: [f32; 3],
    pub(super) near: [f32; 3],
    pub(super) far: [f32; 3],
    /// The axes along which the direction is negative, a bit each.
    pub(super) octant: u8,
    /// All hits lie within `start..=end`.
    pub(super) start: f32,
    pub(super) end: f32,
    pub(super) shear: ShearSetup,
}

/// The part of a setup that the test of triangles needs.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ShearSetup {
    /// The axes x, y and z of Woop's shear; z is the main axis.
    pub(super) axes: [u8; 3],
    /// A vertex is sheared to `(x - slope[0] * z - offset[0], y - slope[1] * z - offset[1])`.
    pub(super) slope: [f32; 2],
    pub(super) offset: [f32; 2],
    /// At depth `z` the parameter is `z * depth_scale + depth_offset`.
    pub(super) depth_scale: f32,
    pub(super) depth_offset: f32,
    /// The error of an edge function of vertices up to `p` from the ray is at most
    /// `edge_err[0] * p + edge_err[1]`.
    pub(super) edge_err: [f32; 2],
    /// Error of a parameter, beyond that of the edge functions.
    pub(super) t_err: f32,
    /// A hit whose upper bound is below this is certainly before the end of the ray's range.
    pub(super) range_end: f32,
}

/// The setups of `N` rays, a column for each number, so that they are computed in parallel.
#[repr(align(64))]
#[derive(Clone, Debug)]
pub(super) struct RaySetups<const N: usize> {
    pub(super) origin: [[f32; N]; 3],
    pub(super) direction: [[f32; N]; 3],
    pub(super) inverse: [[f32; N]; 3],
    pub(super) near: [[f32; N]; 3],
    pub(super) far: [[f32; N]; 3],
    pub(super) octant: [u32; N],
    pub(super) main_axis: [u32; N],
    pub(super) slope: [[f32; N]; 2],
    pub(super) offset: [[f32; N]; 2],
    pub(super) depth_scale: [f32; N],
    pub(super) depth_offset: [f32; N],
    pub(super) edge_err: [[f32; N]; 2],
    pub(super) t_err: [f32; N],
    pub(super) start: [f32; N],
    pub(super) end: [f32; N],
    pub(super) range_end: [f32; N],
    /// Whether the ray is traceable, and may meet anything.
    pub(super) may_hit: [bool; N],
}

impl<const N: usize> RaySetups<N> {
    /// Sets up the rays given by `columns` for a scene within `bounds`.
    #[inline(always)]
    pub(super) fn set(&mut self, columns: &RayColumns<N>, bounds: &Aabb, space: &NormalizedSpace) {
        self.set_columns::<true>(columns, bounds, space);
    }

    /// Sets only what tests of projected triangles need: `origin`, `direction`, `t_err`, `start`, `end`, `range_end` and
    /// `may_hit`. [`RaySetups::get`] must not be called then.
    #[inline(always)]
    pub(super) fn set_for_projected(
        &mut self,
        columns: &RayColumns<N>,
        bounds: &Aabb,
        space: &NormalizedSpace,
    ) {
        self.set_columns::<false>(columns, bounds, space);
    }

    #[inline(always)]
    fn set_columns<const ALL: bool>(
        &mut self,
        columns: &RayColumns<N>,
        bounds: &Aabb,
        space: &NormalizedSpace,
    ) {
        let scene_is_empty = bounds.is_empty();
        // Without a branch, so that the compiler vectorises the loop.
        for i in 0..N {
            self.set_one::<ALL>(i, &ray(columns, i), bounds, space);
        }
        for i in 0..N {
            self.may_hit[i] =
                ray(columns, i).is_traceable() & !scene_is_empty & (self.start[i] <= self.end[i]);
        }
    }

    #[inline(always)]
    fn set_one<const ALL: bool>(&mut self, i: usize, ray: &Ray, bounds: &Aabb, space: &NormalizedSpace) {
        let pruner = Pruner::new(ray, bounds);
        // No hit lies outside the clipped range; the slack includes all that happens in `f64`.
        let entry = pruner.clip(ray, bounds);
        let z = main_axis(ray.direction);
        let unit = power_of_two_below(permute(ray.direction, z).z.abs());
        let gain = unit * space.scale;
        let slack = pruner.slack * space.scale;
        let lost = slack > LOST_RAY_ERR;
        let slack = if lost { 8.0 } else { slack };
        let direction = ray.direction * power_of_two_inverse(unit);
        let bounded = |x: f64| if x.abs() > MAX_INVERSE { MAX_INVERSE.copysign(x) } else { x };
        let DVec3 { x, y, z: w } = pruner.inverse * unit;
        let inverse = DVec3::new(bounded(x), bounded(y), bounded(w));
        let origin = (ray.origin + entry.start * ray.direction - space.center) * space.scale;
        // The origin of a lost ray is unknown.
        let inside = |x: f64| if lost && x.abs() > 1.0 { 1.0_f64.copysign(x) } else { x };
        let origin = DVec3::new(inside(origin.x), inside(origin.y), inside(origin.z));

        for axis in 0..3 {
            self.origin[axis][i] = origin[axis] as f32;
            self.direction[axis][i] = direction[axis] as f32;
        }
        if ALL {
            let thick = (FACE_ERR * W_F64 + slack) * inverse.abs();
            let at = -origin * inverse;
            let (near, far) = (at - thick, at + thick);
            for axis in 0..3 {
                self.inverse[axis][i] = inverse[axis] as f32;
                self.near[axis][i] = near[axis] as f32;
                self.far[axis][i] = far[axis] as f32;
            }
            self.octant[i] = inverse.is_negative_bitmask();
            self.main_axis[i] = z as u32;
            let (origin, direction) = (permute(origin, z), permute(direction, z));
            let inverse_z = permute(inverse, z).z;
            for axis in 0..2 {
                let slope = direction[axis] * inverse_z;
                self.slope[axis][i] = slope as f32;
                self.offset[axis][i] = (origin[axis] - slope * origin.z) as f32;
            }
            self.depth_scale[i] = inverse_z as f32;
            self.depth_offset[i] = (-origin.z * inverse_z) as f32;
            let vertex_err = VERTEX_ERR * W_F64 + slack;
            self.edge_err[0][i] = (4.0 * vertex_err + 12.0 * W_F64) as f32;
            self.edge_err[1][i] = (2.1 * vertex_err * vertex_err) as f32;
        }

        // The parameters of a lost ray are unknown.
        let unless_lost = |x: f64, otherwise: f32| if lost { otherwise } else { x as f32 };
        let after = |t: f64| (t - entry.start) * gain;
        self.t_err[i] = unless_lost(DEPTH_ERR * W_F64 + slack, f32::INFINITY);
        let missed = entry.start > entry.end;
        let (start, end) = (unless_lost(0.0, f32::NEG_INFINITY), after(entry.end) * (1.0 + 4.0 * W_F64));
        self.start[i] = if missed { f32::INFINITY } else { start };
        self.end[i] = if missed { f32::NEG_INFINITY } else { unless_lost(end, f32::INFINITY) };
        self.range_end[i] = unless_lost(after(ray.t_max) * (1.0 - 4.0 * W_F64), f32::NEG_INFINITY);
    }

    pub(super) const fn idle() -> Self {
        let zero = [0.0; N];
        Self {
            origin: [zero; 3],
            direction: [zero; 3],
            inverse: [zero; 3],
            near: [zero; 3],
            far: [zero; 3],
            octant: [0; N],
            main_axis: [0; N],
            slope: [zero; 2],
            offset: [zero; 2],
            depth_scale: zero,
            depth_offset: zero,
            edge_err: [zero; 2],
            t_err: zero,
            start: zero,
            end: zero,
            range_end: zero,
            may_hit: [false; N],
        }
    }

    /// The setup of ray `i`; `None` if it certainly meets nothing.
    #[inline(always)]
    pub(super) fn get(&self, i: usize) -> Option<RaySetup> {
        if !self.may_hit[i] {
            return None;
        }
        Some(RaySetup {
            inverse: [self.inverse[0][i], self.inverse[1][i], self.inverse[2][i]],
            near: [self.near[0][i], self.near[1][i], self.near[2][i]],
            far: [self.far[0][i], self.far[1][i], self.far[2][i]],
            octant: self.octant[i] as u8,
            start: self.start[i],
            end: self.end[i],
            shear: self.shear(i),
        })
    }

    /// The part of ray `i`'s setup that the test of triangles needs.
    #[inline(always)]
    pub(super) fn shear(&self, i: usize) -> ShearSetup {
        let z = self.main_axis[i] as u8 % 3;
        ShearSetup {
            axes: AXES[usize::from(z)],
            slope: [self.slope[0][i], self.slope[1][i]],
            offset: [self.offset[0][i], self.offset[1][i]],
            depth_scale: self.depth_scale[i],
            depth_offset: self.depth_offset[i],
            edge_err: [self.edge_err[0][i], self.edge_err[1][i]],
            t_err: self.t_err[i],
            range_end: self.range_end[i],
        }
    }
}

/// Ray `i` of `columns`.
#[inline(always)]
fn ray<const N: usize>(columns: &RayColumns<N>, i: usize) -> Ray {
    let [ox, oy, oz, dx, dy, dz, t_min, t_max] = columns.0.each_ref().map(
        #[inline(always)]
        |column| column[i],
    );
    Ray::new(DVec3::new(ox, oy, oz), DVec3::new(dx, dy, dz)).with_range(t_min, t_max)
}
