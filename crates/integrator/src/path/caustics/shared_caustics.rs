//! Caustics that pixels share.
//!
//! A path may leave its first diffuse vertex `x` toward a mirror, and find a light by way of mirrors alone. Where light
//! samples do not find such light, or hardly ever, these paths are rare and bring much. So each of them is shared by all
//! pixels of a square. Every pixel connects its own `x` to the point `y` on the first mirror, and follows mirrors from
//! there. The pixels that find a light could have sampled `y` themselves; they are combined by the balance heuristic, each
//! with the radiance that arrives by way of `y`. [Rays guided by photons](super::photon_rays) find a part of what comes by
//! way of several mirrors. What suffixes find by way of mirrors is shared [with the suffix](crate::path::reuse).

use super::photon_rays::bsdf_weight;
use crate::Interaction;
use crate::checked_accel;
use crate::path::counters::Counters;
use crate::path::emission_rays::{EmissionRays, FoundEmission, reflected_ray};
use crate::path::mirrors_left::mirrors_left;
use crate::path::mis::MisContext;
use crate::path::path_state::Path;
use crate::path::render_context::RenderContext;
use crate::path::reuse::{Connection, Prefix, Prefixes, ReuseVertex, Suffix};
use crate::path::reuse_stage::ReuseStage;
use crate::path::tile_samples::TileSamples;
use globillum_geom::{PdfSolidAngle, Ray, SurfacePoint};
use globillum_material::{Bsdf, Density, Rgb};
use std::f64::consts::PI;

/// The least weight of multiple importance sampling with which a light is shared. Below it, light samples find most.
pub(in crate::path) const MIN_WEIGHT: f64 = 0.5;

/// The caustics that the paths of a wavefront have found.
#[derive(Debug, Default)]
pub(in crate::path) struct SharedCaustics {
    found: Vec<PathCaustic>,
    /// The prefixes that may share a caustic, each with the radiance that it receives; its own is first.
    connections: Vec<(Connection, Rgb)>,
    /// The segment from each but the first to the mirror.
    rays: Vec<Ray>,
    occluded: Vec<bool>,
    emission_rays: EmissionRays,
}

/// A caustic that the path of a sample has found.
#[derive(Clone, Copy, Debug)]
struct PathCaustic {
    sample: u32,
    /// What leaves the first mirror toward the end of the prefix.
    radiance: Rgb,
    /// Whether it came by way of several mirrors.
    by_several_mirrors: bool,
}

impl SharedCaustics {
    /// Forgets what was found.
    pub(in crate::path) fn clear(&mut self) {
        self.found.clear();
    }

    /// Takes the emission that a path has met by way of mirrors after its prefix, if pixels share it. Otherwise returns its
    /// radiance, which belongs to the sample of the path alone.
    #[inline(never)]
    pub(in crate::path) fn take_emission(
        &mut self,
        context: &RenderContext<'_>,
        path: &Path,
        at: &Interaction<'_>,
    ) -> Rgb {
        let emitted = at.emitted();
        if emitted.is_black() {
            return emitted;
        }
        let weight = path.mis.weight(context, at);
        let radiance = path.throughput * emitted * weight;
        // A radiance that is not finite stays with its own sample, so that an error names that one.
        if !context.shares_caustics || weight < MIN_WEIGHT || radiance.is_black() || !radiance.is_finite() {
            return radiance;
        }
        let by_several_mirrors = matches!(path.stage, ReuseStage::Reflected(mirrors) if mirrors > 1);
        self.found.push(PathCaustic { sample: path.target.sample(), radiance, by_several_mirrors });
        Rgb::BLACK
    }

    /// What the path of a sample has found.
    pub(in crate::path) fn found_by(&self, sample: u32) -> Rgb {
        let own = self.found.iter().filter(|found| found.sample == sample);
        own.map(|found| found.radiance).sum()
    }

