//! Wavefront OBJ with MTL materials.

mod mtl;
mod palette;
mod scan;
mod source;
mod triangulate;
mod warning;

use crate::IoError;
use globillum_integrator::Model;
use mtl::Description;
use palette::Palette;
use scan::Scan;
use source::Source;
use std::path::Path;
pub use warning::Warning;

/// What [`load_obj`] makes of a file.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Loaded {
    /// Triangles with materials.
    pub model: Model,
    /// What was passed over, if anything.
    pub warnings: Vec<Warning>,
}

/// Loads the faces of a Wavefront OBJ file, with the materials of the libraries it names.
///
/// Triangles come in the order of the file's faces; a face of more than three vertices becomes a
/// fan around its first. Indices must refer to what is defined above them.
///
/// Of a material, `Kd` becomes a Lambertian albedo and `Ke` what is emitted from the front. It
/// is a mirror of reflectance `Ks` instead if it says `illum 3`, or has no `Kd`. Faces without a
/// material are Lambertian with an albedo of one half. Libraries are sought in the file's own
/// folder and below; texture maps and vertex normals are not used.
///
/// # Errors
/// An [`IoError`] that names file and line: for a file that can not be read or has no faces, a
/// malformed statement, an index out of range, a coordinate that is not finite, a library
/// outside the folder, and a material that breaks [`Material`](globillum_material::Material)'s
/// bounds. A missing library or material is no error but a [`Warning`].
///
/// ```no_run
/// let loaded = globillum_io::load_obj("bunny.obj".as_ref())?;
/// for warning in &loaded.warnings {
///     eprintln!("{warning}");
/// }
/// println!("{} triangles", loaded.model.triangles().len());
/// # Ok::<(), globillum_io::IoError>(())
/// ```
pub fn load_obj(path: &Path) -> Result<Loaded, IoError> {
    let source = Source::read(path)?;
    let scan = Scan::of(&source)?;
    let mut warnings = Vec::new();
    let palette = Palette::load(&scan.libraries, &mut warnings)?;
    warnings.extend(passed_over(&scan, &palette));
    let model = model(path, &scan, &palette)?;
    Ok(Loaded { model, warnings })
}

fn passed_over(scan: &Scan<'_>, palette: &Palette) -> impl Iterator<Item = Warning> {
    let unknown = scan.materials.iter().filter(|(name, _)| !palette.ids.contains_key(**name));
    let unknown = unknown.map(|(&name, first_use)| {
        let (path, line) = first_use.place();
        Warning::UnknownMaterial { path, line, name: name.into() }
    });
    let short = scan.short_faces.map(|(first, count)| {
        let (path, line) = first.place();
        Warning::ShortFaces { path, line, count }
    });
    unknown.chain(short)
}

/// One addition for each run of faces of one material, which keeps the file's order.
fn model(path: &Path, scan: &Scan<'_>, palette: &Palette) -> Result<Model, IoError> {
    let default = Description::default().material().map_err(|e| triangulate::failed(path, &e.to_string()))?;
    let mut model = Model::default();
    for mesh in triangulate::meshes(path, &scan.triangles, &palette.ids)? {
        let material = mesh.material_id.map_or(default, |id| palette.materials[id]);
        model.add(material, triangulate::triangles(&mesh));
    }
    if model.triangles().is_empty() { Err(IoError::Empty { path: path.into() }) } else { Ok(model) }
}
