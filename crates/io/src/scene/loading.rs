use crate::error::Result;
#[cfg(feature = "gltf")]
use crate::limits::check_count;
use crate::scene::files::{SceneFiles, Storage};
use crate::scene::lint;
use crate::scene::loaded::{Loaded, NamedMaterial, Object};
use crate::{IoError, Limits, LoadMonitor, LoadProgress, LoadReport, Location, Place, Warning, WarningKind};
use globillum_geom::Triangle;
#[cfg(feature = "gltf")]
use globillum_integrator::DeltaLight;
use globillum_integrator::{MaterialId, Model, PinholeCamera};
use globillum_material::Material;
use std::io;
use std::path::Path;

/// The maximum amount of work between two calls of the monitor.
const STEPS_BETWEEN_REPORTS: u64 = 1 << 16;

/// The report keeps this many bytes of warnings beyond a quarter of the files' size. Three bytes of a file
/// can cause a warning, and a growing vector takes up to three times the memory of its content.
const ROOM_FOR_WARNINGS: u64 = 128 << 10;

/// The state of loading a scene: its limits, its monitor, and the result so far.
pub(crate) struct Loading<'a> {
    pub(crate) path: &'a Path,
    pub(crate) limits: &'a Limits,
    pub(crate) files: SceneFiles<'a>,
    pub(crate) cameras: Vec<PinholeCamera>,
    pub(crate) aspect_ratios: Vec<Option<f64>>,
    materials: Vec<NamedMaterial>,
    /// `None` if nobody asks for them.
    pub(crate) objects: Option<Vec<Object>>,
    report: LoadReport,
    model: Model,
    monitor: &'a dyn LoadMonitor,
    reported: u64,
    bytes_of_warnings: u64,
    warnings_left_out: usize,
}

impl<'a> Loading<'a> {
    pub(crate) fn new(
        path: &'a Path,
        storage: Storage<'a>,
        limits: &'a Limits,
        monitor: &'a dyn LoadMonitor,
    ) -> Self {
        let files = SceneFiles::around(path, storage, limits);
        let (report, model) = (LoadReport::default(), Model::default());
        let (cameras, reported, bytes_of_warnings, warnings_left_out) = (Vec::new(), 0, 0, 0);
        Self {
            path,
            limits,
            files,
            cameras,
            aspect_ratios: Vec::new(),
            materials: Vec::new(),
            objects: None,
            report,
            model,
            monitor,
            reported,
            bytes_of_warnings,
            warnings_left_out,
        }
    }

    /// The location of a place in the scene file.
    #[cfg(feature = "gltf")]
    pub(crate) fn at(&self, place: Place) -> Location {
        place.of(self.path)
    }

    /// Adds a warning about the scene file.
    pub(crate) fn warn(&mut self, place: Place, kind: WarningKind) {
        self.warn_of(place.of(self.path), kind);
    }

    /// Adds a warning about any file of the scene, or counts it if the report has no room.
    pub(crate) fn warn_of(&mut self, at: Location, kind: WarningKind) {
        let warning = Warning { at, kind };
        let bytes = self.bytes_of_warnings + warning.bytes() as u64;
        if bytes <= ROOM_FOR_WARNINGS + self.files.bytes_read() / 4 {
            self.bytes_of_warnings = bytes;
            self.report.warnings.push(warning);
        } else {
            self.warnings_left_out += 1;
        }
    }

    /// Adds a material without a name.
    pub(crate) fn add_material(&mut self, material: Material) -> MaterialId {
        self.model.add_material(material)
    }

    /// Adds a material of this name.
    pub(crate) fn add_named_material(&mut self, name: String, material: Material) -> MaterialId {
        let id = self.add_material(material);
        self.materials.push(NamedMaterial { name, id });
        id
    }

    #[cfg(feature = "gltf")]
    pub(crate) fn add_delta_light(&mut self, light: DeltaLight) {
        self.model.add_delta_light(light);
    }

