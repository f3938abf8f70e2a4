use glam::DVec3;
use globillum_geom::GeomError;
use globillum_material::{MaterialError, Rgb};
use std::io::ErrorKind;
use std::ops::Range;
use thiserror::Error;

/// Why a scene could not be built or a picture not be rendered.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RenderError {
    /// The triangles are invalid, or the accelerator could not be built.
    #[error(transparent)]
    Geometry(#[from] GeomError),
    /// The accelerator has other bounds than the triangles that it was to be built over.
    #[error("the accelerator is not one over the scene's triangles: its bounds differ from theirs")]
    OtherTriangles,
    /// A radiance or a reflectance is out of range.
    #[error(transparent)]
    Material(#[from] MaterialError),
    /// A delta light is invalid.
    #[error(transparent)]
    DeltaLight(#[from] DeltaLightError),
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
    /// A range of passes, rows or columns is empty or backward, does not lie within `0..end`, or has an end that is
    /// neither a multiple of `step` nor `end`.
    #[error(
        "{name} {}..{} must be a range within 0..{end} with at least one element{}",
        asked.start, asked.end, multiples(*step, *end)
    )]
    Range {
        /// What is asked for.
        name: &'static str,
        /// The range.
        asked: Range<u32>,
        /// How many there are.
        end: u32,
        /// The step of the ends.
        step: u32,
    },
    /// The settings have another size than the sensor.
    #[error("settings of {} x {} elements for a sensor of {} x {}", settings[0], settings[1], sensor[0], sensor[1])]
    SensorSize {
        /// Width and height of the settings.
        settings: [u32; 2],
        /// Width and height of the sensor's grid.
        sensor: [u32; 2],
    },
    /// A list of points is invalid.
    #[error(transparent)]
    Point(#[from] PointError),
    /// The camera's position and direction are invalid.
    #[error("camera: {0}")]
    Camera(&'static str),
    /// What a sample measures is NaN or infinite, or the sensor started it with a ray that cannot be traced, or at a point
    /// that is not finite or has no unit normal. Such samples are never dropped.
    #[error(
        "pixel ({x}, {y}), sample {sample}: the sample is not finite, or the sensor returned an invalid ray or point"
    )]
    NonFinite {
        /// Column of the pixel.
        x: u32,
        /// Row of the pixel, 0 at the top.
        y: u32,
        /// Index of the sample within the pixel.
        sample: u32,
    },
    /// A panic before the first tile, while probes and photons are traced: in an accelerator,
    /// [`Sensor::start`](crate::Sensor::start), [`Sensor::project`](crate::Sensor::project) or
    /// [`Monitor::cancelled`](crate::Monitor::cancelled). The process and later renders go on.
    #[error("panic before the first tile: {message}")]
    Preparation {
        /// The message of the panic.
        message: String,
    },
    /// A panic while a tile was rendered: in an accelerator, [`Sensor::start`](crate::Sensor::start),
    /// [`Monitor::progress`](crate::Monitor::progress) or [`Monitor::cancelled`](crate::Monitor::cancelled). A replay reports
    /// panics before its tile so, too, also in [`Sensor::project`](crate::Sensor::project). The process and later renders go
    /// on.
    #[error("panic in the tile at pixel ({x}, {y}): {message}")]
    Worker {
        /// Column of the tile's upper left pixel. While a guide is trained, that of the tile that trains; of a replay, that
        /// of the pixel's tile; of first hits, 0, and `y` is their row.
        x: u32,
        /// Row of that pixel, 0 at the top.
        y: u32,
        /// The message of the panic.
        message: String,
    },
    /// [`Monitor::pass_done`](crate::Monitor::pass_done), or [`Monitor::progress`](crate::Monitor::progress) after a pass,
    /// panicked.
    #[error("panic in the monitor after {samples} samples per pixel: {message}")]
    Monitor {
        /// Samples per pixel of the picture passed to it.
        samples: u32,
        /// The message of the panic.
        message: String,
    },
    /// The picture to resume cannot be continued.
    #[error("the picture to resume {0}")]
    Checkpoint(CheckpointError),
    /// The system refuses the memory that a picture takes. One that is promised more memory than there is may still end the
    /// process.
    #[error("{} x {} pixels take at least {bytes} bytes of memory, which the system refuses", size[0], size[1])]
    Memory {
        /// Width and height of what was to be rendered.
        size: [u32; 2],
        /// The bytes that its first pass holds at least.
        bytes: u64,
    },
    /// The worker threads could not be started.
    #[error("worker threads: {0}")]
    Threads(String),
}

/// What is said of the ends of a range; nothing if all are allowed.
fn multiples(step: u32, end: u32) -> String {
    if step == 1 { String::new() } else { format!(", whose ends are multiples of {step} or {end}") }
}