    /// Adds each caustic to the samples of equal number in the pixels of its square.
    pub(in crate::path) fn share(
        &mut self,
        context: &RenderContext<'_>,
        samples: &TileSamples,
        prefixes: &Prefixes,
        radiance: &mut [Rgb],
        counters: &mut Counters,
    ) {
        let mut found = std::mem::take(&mut self.found);
        // A mirror that emits brings several to one sample.
        found.sort_by_key(|found| found.sample);
        for of_sample in found.chunk_by(|a, b| a.sample == b.sample) {
            let sample = of_sample[0].sample;
            let Some((own, mirror)) = prefixes.of(sample).and_then(|own| Some((own, own.mirror?))) else {
                continue;
            };
            let shared = shared_radiance(context, own, &mirror, of_sample);
            let Self { connections, rays, .. } = self;
            connections.clear();
            rays.clear();
            let suffix = Suffix::Surface { start: mirror, mirror: None };
            let add = |connection, _| connections.push((connection, Rgb::BLACK));
            let others = samples.of_square(sample);
            Connection::connect(context, prefixes, sample, Some(&suffix), others, rays, add);
            connections[0].1 = shared;
            self.trace_connections(context, prefixes, own.bounce, &mirror.point, counters);
            let lit = self.connections.iter().filter(|(_, radiance)| !radiance.is_black());
            let lit = lit.map(|(connection, radiance)| (connection, *radiance));
            Connection::divide(lit, prefixes, radiance);
        }
        self.found = found;
    }

    /// Finds the light that arrives along each connection but the first by way of `mirror`, the first one after the end of
    /// prefixes at this bounce.
    fn trace_connections(
        &mut self,
        context: &RenderContext<'_>,
        prefixes: &Prefixes,
        bounce: u32,
        mirror: &SurfacePoint,
        counters: &mut Counters,
    ) {
        let Self { connections, rays, occluded, emission_rays, .. } = self;
        checked_accel::occluded(context.scene.accel(), rays, occluded);
        let Bsdf::Mirror(reflectance) = context.scene.material(mirror.triangle).bsdf else { return };
        for (i, (ray, _)) in
            (1..).zip(rays.iter().zip(occluded.iter())).filter(|(_, (_, occluded))| !**occluded)
        {
            emission_rays.push(reflected_ray(mirror, ray.direction), i, reflectance.rgb());
        }
        // Two bounces: at the prefix's end, and at this mirror.
        let left = mirrors_left(context.settings, bounce + 1) - 1;
        let show = |found: FoundEmission<'_>| {
            let (connection, radiance) = &mut connections[found.tag as usize];
            let Some(Prefix { end, .. }) = prefixes.of(connection.sample) else { return };
            let direction = end.direction_to(mirror);
            let pdf =
                PdfSolidAngle(end.normal.dot(direction) / PI * end.guide_ratio(context.guide, direction));
            let mis = MisContext::scattered(Density::SolidAngle(pdf), end.receiver(), true);
            let weight = mis.weight_by_mirror(context, mirror.triangle, &found);
            if weight >= MIN_WEIGHT {
                let bsdf_weight = if found.mirrors > 0 { bsdf_weight(context, end, direction) } else { 1.0 };
                *radiance += found.radiance * (weight * bsdf_weight);
            }
        };
        let traced = emission_rays.trace(context, left, show, |_, _| {});
        counters.shadow_rays += rays.len() as u64 + traced;
    }
}

/// The part of what a path has found that is left for pixels to share.
fn shared_radiance(
    context: &RenderContext<'_>,
    own: &Prefix,
    mirror: &ReuseVertex,
    of_sample: &[PathCaustic],
) -> Rgb {
    let direction = own.end.direction_to(&mirror.point);
    of_sample.iter().fold(Rgb::BLACK, |sum, &PathCaustic { radiance, by_several_mirrors, .. }| {
        sum + radiance * if by_several_mirrors { bsdf_weight(context, &own.end, direction) } else { 1.0 }
    })
}

#[cfg(test)]
mod tests;
