//! The extension KHR_lights_punctual.

use super::document::Document;
use super::tree::{Placed, Tree};
use crate::error::Result;
use crate::scene::loading::Loading;
use crate::scene::occurrences::Occurrences;
use crate::{IoError, Place, WarningKind};
use glam::DVec3;
use globillum_integrator::DeltaLight;
use globillum_material::Rgb;
use gltf::json::extensions::scene::khr_lights_punctual::{Light, Type};
use gltf::json::validation::Checked::Valid;

/// Adds the lights that nodes place. A light emits along -z of its node, whose scale does not change its
/// intensity.
pub(super) fn add_all(
    document: &Document,
    tree: &Tree<'_>,
    luminous_efficacy: f64,
    loading: &mut Loading<'_>,
) -> Result<()> {
    let extension = document.extensions.as_ref().and_then(|all| all.khr_lights_punctual.as_ref());
    let lights = extension.map_or(&[][..], |extension| &extension.lights);
    let (mut count, mut ranges) = (0, Occurrences::default());
    for placed in tree.placed() {
        let extensions = placed.node.extensions.as_ref();
        let Some(node) = extensions.and_then(|all| all.khr_lights_punctual.as_ref()) else { continue };
        let at = Place::Node(placed.index);
        let index = loading.check_index(at, node.light.value() as u64, lights.len(), "lights")?;
        count += 1;
        loading.check_count(count, loading.limits.delta_lights, "delta lights")?;
        let (json, place) = (&lights[index], Place::Light(index));
        if json.intensity < 0.0 {
            let message = format!("intensity is negative: {}", json.intensity);
            return Err(IoError::Parse { at: loading.at(place), message });
        }
        // Candela to watts per steradian, or lux to watts per square metre.
        let watts = f64::from(json.intensity) / luminous_efficacy;
        let Some(light) = of(json, watts, place, &placed, loading)? else {
            loading.warn(at, WarningKind::LightIgnored);
            continue;
        };
        ranges.add(place, json.range.is_some().into());
        loading.add_delta_light(light);
    }
    ranges.warn(loading, |count| WarningKind::RangeIgnored { count });
    Ok(())
}

/// The light `json` at the node `placed`; `None` if it has a direction and the node has no -z axis, as with a
/// scale of zero.
fn of(
    json: &Light,
    watts: f64,
    at: Place,
    placed: &Placed<'_>,
    loading: &Loading<'_>,
) -> Result<Option<DeltaLight>> {
    let malformed = |message: &str| IoError::Parse { at: loading.at(at), message: message.into() };
    let position = placed.world.translation.as_vec3();
    let direction = placed.world.transform_vector3(DVec3::NEG_Z).normalize_or_zero().as_vec3();
    let value = Rgb::from(json.color.map(f64::from)) * watts;
    let Valid(kind) = json.type_ else {
        return Err(malformed("light type is none of point, spot and directional"));
    };
    let light = match kind {
        Type::Point => DeltaLight::point(position, value),
        _ if direction.length_squared() == 0.0 => return Ok(None),
        Type::Directional => DeltaLight::directional(direction, value),
        Type::Spot => {
            let spot = json.spot.as_ref().ok_or_else(|| malformed("spot light has no `spot`"))?;
            let [inner, outer] = [spot.inner_cone_angle, spot.outer_cone_angle].map(f64::from);
            // Blender writes equal angles for a cone with a sharp edge. The equations of the extension allow
            // them.
            let inner = if inner == outer && outer > 0.0 { outer.next_down() } else { inner };
            DeltaLight::spot(position, direction, value, inner, outer)
        }
    };
    light.map(Some).map_err(|source| IoError::Light { at: loading.at(at), source })
}
