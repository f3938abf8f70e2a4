use super::document::Document;
use super::tree::{Placed, Tree};
use crate::error::Result;
use crate::scene::loading::Loading;
use crate::{IoError, Place, WarningKind};
use glam::DVec3;
use globillum_integrator::{PinholeCamera, RenderError};
use gltf::json::camera::Type;
use gltf::json::validation::Checked::Valid;

/// Adds the perspective cameras that nodes place. A camera looks along -z of its node. The picture determines the aspect
/// ratio, not the file, whose own is kept beside. A camera whose node flattens its view is left out with a warning.
pub(super) fn add_all(document: &Document, tree: &Tree<'_>, loading: &mut Loading<'_>) -> Result<()> {
    for placed in tree.placed() {
        let Some(camera) = placed.node.camera else { continue };
        let (at, count) = (Place::Node(placed.index), document.cameras.len());
        let index = loading.check_index(at, camera.value() as u64, count, "cameras")?;
        let (json, place) = (&document.cameras[index], Place::Camera(index));
        let Some(perspective) = json.perspective.as_ref().filter(|_| json.type_ == Valid(Type::Perspective))
        else {
            loading.warn(place, WarningKind::CameraIgnored);
            continue;
        };
        loading.check_count(loading.cameras.len() as u64 + 1, loading.limits.cameras, "cameras")?;
        match of(&placed, perspective.yfov.into()) {
            Ok(camera) => {
                loading.cameras.push(camera);
                let ratio = perspective.aspect_ratio.map(f64::from);
                loading.aspect_ratios.push(ratio.filter(|&ratio| ratio > 0.0 && ratio.is_finite()));
            }
            Err(RenderError::Camera(_)) => loading.warn(at, WarningKind::CameraFlattened),
            Err(source) => return Err(IoError::Camera { at: loading.at(place), source }),
        }
    }
    Ok(())
}

/// The camera at the node `placed`.
///
/// # Errors
/// [`RenderError::Camera`] if the node flattens the view: coordinates are finite, but its -z axis is zero, or its y axis is
/// zero or parallel to that. [`RenderError::Param`] for a field of view out of range.
fn of(placed: &Placed<'_>, field_of_view: f64) -> Result<PinholeCamera, RenderError> {
    let world = placed.world;
    let eye = world.translation;
    let forward = world.transform_vector3(DVec3::NEG_Z).normalize_or_zero();
    // At this distance the difference to the eye is precise.
    let target = eye + forward * eye.length().max(1.0);
    PinholeCamera::look_at(eye, target, world.transform_vector3(DVec3::Y), field_of_view)
}
