use crate::loading::Loading;
use crate::path::extension_of;
use crate::{IoError, Limits, LoadReport};
use globillum_integrator::{Camera, Model};
use std::fmt;
use std::path::Path;

/// What is made of a scene file.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Loaded {
    /// Triangles with materials.
    pub model: Model,
    /// The file's cameras, if it has any.
    pub cameras: Vec<Camera>,
    /// What was passed over or approximated.
    pub report: LoadReport,
}

/// How far a loader has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct LoadProgress {
    /// What is done: bytes of OBJ, or triangles of glTF.
    pub done: u64,
    /// What there is to do.
    pub total: u64,
}

/// Watches a loader, and may stop it. Methods are called often: they should return at once.
pub trait LoadMonitor {
    /// Called every so often.
    fn progress(&self, _progress: LoadProgress) {}

    /// Asked as often; `true` ends loading with [`IoError::Cancelled`].
    fn cancelled(&self) -> bool {
        false
    }
}

/// Watches nothing.
impl LoadMonitor for () {}

/// Loads scene files: with other limits than the default ones, or watched.
///
/// ```no_run
/// use globillum_io::{Limits, LoadMonitor, LoadProgress, Loader};
///
/// struct Percent;
/// impl LoadMonitor for Percent {
///     fn progress(&self, progress: LoadProgress) {
///         eprintln!("{} %", 100 * progress.done / progress.total);
///     }
/// }
/// let mut limits = Limits::default();
/// limits.bytes = 1 << 20;
/// let loaded = Loader::new().limits(limits).monitor(&Percent).load("bunny.obj".as_ref())?;
/// # Ok::<(), globillum_io::IoError>(())
/// ```
#[derive(Clone, Copy)]
pub struct Loader<'a> {
    limits: Limits,
    monitor: &'a dyn LoadMonitor,
}

impl<'a> Loader<'a> {
    /// A loader with the default limits that nobody watches.
    pub fn new() -> Self {
        Self { limits: Limits::default(), monitor: &() }
    }

    /// The same loader with other limits.
    #[must_use]
    pub fn limits(self, limits: Limits) -> Self {
        Self { limits, ..self }
    }

    /// The same loader, watched by `monitor`.
    #[must_use]
    pub fn monitor<'b>(self, monitor: &'b dyn LoadMonitor) -> Loader<'b> {
        Loader { limits: self.limits, monitor }
    }

    /// Loads a scene in the format that its extension names, in upper or lower case.
    ///
    /// # Errors
    /// [`IoError::UnknownScene`] for any extension but those of the formats that were built in;
    /// else what the format's own function says.
    pub fn load(&self, path: &Path) -> Result<Loaded, IoError> {
        match extension_of(path).to_str() {
            #[cfg(feature = "obj")]
            Some("obj") => self.load_obj(path),
            #[cfg(feature = "gltf")]
            Some("gltf" | "glb") => self.load_gltf(path),
            _ => Err(IoError::UnknownScene { path: path.into(), supported: SUPPORTED }),
        }
    }

    /// [`load_obj`](crate::load_obj) with this loader's limits and monitor.
    ///
    /// # Errors
    /// Those of [`load_obj`](crate::load_obj).
    #[cfg(feature = "obj")]
    pub fn load_obj(&self, path: &Path) -> Result<Loaded, IoError> {
        crate::obj::load(self.start(path))
    }

    /// [`load_gltf`](crate::load_gltf) with this loader's limits and monitor.
    ///
    /// # Errors
    /// Those of [`load_gltf`](crate::load_gltf).
    #[cfg(feature = "gltf")]
    pub fn load_gltf(&self, path: &Path) -> Result<Loaded, IoError> {
        crate::gltf::load(self.start(path))
    }

    #[cfg(any(feature = "obj", feature = "gltf"))]
    fn start<'b>(&'b self, path: &'b Path) -> Loading<'b> {
        Loading::new(path, &self.limits, self.monitor)
    }
}

const SUPPORTED: &str = match (cfg!(feature = "obj"), cfg!(feature = "gltf")) {
    (true, true) => ".obj, .gltf and .glb",
    (true, false) => ".obj",
    (false, true) => ".gltf and .glb",
    (false, false) => "none",
};

impl Default for Loader<'_> {
    fn default() -> Self {
        Self::new()
    }
}

impl fmt::Debug for Loader<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Loader").field("limits", &self.limits).finish_non_exhaustive()
    }
}
