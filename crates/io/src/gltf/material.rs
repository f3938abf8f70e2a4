use super::document::Document;
use super::json;
use crate::error::Result;
use crate::loading::Loading;
use crate::losses::Losses;
use crate::{IoError, Place};
use globillum_integrator::MaterialId;
use globillum_material::{Emission, Material, MaterialError, Rgb, Sides};
use std::borrow::Cow;

/// The materials of a file, and the default material.
pub(super) struct Materials {
    all: Vec<MaterialId>,
    default: MaterialId,
}

impl Materials {
    /// The material `index`, which `place` refers to; the default material for `None`.
    pub(super) fn get(&self, index: Option<u32>, place: Place, loading: &Loading<'_>) -> Result<MaterialId> {
        let Some(index) = index else { return Ok(self.default) };
        Ok(self.all[loading.check_index(place, index.into(), self.all.len(), "materials")?])
    }
}

/// Adds every material, with warnings about the properties that are lost.
pub(super) fn all(document: &Document<'_>, loading: &mut Loading<'_>) -> Result<Materials> {
    let count = document.materials.len();
    loading.check_count(count as u64, loading.limits.materials, "materials")?;
    let mut all = Vec::with_capacity(count);
    for (index, json) in document.materials.iter().enumerate() {
        let place = Place::Material(index);
        let name = json.name.as_ref().map_or_else(|| index.to_string().into(), |name| Cow::from(&*name.0));
        let refused = |source| IoError::Material { at: loading.at(place), name: name.to_string(), source };
        let material = material(&json).map_err(refused)?;
        for kind in losses(&json).warnings(&name) {
            loading.warn(place, kind);
        }
        all.push(loading.add_material(material));
    }
    let refused = |source| IoError::Material { at: loading.at(Place::File), name: "default".into(), source };
    let default = Material::lambert(Rgb::WHITE).map_err(refused)?;
    Ok(Materials { all, default: loading.add_material(default) })
}

fn material(json: &json::Material<'_>) -> Result<Material, MaterialError> {
    let [r, g, b, _] = json.pbr_metallic_roughness.base_color_factor;
    let colour = Rgb::new(r, g, b);
    let scattering = if is_mirror(json) { Material::mirror(colour)? } else { Material::lambert(colour)? };
    let radiance = Rgb::from(json.emissive_factor) * json.extensions.emissive_strength.emissive_strength;
    let sides = if json.double_sided { Sides::Both } else { Sides::Front };
    Ok(scattering.emitting(Emission::new(radiance, sides)?))
}

/// Whether the material is closer to an ideal mirror (metallic 1, roughness 0) than to an ideal diffuse
/// surface (metallic 0, roughness 1).
fn is_mirror(json: &json::Material<'_>) -> bool {
    let pbr = &json.pbr_metallic_roughness;
    pbr.metallic_factor > pbr.roughness_factor
}

fn losses(json: &json::Material<'_>) -> Losses {
    let pbr = &json.pbr_metallic_roughness;
    let textures = [
        &pbr.base_color_texture,
        &pbr.metallic_roughness_texture,
        &json.normal_texture,
        &json.occlusion_texture,
        &json.emissive_texture,
    ];
    let ideal = matches!((pbr.metallic_factor, pbr.roughness_factor), (0.0, 1.0) | (1.0, 0.0));
    // A black surface reflects nothing, so its approximation is exact.
    let black = pbr.base_color_factor[..3].iter().all(|&x| x == 0.0);
    Losses {
        textured: textures.iter().any(|texture| texture.is_some()),
        transparent: json.alpha_mode.as_ref().is_some_and(|mode| mode.0 != "OPAQUE"),
        spectral: false,
        approximated: !ideal && !black,
        is_mirror: is_mirror(json),
    }
}
