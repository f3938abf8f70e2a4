//! The form factor of a rectangle.

use std::f64::consts::TAU;

/// The form factor of a rectangle of sides `a` and `b` that is parallel to the receiver and has one corner at
/// height 1 above it. It is odd in each side, so that any rectangle is a sum of four.
pub fn corner(a: f64, b: f64) -> f64 {
    let part = |a: f64, b: f64| a / a.hypot(1.0) * (b / a.hypot(1.0)).atan();
    (part(a, b) + part(b, a)) / TAU
}
