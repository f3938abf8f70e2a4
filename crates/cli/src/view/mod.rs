//! Cameras and colours on the command line, and the camera of a scene that has none.

mod axes;
mod flags;
mod inside;
mod outside;

pub use axes::Up;
pub(crate) use flags::{format_camera, format_vector};
pub use flags::{parse_camera, parse_colour};
pub use outside::of_all;

use globillum::geom::Accel;
use globillum::integrator::{Camera, RenderError, Scene};
use serde::Serialize;

/// Where a picture is seen from.
#[derive(Clone, Copy, Debug)]
pub(crate) enum View {
    Fixed(Camera, CameraBy),
    /// By a camera that depends on the scene.
    Automatic(Up),
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
    /// The camera for a picture `aspect` times as wide as high.
    ///
    /// # Errors
    /// [`RenderError::Camera`] if the scene has no extent.
    pub(crate) fn camera<A: Accel>(
        self,
        scene: &Scene<A>,
        aspect: f64,
    ) -> Result<(Camera, CameraBy), RenderError> {
        let up = match self {
            Self::Fixed(camera, by) => return Ok((camera, by)),
            Self::Automatic(up) => up,
        };
        let outside = of_all(&scene.triangles().bounds(), up, aspect)?;
        let inside = inside::of_room(scene, up, aspect, &outside)?;
        Ok(inside.map_or((outside, CameraBy::Outside), |camera| (camera, CameraBy::Inside)))
    }
}
