//! Probes that find whether caustics are rare, so that sharing them costs little.

use crate::path::caustics::{LEAST_WEIGHT, at_first_vertex, weight};
use crate::path::emission_rays::{EmissionRays, FoundEmission, MAX_REFLECTIONS, reflected_ray};
use crate::path::render_context::RenderContext;
use crate::path::shading_point::MisContext;
use crate::{PathStart, Stream};
use globillum_geom::{Frame, Ray};
use globillum_material::Bsdf;

/// Probes along each side of the picture, by which caustics are found to be rare.
const PROBES: u32 = 64;

/// The most caustics that the probes find where caustics are rare. Sharing then takes two connections per sample or less,
/// as far as the probes tell.
const MOST_FOUND: usize = (PROBES * PROBES) as usize / 128;

/// The address of the random numbers of probes, in place of a pixel; that of photons is another one.
const PIXEL: u64 = u64::MAX - 1;

/// Whether pixels share caustics: these are rare if some paths at fixed places find few.
pub(super) fn are_shared(context: &RenderContext<'_>) -> bool {
    let may_share = context.reuses_paths() && context.scene.has_mirrors();
    may_share && caustics_found(context) <= MOST_FOUND
}

/// How many caustics that would be shared [`PROBES`] x [`PROBES`] paths find, each by way of up to [`MAX_REFLECTIONS`]
/// mirrors whatever the limit on bounces. They follow from the scene, the sensor and the settings, never from samples.
fn caustics_found(context: &RenderContext<'_>) -> usize {
    let scattered = scattered(context);
    let rays: Vec<Ray> = scattered.iter().map(|(ray, _)| *ray).collect();
    let mut hits = Vec::new();
    context.scene.accel().intersect_batch(&rays, &mut hits);
    let mut reflected = EmissionRays::default();
    for (i, (ray, hit)) in (0..).zip(rays.iter().zip(&hits)) {
        let Some(at) = hit.as_ref().map(|hit| context.scene.interaction(ray, hit)) else { continue };
        let Bsdf::Mirror(reflectance) = at.material.bsdf else { continue };
        if at.point.position.is_finite() {
            reflected.push(reflected_ray(&at.point, ray.direction), i, reflectance.rgb());
        }
    }
    let mut count = 0;
    let add = |found: FoundEmission<'_>| {
        let i = found.target as usize;
        let mirror = hits[i].as_ref().map_or(Ray::NO_TRIANGLE, |hit| hit.triangle);
        count += usize::from(weight(context, scattered[i].1, mirror, &found) >= LEAST_WEIGHT);
    };
    reflected.trace(context, MAX_REFLECTIONS - 1, add, |_, _| {});
    count
}

/// The rays that diffuse surfaces scatter where probes see them, with what weights depend on. A probe that sees a mirror
/// has none.
fn scattered(context: &RenderContext<'_>) -> Vec<(Ray, MisContext)> {
    let places = (0..PROBES).flat_map(|y| (0..PROBES).map(move |x| [x, y]));
    let rays: Vec<Ray> = places.filter_map(|place| probe(context, place)).collect();
    let mut hits = Vec::new();
    context.scene.accel().intersect_batch(&rays, &mut hits);
    let of_probe = |(i, (ray, hit)): (u32, (&Ray, &Option<_>))| {
        let at = context.scene.interaction(ray, hit.as_ref()?);
        if !(at.material.bsdf.is_diffuse() && at.point.position.is_finite()) {
            return None;
        }
        let frame = Frame::around(at.side());
        let u = Stream::new(0, PIXEL, i).uniform_pair(0);
        let sample = at.material.bsdf.sample(frame.to_local(at.wo), u)?;
        let mis = at_first_vertex(sample.density, at.receiver());
        Some((at.point.spawn(frame.to_world(sample.wi)), mis))
    };
    (0..).zip(rays.iter().zip(&hits)).filter_map(of_probe).collect()
}

/// The ray at a place of the grid of probes.
fn probe(context: &RenderContext<'_>, [column, row]: [u32; 2]) -> Option<Ray> {
    let place = |probe: u32, pixels: u32| {
        let at = (f64::from(probe) + 0.5) / f64::from(PROBES) * f64::from(pixels);
        (at as u32, at.fract())
    };
    let ((x, u), (y, v)) = (place(column, context.settings.width), place(row, context.settings.height));
    match context.path_start((x, y), [u, v]) {
        PathStart::Ray(ray) if ray.is_traceable() => Some(ray),
        _ => None,
    }
}
