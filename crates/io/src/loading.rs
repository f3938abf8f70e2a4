use crate::jail::Jail;
use crate::lights;
use crate::loader::{LoadMonitor, LoadProgress, Loaded};
use crate::{IoError, Limits, LoadReport, Location, Place, Warning, WarningKind};
use globillum_geom::Triangle;
use globillum_integrator::{Camera, MaterialId, Model};
use globillum_material::Material;
use std::io;
use std::path::Path;

/// The most steps between two looks at the monitor.
const STEPS_BETWEEN_REPORTS: u64 = 1 << 16;

/// Bytes of warnings that are kept, beyond a quarter of what the files have: three bytes may give rise to
/// one, and what holds them takes up to three times as much while it grows.
const ROOM_FOR_WARNINGS: u64 = 128 << 10;

/// A scene that is being loaded: what is known of it so far, and what watches over it.
pub(crate) struct Loading<'a> {
    pub(crate) path: &'a Path,
    pub(crate) limits: &'a Limits,
    pub(crate) jail: Jail<'a>,
    report: LoadReport,
    model: Model,
    monitor: &'a dyn LoadMonitor,
    reported: u64,
    bytes_of_warnings: u64,
    warnings_left_out: usize,
}

impl<'a> Loading<'a> {
    pub(crate) fn new(path: &'a Path, limits: &'a Limits, monitor: &'a dyn LoadMonitor) -> Self {
        let jail = Jail::around(path, limits);
        Self {
            path,
            limits,
            jail,
            report: LoadReport::default(),
            model: Model::default(),
            monitor,
            reported: 0,
            bytes_of_warnings: 0,
            warnings_left_out: 0,
        }
    }

    /// A place in the scene file.
    #[cfg(feature = "gltf")]
    pub(crate) fn at(&self, place: Place) -> Location {
        place.of(self.path)
    }

    /// Warns of something in the scene file.
    pub(crate) fn warn(&mut self, place: Place, kind: WarningKind) {
        self.warn_of(place.of(self.path), kind);
    }

    /// Warns of something in one of the scene's files, if there is room.
    pub(crate) fn warn_of(&mut self, at: Location, kind: WarningKind) {
        let warning = Warning { at, kind };
        let bytes = self.bytes_of_warnings + warning.bytes() as u64;
        if bytes <= ROOM_FOR_WARNINGS + self.jail.bytes_read() / 4 {
            self.bytes_of_warnings = bytes;
            self.report.warnings.push(warning);
        } else {
            self.warnings_left_out += 1;
        }
    }

    pub(crate) fn add_material(&mut self, material: Material) -> MaterialId {
        self.model.add_material(material)
    }

    #[cfg(feature = "obj")]
    pub(crate) fn set_material(&mut self, id: MaterialId, material: Material) {
        self.model.set_material(id, material);
    }

    /// Refuses to go on if there are to be more triangles than are allowed.
    #[cfg(feature = "gltf")]
    pub(crate) fn check_triangles(&self, count: u64) -> Result<(), IoError> {
        let too_large = |what, limit| Err(IoError::TooLarge { at: self.at(Place::File), what, limit });
        let Limits { triangles, instanced, .. } = *self.limits;
        if count > triangles {
            return too_large("triangles", triangles);
        }
        if count.saturating_sub(self.jail.bytes_read()) > instanced {
            return too_large("triangles made by placing meshes again", instanced);
        }
        Ok(())
    }

    /// Makes room for so many triangles more.
    pub(crate) fn try_grow(&mut self, count: usize) -> Result<(), IoError> {
        self.model.try_reserve(count).map_err(|_| self.out_of_memory())
    }

    /// That the machine has no memory for the scene.
    pub(crate) fn out_of_memory(&self) -> IoError {
        IoError::Read { path: self.path.into(), source: io::ErrorKind::OutOfMemory.into() }
    }

    /// Adds a triangle, unless nothing can hit it.
    pub(crate) fn add(&mut self, material: MaterialId, triangle: Triangle) {
        if triangle.is_degenerate() {
            self.report.degenerate_triangles += 1;
        } else {
            self.model.push(material, triangle);
        }
    }

    /// Tells the monitor, every so often.
    pub(crate) fn progress(&mut self, done: u64, total: u64) -> Result<(), IoError> {
        if done < total && done < self.reported.saturating_add(STEPS_BETWEEN_REPORTS) {
            return Ok(());
        }
        self.reported = done;
        self.monitor.progress(LoadProgress { done, total });
        if self.monitor.cancelled() { Err(IoError::Cancelled { path: self.path.into() }) } else { Ok(()) }
    }

    /// Looks the whole scene over and hands it out.
    pub(crate) fn finish(mut self, cameras: Vec<Camera>) -> Result<Loaded, IoError> {
        if self.model.triangles().is_empty() {
            return Err(IoError::Empty { path: self.path.into() });
        }
        // What is said of the scene as a whole has room.
        self.bytes_of_warnings = 0;
        let count = std::mem::take(&mut self.warnings_left_out);
        if count > 0 {
            self.warn(Place::File, WarningKind::LeftOut { count });
        }
        let count = self.report.degenerate_triangles;
        if count > 0 {
            self.warn(Place::File, WarningKind::Degenerate { count });
        }
        let emitting = lights::all(&self.model);
        if emitting.is_empty() {
            self.warn(Place::File, WarningKind::NoLight);
        } else {
            let count = lights::coplanar(&self.model, &emitting);
            if count > 0 {
                self.warn(Place::File, WarningKind::CoplanarLights { count });
            }
        }
        Ok(Loaded { model: self.model, cameras, report: self.report })
    }
}
