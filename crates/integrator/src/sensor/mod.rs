//! Sensors: what a render measures with. The pinhole camera is one.

mod camera;
mod irradiance_points;
mod orientation;
mod orthographic;
mod sample;
mod spherical;

pub use camera::Camera;
pub use irradiance_points::{IrradiancePoints, Reading};
pub use orthographic::OrthographicCamera;
pub use sample::{ElementSample, PathStart, Sensor};
pub use spherical::SphericalCamera;
