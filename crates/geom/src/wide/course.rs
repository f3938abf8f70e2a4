//! A ray in the space of a wide tree, in `f32`, with bounds for how wrong it is.
//!
//! Everything a search compares with follows from here; docs/numerics.md derives the bounds.

use super::space::{Space, power_of_two_below, power_of_two_inverse};
use crate::decide::main_axis;
use crate::prune::Pruner;
use crate::{Aabb, Ray};
use glam::DVec3;

/// Unit roundoff of `f32`.
const U: f64 = f32::EPSILON as f64 / 2.0;
/// Half the thickness of planes, in units of `U`.
const PLANE_ERR: f64 = 8.0;
/// Error of a projected vertex, in units of `U`.
const VERTEX_ERR: f64 = 7.0;
/// Error of a depth beyond that of the weights, in units of `U`.
const DEPTH_ERR: f64 = 20.0;
/// A ray from so far away that this much of the scene is rounding is lost: all is possible.
const LOST: f64 = 0.25;
/// Inverse direction components beyond this count as this; the scene is 2 wide.
const LARGEST_INVERSE: f64 = (1_u64 << 60) as f64;

/// A ray from where it enters the scene, with its main direction component in `1..2`.
///
/// Its parameter `t'` is `(t - entry) * gain`, with a power of two for a gain; here, `t` means `t'`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Course {
    /// A plane `x` of axis `a` is crossed between `x * inverse[a] + near[a]` and
    /// `x * inverse[a] + far[a]`.
    pub(super) inverse: [f32; 3],
    pub(super) near: [f32; 3],
    pub(super) far: [f32; 3],
    /// The axes along which the ray descends, a bit each.
    pub(super) octant: u8,
    /// The axes x, y and z of Woop's shear; z is the main axis.
    pub(super) axes: [u8; 4],
    /// A vertex is sheared to `(x + slope[0] * z - offset[0], y + slope[1] * z - offset[1])`.
    pub(super) slope: [f32; 2],
    pub(super) offset: [f32; 2],
    /// At depth `z` the parameter is `z * depth_scale + depth_offset`.
    pub(super) depth_scale: f32,
    pub(super) depth_offset: f32,
    /// An edge function of vertices up to `p` from the ray is wrong by at most
    /// `edge_err[0] * p + edge_err[1]`.
    pub(super) edge_err: [f32; 2],
    /// Error of a parameter, beyond that of the edge functions.
    pub(super) t_err: f32,
    /// All hits lie within `start..=end`.
    pub(super) start: f32,
    pub(super) end: f32,
    /// What certainly ends below this is within the ray's range.
    pub(super) certain_end: f32,
}

impl Course {
    /// `None` if the ray certainly meets nothing within `bounds`.
    #[inline(always)]
    pub(super) fn new(ray: &Ray, bounds: &Aabb, space: &Space) -> Option<Self> {
        if !ray.is_traceable() || bounds.is_empty() {
            return None;
        }
        let pruner = Pruner::new(ray, bounds);
        let entry = pruner.clip(ray, bounds);
        // No hit lies outside the clipped range; the slack includes all that happens in `f64`.
        if entry.start > entry.end {
            return None;
        }
        let z = main_axis(ray.direction);
        let unit = power_of_two_below(ray.direction[z].abs());
        let gain = unit * space.scale;
        let slack = pruner.slack * space.scale;
        let lost = slack > LOST;
        let slack = if lost { 8.0 } else { slack };
        let direction = ray.direction * power_of_two_inverse(unit);
        let largest = DVec3::splat(LARGEST_INVERSE);
        let inverse = (pruner.inverse * unit).clamp(-largest, largest);
        let origin = (ray.origin + entry.start * ray.direction - space.center) * space.scale;
        // Of a lost ray only the direction is known.
        let origin = if lost { origin.clamp(-DVec3::ONE, DVec3::ONE) } else { origin };

        let thick = (PLANE_ERR * U + slack) * inverse.abs();
        let at = -origin * inverse;
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        let slope = [direction[x] * inverse[z], direction[y] * inverse[z]];
        let offset = [origin[x] - slope[0] * origin[z], origin[y] - slope[1] * origin[z]];
        let vertex_err = VERTEX_ERR * U + slack;
        let after = |t: f64| (t - entry.start) * gain;
        let course = Self {
            inverse: inverse.as_vec3().to_array(),
            near: (at - thick).as_vec3().to_array(),
            far: (at + thick).as_vec3().to_array(),
            octant: inverse.is_negative_bitmask() as u8,
            axes: [x as u8, y as u8, z as u8, 0],
            slope: slope.map(|s| -s as f32),
            offset: offset.map(|o| o as f32),
            depth_scale: inverse[z] as f32,
            depth_offset: (-origin[z] * inverse[z]) as f32,
            edge_err: [(4.0 * vertex_err + 12.0 * U) as f32, (2.1 * vertex_err * vertex_err) as f32],
            t_err: (DEPTH_ERR * U + slack) as f32,
            start: 0.0,
            end: (after(entry.end) * (1.0 + 4.0 * U)) as f32,
            certain_end: (after(ray.t_max) * (1.0 - 4.0 * U)) as f32,
        };
        Some(if lost { course.lost() } else { course })
    }

    /// Nothing is certain about a lost ray's parameters.
    fn lost(self) -> Self {
        let (start, end) = (f32::NEG_INFINITY, f32::INFINITY);
        Self { t_err: f32::INFINITY, start, end, certain_end: f32::NEG_INFINITY, ..self }
    }
}
