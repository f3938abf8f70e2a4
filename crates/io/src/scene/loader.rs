use crate::path::extension_of;
use crate::scene::files::Storage;
use crate::scene::loaded::Loaded;
use crate::scene::loading::Loading;
use crate::{IoError, Limits, LoadMonitor, Place};
use std::fmt;
use std::path::Path;

/// Loads scene files, on disk or in memory, within given [`Limits`], observed by a [`LoadMonitor`].
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
/// let loaded = Loader::new().limits(limits).monitor(&Percent).load("bunny.obj")?;
/// # Ok::<(), globillum_io::IoError>(())
/// ```
#[derive(Clone, Copy)]
pub struct Loader<'a> {
    storage: Storage<'a>,
    limits: Limits,
    monitor: &'a dyn LoadMonitor,
    luminous_efficacy: f64,
    keeps_objects: bool,
}

impl<'a> Loader<'a> {
    /// A loader of files on disk, with the default limits and no monitor.
    pub fn new() -> Self {
        let (storage, limits) = (Storage::Disk, Limits::default());
        Self { storage, limits, monitor: &(), luminous_efficacy: 683.0, keeps_objects: false }
    }

    /// The same loader, which reads these files, each with its name and its content, and none on disk. The scene file and
    /// those that it refers to, such as material libraries and buffers, are found by their names. A name may have folders,
    /// separated by `/`; upper and lower case differ; `./` changes nothing. Of equal names the first counts. Files that are
    /// read are copied.
    ///
    /// ```
    /// use globillum_io::Loader;
    ///
    /// # #[cfg(feature = "obj")] {
    /// // A program may contain its files, by `include_bytes!`.
    /// let obj = b"mtllib floor.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl floor\nf 1 2 3";
    /// let mtl = b"newmtl floor\nKd 0.7 0.6 0.5";
    /// let files: [(&str, &[u8]); 2] = [("floor.obj", obj), ("floor.mtl", mtl)];
    /// let loaded = Loader::new().files(&files).load("floor.obj")?;
    /// assert_eq!(loaded.materials[0].name, "floor");
    /// # }
    /// # Ok::<(), globillum_io::IoError>(())
    /// ```
    #[must_use]
    pub fn files(self, files: &'a [(&'a str, &'a [u8])]) -> Self {
        Self { storage: Storage::Memory(files), ..self }
    }

    /// The same loader with other limits.
    #[must_use]
    pub fn limits(self, limits: Limits) -> Self {
        Self { limits, ..self }
    }

    /// The same loader, observed by `monitor`.
    #[must_use]
    pub fn monitor(self, monitor: &'a dyn LoadMonitor) -> Self {
        Self { monitor, ..self }
    }

    /// The same loader with a luminous efficacy of `lumens_per_watt` for the delta lights of glTF.
    ///
    /// The extension KHR_lights_punctual states intensities in candela and irradiances in lux, which are
    /// divided by this number. The default, 683, is the efficacy of monochromatic light of 555 nm. Blender's
    /// exporter multiplies by it, so delta lights have the scale of emissive materials, which are in watts. A
    /// number that is not positive makes each delta light an error.
    #[must_use]
    pub fn luminous_efficacy(self, lumens_per_watt: f64) -> Self {
        Self { luminous_efficacy: lumens_per_watt, ..self }
    }

    /// The same loader, which also lists the [objects](Loaded::objects) of the file.
    #[must_use]
    pub fn keep_objects(self) -> Self {
        Self { keeps_objects: true, ..self }
    }

