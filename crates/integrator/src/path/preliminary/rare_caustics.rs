//! Probes that find whether caustics are rare, so that sharing them costs little.

use super::path_starts::probe_starts;
use crate::checked_accel;
use crate::path::caustics::MIN_WEIGHT;
use crate::path::diffuse_vertex::{diffuse_vertex, first_diffuse_vertex, scattered_ray};
use crate::path::emission_rays::{EmissionRays, FoundEmission, reflected_ray};
use crate::path::mirrors_left::MAX_MIRRORS;
use crate::path::mis::MisContext;
use crate::path::render_context::RenderContext;
use crate::sampler::ReservedStream;
use crate::{PathStart, Stream};
use globillum_geom::Ray;
use globillum_material::Bsdf;

/// Probes along each side of the picture, by which caustics are found to be rare.
const PROBES_PER_SIDE: u32 = 64;

/// The most caustics that the probes find where caustics are rare. Sharing then takes two connections per sample or less,
/// as far as the probes tell.
const MAX_FOUND: usize = (PROBES_PER_SIDE * PROBES_PER_SIDE) as usize / 128;

/// Whether pixels share caustics: these are rare if probes find few.
pub(super) fn are_shared(context: &RenderContext<'_>) -> bool {
    let may_share = context.reuses_paths() && context.scene.has_mirrors();
    may_share && caustics_found(context) <= MAX_FOUND
}

/// How many caustics that would be shared [`PROBES_PER_SIDE`] x [`PROBES_PER_SIDE`] paths find from their first two diffuse
/// vertices, each by way of up to [`MAX_MIRRORS`] mirrors whatever the limit on bounces. They follow from the scene,
/// the sensor and the settings, never from samples.
fn caustics_found(context: &RenderContext<'_>) -> usize {
    let first = scattered_rays(context, 0, starts(context));
    let second = scattered_rays(context, 1, first.iter().map(|&(ray, _)| PathStart::Ray(ray)));
    found_from(context, &first) + found_from(context, &second)
}

/// How many of these rays, each with what weights depend on, find a caustic that would be shared.
fn found_from(context: &RenderContext<'_>, scattered: &[(Ray, MisContext)]) -> usize {
    let rays: Vec<Ray> = scattered.iter().map(|(ray, _)| *ray).collect();
    let mut hits = Vec::new();
    checked_accel::intersect(context.scene.accel(), &rays, &mut hits);
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
        let i = found.tag as usize;
        let mirror = hits[i].as_ref().map_or(Ray::NO_TRIANGLE, |hit| hit.triangle);
        let weight = scattered[i].1.weight_by_mirror(context, mirror, &found);
        count += usize::from(weight >= MIN_WEIGHT);
    };
    reflected.trace(context, MAX_MIRRORS - 1, add, |_, _| {});
    count
}

/// The rays that the next diffuse vertices of paths scatter, with what weights depend on. `before` is the number of diffuse
/// vertices that precede them.
fn scattered_rays(
    context: &RenderContext<'_>,
    before: u32,
    paths: impl Iterator<Item = PathStart>,
) -> Vec<(Ray, MisContext)> {
    let scatter = |(i, path)| {
        let at = match before {
            0 => first_diffuse_vertex(context, path)?,
            // A suffix begins after one mirror at most.
            _ => diffuse_vertex(context, path, |mirrors| mirrors <= 1)?,
        };
        let u = Stream::reserved(ReservedStream::CausticProbes, i).uniform_pair(2 * before);
        let (ray, density) = scattered_ray(&at, u)?;
        Some((ray, MisContext::scattered(density, at.receiver(), before == 0)))
    };
    (0..).zip(paths).filter_map(scatter).collect()
}

