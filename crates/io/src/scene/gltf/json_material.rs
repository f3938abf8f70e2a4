//! Materials in the JSON of a file. With both extensions, the types of the crate gltf would take more
//! memory than the kilobyte that an object may.

use gltf::json::extensions::material::EmissiveStrength;
use gltf::json::material::{
    AlphaMode, EmissiveFactor, NormalTexture, OcclusionTexture, PbrMetallicRoughness,
};
use gltf::json::texture;
use gltf::json::validation::Checked;
use serde::Deserialize;

/// What is read of a material.
#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct JsonMaterial {
    pub(super) name: Option<String>,
    pub(super) alpha_mode: Checked<AlphaMode>,
    pub(super) double_sided: bool,
    pub(super) pbr_metallic_roughness: PbrMetallicRoughness,
    pub(super) normal_texture: Option<NormalTexture>,
    pub(super) occlusion_texture: Option<OcclusionTexture>,
    pub(super) emissive_texture: Option<texture::Info>,
    pub(super) emissive_factor: EmissiveFactor,
    pub(super) extensions: Option<MaterialExtensions>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(super) struct MaterialExtensions {
    #[serde(rename = "KHR_materials_emissive_strength")]
    pub(super) emissive_strength: Option<EmissiveStrength>,
    #[serde(rename = "KHR_materials_specular")]
    pub(super) specular: Option<Specular>,
    #[serde(rename = "KHR_materials_transmission")]
    pub(super) transmission: Option<Transmission>,
}

#[derive(Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Specular {
    pub(super) specular_factor: f32,
}

impl Default for Specular {
    fn default() -> Self {
        Self { specular_factor: 1.0 }
    }
}

#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Transmission {
    pub(super) transmission_factor: f32,
}