    #[cfg(feature = "obj")]
    pub(crate) fn set_material(&mut self, id: MaterialId, material: Material) {
        self.model.set_material(id, material);
    }

    /// An error if `count` triangles exceed the limits.
    #[cfg(feature = "gltf")]
    pub(crate) fn check_triangles(&self, count: u64) -> Result<()> {
        self.check_count(count, self.limits.triangles, "triangles")?;
        let beyond = count.saturating_sub(self.files.bytes_read());
        self.check_count(beyond, self.limits.instanced, "triangles of repeated mesh instances")
    }

    /// An error about the scene file as a whole if `count` exceeds `limit`.
    #[cfg(feature = "gltf")]
    pub(crate) fn check_count(&self, count: u64, limit: u64, what: &'static str) -> Result<()> {
        check_count(count, limit, what, || self.at(Place::File))
    }

    /// An index as `usize`, or an error `at` its place if it is not below `count`.
    #[cfg(feature = "gltf")]
    pub(crate) fn check_index(
        &self,
        at: Place,
        index: u64,
        count: usize,
        what: &'static str,
    ) -> Result<usize> {
        if index < count as u64 {
            Ok(index as usize)
        } else {
            Err(IoError::Index { at: self.at(at), index: index as i64, count, what })
        }
    }

    /// Reserves memory for `count` more triangles.
    pub(crate) fn try_grow(&mut self, count: usize) -> Result<()> {
        self.model.try_reserve(count).map_err(|_| self.out_of_memory())
    }

    /// The error for a failed allocation.
    pub(crate) fn out_of_memory(&self) -> IoError {
        IoError::Read { path: self.path.into(), source: io::ErrorKind::OutOfMemory.into() }
    }

    /// Begins an object: the triangles that follow belong to it.
    pub(crate) fn begin_object(&mut self, name: impl FnOnce() -> String) {
        let start = self.model.triangles().len();
        if let Some(objects) = &mut self.objects {
            objects.push(Object { name: name(), triangles: start..start });
        }
    }

    /// Adds a triangle. A degenerate triangle is only counted, since no ray can hit it.
    pub(crate) fn add(&mut self, material: MaterialId, triangle: Triangle) {
        if triangle.is_degenerate() {
            self.report.degenerate_triangles += 1;
        } else {
            self.model.push(material, triangle);
            if let Some(object) = self.objects.as_mut().and_then(|objects| objects.last_mut()) {
                object.triangles.end = self.model.triangles().len();
            }
        }
    }

    /// Calls the monitor at regular intervals of work.
    pub(crate) fn progress(&mut self, done: u64, total: u64) -> Result<()> {
        if done < total && done < self.reported.saturating_add(STEPS_BETWEEN_REPORTS) {
            return Ok(());
        }
        self.reported = done;
        self.monitor.progress(LoadProgress { done, total });
        if self.monitor.cancelled() { Err(IoError::Cancelled { path: self.path.into() }) } else { Ok(()) }
    }

    /// Checks the complete scene and returns it.
    pub(crate) fn finish(mut self) -> Result<Loaded> {
        // The report always has room for warnings about the scene as a whole.
        self.bytes_of_warnings = 0;
        let count = std::mem::take(&mut self.warnings_left_out);
        if count > 0 {
            self.warn(Place::File, WarningKind::LeftOut { count });
        }
        let count = self.report.degenerate_triangles;
        if count > 0 {
            self.warn(Place::File, WarningKind::Degenerate { count });
        }
        if self.model.triangles().is_empty() {
            return Err(IoError::Empty { path: self.path.into(), skipped: self.report.skipped() });
        }
        if let Some(kind) = lint::check_lights(&self.model) {
            self.warn(Place::File, kind);
        }
        let objects = self.objects.unwrap_or_default();
        let Self { model, cameras, aspect_ratios, materials, report, files, .. } = self;
        Ok(Loaded { model, cameras, aspect_ratios, materials, report, objects, files: files.paths_read })
    }
}
