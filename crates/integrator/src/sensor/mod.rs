//! Sensors: what a render measures with. The pinhole camera is one.

mod irradiance_points;
mod orientation;
mod orthographic;
mod pinhole;
mod sample;
mod spherical;

pub use irradiance_points::{IrradiancePoints, Reading};
pub use orthographic::OrthographicCamera;
pub use pinhole::PinholeCamera;
pub use sample::{ElementSample, PathStart, Sensor};
pub use spherical::SphericalCamera;
