use super::orientation::Orientation;
use super::sample::{ElementSample, PathStart, Sensor};
use crate::RenderError;
use crate::param::Param;
use glam::{DVec2, DVec3};
use globillum_geom::Ray;
use std::hash::Hasher;

/// A camera of parallel rays (an orthographic projection): plans and elevations.
///
/// Its rays begin in the plane through the eye, perpendicular to the view. What is behind it is not seen.
///
/// ```
/// use glam::DVec3;
/// use globillum_integrator::OrthographicCamera;
///
/// // A plan, ten units high, of what lies below height 3.
/// let (eye, down) = (DVec3::new(0.0, 3.0, 0.0), DVec3::ZERO);
/// let camera = OrthographicCamera::look_at(eye, down, -DVec3::Z, 10.0)?;
/// let corner = camera.ray(1.0, 1.0, 1.5);
/// assert_eq!((corner.origin, corner.direction), (DVec3::new(7.5, 3.0, -5.0), -DVec3::Y));
/// # Ok::<(), globillum_integrator::RenderError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrthographicCamera {
    /// Right and up are half the picture's height.
    view: Orientation,
}

impl OrthographicCamera {
    /// A camera in the plane of `eye` that looks toward `target`, with `up` upward in the picture. `eye` is in the
    /// middle of the picture, which shows `height` units of length from its bottom to its top.
    ///
    /// # Errors
    /// [`RenderError::Camera`] if `eye` and `target` coincide, `up` is parallel to the view, or a
    /// coordinate is not finite; [`RenderError::Param`] unless `height` is positive and finite.
    pub fn look_at(eye: DVec3, target: DVec3, up: DVec3, height: f64) -> Result<Self, RenderError> {
        Param::check([Param::positive("height", height)])?;
        let Orientation { eye, forward, right, up } = Orientation::look_at(eye, target, up)?;
        let half = 0.5 * height;
        Ok(Self { view: Orientation { eye, forward, right: right * half, up: up * half } })
    }

    /// The ray through the film at `x`, `y`, which run from -1 to 1 rightward and upward; `aspect` is the
    /// picture's width over its height. The direction is a unit vector.
    pub fn ray(&self, x: f64, y: f64, aspect: f64) -> Ray {
        let Orientation { eye, forward, right, up } = self.view;
        Ray::new(eye + (x * aspect) * right + y * up, forward)
    }
}

impl Sensor for OrthographicCamera {
    fn start(&self, sample: &ElementSample) -> PathStart {
        PathStart::Ray(self.ray(sample.x, sample.y, sample.aspect))
    }

    fn project(&self, point: DVec3, aspect: f64) -> Option<DVec2> {
        let (view, toward) = (&self.view, point - self.view.eye);
        (toward.dot(view.forward) > 0.0).then(|| view.in_plane(toward, aspect))
    }

    fn hash(&self, key: &mut dyn Hasher) {
        key.write(b"orthographic");
        self.view.hash(key);
    }
}
