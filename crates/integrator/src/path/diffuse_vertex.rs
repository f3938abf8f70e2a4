//! Diffuse vertices of paths, directly and by way of mirrors.

use super::emission_rays::reflected_ray;
use super::mirrors_left::MAX_MIRRORS;
use super::render_context::RenderContext;
use crate::{Interaction, PathStart};
use globillum_geom::{Frame, Ray, SurfacePoint};
use globillum_material::{Bsdf, Density, Emission, Material, Reflectance};

/// The surface at which a path begins to measure irradiance. A white Lambertian surface: it sends out `E / pi` in all
/// directions, where `E` is the irradiance.
const WHITE: Material = Material { bsdf: Bsdf::Lambert(Reflectance::ONE), emission: Emission::NONE };

/// The vertex at which a path begins to measure irradiance.
pub(super) fn irradiance_vertex(point: SurfacePoint) -> Interaction<'static> {
    Interaction { point, material: &WHITE, wo: point.normal }
}

/// The [first diffuse vertex](diffuse_vertex) of the path that begins at `start`, if its prefix may be reused there.
pub(super) fn first_diffuse_vertex<'a>(
    context: &RenderContext<'a>,
    start: PathStart,
) -> Option<Interaction<'a>> {
    diffuse_vertex(context, start, |bounce| context.may_reuse_prefix(bounce))
}

/// The first diffuse vertex of the path that begins at `start`, if no more than [`MAX_MIRRORS`] mirrors precede it and
/// `may_end` holds for its bounce and those of the mirrors. A path that measures irradiance has it where it begins. `None`
/// too if the start is not valid.
pub(super) fn diffuse_vertex<'a>(
    context: &RenderContext<'a>,
    start: PathStart,
    may_end: impl Fn(u32) -> bool,
) -> Option<Interaction<'a>> {
    let mut ray = match start {
        start if !start.is_valid() => return None,
        PathStart::Ray(ray) => ray,
        PathStart::Irradiance { position, normal } => {
            return Some(irradiance_vertex(context.scene.triangles().given_point(position, normal)));
        }
        PathStart::Nowhere => return None,
    };
    for bounce in 0..=MAX_MIRRORS {
        let hit = context.scene.accel().intersect(&ray).filter(|_| may_end(bounce))?;
        let at = context.scene.interaction(&ray, &hit);
        match at.material.bsdf {
            _ if !at.point.position.is_finite() => return None,
            Bsdf::Mirror(reflectance) if reflectance.rgb().is_black() => return None,
            Bsdf::Mirror(_) => ray = reflected_ray(&at.point, -at.wo),
            _ => return Some(at),
        }
    }
    None
}

/// The ray that a diffuse surface scatters by the uniform numbers `u`, and its density; `None` if it reflects nothing.
pub(super) fn scattered_ray(at: &Interaction<'_>, u: [f64; 2]) -> Option<(Ray, Density)> {
    let frame = Frame::around(at.facing_normal());
    let sample = at.material.bsdf.sample(frame.to_local(at.wo), u)?;
    Some((at.point.spawn_ray(frame.to_world(sample.wi)), sample.density))
}
