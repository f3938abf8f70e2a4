//! What all rays of a pencil share.

use super::super::course::AXES;
use super::super::scratch::WIDTH;
use super::super::space::Space;
use crate::Ray;
use crate::decide::{main_axis, permute};
use glam::DVec3;

/// Where a point is from which the scene, 2 wide, is too small to be seen in `f32`.
const FAR: f64 = 64.0;
/// Slopes further apart than this have too few cells in common.
pub(super) const WIDEST: f64 = 0.125;

/// A point and a middle ray from it.
///
/// Components are in the order of the [`Shear`](crate::decide::Shear), the main axis last. Along it places are
/// measured in the sense of the rays, *ahead*; slopes are lengths across for each unit ahead.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    pub(super) main_axis: usize,
    /// The axes x, y and z.
    pub(super) axes: [usize; 3],
    /// 1 if the rays ascend along the main axis, -1 if they descend.
    pub(super) sense: f64,
    /// The point, as the rays give it.
    pub(super) given: DVec3,
    /// The same in the order of the shear.
    pub(super) ray_origin: DVec3,
    /// In the tree's space, the last component ahead.
    pub(super) origin: DVec3,
    /// A power of two, as in the tree's space.
    pub(super) scale: f64,
    /// The slopes of the middle ray.
    pub(super) middle: [f32; 2],
    /// The least and the greatest of the rays' deviations from them.
    pub(super) low: [f32; 2],
    pub(super) high: [f32; 2],
    /// Where the first of them begins.
    pub(super) begin: f32,
    /// That of one ray's direction. Cells come in its order, which need not be that of all others: no
    /// ray's answer depends on it.
    pub(super) octant: u8,
}

impl View {
    /// The point that some of the rays share, and a ray in the middle of them; `None` if they are no pencil.
    /// What they deviate is still to be found.
    #[inline(always)]
    pub(super) fn new(rays: &[Ray; WIDTH], space: &Space) -> Option<Self> {
        let (first, last) = (&rays[0], &rays[WIDTH - 1]);
        if first.origin != last.origin || !first.is_traceable() {
            return None;
        }
        let main_axis = main_axis(first.direction);
        let direction = permute(first.direction, main_axis);
        let sense = 1.0_f64.copysign(direction.z);
        let ray_origin = permute(first.origin, main_axis);
        let mut origin = (ray_origin - permute(space.center, main_axis)) * space.scale;
        origin.z *= sense;
        let is_near = origin.abs().max_element() <= FAR;
        let other = permute(last.direction, main_axis);
        let (first_slopes, last_slopes) = (direction / direction.z.abs(), other / other.z.abs());
        if (first_slopes - last_slopes).abs().max_element() > WIDEST {
            return None;
        }
        let DVec3 { x, y, .. } = 0.5 * (first_slopes + last_slopes);
        let middle = [x as f32, y as f32];
        let negative = |x: f64| (x.to_bits() >> 63) as u8;
        let DVec3 { x, y, z } = first.direction;
        let octant = negative(x) | negative(y) << 1 | negative(z) << 2;
        let [x, y, z] = AXES[main_axis % 3];
        let axes = [usize::from(x), usize::from(y), usize::from(z)];
        let ([low, high], scale, begin) = ([[0.0; 2]; 2], space.scale, 0.0);
        let view = Self {
            main_axis,
            axes,
            sense,
            given: first.origin,
            ray_origin,
            origin,
            scale,
            middle,
            low,
            high,
            begin,
            octant,
        };
        is_near.then_some(view)
    }

    pub(super) fn descends(&self) -> bool {
        self.sense < 0.0
    }
}
