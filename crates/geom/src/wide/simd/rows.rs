//! Rays and triangles as rows of numbers, as they are in memory.

use crate::{Ray, Triangle};
use glam::{DVec3, Vec3};
use std::mem::offset_of;

const F32: usize = size_of::<f32>();
const F64: usize = size_of::<f64>();

// What the casts below rest on.
const _: () = {
    assert!(offset_of!(DVec3, x) == 0 && offset_of!(DVec3, y) == F64 && offset_of!(DVec3, z) == 2 * F64);
    assert!(offset_of!(Ray, origin) == 0 && offset_of!(Ray, direction) == 3 * F64);
    assert!(offset_of!(Ray, t_min) == 6 * F64 && offset_of!(Ray, t_max) == 7 * F64);
    assert!(size_of::<Ray>() == 8 * F64 && align_of::<Ray>() == align_of::<f64>());
    assert!(offset_of!(Vec3, x) == 0 && offset_of!(Vec3, y) == F32 && offset_of!(Vec3, z) == 2 * F32);
    assert!(offset_of!(Triangle, vertices) == 0 && size_of::<[Vec3; 3]>() == 9 * F32);
    assert!(size_of::<Triangle>() == 9 * F32 && align_of::<Triangle>() == align_of::<f32>());
};

/// Origin, direction, `t_min` and `t_max`.
#[inline(always)]
pub(super) fn numbers(ray: &Ray) -> &[f64; 8] {
    // SAFETY: a ray is eight `f64`, in this order.
    unsafe { &*std::ptr::from_ref(ray).cast() }
}

/// The coordinates of the first vertex, the second and the third.
#[inline(always)]
pub(super) fn coordinates(triangle: &Triangle) -> &[f32; 9] {
    // SAFETY: a triangle is nine `f32`, in this order.
    unsafe { &*std::ptr::from_ref(triangle).cast() }
}