/// Where the probes begin, row by row.
fn starts(context: &RenderContext<'_>) -> impl Iterator<Item = PathStart> {
    (0..PROBES_PER_SIDE).flat_map(|row| probe_starts(context, PROBES_PER_SIDE, row))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::prepare;
    use crate::path::test_rooms::{FloorPoints, built, camera, room, settings, shaft, shaft_model};
    use crate::{PathReuse, PinholeCamera, Roulette, Sensor, Settings};
    use glam::DVec3;
    use globillum_geom::conformance::shapes::quad;
    use globillum_material::{Material, Rgb};

    /// What is seen directly, by way of one mirror or of two, and what is measured, has the same caustics. Where roulette
    /// begins so early that no pixel shares what it sees in mirrors, these do not count.
    #[test]
    fn first_diffuse_vertices_count_wherever_paths_meet_them() {
        let all = (PROBES_PER_SIDE * PROBES_PER_SIDE) as usize;
        let eye = DVec3::new(0.0, 2.0, 0.5);
        let toward = |x: f64| PinholeCamera::look_at(eye, DVec3::new(x, 0.0, 0.0), DVec3::Y, 0.1).unwrap();
        let [direct, by_one, by_two] = [0.0, 1.0, 2.0].map(toward);
        let sensors: [(&dyn Sensor, u32); 4] =
            [(&direct, 1), (&by_one, 2), (&by_two, 3), (&FloorPoints([0.4, 0.9]), 1)];
        for (sensor, start) in sensors {
            let settings =
                |start| Settings { roulette: Roulette { start, threshold: 0.2 }, ..Settings::new(16, 16, 4) };
            let (settings, earlier) = (settings(start), settings(start - 1));
            for (half_light, are_common) in [(0.5, true), (0.005, false)] {
                let scene = shaft(half_light);
                let context = RenderContext::new(&scene, sensor, &settings);
                let (count, found) =
                    (scattered_rays(&context, 0, starts(&context)).len(), caustics_found(&context));
                assert_eq!(count, all, "{sensor:?}, {half_light}");
                assert_eq!(found > MAX_FOUND, are_common, "{sensor:?}, {half_light}: {found}");
                assert_eq!(are_shared(&context), !are_common, "{sensor:?}, {half_light}");
                let context = RenderContext { settings: &earlier, ..context };
                assert!(start == 1 || caustics_found(&context) == 0, "{sensor:?}, {half_light}");
            }
        }
    }

    /// A ceiling that sees no light, above a floor that sees much by way of mirrors. The start of roulette has no part in
    /// where suffixes begin.
    #[test]
    fn second_diffuse_vertices_count_too() {
        let p = |x, z| DVec3::new(x, 3.9, z);
        let mut model = shaft_model(0.5);
        let ceiling = quad(p(-0.5, 2.0), p(-0.5, -2.0), p(0.5, -2.0), p(0.5, 2.0));
        model.add(Material::lambert(Rgb::splat(0.8)).unwrap(), ceiling);
        let scene = built(model);
        let camera =
            PinholeCamera::look_at(DVec3::new(0.0, 2.0, 0.5), DVec3::Y * 3.9, DVec3::X, 0.1).unwrap();
        let settings = Settings::new(16, 16, 4);
        let context = RenderContext::new(&scene, &camera, &settings);
        let first = scattered_rays(&context, 0, starts(&context));
        assert_eq!(found_from(&context, &first), 0);
        let found = |start| {
            let settings = Settings { roulette: Roulette { start, threshold: 0.2 }, ..settings };
            caustics_found(&RenderContext::new(&scene, &camera, &settings))
        };
        assert!(found(1) > 10 * MAX_FOUND);
        assert_eq!([2, 3, 8].map(found), [found(1); 3]);
    }

    #[test]
    fn caustics_are_shared_where_they_are_rare() {
        let (camera, settings) = (camera(0.9), settings());
        let off = Settings { path_reuse: PathReuse::Off, ..settings };
        for (size, settings, expected) in
            [(0.6, &settings, false), (0.2, &settings, true), (0.2, &off, false)]
        {
            let scene = room(size);
            let context = prepare(&scene, &camera, settings, None, || false).continue_value().unwrap();
            assert_eq!(context.shares_caustics, expected, "{size}, {:?}", settings.path_reuse);
            assert_eq!(context.photons.is_some(), expected, "{size}, {:?}", settings.path_reuse);
        }
    }

    #[test]
    fn photons_can_be_cancelled() {
        let (scene, camera, settings) = (room(0.2), camera(0.9), settings());
        assert!(prepare(&scene, &camera, &settings, None, || true).is_break());
    }
}
