use super::document::Document;
use super::tree::Placed;
use crate::loading::Loading;
use crate::{IoError, Place, WarningKind};
use glam::DVec3;
use globillum_integrator::Camera;

/// The perspective cameras that nodes place. They look down their -z axis; the aspect ratio is the
/// picture's, not the file's.
pub(super) fn all(
    document: &Document<'_>,
    placed: &[Placed],
    loading: &mut Loading<'_>,
) -> Result<Vec<Camera>, IoError> {
    let mut cameras = Vec::new();
    for Placed { node, world } in placed {
        let Some(index) = document.nodes[*node].camera else { continue };
        let json = document.cameras.get(index as usize).ok_or_else(|| IoError::Index {
            at: loading.at(Place::Node(*node)),
            index: index.into(),
            count: document.cameras.len(),
            what: "cameras",
        })?;
        let place = Place::Camera(index as usize);
        let Some(perspective) = json.perspective.as_ref().filter(|_| json.kind.0 == "perspective") else {
            loading.warn(place, WarningKind::CameraIgnored);
            continue;
        };
        let eye = world.translation;
        let forward = world.transform_vector3(DVec3::NEG_Z).normalize_or_zero();
        // So far away that the difference to the eye keeps its digits.
        let target = eye + forward * eye.length().max(1.0);
        let camera = Camera::look_at(eye, target, world.transform_vector3(DVec3::Y), perspective.yfov);
        cameras.push(camera.map_err(|source| IoError::Camera { at: loading.at(place), source })?);
    }
    Ok(cameras)
}
