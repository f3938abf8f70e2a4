use super::document::Document;
use super::json;
use super::tree::{Placed, Tree};
use crate::error::Result;
use crate::loading::Loading;
use crate::{IoError, Place, WarningKind};
use glam::DVec3;
use globillum_integrator::{Camera, RenderError};

/// The perspective cameras that nodes place. A camera looks along -z of its node. The picture determines the
/// aspect ratio, not the file.
pub(super) fn all(
    document: &Document<'_>,
    tree: &Tree<'_>,
    loading: &mut Loading<'_>,
) -> Result<Vec<Camera>> {
    if !tree.has_cameras {
        return Ok(Vec::new());
    }
    // Each camera is read once, since many nodes may place it.
    let mut lenses = Vec::with_capacity(document.cameras.len());
    lenses.extend(document.cameras.iter().map(|json| field_of_view(&json)));
    let mut count = 0;
    tree.walk(loading, |placed, _| {
        let lens = placed.node.camera.and_then(|index| lenses.get(index as usize));
        count += usize::from(lens.is_some_and(Option::is_some));
        Ok(())
    })?;
    loading.check_count(count as u64, loading.limits.cameras, "cameras")?;
    let mut cameras = Vec::with_capacity(count);
    tree.walk(loading, |placed, loading| {
        let Some(index) = placed.node.camera else { return Ok(()) };
        let at = Place::Node(placed.index);
        let index = loading.check_index(at, index.into(), lenses.len(), "cameras")?;
        let place = Place::Camera(index);
        let Some(field_of_view) = lenses[index] else {
            loading.warn(place, WarningKind::CameraIgnored);
            return Ok(());
        };
        let camera = of(placed, field_of_view);
        cameras.push(camera.map_err(|source| IoError::Camera { at: loading.at(place), source })?);
        Ok(())
    })?;
    Ok(cameras)
}

/// The vertical field of view in radians; `None` if the camera is not perspective.
fn field_of_view(json: &json::Camera<'_>) -> Option<f64> {
    let perspective = json.perspective.as_ref().filter(|_| json.kind.0 == "perspective");
    perspective.map(|perspective| perspective.yfov)
}

fn of(placed: &Placed<'_>, field_of_view: f64) -> Result<Camera, RenderError> {
    let world = &placed.world;
    let eye = world.translation;
    let forward = world.transform_vector3(DVec3::NEG_Z).normalize_or_zero();
    // At this distance the difference to the eye is precise.
    let target = eye + forward * eye.length().max(1.0);
    Camera::look_at(eye, target, world.transform_vector3(DVec3::Y), field_of_view)
}
