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

use crate::error::Result;
use crate::loading::Loading;
use accessor::Accessors;
use buffer::Buffers;
use document::Document;
use tree::Tree;

/// Reads the content of a glTF file, text or binary, into `loading`.
pub(crate) fn read(bytes: Vec<u8>, loading: &mut Loading<'_>) -> Result<()> {
    let container = container::open(&bytes, loading.path)?;
    let document = Document::parse(&container, loading)?;
    let buffers = Buffers::of(&document, container.binary, loading)?;
    let tree = Tree::of(&document, loading)?;
    let materials = material::all(&document, loading)?;
    let accessors = Accessors::new(&document, &buffers);
    instance::add_all(&document, accessors, &tree, &materials, loading)?;
    loading.cameras = camera::all(&document, &tree, loading)?;
    Ok(())
}
