use crate::RenderError;
use glam::DVec3;
use globillum_geom::Ray;

/// A pinhole camera.
///
/// ```
/// use glam::DVec3;
/// use globillum_integrator::Camera;
///
/// let (eye, target) = (DVec3::new(0.0, 1.0, 5.0), DVec3::ZERO);
/// let camera = Camera::look_at(eye, target, DVec3::Y, 40.0_f64.to_radians())?;
/// assert_eq!(camera.ray(0.0, 0.0, 1.0).origin, eye); // the middle of the picture
/// # Ok::<(), globillum_integrator::RenderError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    eye: DVec3,
    forward: DVec3,
    /// Half the picture's height at distance 1, along the picture's right and up.
    right: DVec3,
    up: DVec3,
}

impl Camera {
    /// A camera at `eye` that looks at `target`, with `up` upward in the picture and a vertical
    /// field of view of `fov_y` radians.
    ///
    /// # Errors
    /// [`RenderError::Camera`] if `eye` and `target` coincide, `up` is parallel to the view, or a
    /// coordinate is not finite; [`RenderError::Param`] unless `0 < fov_y < pi`.
    pub fn look_at(eye: DVec3, target: DVec3, up: DVec3, fov_y: f64) -> Result<Self, RenderError> {
        if !(fov_y > 0.0 && fov_y < std::f64::consts::PI) {
            return Err(RenderError::Param { name: "fov_y", value: fov_y, range: "(0, pi) radians" });
        }
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
        // libm gives the same bits on every platform.
        let half_height = libm::tan(0.5 * fov_y);
        Ok(Self { eye, forward, right: right * half_height, up: right.cross(forward) * half_height })
    }

    /// The origin of all rays.
    pub(crate) fn eye(&self) -> DVec3 {
        self.eye
    }

    /// The vectors that determine the camera.
    pub(crate) fn vectors(&self) -> [DVec3; 4] {
        [self.eye, self.forward, self.right, self.up]
    }

    /// The ray through the film at `x`, `y`, which run from -1 to 1 rightward and upward; `aspect` is the
    /// picture's width over its height. The direction is not a unit vector.
    pub fn ray(&self, x: f64, y: f64, aspect: f64) -> Ray {
        Ray::new(self.eye, self.forward + (x * aspect) * self.right + y * self.up)
    }
}
