//! The unit roundoffs, by their names in docs/numerics.md.

/// `eps`, the unit roundoff of `f64`: `2^-53`.
pub(crate) const EPS: f64 = f64::EPSILON / 2.0;

/// `w`, the unit roundoff of `f32`: `2^-24`.
pub(crate) const W: f32 = f32::EPSILON / 2.0;

/// [`W`], for bounds that are evaluated in `f64`.
pub(crate) const W_F64: f64 = W as f64;