/// Why a list of points cannot be measured.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum PointError {
    /// The list is empty.
    #[error("there are no points")]
    Empty,
    /// A coordinate is not finite or larger in magnitude than
    /// [`Triangle::MAX_COORDINATE`](globillum_geom::Triangle::MAX_COORDINATE).
    #[error("position {position} of point {index} is not finite or beyond the domain of +-2^60")]
    Position {
        /// Which point, from 0.
        index: usize,
        /// Its position.
        position: DVec3,
    },
    /// The length of the normal is not 1 up to rounding.
    #[error("normal {normal} of point {index} is not a unit vector: its length is {}", normal.length())]
    Normal {
        /// Which point, from 0.
        index: usize,
        /// Its normal.
        normal: DVec3,
    },
}

/// Why a delta light is invalid.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum DeltaLightError {
    /// A coordinate is not finite or larger in magnitude than
    /// [`Triangle::MAX_COORDINATE`](globillum_geom::Triangle::MAX_COORDINATE).
    #[error("position {0} of a delta light is not finite or beyond the domain of +-2^60")]
    Position(DVec3),
    /// The direction is zero or not finite.
    #[error("direction {0} of a delta light is zero or not finite")]
    Direction(DVec3),
    /// A component of intensity or irradiance is negative, not finite, or beyond the range of
    /// [`DeltaLight`](crate::DeltaLight).
    #[error("{0} of a delta light has a component that is neither 0 nor within [1e-50, 1e50]")]
    Value(Rgb),
    /// The angles of a cone are not `0 <= inner < outer <= pi / 2`, or the cosine of `outer` rounds to 1.
    #[error("the cone of a spot light has the angles {inner} and {outer}, not 0 <= inner < outer <= pi/2")]
    Cone {
        /// The inner angle in radians.
        inner: f64,
        /// The outer angle in radians.
        outer: f64,
    },
}

/// Why a checkpoint cannot be used. Messages continue a sentence that begins with the name of the checkpoint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// It could not be read.
    #[error("cannot be read: {0}")]
    Read(ErrorKind),
    /// The first bytes are not those of a checkpoint.
    #[error("is not a checkpoint")]
    NoCheckpoint,
    /// The checkpoint has another version of the format.
    #[error("is a checkpoint of version {0}; this program reads version {CHECKPOINT_VERSION}")]
    Version(u32),
    /// The length differs from what the header says: bytes are missing or were added.
    #[error("has a length that does not match its header")]
    Length,
    /// The checksum is wrong: some bytes were changed.
    #[error("is damaged: its checksum is wrong")]
    Checksum,
    /// A value is one that no render writes.
    #[error("has an invalid {0}")]
    Malformed(&'static str),
    /// The checkpoint belongs to a picture that differs in what is named here.
    #[error("belongs to another picture: the {0} differs")]
    Mismatch(&'static str),
    /// Its last pass is incomplete, since the number of samples was not a multiple of `pass_samples`. No pass can follow it.
    #[error(
        "cannot be continued: its last pass is incomplete, since its samples are not a multiple of those of a pass"
    )]
    CutShort,
    /// It holds more samples than are asked for.
    #[error("holds more samples than are asked for")]
    TooManySamples,
    /// Its rows hold different passes, or it lacks some: it can be merged, but not be continued.
    #[error("holds different passes in different rows")]
    Uneven,
    /// Both pictures hold the same pass.
    #[error("pass {pass} is held twice")]
    Overlap {
        /// The first pass that both hold.
        pass: u32,
    },
}

impl CheckpointError {
    /// For keys that differ.
    pub(crate) const OTHER_PICTURE: Self = Self::Mismatch("scene, camera, settings or build");
}

/// The version of the checkpoint format that this library writes and reads.
pub(crate) const CHECKPOINT_VERSION: u32 = 5;

/// Why checkpoints cannot be merged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum MergeError {
    /// There is nothing to merge.
    #[error("there is not a checkpoint to merge")]
    Empty,
    /// A checkpoint cannot be used, or belongs to another picture than the first.
    #[error("checkpoint {index} {error}")]
    Input {
        /// Which one, from 0.
        index: usize,
        /// Why.
        error: CheckpointError,
    },
    /// Two checkpoints hold the same pass of a row, and are not the same.
    #[error("checkpoints {} and {} differ and both hold pass {pass} of row {row}", indices[0], indices[1])]
    Overlap {
        /// Which ones, from 0.
        indices: [usize; 2],
        /// The first pass that both hold.
        pass: u32,
        /// In this row, the first.
        row: u32,
    },
    /// What was done with the rows failed.
    #[error("{0}")]
    Write(ErrorKind),
}
