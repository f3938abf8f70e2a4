use clap::ValueEnum;
use globillum::glam::DVec3;
use globillum::integrator::{OrthographicCamera, PinholeCamera, RenderError, Sensor, SphericalCamera};
use serde::Serialize;

/// How a camera maps directions to the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum CameraType {
    /// Perspective, as most cameras
    #[default]
    Pinhole,
    /// Parallel rays: plans and elevations
    Orthographic,
    /// All directions (equirectangular): longitude rightward, latitude upward
    #[value(name = "360")]
    #[serde(rename = "360")]
    Spherical,
}

/// A camera of any type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum AnyCamera {
    Pinhole(PinholeCamera),
    Orthographic(OrthographicCamera),
    Spherical(SphericalCamera),
}

impl AnyCamera {
    /// A camera of another type that stands and looks as `camera`. An orthographic one shows as much of the plane
    /// through `near`; a spherical one has `up` upward.
    pub(super) fn like(
        camera: PinholeCamera,
        camera_type: CameraType,
        near: DVec3,
        up: DVec3,
    ) -> Result<Self, RenderError> {
        let ray = camera.ray(0.0, 0.0, 1.0);
        let (eye, forward) = (ray.origin, ray.direction);
        let own_up = camera.ray(0.0, 1.0, 1.0).direction - forward;
        Ok(match camera_type {
            CameraType::Pinhole => Self::Pinhole(camera),
            CameraType::Orthographic => {
                let depth = forward.dot(near - eye) / forward.length_squared();
                let height = 2.0 * own_up.length() * depth.abs().max(f64::MIN_POSITIVE);
                Self::Orthographic(OrthographicCamera::look_at(eye, eye + forward, own_up, height)?)
            }
            CameraType::Spherical => {
                let level = forward - forward.dot(up) * up;
                let forward = if level.length() > 1e-6 * forward.length() { level } else { own_up };
                Self::Spherical(SphericalCamera::look_at(eye, eye + forward, up)?)
            }
        })
    }

    /// The direction of the middle of its picture, of any length.
    pub(super) fn forward(&self) -> DVec3 {
        match self {
            Self::Pinhole(camera) => camera.ray(0.0, 0.0, 1.0).direction,
            Self::Orthographic(camera) => camera.ray(0.0, 0.0, 1.0).direction,
            Self::Spherical(camera) => camera.ray(0.0, 0.0).direction,
        }
    }

    pub(crate) fn sensor(&self) -> &dyn Sensor {
        match self {
            Self::Pinhole(camera) => camera,
            Self::Orthographic(camera) => camera,
            Self::Spherical(camera) => camera,
        }
    }

    /// The camera, if it is a pinhole.
    pub(crate) fn pinhole(&self) -> Option<&PinholeCamera> {
        if let Self::Pinhole(camera) = self { Some(camera) } else { None }
    }

    pub(crate) fn camera_type(&self) -> CameraType {
        match self {
            Self::Pinhole(_) => CameraType::Pinhole,
            Self::Orthographic(_) => CameraType::Orthographic,
            Self::Spherical(_) => CameraType::Spherical,
        }
    }
}
