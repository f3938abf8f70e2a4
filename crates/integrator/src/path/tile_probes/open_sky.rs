//! Probes that find whether what a square of pixels sees lies in the open.

use crate::path::diffuse_vertex::{first_diffuse_vertex, scattered_ray};
use crate::path::emission_rays::reflected_ray;
use crate::path::mirrors_left::MAX_MIRRORS;
use crate::path::render_context::RenderContext;
use crate::pixel_rect::PixelRect;
use crate::sampler::ReservedStream;
use crate::{Interaction, Stream};
use globillum_geom::Ray;

/// Probes of a square.
const PROBES: usize = 64;

/// Whether most of the directions scattered by the surfaces that a square sees lead to the environment, directly or by way
/// of mirrors. False where paths are not reused, and where no surface is seen.
pub(super) fn is_open(context: &RenderContext<'_>, square: PixelRect) -> bool {
    if !context.reuses_paths() || context.scene.environment().is_black() {
        return false;
    }
    let leads_out = |i: usize| {
        let pixel = square.pixel((i * square.pixel_count() / PROBES) as u32);
        let at = first_diffuse_vertex(context, context.path_start(pixel, [0.5, 0.5]))?;
        let numbers = Stream::reserved(ReservedStream::SkyProbes, i as u32);
        let (scattered, _) = scattered_ray(&at, numbers.uniform_pair(0))?;
        Some(surface_along(context, scattered).is_none())
    };
    let [mut out, mut all] = [0, 0];
    for leads_out in (0..PROBES).filter_map(leads_out) {
        out += usize::from(leads_out);
        all += 1;
    }
    2 * out > all
}

/// The diffuse surface that a ray finds, directly or by way of up to [`MAX_MIRRORS`] mirrors, or the mirror after these.
fn surface_along<'a>(context: &RenderContext<'a>, mut ray: Ray) -> Option<Interaction<'a>> {
    for mirrors in 0.. {
        let hit = context.scene.accel().intersect(&ray)?;
        let at = context.scene.interaction(&ray, &hit);
        if at.material.bsdf.is_diffuse() || mirrors == MAX_MIRRORS || !at.point.position.is_finite() {
            return Some(at);
        }
        ray = reflected_ray(&at.point, -at.wo);
    }
    None
}
