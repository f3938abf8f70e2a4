//! The structures of glTF JSON that a scene needs.
//!
//! The structures of the `gltf` crate are not used, since they read an index of 2^32 as 0 and keep more
//! content. Strings are borrowed from the file where possible, and lists stay in it. `KEPT` is that of
//! [`List`].

use super::list::{Count, Indices, List};
use serde::Deserialize;
use std::borrow::Cow;

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Root<'a, const KEPT: bool> {
    #[serde(borrow)]
    pub(super) asset: Asset<'a>,
    pub(super) scene: Option<u32>,
    #[serde(borrow, default)]
    pub(super) scenes: List<'a, Scene<'a, KEPT>, KEPT>,
    #[serde(borrow, default)]
    pub(super) nodes: List<'a, Node<'a, KEPT>, KEPT>,
    #[serde(borrow, default)]
    pub(super) meshes: List<'a, Mesh<'a, KEPT>, KEPT>,
    #[serde(borrow, default)]
    pub(super) accessors: List<'a, Accessor, KEPT>,
    #[serde(borrow, default)]
    pub(super) buffer_views: List<'a, BufferView, KEPT>,
    #[serde(borrow, default)]
    pub(super) buffers: List<'a, Buffer<'a>, KEPT>,
    #[serde(borrow, default)]
    pub(super) materials: List<'a, Material<'a>, KEPT>,
    #[serde(borrow, default)]
    pub(super) cameras: List<'a, Camera<'a>, KEPT>,
    #[serde(borrow, default)]
    pub(super) images: List<'a, Image<'a>, KEPT>,
    #[serde(default)]
    pub(super) animations: Count<Ignored>,
    #[serde(borrow, default)]
    pub(super) extensions_used: List<'a, Text<'a>, KEPT>,
    #[serde(borrow, default)]
    pub(super) extensions_required: List<'a, Text<'a>, KEPT>,
}

/// A value of which only the presence matters.
#[derive(Default, Deserialize)]
pub(super) struct Ignored {}

#[derive(Deserialize)]
pub(super) struct Text<'a>(#[serde(borrow)] pub(super) Cow<'a, str>);

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Asset<'a> {
    #[serde(borrow)]
    pub(super) version: Text<'a>,
    #[serde(borrow)]
    pub(super) min_version: Option<Text<'a>>,
}

#[derive(Deserialize)]
pub(super) struct Scene<'a, const KEPT: bool> {
    #[serde(borrow, default)]
    pub(super) nodes: Indices<'a, KEPT>,
}

#[derive(Deserialize)]
pub(super) struct Node<'a, const KEPT: bool> {
    #[serde(borrow, default)]
    pub(super) children: Indices<'a, KEPT>,
    pub(super) mesh: Option<u32>,
    pub(super) camera: Option<u32>,
    pub(super) skin: Option<u32>,
    /// Boxed like the three below, since most nodes of a large scene have at most one of them.
    pub(super) matrix: Option<Box<[f64; 16]>>,
    pub(super) translation: Option<Box<[f64; 3]>>,
    pub(super) rotation: Option<Box<[f64; 4]>>,
    pub(super) scale: Option<Box<[f64; 3]>>,
}

#[derive(Deserialize)]
pub(super) struct Mesh<'a, const KEPT: bool> {
    #[serde(borrow)]
    pub(super) primitives: List<'a, Primitive, KEPT>,
}

#[derive(Deserialize)]
pub(super) struct Primitive {
    pub(super) attributes: Attributes,
    pub(super) indices: Option<u32>,
    pub(super) material: Option<u32>,
    #[serde(default = "triangles")]
    pub(super) mode: u32,
    #[serde(default)]
    pub(super) targets: Count<Ignored>,
}

/// The default mode: separate triangles.
fn triangles() -> u32 {
    4
}

#[derive(Deserialize)]
#[serde(rename_all = "UPPERCASE")]
pub(super) struct Attributes {
    pub(super) position: Option<u32>,
    pub(super) normal: Option<u32>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    pub(super) buffer_view: Option<u32>,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) component_type: u32,
    pub(super) count: u64,
    #[serde(rename = "type")]
    pub(super) shape: Shape,
    pub(super) sparse: Option<Sparse>,
}

#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
pub(super) enum Shape {
    Scalar,
    Vec2,
    Vec3,
    Vec4,
    Mat2,
    Mat3,
    Mat4,
}

#[derive(Deserialize)]
pub(super) struct Sparse {
    pub(super) count: u64,
    pub(super) indices: SparseIndices,
    pub(super) values: SparseValues,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseIndices {
    pub(super) buffer_view: u32,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) component_type: u32,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseValues {
    pub(super) buffer_view: u32,
    #[serde(default)]
    pub(super) byte_offset: u64,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct BufferView {
    pub(super) buffer: u32,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) byte_length: u64,
    pub(super) byte_stride: Option<u64>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Buffer<'a> {
    #[serde(borrow)]
    pub(super) uri: Option<Text<'a>>,
    pub(super) byte_length: u64,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Image<'a> {
    #[serde(borrow)]
    pub(super) uri: Option<Text<'a>>,
    pub(super) buffer_view: Option<u32>,
    #[serde(borrow)]
    pub(super) mime_type: Option<Text<'a>>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Material<'a> {
    #[serde(borrow)]
    pub(super) name: Option<Text<'a>>,
    #[serde(default)]
    pub(super) pbr_metallic_roughness: MetallicRoughness,
    #[serde(default)]
    pub(super) emissive_factor: [f64; 3],
    #[serde(default)]
    pub(super) double_sided: bool,
    #[serde(borrow)]
    pub(super) alpha_mode: Option<Text<'a>>,
    pub(super) normal_texture: Option<Ignored>,
    pub(super) occlusion_texture: Option<Ignored>,
    pub(super) emissive_texture: Option<Ignored>,
    #[serde(default)]
    pub(super) extensions: MaterialExtensions,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct MetallicRoughness {
    pub(super) base_color_factor: [f64; 4],
    pub(super) metallic_factor: f64,
    pub(super) roughness_factor: f64,
    pub(super) base_color_texture: Option<Ignored>,
    pub(super) metallic_roughness_texture: Option<Ignored>,
}

impl Default for MetallicRoughness {
    fn default() -> Self {
        Self {
            base_color_factor: [1.0; 4],
            metallic_factor: 1.0,
            roughness_factor: 1.0,
            base_color_texture: None,
            metallic_roughness_texture: None,
        }
    }
}

#[derive(Default, Deserialize)]
pub(super) struct MaterialExtensions {
    #[serde(rename = "KHR_materials_emissive_strength", default)]
    pub(super) emissive_strength: EmissiveStrength,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct EmissiveStrength {
    pub(super) emissive_strength: f64,
}

impl Default for EmissiveStrength {
    fn default() -> Self {
        Self { emissive_strength: 1.0 }
    }
}

#[derive(Deserialize)]
pub(super) struct Camera<'a> {
    #[serde(rename = "type", borrow)]
    pub(super) kind: Text<'a>,
    pub(super) perspective: Option<Perspective>,
}

#[derive(Deserialize)]
pub(super) struct Perspective {
    pub(super) yfov: f64,
}
