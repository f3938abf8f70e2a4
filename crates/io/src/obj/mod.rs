//! Wavefront OBJ with MTL materials.

mod face;
mod mtl;
mod number;
mod palette;
mod polygon;
mod scan;
mod source;
mod totals;

use crate::loading::Loading;
use crate::{IoError, Loaded, Loader};
use globillum_material::{Bsdf, Emission, Material, Reflectance, Rgb};
use palette::Palette;
use scan::Scan;
use source::Source;
use std::path::Path;
use totals::Totals;

/// Loads the faces of a Wavefront OBJ file, with the materials of the libraries it names, within
/// the default [`Limits`](crate::Limits).
///
/// Triangles come in the order of the file's faces, degenerate ones left out; a face of more than
/// three vertices becomes a fan around its first. Indices must refer to what is defined above
/// them.
///
/// Of a material, `Kd` becomes a Lambertian albedo and `Ke` what is emitted from the front. It
/// is a mirror of reflectance `Ks` instead if it says `illum 3`, or has no `Kd`. Faces without a
/// material are Lambertian with an albedo of one half. Libraries are sought in the file's own
/// folder and below; texture maps and vertex normals are not used.
///
/// # Errors
/// An [`IoError`] that names file and line: for a file that can not be read or has no faces, a
/// malformed statement, an index out of range, a coordinate that is not finite or too large to be
/// traced, a library outside the folder, and a material that breaks
/// [`Material`](globillum_material::Material)'s bounds. A missing library or material is no error
/// but a [`Warning`](crate::Warning).
///
/// ```no_run
/// let loaded = globillum_io::load_obj("bunny.obj".as_ref())?;
/// for warning in &loaded.report.warnings {
///     eprintln!("{warning}");
/// }
/// println!("{} triangles", loaded.model.triangles().len());
/// # Ok::<(), globillum_io::IoError>(())
/// ```
pub fn load_obj(path: &Path) -> Result<Loaded, IoError> {
    Loader::new().load_obj(path)
}

pub(crate) fn load(mut loading: Loading<'_>) -> Result<Loaded, IoError> {
    let bytes = loading.jail.read_scene()?;
    let source = Source::of(loading.path, bytes, loading.limits)?;
    let default = loading.add_material(default_material());
    let totals = Totals::of(&source, loading.limits);
    let named = Scan::new(&mut loading, default, &totals)?.run(source.statements(), source.len())?;
    Palette::new(&named, &mut loading).load()?;
    loading.finish(Vec::new())
}

/// What faces are made of that have no material: a grey of one half.
fn default_material() -> Material {
    let half = Rgb::splat(0.5);
    Material { bsdf: Bsdf::Lambert(Reflectance::new(half).unwrap_or_default()), emission: Emission::NONE }
}
