use super::document::Document;
use super::json;
use crate::loading::Loading;
use crate::{IoError, Place, WarningKind};
use globillum_integrator::MaterialId;
use globillum_material::{Emission, Material, MaterialError, Rgb, Sides};
use std::borrow::Cow;

/// The materials of a file, and the one for primitives without any.
pub(super) struct Materials {
    all: Vec<MaterialId>,
    default: MaterialId,
}

impl Materials {
    /// The material of that index, which `place` refers to.
    pub(super) fn get(
        &self,
        index: Option<u32>,
        place: Place,
        loading: &Loading<'_>,
    ) -> Result<MaterialId, IoError> {
        let Some(index) = index else { return Ok(self.default) };
        self.all.get(index as usize).copied().ok_or_else(|| IoError::Index {
            at: loading.at(place),
            index: index.into(),
            count: self.all.len(),
            what: "materials",
        })
    }
}

/// Makes every material, and reports what is lost.
pub(super) fn all(document: &Document<'_>, loading: &mut Loading<'_>) -> Result<Materials, IoError> {
    let limit = loading.limits.materials;
    if document.materials.len() as u64 > limit {
        return Err(IoError::TooLarge { at: loading.at(Place::File), what: "materials", limit });
    }
    let mut all = Vec::with_capacity(document.materials.len());
    for (index, json) in document.materials.iter().enumerate() {
        let place = Place::Material(index);
        let name = json.name.as_ref().map_or_else(|| index.to_string().into(), |name| Cow::from(&*name.0));
        let refused = |source| IoError::Material { at: loading.at(place), name: name.to_string(), source };
        let material = material(&json).map_err(refused)?;
        for kind in passed_over(&json, &name) {
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

/// Whether an ideal mirror (metallic 1, roughness 0) is nearer than an ideal diffuse surface
/// (metallic 0, roughness 1).
fn is_mirror(json: &json::Material<'_>) -> bool {
    let pbr = &json.pbr_metallic_roughness;
    pbr.metallic_factor > pbr.roughness_factor
}

fn passed_over(json: &json::Material<'_>, name: &str) -> impl Iterator<Item = WarningKind> {
    let pbr = &json.pbr_metallic_roughness;
    let textures = [
        &pbr.base_color_texture,
        &pbr.metallic_roughness_texture,
        &json.normal_texture,
        &json.occlusion_texture,
        &json.emissive_texture,
    ];
    let textured = textures.iter().any(|texture| texture.is_some());
    let transparent = json.alpha_mode.as_ref().is_some_and(|mode| mode.0 != "OPAQUE");
    let ideal = matches!((pbr.metallic_factor, pbr.roughness_factor), (0.0, 1.0) | (1.0, 0.0));
    // What reflects nothing does so ideally.
    let black = pbr.base_color_factor[..3].iter().all(|&x| x == 0.0);
    let by = if is_mirror(json) { "an ideal mirror" } else { "an ideal diffuse surface" };
    // Names may be long: one copy at a time.
    type Kind = fn(String, &'static str) -> WarningKind;
    let kinds: [(bool, Kind); 3] = [
        (textured, |name, _| WarningKind::TexturesIgnored { name }),
        (transparent, |name, _| WarningKind::TransparencyIgnored { name }),
        (!ideal && !black, |name, by| WarningKind::Approximated { name, by }),
    ];
    kinds.into_iter().filter(|(is_lost, _)| *is_lost).map(move |(_, kind)| kind(name.to_owned(), by))
}
