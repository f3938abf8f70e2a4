//! Cameras and colours on the command line, and the camera of a scene that has none.

mod any_camera;
mod axes;
mod flags;
mod inside;
mod outside;
pub(crate) mod sun;

pub(crate) use any_camera::{AnyCamera, CameraType};
pub use axes::Up;
pub(crate) use flags::{format_camera, format_vector, parse_any_camera};
pub use flags::{parse_camera, parse_colour};
pub use outside::of_all;

use globillum::geom::{Aabb, Accel};
use globillum::glam::DVec3;
use globillum::integrator::{PinholeCamera, RenderError, Scene};
use serde::Serialize;

/// Where a picture is seen from.
#[derive(Clone, Copy, Debug)]
pub(crate) enum View {
    /// By the camera of the flag.
    Given(AnyCamera),
    /// By the scene's camera, as one of this type.
    Own(PinholeCamera, CameraType, Up),
    /// By a camera of this type that depends on the scene.
    Automatic(CameraType, Up),
}

/// Who chose a camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum CameraBy {
    /// The flag `--camera`.
    Flag,
    /// The scene file, or the built-in scene.
    Scene,
    /// Nobody: it stands outside the scene.
    Outside,
    /// Nobody: it stands inside a room.
    Inside,
}

impl View {
    /// The direction in which it looks; that of an automatic camera outside a scene with these `bounds`.
    ///
    /// # Errors
    /// [`RenderError::Camera`] if an automatic camera finds no extent.
    fn forward(&self, bounds: &Aabb) -> Result<DVec3, RenderError> {
        Ok(match self {
            Self::Given(camera) => camera.forward(),
            Self::Own(camera, ..) => camera.ray(0.0, 0.0, 1.0).direction,
            Self::Automatic(_, up) => of_all(bounds, *up, 1.0)?.ray(0.0, 0.0, 1.0).direction,
        })
    }

    /// The camera for a picture `aspect` times as wide as high. If `cancelled`, the search for an automatic one ends early
    /// with any.
    ///
    /// # Errors
    /// [`RenderError::Camera`] if the scene has no extent.
    pub(crate) fn camera<A: Accel>(
        self,
        scene: &Scene<A>,
        aspect: f64,
        cancelled: &(dyn Fn() -> bool + Sync),
    ) -> Result<(AnyCamera, CameraBy), RenderError> {
        let (camera, by, camera_type, up) = match self {
            Self::Given(camera) => return Ok((camera, CameraBy::Flag)),
            Self::Own(camera, camera_type, up) => (camera, CameraBy::Scene, camera_type, up),
            Self::Automatic(camera_type, up) => {
                let outside = of_all(&scene.triangles().bounds(), up, aspect)?;
                let inside = inside::of_room(scene, up, aspect, &outside, cancelled)?;
                let by = if inside.is_some() { CameraBy::Inside } else { CameraBy::Outside };
                (inside.unwrap_or(outside), by, camera_type, up)
            }
        };
        let bounds = scene.triangles().bounds();
        let middle = bounds.center();
        Ok((AnyCamera::like(camera, camera_type, middle, up.axes().y_axis)?, by))
    }
}
