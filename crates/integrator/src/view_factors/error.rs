use crate::CheckpointError;
use thiserror::Error;

/// Why view factors could not be computed.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum FactorError {
    /// The patches are not those of the triangles.
    #[error("patches are given for {patched} triangles; the scene has {triangles}")]
    Patches {
        /// The number of triangles that the patches divide.
        patched: usize,
        /// The number of triangles of the scene.
        triangles: usize,
    },
    /// The accelerator has other bounds than the triangles.
    #[error("the accelerator is not one over these triangles: its bounds differ from theirs")]
    OtherTriangles,
    /// No triangle of a patch has an area, so no ray can leave it.
    #[error("patch {patch} has no triangle with an area")]
    EmptyPatch {
        /// The first such patch.
        patch: u32,
    },
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
    /// No factor is as large as those that the goal is about ([`FactorSettings::least_factor`]): not one upper end of
    /// their 95 % intervals is. The goal cannot be reached.
    ///
    /// [`FactorSettings::least_factor`]: super::FactorSettings::least_factor
    #[error("no factor reaches least_factor = {least}: they are {most:.4} at most")]
    NoneAsLarge {
        /// [`FactorSettings::least_factor`](super::FactorSettings::least_factor).
        least: f64,
        /// The largest upper end.
        most: f64,
    },
    /// The view factors to resume are of another run.
    #[error(
        "belongs to other view factors: the scene, patches, rays of a pass, other settings or build differ"
    )]
    OtherRun,
    /// A checkpoint cannot be used.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// A panic while the rays of a patch were traced: in an accelerator,
    /// [`Monitor::progress`](crate::Monitor::progress) or [`Monitor::cancelled`](crate::Monitor::cancelled).
    #[error("panic in patch {patch}: {message}")]
    Worker {
        /// The patch.
        patch: u32,
        /// The message of the panic.
        message: String,
    },
    /// [`Monitor::pass_done`](crate::Monitor::pass_done) panicked.
    #[error("panic in the monitor after {passes} passes: {message}")]
    Monitor {
        /// Passes of the view factors passed to it.
        passes: u32,
        /// The message of the panic.
        message: String,
    },
    /// The worker threads could not be started.
    #[error("worker threads: {0}")]
    Threads(String),
}
