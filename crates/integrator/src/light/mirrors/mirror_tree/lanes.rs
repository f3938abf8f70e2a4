//! Numbers and vectors of a node's children side by side, in plain loops that the compiler vectorizes.

use crate::light::child_weights::{WIDTH, child_of};
use glam::DVec3;

/// A number for each child, by lane. Single precision is enough for what only guides sampling.
pub(super) type Lanes = [f32; WIDTH];

/// A number of each child; 0 where there is no child.
pub(super) fn lanes<T>(children: &[T], value: &dyn Fn(&T) -> f64) -> Lanes {
    std::array::from_fn(|lane| children.get(child_of(lane)).map_or(0.0, |child| value(child) as f32))
}

/// A vector of each child, by component.
pub(super) fn vector_lanes<T>(children: &[T], value: &dyn Fn(&T) -> DVec3) -> [Lanes; 3] {
    [0, 1, 2].map(|k| lanes(children, &|child| value(child)[k]))
}

/// The vector of lane `i`.
#[inline(always)]
pub(super) fn lane(vectors: &[Lanes; 3], i: usize) -> [f32; 3] {
    [vectors[0][i], vectors[1][i], vectors[2][i]]
}

#[inline(always)]
pub(super) fn minus(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [0, 1, 2].map(|k| a[k] - b[k])
}

#[inline(always)]
pub(super) fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub(super) fn length(a: [f32; 3]) -> f32 {
    dot(a, a).sqrt()
}

#[inline(always)]
pub(super) fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[inline(always)]
pub(super) fn abs(a: f32) -> f32 {
    a.abs()
}

#[inline(always)]
pub(super) fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[inline(always)]
pub(super) fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}
