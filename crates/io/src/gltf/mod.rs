//! glTF 2.0, as text (.gltf) or binary (.glb).

mod accessor;
mod buffer;
mod camera;
mod container;
mod document;
mod instance;
mod json;
mod list;
mod material;
mod pending;
mod primitive;
mod transform;
mod tree;
mod uri;

use crate::loading::Loading;
use crate::{IoError, Loaded, Loader};
use accessor::Accessors;
use buffer::Buffers;
use document::Document;
use std::path::Path;
use tree::Tree;

/// Loads the default scene of a glTF 2.0 file, text or binary, within the default
/// [`Limits`](crate::Limits).
///
/// Triangles come in the order of the scene's nodes, depth first, degenerate ones left out; each is
/// moved to where its node places it, and its winding is flipped if that mirrors it. Strips and
/// fans become single triangles.
///
/// A material becomes Lambertian with `baseColorFactor` as its albedo, or an ideal mirror with
/// that reflectance if it is more metallic than rough; unless it is ideal already, that is
/// reported. It emits `emissiveFactor` times the strength of `KHR_materials_emissive_strength`
/// from the front, or from both sides if it is `doubleSided`. Primitives without a material are
/// Lambertian and white. Textures, vertex normals, skins, morph targets, animations and other
/// extensions are not used.
///
/// # Errors
/// An [`IoError`] that names the file and the element: for malformed JSON, structures that
/// contradict each other or the data, node graphs that are not trees, a required extension that
/// is not known, files outside the scene's folder, coordinates that are not finite or too large
/// to be traced, and materials that break [`Material`](globillum_material::Material)'s bounds.
///
/// ```no_run
/// let loaded = globillum_io::load_gltf("box.glb".as_ref())?;
/// println!("{} triangles, {} cameras", loaded.model.triangles().len(), loaded.cameras.len());
/// # Ok::<(), globillum_io::IoError>(())
/// ```
pub fn load_gltf(path: &Path) -> Result<Loaded, IoError> {
    Loader::new().load_gltf(path)
}

pub(crate) fn load(mut loading: Loading<'_>) -> Result<Loaded, IoError> {
    let bytes = loading.jail.read_scene()?;
    let container = container::open(&bytes, loading.path)?;
    let document = Document::parse(&container, &mut loading)?;
    let buffers = Buffers::of(&document, container.binary, &mut loading)?;
    let tree = Tree::of(&document, &mut loading)?;
    let materials = material::all(&document, &mut loading)?;
    let accessors = Accessors::new(&document, &buffers);
    instance::add_all(&document, accessors, &tree, &materials, &mut loading)?;
    let cameras = camera::all(&document, &tree, &mut loading)?;
    loading.finish(cameras)
}
