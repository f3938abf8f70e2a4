//! A sun for what has no light of its own.

use super::{Up, View};
use anyhow::Result;
use globillum::glam::DVec3;
use globillum::integrator::{DeltaLight, Model};
use globillum::material::Rgb;
use std::f64::consts::PI;

/// Radiance of the sky beside it.
pub(crate) const SKY: Rgb = Rgb::splat(0.3);

/// What the sun adds to the radiance of a white surface that faces it, which is 1 then.
const SUN: f64 = 0.7;

/// Adds a sun behind the viewer's left shoulder: 45 degrees from the direction in which `view` looks, so that what is seen
/// is lit, and its shape shows.
pub(crate) fn add(model: &mut Model, view: &View, up: Up) -> Result<()> {
    // A scene without an extent has no view, which is an error later.
    if let Ok(forward) = view.forward(&model.bounds()) {
        let direction = from_behind(forward.normalize(), up.axes().y_axis);
        model.add_delta_light(DeltaLight::directional(direction.as_vec3(), Rgb::splat(SUN * PI))?);
    }
    Ok(())
}

/// Where light goes that comes from behind, from above and from the left of who looks `forward`, a unit vector.
fn from_behind(forward: DVec3, up: DVec3) -> DVec3 {
    let right = forward.cross(up);
    let right = if right.length() > 1e-6 { right.normalize() } else { forward.any_orthonormal_vector() };
    forward + 0.6 * right - 0.8 * right.cross(forward)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sun_is_45_degrees_from_the_view_behind_above_and_left_of_it() {
        for up in [Up::Y, Up::Z] {
            let axes = up.axes();
            for (forward, right) in [(-axes.z_axis, axes.x_axis), (axes.x_axis, axes.z_axis)] {
                let light = from_behind(forward, axes.y_axis).normalize();
                assert!((light.dot(forward) - 0.5_f64.sqrt()).abs() < 1e-12);
                assert!(light.dot(axes.y_axis) < -0.5 && light.dot(right) > 0.4);
            }
            // Straight downward.
            let light = from_behind(-axes.y_axis, axes.y_axis).normalize();
            assert!((light.dot(-axes.y_axis) - 0.5_f64.sqrt()).abs() < 1e-12);
        }
    }
}