    /// Loads a scene in the format given by the extension of `path`, in upper or lower case.
    ///
    /// # Errors
    /// [`IoError::UnknownScene`] for any extension but those of the enabled formats; otherwise the errors
    /// of the format's own function.
    pub fn load(&self, path: impl AsRef<Path>) -> Result<Loaded, IoError> {
        let path = path.as_ref();
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
    pub fn load_obj(&self, path: impl AsRef<Path>) -> Result<Loaded, IoError> {
        let path = path.as_ref();
        self.load_by(path, crate::scene::obj::read)
    }

    /// [`load_gltf`](crate::load_gltf) with this loader's limits and monitor.
    ///
    /// # Errors
    /// Those of [`load_gltf`](crate::load_gltf).
    #[cfg(feature = "gltf")]
    pub fn load_gltf(&self, path: impl AsRef<Path>) -> Result<Loaded, IoError> {
        let path = path.as_ref();
        self.load_by(path, |bytes, loading| crate::scene::gltf::read(&bytes, self.luminous_efficacy, loading))
    }

    /// Loads the file `path` by `read`, which reads its content.
    fn load_by(
        &self,
        path: &Path,
        read: impl FnOnce(Vec<u8>, &mut Loading<'_>) -> crate::error::Result<()>,
    ) -> Result<Loaded, IoError> {
        let mut loading = Loading::new(path, self.storage, &self.limits, self.monitor);
        loading.objects = self.keeps_objects.then(Vec::new);
        let bytes = loading.files.read(path)?;
        if bytes.is_empty() {
            return Err(IoError::Parse { at: Place::File.of(path), message: "file is empty".into() });
        }
        read(bytes, &mut loading)?;
        loading.finish()
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
        f.debug_struct("Loader")
            .field("limits", &self.limits)
            .field("luminous_efficacy", &self.luminous_efficacy)
            .field("keeps_objects", &self.keeps_objects)
            .finish_non_exhaustive()
    }
}

/// Loads a scene in the format given by the extension of `path`, within the default [`Limits`].
///
/// # Errors
/// Those of [`Loader::load`].
pub fn load(path: impl AsRef<Path>) -> Result<Loaded, IoError> {
    Loader::new().load(path)
}

#[cfg(feature = "obj")]
/// Loads the faces of a Wavefront OBJ file and the materials of its libraries, within the default
/// [`Limits`].
///
/// Triangles have the order of the file's faces. A face with more than three vertices becomes a fan around
/// its first vertex. Degenerate triangles are dropped. The index of a vertex must refer to one above it in
/// the file.
///
/// A material is Lambertian with the albedo `Kd`, or a mirror. It is a mirror if `Pm` exceeds `Pr`; without `Pm`, if it has
/// `Ks` that is not black and `illum 3`, or `Ks` and neither `Kd` nor `map_Kd`. The mirror's reflectance is `Kd`, or `Ks`
/// where `Kd` is absent, black, or far darker; docs/scenes.md has the whole rule. A texture of `Kd` or `Ks` counts as a
/// grey of 0.5, which multiplies it. `Ke` is the radiance emitted from the front, unless there is a `map_Ke`. Faces without
/// a material are Lambertian with an albedo of one half. Colours are rounded to `f32`. Libraries must be in the file's
/// folder or below it. Textures and vertex normals are not read.
///
/// # Errors
/// An [`IoError`] that names file and line: for a file that cannot be read or has no faces, a malformed
/// statement, an index out of range, a coordinate that is not finite or exceeds
/// [`MAX_COORDINATE`](globillum_geom::Triangle::MAX_COORDINATE), a library outside the folder, and a material
/// outside the bounds of [`Material`](globillum_material::Material). A missing library or material is a
/// [`Warning`](crate::Warning).
///
/// ```no_run
/// let loaded = globillum_io::load_obj("bunny.obj")?;
/// for warning in &loaded.report.warnings {
///     eprintln!("{warning}");
/// }
/// println!("{} triangles", loaded.model.triangles().len());
/// # Ok::<(), globillum_io::IoError>(())
/// ```
pub fn load_obj(path: impl AsRef<Path>) -> Result<Loaded, IoError> {
    Loader::new().load_obj(path)
}

#[cfg(feature = "gltf")]
/// Loads the default scene of a glTF 2.0 file, text or binary, within the default [`Limits`].
///
/// Triangles have the order of the scene's nodes, depth first, in world space. Degenerate triangles are
/// dropped. A transform that mirrors keeps the front of each triangle. Strips and fans become single
/// triangles.
///
/// A material is an ideal mirror if its `metallicFactor` exceeds its `roughnessFactor` and it has no
/// `metallicRoughnessTexture`, and Lambertian otherwise; `baseColorFactor` is the reflectance, halved if there is a
/// `baseColorTexture`. A material that is only approximated is reported. Without an `emissiveTexture` it emits
/// `emissiveFactor` times the strength of `KHR_materials_emissive_strength` from the front, or from both sides if it is
/// `doubleSided`. Primitives without a material are Lambertian and white.
///
/// The point, spot and directional lights of `KHR_lights_punctual` become delta lights. Their candela and lux
/// are divided by 683 lumens per watt, or by [`Loader::luminous_efficacy`]; with 1 they stay as they are in
/// the file. Their `range` is ignored. Equal angles of a spot light make a sharp edge.
///
/// Textures, vertex normals, skins, morph targets, animations and other extensions are not read. Numbers in
/// the JSON are rounded to `f32`.
///
/// # Errors
/// An [`IoError`] that names the file and the element: for malformed JSON, inconsistent structures or data, node graphs
/// that are not trees, a required extension that is not supported and may change triangles, lights or cameras, a file
/// outside the scene's folder, a delta light with an invalid cone or intensity, a coordinate that is not finite or exceeds
/// [`MAX_COORDINATE`](globillum_geom::Triangle::MAX_COORDINATE), and a material outside the bounds of
/// [`Material`](globillum_material::Material).
///
/// ```no_run
/// let loaded = globillum_io::load_gltf("box.glb")?;
/// println!("{} triangles, {} cameras", loaded.model.triangles().len(), loaded.cameras.len());
/// # Ok::<(), globillum_io::IoError>(())
/// ```
pub fn load_gltf(path: impl AsRef<Path>) -> Result<Loaded, IoError> {
    Loader::new().load_gltf(path)
}
