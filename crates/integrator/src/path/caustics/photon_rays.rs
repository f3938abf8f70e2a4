//! Rays that look for caustics where photons left mirrors.
//!
//! A caustic by way of several mirrors is found by two techniques, combined by the balance heuristic: by paths that the
//! BSDF scatters, which pixels [share](super::shared_caustics), and by rays toward the places where photons of the vicinity
//! left their last mirror.

use crate::checked_accel;
use crate::guide::PhotonGuide;
use crate::path::counters::Counters;
use crate::path::emission_rays::{EmissionRays, FoundEmission, reflected_ray};
use crate::path::mirrors_left::mirrors_left;
use crate::path::render_context::RenderContext;
use crate::path::reuse::{Prefix, Prefixes, ReuseVertex};
use crate::path::tile_samples::TileSamples;
use crate::{Sampler, Stream};
use glam::DVec3;
use globillum_geom::{Hit, Ray};
use globillum_material::{Bsdf, Rgb};
use std::f64::consts::PI;

/// How much the BSDF counts in the balance heuristic, since many pixels share what it finds (measured, docs/estimators.md).
const BSDF_FACTOR: f64 = 4.0;

/// The least number of mirrors by way of which these rays find light. Samples of mirrors find light by way of one.
pub(in crate::path) const MIN_MIRRORS: u32 = 2;

/// The probability with which a first diffuse vertex sends out a ray.
const RAY_PROB: f64 = 0.5;

/// Rays toward places where photons left mirrors. Its buffers are reused.
#[derive(Debug, Default)]
pub(in crate::path) struct PhotonRays {
    rays: Vec<Ray>,
    /// The sample of each ray.
    of_samples: Vec<u32>,
    hits: Vec<Option<Hit>>,
    emission_rays: EmissionRays,
}

/// The weight of a caustic by way of two mirrors or more that the BSDF finds in `direction` from the end of a prefix.
pub(super) fn bsdf_weight(context: &RenderContext<'_>, end: &ReuseVertex, direction: DVec3) -> f64 {
    let Some(photons) = &context.photons else { return 1.0 };
    let [bsdf, by_photons] = densities(context, photons, end, direction);
    bsdf / (bsdf + by_photons)
}

/// The densities in the balance heuristic, of the BSDF and of rays guided by photons, over that of cosine sampling.
fn densities(
    context: &RenderContext<'_>,
    photons: &PhotonGuide,
    end: &ReuseVertex,
    direction: DVec3,
) -> [f64; 2] {
    // Above zero but for rounding.
    let cos = end.normal.dot(direction).max(f64::MIN_POSITIVE);
    let by_photons = PI * photons.pdf(end.receiver(), direction).0 / cos;
    [BSDF_FACTOR * end.guide_ratio(context.guide, direction), RAY_PROB * by_photons]
}

impl PhotonRays {
    /// Begins rays at the ends of the prefixes of these samples, each with a probability of [`RAY_PROB`].
    fn begin(
        &mut self,
        context: &RenderContext<'_>,
        photons: &PhotonGuide,
        samples: &TileSamples,
        prefixes: &Prefixes,
    ) {
        let settings = context.settings;
        self.rays.clear();
        self.of_samples.clear();
        let TileSamples { tile, in_pixel } = samples;
        let all = tile.pixels().flat_map(|pixel| in_pixel.clone().map(move |index| (pixel, index)));
        for (sample, ((x, y), index)) in (0..).zip(all) {
            let Some(Prefix { end, bounce, .. }) = prefixes.of(sample) else { continue };
            // Independent numbers: what is so rarely found gains nothing from a net.
            let numbers =
                Stream::new(settings.seed, settings.pixel_index(x, y), index).part(Sampler::MAX_PARTS);
            let choice = numbers.uniform(0);
            if choice >= RAY_PROB || mirrors_left(context.settings, bounce + 1) < MIN_MIRRORS {
                continue;
            }
            let (choice, u) = (choice / RAY_PROB, numbers.uniform_pair(1));
            let Some(direction) = photons.sample(end.receiver(), choice, u) else { continue };
            if end.normal.dot(direction) > 0.0 {
                self.rays.push(end.point.spawn_ray(direction));
                self.of_samples.push(sample);
            }
        }
    }

