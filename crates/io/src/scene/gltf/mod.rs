//! glTF 2.0, as text (.gltf) or binary (.glb).
//!
//! The crate `gltf` gives the types of the document. Its importer and its readers are not used, since they
//! panic on malformed files: container, accessors, nodes and URIs are checked here.

mod accessor;
mod buffer;
mod camera;
mod container;
mod document;
mod guard;
mod instance;
mod json_material;
mod light;
mod material;
mod primitive;
mod transform;
mod tree;
mod uri;

use crate::error::Result;
use crate::scene::loading::Loading;
use accessor::Accessors;
use buffer::Buffers;
use document::Document;
use tree::Tree;

/// Reads the content of a glTF file, text or binary, into `loading`. `luminous_efficacy`, in lumens per watt, converts the
/// units of delta lights.
pub(crate) fn read(bytes: &[u8], luminous_efficacy: f64, loading: &mut Loading<'_>) -> Result<()> {
    let container = container::open(bytes, loading)?;
    let document = Document::parse(&container, loading)?;
    let buffers = Buffers::of(&document, container.binary, loading)?;
    let tree = Tree::of(&document, loading)?;
    let materials = material::all(&document, loading)?;
    let accessors = Accessors::new(&document, &buffers);
    instance::add_all(&document, accessors, &tree, &materials, loading)?;
    light::add_all(&document, &tree, luminous_efficacy, loading)?;
    camera::add_all(&document, &tree, loading)
}
