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
    /// Something panicked while a tile was rendered or before the first one: an accelerator, or
    /// [`Monitor::progress`](crate::Monitor::progress) or
    /// [`Monitor::cancelled`](crate::Monitor::cancelled). The process and later renders go on.
    #[error("panic in the tile at pixel ({x}, {y}): {message}")]
    Worker {
        /// Column of the tile's upper left pixel; 0 before the first tile.
        x: u32,
        /// Row of it, 0 at the top.
        y: u32,
        /// What the panic said.
        message: String,
    },
    /// [`Monitor::pass_done`](crate::Monitor::pass_done) panicked.
    #[error("panic in the monitor, which was handed {samples} samples a pixel: {message}")]
    Monitor {
        /// Samples of each pixel of the picture that it was handed.
        samples: u32,
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

/// Why a checkpoint can not be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// It does not begin as a checkpoint does.
    #[error("is no checkpoint")]
    NoCheckpoint,
    /// It was written by another version of the format.
    #[error("is a checkpoint of version {0}; this program reads version {CHECKPOINT_VERSION}")]
    Version(u32),
    /// It has another length than its header says: it was cut short, or more was added.
    #[error("has another length than its header says")]
    Length,
    /// Its bytes are not those that were written.
    #[error("is damaged: its checksum is wrong")]
    Checksum,
    /// It holds what no render writes.
    #[error("holds an impossible {0}")]
    Malformed(&'static str),
    /// It is of another picture: what is named here differs.
    #[error("belongs to another picture: the {0} differs")]
    Mismatch(&'static str),
    /// A pass that is there already.
    #[error("pass {pass} is held twice")]
    Overlap {
        /// The first such pass.
        pass: u32,
    },
}

/// The version of the checkpoint format that this library writes and reads.
pub(crate) const CHECKPOINT_VERSION: u32 = 2;
