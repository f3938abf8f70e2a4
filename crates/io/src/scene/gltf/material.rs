use super::document::Document;
use super::json_material::JsonMaterial;
use crate::error::Result;
use crate::scene::loading::Loading;
use crate::scene::losses::{Losses, MEAN_OF_TEXTURE};
use crate::{IoError, Place};
use globillum_integrator::MaterialId;
use globillum_material::{Emission, Material, MaterialError, Reflectance, Rgb, Sides};
use gltf::json::material::AlphaMode;
use gltf::json::validation::Checked::Valid;
use gltf::json::{self, Index};
use std::borrow::Cow;

/// The materials of a file, and the default material.
pub(super) struct Materials {
    all: Vec<MaterialId>,
    default: MaterialId,
}

impl Materials {
    /// The material `index`, which `place` refers to; the default material for `None`.
    pub(super) fn get(
        &self,
        index: Option<Index<json::Material>>,
        place: Place,
        loading: &Loading<'_>,
    ) -> Result<MaterialId> {
        let Some(index) = index else { return Ok(self.default) };
        Ok(self.all[loading.check_index(place, index.value() as u64, self.all.len(), "materials")?])
    }
}

/// Adds every material, with warnings about the properties that are lost.
pub(super) fn all(document: &Document, loading: &mut Loading<'_>) -> Result<Materials> {
    let count = document.materials.len();
    loading.check_count(count as u64, loading.limits.materials, "materials")?;
    let mut all = Vec::with_capacity(count);
    for (index, json) in document.materials.iter().enumerate() {
        let place = Place::Material(index);
        let name = json.name.as_ref().map_or_else(|| index.to_string().into(), Cow::from);
        let domain = |message| IoError::Domain { at: loading.at(place), message };
        check_factors(json).map_err(domain)?;
        let refused = |source| IoError::Material { at: loading.at(place), name: name.to_string(), source };
        let material = material(json).map_err(refused)?;
        for kind in losses(json).warnings(&name) {
            loading.warn(place, kind);
        }
        let name = json.name.clone().unwrap_or_else(|| format!("material {index}"));
        all.push(loading.add_named_material(name, material));
    }
    let refused = |source| IoError::Material { at: loading.at(Place::File), name: "default".into(), source };
    let default = Material::lambert(Rgb::WHITE).map_err(refused)?;
    Ok(Materials { all, default: loading.add_material(default) })
}

/// Checks the factors that are no colours.
fn check_factors(json: &JsonMaterial) -> Result<(), String> {
    let pbr = &json.pbr_metallic_roughness;
    for (name, x) in [("metallicFactor", pbr.metallic_factor.0), ("roughnessFactor", pbr.roughness_factor.0)]
    {
        if !(0.0..=1.0).contains(&x) {
            return Err(format!("{name} {x} is not within [0, 1]"));
        }
    }
    Ok(())
}

fn material(json: &JsonMaterial) -> Result<Material, MaterialError> {
    let [r, g, b, _] = json.pbr_metallic_roughness.base_color_factor.0.map(f64::from);
    let factor = Reflectance::new(Rgb::new(r, g, b))?.rgb();
    let texture = json.pbr_metallic_roughness.base_color_texture.as_ref();
    let colour = factor * texture.map_or(1.0, |_| MEAN_OF_TEXTURE);
    let scattering = if is_mirror(json) { Material::mirror(colour)? } else { Material::lambert(colour)? };
    if json.emissive_texture.is_some() {
        return Ok(scattering);
    }
    let strength = json.extensions.as_ref().and_then(|extensions| extensions.emissive_strength.as_ref());
    let strength = strength.map_or(1.0, |strength| strength.emissive_strength.0);
    let radiance = Rgb::from(json.emissive_factor.0.map(f64::from)) * f64::from(strength);
    let sides = if json.double_sided { Sides::Both } else { Sides::Front };
    Ok(scattering.emitting(Emission::new(radiance, sides)?))
}

/// Whether the material is closer to an ideal mirror (metallic 1, roughness 0) than to an ideal diffuse
/// surface (metallic 0, roughness 1). With a texture the factors are only upper bounds, 1 where an exporter
/// has no others, so they show no mirror.
fn is_mirror(json: &JsonMaterial) -> bool {
    let pbr = &json.pbr_metallic_roughness;
    pbr.metallic_roughness_texture.is_none() && pbr.metallic_factor.0 > pbr.roughness_factor.0
}

/// Whether no property is set that says how the surface reflects or emits light, as where an exporter does not know the
/// shader.
fn is_unspecified(json: &JsonMaterial) -> bool {
    let pbr = &json.pbr_metallic_roughness;
    let factors = (pbr.base_color_factor.0, pbr.metallic_factor.0, pbr.roughness_factor.0);
    factors == ([1.0; 4], 1.0, 1.0)
        && pbr.base_color_texture.is_none()
        && pbr.metallic_roughness_texture.is_none()
        && json.emissive_texture.is_none()
        && json.emissive_factor.0 == [0.0; 3]
        && json.extensions.is_none()
}

fn losses(json: &JsonMaterial) -> Losses {
    let pbr = &json.pbr_metallic_roughness;
    let extensions = json.extensions.as_ref();
    let specular = extensions.and_then(|all| all.specular.as_ref()).map_or(1.0, |it| it.specular_factor);
    let transmission =
        extensions.and_then(|all| all.transmission.as_ref()).map_or(0.0, |it| it.transmission_factor);
    // Without specular reflection a non-metal is diffuse, however smooth.
    let ideal = match (pbr.metallic_factor.0, pbr.roughness_factor.0) {
        (0.0, 1.0) | (1.0, 0.0) => true,
        (metallic, _) => metallic == 0.0 && specular == 0.0,
    };
    let is_unspecified = is_unspecified(json);
    // A black surface reflects nothing, so its approximation is exact.
    let black = pbr.base_color_factor.0[..3].iter().all(|&x| x == 0.0);
    Losses {
        textured: pbr.base_color_texture.is_some()
            || pbr.metallic_roughness_texture.is_some()
            || json.normal_texture.is_some()
            || json.occlusion_texture.is_some(),
        emission: json.emissive_texture.is_some() && json.emissive_factor.0 != [0.0; 3],
        transparent: json.alpha_mode != Valid(AlphaMode::Opaque) || transmission > 0.0,
        spectral: false,
        unspecified: is_unspecified,
        approximated: !ideal && !black && !is_unspecified,
        is_mirror: is_mirror(json),
    }
}
