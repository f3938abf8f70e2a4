use super::document::Document;
use super::json;
use super::tree::{Placed, Tree};
use crate::loading::Loading;
use crate::{IoError, Place, WarningKind};
use glam::DVec3;
use globillum_integrator::{Camera, RenderError};

/// The perspective cameras that nodes place. They look down their -z axis; the aspect ratio is the
/// picture's, not the file's.
pub(super) fn all(
    document: &Document<'_>,
    tree: &Tree<'_>,
    loading: &mut Loading<'_>,
) -> Result<Vec<Camera>, IoError> {
    if !tree.has_cameras {
        return Ok(Vec::new());
    }
    // Many nodes may place one camera: each is read once.
    let mut lenses = Vec::with_capacity(document.cameras.len());
    lenses.extend(document.cameras.iter().map(|json| field_of_view(&json)));
    let mut count = 0;
    tree.walk(loading, |placed, _| {
        let lens = placed.node.camera.and_then(|index| lenses.get(index as usize));
        count += usize::from(lens.is_some_and(Option::is_some));
        Ok(())
    })?;
    let limit = loading.limits.cameras;
    if count as u64 > limit {
        return Err(IoError::TooLarge { at: loading.at(Place::File), what: "cameras", limit });
    }
    let mut cameras = Vec::with_capacity(count);
    tree.walk(loading, |placed, loading| {
        let Some(index) = placed.node.camera else { return Ok(()) };
        let lens = lenses.get(index as usize).ok_or_else(|| IoError::Index {
            at: loading.at(Place::Node(placed.index)),
            index: index.into(),
            count: lenses.len(),
            what: "cameras",
        })?;
        let place = Place::Camera(index as usize);
        let Some(field_of_view) = *lens else {
            loading.warn(place, WarningKind::CameraIgnored);
            return Ok(());
        };
        let camera = of(placed, field_of_view);
        cameras.push(camera.map_err(|source| IoError::Camera { at: loading.at(place), source })?);
        Ok(())
    })?;
    Ok(cameras)
}

/// The vertical one, in radians; `None` for cameras that are not perspective ones.
fn field_of_view(json: &json::Camera<'_>) -> Option<f64> {
    let perspective = json.perspective.as_ref().filter(|_| json.kind.0 == "perspective");
    perspective.map(|perspective| perspective.yfov)
}

fn of(placed: &Placed<'_>, field_of_view: f64) -> Result<Camera, RenderError> {
    let world = &placed.world;
    let eye = world.translation;
    let forward = world.transform_vector3(DVec3::NEG_Z).normalize_or_zero();
    // So far away that the difference to the eye keeps its digits.
    let target = eye + forward * eye.length().max(1.0);
    Camera::look_at(eye, target, world.transform_vector3(DVec3::Y), field_of_view)
}
