use crate::RenderError;
use glam::DVec3;
use std::hash::Hasher;

/// Where a camera stands, and the unit vectors of its view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Orientation {
    pub(super) eye: DVec3,
    pub(super) forward: DVec3,
    pub(super) right: DVec3,
    pub(super) up: DVec3,
}

impl Orientation {
    /// At `eye`, looking at `target`, with `up` upward in the picture.
    ///
    /// # Errors
    /// [`RenderError::Camera`] if `eye` and `target` coincide, `up` is parallel to the view, or a
    /// coordinate is not finite.
    pub(super) fn look_at(eye: DVec3, target: DVec3, up: DVec3) -> Result<Self, RenderError> {
        let forward = (target - eye)
            .try_normalize()
            .ok_or(RenderError::Camera("eye and target must be finite and apart"))?;
        let parallel = RenderError::Camera("up must be finite and not parallel to the view");
        let up = up.try_normalize().ok_or(parallel.clone())?;
        let right = forward.cross(up);
        // Within rounding of parallel.
        if right.length() < 8.0 * f64::EPSILON {
            return Err(parallel);
        }
        let right = right.normalize();
        Ok(Self { eye, forward, right, up: right.cross(forward) })
    }

    /// Hands the vectors to `key`.
    pub(super) fn hash(&self, key: &mut dyn Hasher) {
        let vectors = [self.eye, self.forward, self.right, self.up];
        vectors.into_iter().flat_map(|v| v.to_array()).for_each(|x| key.write_u64(x.to_bits()));
    }
}
