use super::orientation::Orientation;
use super::sample::{ElementSample, PathStart, Sensor};
use crate::RenderError;
use glam::{DVec2, DVec3};
use globillum_geom::Ray;
use std::f64::consts::{FRAC_PI_2, PI};
use std::hash::Hasher;

/// A camera that sees all directions (an equirectangular projection): panoramas of 360 x 180 degrees.
///
/// Columns are longitudes, from -180 degrees at the left to 180 at the right; rows are latitudes, from 90 degrees at
/// the top to -90 at the bottom. A pixel is the mean over its longitudes and latitudes, so those near the poles stand
/// for less solid angle. In a picture twice as wide as high, pixels at the horizon are square.
///
/// ```
/// use glam::DVec3;
/// use globillum_integrator::SphericalCamera;
///
/// let camera = SphericalCamera::look_at(DVec3::ZERO, -DVec3::Z, DVec3::Y)?;
/// let is_toward = |x, y, direction: DVec3| camera.ray(x, y).direction.dot(direction) > 1.0 - 1e-15;
/// assert!(is_toward(0.0, 0.0, -DVec3::Z) && is_toward(0.5, 0.0, DVec3::X) && is_toward(0.3, 1.0, DVec3::Y));
/// # Ok::<(), globillum_integrator::RenderError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphericalCamera {
    view: Orientation,
}

impl SphericalCamera {
    /// A camera at `eye` with `target` in the middle of the picture. For a level horizon, `target` is as high as
    /// `eye`.
    ///
    /// # Errors
    /// [`RenderError::Camera`] if `eye` and `target` coincide, `up` is parallel to the view, or a
    /// coordinate is not finite.
    pub fn look_at(eye: DVec3, target: DVec3, up: DVec3) -> Result<Self, RenderError> {
        Ok(Self { view: Orientation::look_at(eye, target, up)? })
    }

    /// The ray through the film at `x`, `y`, which run from -1 to 1: longitude over 180 degrees and latitude over 90.
    /// The direction is a unit vector.
    pub fn ray(&self, x: f64, y: f64) -> Ray {
        let Orientation { eye, forward, right, up } = self.view;
        // libm gives the same bits on every platform.
        let (sin_longitude, cos_longitude) = libm::sincos(PI * x);
        let (sin_latitude, cos_latitude) = libm::sincos(FRAC_PI_2 * y);
        let level = sin_longitude * right + cos_longitude * forward;
        Ray::new(eye, cos_latitude * level + sin_latitude * up)
    }
}

impl Sensor for SphericalCamera {
    fn start(&self, sample: &ElementSample) -> PathStart {
        PathStart::Ray(self.ray(sample.x, sample.y))
    }

    fn project(&self, point: DVec3, _aspect: f64) -> Option<DVec2> {
        let Orientation { eye, forward, right, up } = self.view;
        let toward = point - eye;
        let [ahead, aside, above] = [forward, right, up].map(|axis| toward.dot(axis));
        let latitude = libm::atan2(above, libm::hypot(ahead, aside));
        Some(DVec2::new(libm::atan2(aside, ahead) / PI, latitude / FRAC_PI_2))
    }

    fn hash(&self, key: &mut dyn Hasher) {
        key.write(b"spherical");
        self.view.hash(key);
    }
}