    /// Adds the caustics that rays find by way of two mirrors or more, each to its own sample.
    pub(in crate::path) fn trace(
        &mut self,
        context: &RenderContext<'_>,
        samples: &TileSamples,
        prefixes: &Prefixes,
        radiance: &mut [Rgb],
        counters: &mut Counters,
    ) {
        let Some(photons) = &context.photons else { return };
        self.begin(context, photons, samples, prefixes);
        let Self { rays, of_samples, hits, emission_rays } = self;
        checked_accel::intersect(context.scene.accel(), rays, hits);
        for (i, (ray, hit)) in (0..).zip(rays.iter().zip(hits)) {
            let Some(at) = hit.as_ref().map(|hit| context.scene.interaction(ray, hit)) else { continue };
            if !at.point.position.is_finite() {
                // As for the path of a sample: no ray can leave it.
                radiance[of_samples[i as usize] as usize] = Rgb::splat(f64::NAN);
            } else if let Bsdf::Mirror(reflectance) = at.material.bsdf {
                emission_rays.push(reflected_ray(&at.point, ray.direction), i, reflectance.rgb());
            }
        }
        let add = |found: FoundEmission<'_>| {
            let (ray, sample) = (&rays[found.tag as usize], of_samples[found.tag as usize]);
            let (mirrors, Some(prefix)) = (found.mirrors + 1, prefixes.of(sample)) else { return };
            let is_looked_for =
                (MIN_MIRRORS..=mirrors_left(context.settings, prefix.bounce + 1)).contains(&mirrors);
            if is_looked_for || !found.radiance.is_finite() {
                let [bsdf, by_photons] = densities(context, photons, &prefix.end, ray.direction);
                radiance[sample as usize] += prefix.throughput * found.radiance / (bsdf + by_photons);
            }
        };
        let traced = emission_rays.trace(context, mirrors_left(context.settings, 1) - 1, add, |_, _| {});
        counters.shadow_rays += rays.len() as u64 + traced;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PinholeCamera;
    use crate::guide::{Photon, guide_vertex};
    use crate::light::Receiver;
    use crate::path::test_rooms::{Setup, TILE, settings, shaft};
    use glam::Vec3;

    /// In the middle between the walls, a ray toward the height `4 / (2 k)` of a wall reaches the light after `k` mirrors.
    #[test]
    fn rays_of_photons_follow_as_many_mirrors_as_paths_do() {
        let (scene, settings) = (shaft(0.5), settings());
        let camera = PinholeCamera::look_at(DVec3::new(0.0, 2.0, 0.5), DVec3::ZERO, DVec3::Y, 0.02).unwrap();
        for mirrors in [1.0, 2.0, 8.0, 9.0] {
            let vertex = guide_vertex(Receiver { position: DVec3::ZERO, normal: Vec3::Y });
            let photon = Photon { vertex, exit: Vec3::new(0.5, 2.0 / mirrors, 0.0) };
            let photons = PhotonGuide::new(&[photon; 64]).unwrap();
            let setup = Setup { scene: &scene, sensor: &camera, photons, trained: None };
            let [with_photons, shared, _] = setup.pixels(&settings);
            let brighter = with_photons.iter().zip(&shared).filter(|(a, b)| a.g > b.g).count();
            let looked_for = (2.0..=8.0).contains(&mirrors);
            assert_eq!(brighter > TILE.pixel_count() / 2, looked_for, "{mirrors}: {brighter}");
            assert_eq!(with_photons == shared, !looked_for, "{mirrors}");
        }
    }
}
