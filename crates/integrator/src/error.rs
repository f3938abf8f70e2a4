use crate::CheckpointError;
use globillum_geom::GeomError;
use globillum_material::MaterialError;
use thiserror::Error;

/// Why a scene could not be set up, or a picture not be rendered.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RenderError {
    /// The triangles were refused, or the accelerator could not be built.
    #[error(transparent)]
    Geometry(#[from] GeomError),
    /// A radiance or a reflectance was refused.
    #[error(transparent)]
    Material(#[from] MaterialError),
    /// A parameter is out of its range.
    #[error("{name} = {value} is outside {range}")]
    Param {
        /// The parameter's name.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The range it must lie in.
        range: &'static str,
    },
    /// The camera can not be placed as asked.
    #[error("camera: {0}")]
    Camera(&'static str),
    /// A sample came out NaN or infinite; it is never dropped or painted black.
    #[error("pixel ({x}, {y}), sample {sample}: radiance is not finite")]
    NonFinite {
        /// Column of the pixel.
        x: u32,
        /// Row of the pixel, 0 at the top.
        y: u32,
        /// Index of the sample within the pixel.
        sample: u32,
    },
    /// Something panicked while a tile was rendered: an accelerator or a monitor. The process and
    /// later renders go on.
    #[error("panic in the tile at pixel ({x}, {y}): {message}")]
    Worker {
        /// Column of the tile's upper left pixel.
        x: u32,
        /// Row of it, 0 at the top.
        y: u32,
        /// What the panic said.
        message: String,
    },
    /// A checkpoint can not be used.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// The worker threads could not be started.
    #[error("worker threads: {0}")]
    Threads(String),
}
