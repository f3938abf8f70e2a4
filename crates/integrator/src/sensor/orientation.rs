use crate::RenderError;
use glam::{DVec2, DVec3};
use std::hash::Hasher;

/// Where a camera stands, and the unit vectors of its view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Orientation {
    pub(super) eye: DVec3,
    pub(super) forward: DVec3,
    pub(super) right: DVec3,
    pub(super) up: DVec3,
}

/// The sine of an angle below which vectors are nearly parallel.
const NEARLY_PARALLEL: f64 = 1e-6;

impl Orientation {
    /// At `eye`, looking at `target`, with `up` upward in the picture.
    ///
    /// # Errors
    /// [`RenderError::Camera`] if `eye` and `target` coincide, `up` is parallel to the view, or a
    /// coordinate is not finite.
    pub(super) fn look_at(eye: DVec3, target: DVec3, up: DVec3) -> Result<Self, RenderError> {
        let forward =
            direction(target - eye).ok_or(RenderError::Camera("eye and target must be finite and apart"))?;
        let parallel = RenderError::Camera("up must be finite and not parallel to the view");
        let up = direction(up).ok_or(parallel.clone())?;
        let right = forward.cross(up);
        let sine = right.length();
        // Within rounding of parallel.
        if sine < 8.0 * f64::EPSILON {
            return Err(parallel);
        }
        let mut right = right.normalize();
        if sine < NEARLY_PARALLEL {
            // Rounding is a large part of the product, also along the view.
            right = (right - right.dot(forward) * forward).normalize();
        }
        Ok(Self { eye, forward, right, up: right.cross(forward) })
    }

    /// The coordinates of `v` along right, over the aspect, and up, in units of their lengths.
    pub(super) fn in_plane(&self, v: DVec3, aspect: f64) -> DVec2 {
        let along = |axis: DVec3| v.dot(axis) / axis.length_squared();
        DVec2::new(along(self.right) / aspect, along(self.up))
    }

    /// Hands the vectors to `key`.
    pub(super) fn hash(&self, key: &mut dyn Hasher) {
        let vectors = [self.eye, self.forward, self.right, self.up];
        vectors.into_iter().flat_map(|v| v.to_array()).for_each(|x| key.write_u64(x.to_bits()));
    }
}

/// The unit vector along `v`; `None` if it is 0 or not finite.
fn direction(v: DVec3) -> Option<DVec3> {
    let size = v.abs().max_element();
    // Of others, squares may overflow, or lose digits.
    let has_squares = (1e-100..1e100).contains(&size);
    (if has_squares { v } else { v / size }).try_normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_orthonormal_also_near_the_limit() {
        for exponent in 1..=14 {
            let forward = DVec3::new(0.3, -0.5, 0.7).normalize();
            let up = forward + 10.0_f64.powi(-exponent) * DVec3::new(0.6, 0.7, 0.2);
            let Orientation { forward, right, up, .. } =
                Orientation::look_at(DVec3::ZERO, forward, up).expect("the vectors are not parallel");
            for product in [right.dot(forward), up.dot(forward), right.dot(up)] {
                assert!(product.abs() < 1e-9, "1e-{exponent}: {product}");
            }
            for axis in [forward, right, up] {
                assert!((axis.length() - 1.0).abs() < 1e-15, "1e-{exponent}: {axis}");
            }
        }
    }

    #[test]
    fn the_size_of_vectors_does_not_matter() {
        let ordinary = Orientation::look_at(DVec3::ZERO, DVec3::Z, DVec3::Y).expect("they are not parallel");
        for size in [1e-300, 1e-160, 1e160, 1e300] {
            let scaled = Orientation::look_at(DVec3::ZERO, size * DVec3::Z, size * DVec3::Y);
            assert_eq!(scaled.expect("they are not parallel"), ordinary, "{size}");
        }
        for v in [DVec3::ZERO, DVec3::splat(f64::INFINITY), DVec3::new(1.0, f64::NAN, 0.0)] {
            assert!(Orientation::look_at(DVec3::ZERO, DVec3::X, v).is_err(), "{v}");
            assert!(Orientation::look_at(DVec3::ZERO, v, DVec3::Y).is_err(), "{v}");
        }
    }
}
