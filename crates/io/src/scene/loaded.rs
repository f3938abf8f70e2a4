use crate::LoadReport;
use globillum_integrator::{MaterialId, Model, PinholeCamera};
use std::ops::Range;
use std::path::PathBuf;

/// The content of a scene file.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Loaded {
    /// Triangles with materials, and delta lights.
    pub model: Model,
    /// The cameras that can be used, in the order of their nodes. Those that cannot are left out, each with a warning, so
    /// that an index here need not be the camera's index in the file.
    pub cameras: Vec<PinholeCamera>,
    /// For each camera the ratio of width to height of the picture that the file means it for, positive and finite; `None`
    /// where it says no such ratio. A picture of another ratio keeps the vertical field of view.
    pub aspect_ratios: Vec<Option<f64>>,
    /// Content that is ignored or approximated.
    pub report: LoadReport,
    /// The materials with their names, in the order of the model's: those that `usemtl` names in an OBJ file, also if no
    /// library has them, or all of a glTF file. The material of faces without one is not among them.
    pub materials: Vec<NamedMaterial>,
    /// The objects of the file, in the order of their triangles; empty unless
    /// [asked for](crate::Loader::keep_objects).
    pub objects: Vec<Object>,
    /// The files that were read, in this order: the scene file, then those that it refers to, such as material libraries and
    /// buffers, by their names in its folder; no textures. One may be there several times.
    pub files: Vec<PathBuf>,
}

/// A material of a scene file by its name, for [`Model::set_material`]. [`MaterialId::index`] finds it in
/// [`Model::materials`]; after [`Model::append`] it is the material of the first model only.
///
/// ```no_run
/// use globillum_integrator::Model;
/// use globillum_material::{Material, Rgb};
///
/// /// The scene of a file, with a mirror in place of each material of this name.
/// fn polished(path: &str, name: &str) -> Result<Model, Box<dyn std::error::Error>> {
///     let mut loaded = globillum_io::load(path)?;
///     for material in loaded.materials.iter().filter(|material| material.name == name) {
///         loaded.model.set_material(material.id, Material::mirror(Rgb::splat(0.9))?);
///     }
///     Ok(loaded.model)
/// }
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct NamedMaterial {
    /// Its name in the file. In glTF other materials may share it, and one without a name is `material N`; in OBJ the name
    /// may be empty.
    pub name: String,
    /// The material of the model.
    pub id: MaterialId,
}

/// An object of a scene file: what follows a statement `o` or `g` of OBJ, or the mesh of a node of glTF.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Object {
    /// Its name in the file, which other objects may share. `default` for what follows no statement or one without a
    /// name, `node N` for a node without one.
    pub name: String,
    /// Its triangles in the model; none if all were degenerate.
    pub triangles: Range<usize>,
}
