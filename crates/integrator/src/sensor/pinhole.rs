use super::orientation::Orientation;
use super::sample::{ElementSample, PathStart, Sensor};
use crate::RenderError;
use crate::param::Param;
use glam::{DVec2, DVec3};
use globillum_geom::Ray;
use std::hash::Hasher;

/// A pinhole camera.
///
/// ```
/// use glam::DVec3;
/// use globillum_integrator::PinholeCamera;
///
/// let (eye, target) = (DVec3::new(0.0, 1.0, 5.0), DVec3::ZERO);
/// let camera = PinholeCamera::look_at(eye, target, DVec3::Y, 40.0_f64.to_radians())?;
/// assert_eq!(camera.ray(0.0, 0.0, 1.0).origin, eye); // the middle of the picture
/// # Ok::<(), globillum_integrator::RenderError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PinholeCamera {
    /// Right and up are half the picture's height at distance 1.
    view: Orientation,
}

impl PinholeCamera {
    /// A camera at `eye` that looks at `target`, with `up` upward in the picture and a vertical
    /// field of view of `fov_y` radians.
    ///
    /// # Errors
    /// [`RenderError::Camera`] if `eye` and `target` coincide, `up` is parallel to the view, or a
    /// coordinate is not finite; [`RenderError::Param`] unless `0 < fov_y < pi`.
    pub fn look_at(eye: DVec3, target: DVec3, up: DVec3, fov_y: f64) -> Result<Self, RenderError> {
        let is_angle = fov_y > 0.0 && fov_y < std::f64::consts::PI;
        Param::check([Param::new(is_angle, "fov_y", fov_y, "(0, pi) radians")])?;
        let Orientation { eye, forward, right, up } = Orientation::look_at(eye, target, up)?;
        // libm gives the same bits on every platform.
        let half_height = libm::tan(0.5 * fov_y);
        Ok(Self { view: Orientation { eye, forward, right: right * half_height, up: up * half_height } })
    }

    /// The ray through the film at `x`, `y`, which run from -1 to 1 rightward and upward; `aspect` is the
    /// picture's width over its height. The direction is not a unit vector.
    pub fn ray(&self, x: f64, y: f64, aspect: f64) -> Ray {
        let Orientation { eye, forward, right, up } = self.view;
        Ray::new(eye, forward + (x * aspect) * right + y * up)
    }
}

impl Sensor for PinholeCamera {
    #[inline]
    fn start(&self, sample: &ElementSample) -> PathStart {
        PathStart::Ray(self.ray(sample.x, sample.y, sample.aspect))
    }

    fn project(&self, point: DVec3, aspect: f64) -> Option<DVec2> {
        let (view, toward) = (&self.view, point - self.view.eye);
        let depth = toward.dot(view.forward);
        (depth > 0.0).then(|| view.in_plane(toward / depth, aspect))
    }

    fn hash(&self, key: &mut dyn Hasher) {
        key.write(b"pinhole");
        self.view.hash(key);
    }
}
