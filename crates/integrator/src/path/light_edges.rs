//! Supersampling of lights: more camera rays where neighbouring pixels see different emission.
//!
//! Which pixels these are depends on probes at fixed places, never on samples, so the mean is that of one camera ray
//! per sample.

use super::render_context::RenderContext;
use super::tile_bounds::Tile;
use crate::{PathStart, Sampler, Settings};
use globillum_geom::{Hit, Ray};
use globillum_material::{Bsdf, Material, Rgb};
use std::ops::Range;

/// The most mirrors by way of which a ray finds a light.
pub(super) const MAX_REFLECTIONS: u32 = 4;

/// Probes along each side of a pixel.
const PROBES: u32 = 4;

/// Rays that are traced at once.
const BATCH: usize = 1024;

/// The pixels of a tile that may see the edge of a light, as indices into [`Tile::pixels`], in ascending order.
#[derive(Debug, Default)]
pub(crate) struct LightEdges {
    pub(super) pixels: Vec<u32>,
}

/// Camera rays that find emission only, and the samples that they are for.
#[derive(Debug, Default)]
pub(super) struct EmissionRays {
    rays: Vec<Ray>,
    /// What each ray is for, and the throughput along it.
    states: Vec<(u32, Rgb)>,
    hits: Vec<Option<Hit>>,
    /// What was found, by the sample that it is for.
    pub(super) found: Vec<(u32, Rgb)>,
}

impl LightEdges {
    /// Finds them by probes in the tile and in the pixels around it.
    pub(crate) fn of(context: &RenderContext<'_>, tile: Tile) -> Self {
        if !context.supersamples_lights() {
            return Self::default();
        }
        let Settings { width, height, .. } = *context.settings;
        let around = tile.grown(width, height);
        let mut seen = vec![[Rgb::BLACK; (PROBES * PROBES) as usize]; around.pixel_count()];
        let mut rays = EmissionRays::default();
        for (i, (x, y)) in (0..).zip(around.pixels()) {
            for probe in 0..PROBES * PROBES {
                let u = [probe % PROBES, probe / PROBES].map(|k| (f64::from(k) + 0.5) / f64::from(PROBES));
                rays.push(i * PROBES * PROBES + probe, context.path_start((x, y), u));
            }
        }
        let probes = seen.as_flattened_mut();
        rays.trace(context, |probe, emitted| probes[probe as usize] += emitted);
        let differs = |(x, y): (u32, u32)| {
            let own = seen[around.index(x, y)][0];
            let near = Tile { x, y, width: 1, height: 1 }.grown(width, height);
            near.pixels().any(|(x, y)| seen[around.index(x, y)].iter().any(|&other| other != own))
        };
        let pixels = (0..).zip(tile.pixels()).filter(|&(_, pixel)| differs(pixel)).map(|(i, _)| i).collect();
        Self { pixels }
    }
}

impl EmissionRays {
    /// Finds the emission that camera rays see at the edges: for each sample of each of their pixels, the mean of the
    /// sample's rays. Returns the number of camera rays.
    pub(super) fn find(
        &mut self,
        context: &RenderContext<'_>,
        (tile, edges): (Tile, &LightEdges),
        samples: &Range<u32>,
    ) -> u64 {
        self.found.clear();
        let at_once = 1.max(BATCH / (samples.len() * Sampler::RAYS));
        let mut camera_rays = 0;
        for pixels in edges.pixels.chunks(at_once) {
            let before = self.found.len();
            context.simd.run(
                #[inline(always)]
                || self.begin(context, tile, pixels, samples),
            );
            camera_rays += self.rays.len() as u64;
            let mut found = std::mem::take(&mut self.found);
            self.trace(context, |i, emitted| found[i as usize].1 += emitted);
            found[before..].iter_mut().for_each(|(_, sum)| *sum = *sum / Sampler::RAYS as f64);
            self.found = found;
        }
        camera_rays
    }

    /// Begins the rays of these pixels.
    #[inline(always)]
    fn begin(&mut self, context: &RenderContext<'_>, tile: Tile, pixels: &[u32], samples: &Range<u32>) {
        let settings = context.settings;
        let pass = settings.pass_of(samples.start);
        for &pixel in pixels {
            let (x, y) = tile.pixel(pixel);
            let net = u64::from(y) * u64::from(settings.width) + u64::from(x);
            for (sample, i) in samples.clone().zip(pixel * samples.len() as u32..) {
                for u in settings.sampler.ray_positions(settings.seed, net, sample, &pass) {
                    self.push(self.found.len() as u32, context.path_start((x, y), u));
                }
                self.found.push((i, Rgb::BLACK));
            }
        }
    }

    fn push(&mut self, target: u32, start: PathStart) {
        match start {
            PathStart::Ray(ray) if ray.is_traceable() => {
                self.rays.push(ray);
                self.states.push((target, Rgb::WHITE));
            }
            // The path of the sample tells of a ray that is not traceable.
            _ => {}
        }
    }

    /// Calls `add` with the emission that each ray finds, directly and by way of mirrors. No rays are left.
    fn trace(&mut self, context: &RenderContext<'_>, mut add: impl FnMut(u32, Rgb)) {
        let scene = context.scene;
        for _ in 0..=context.settings.max_bounces.unwrap_or(u32::MAX).min(MAX_REFLECTIONS) {
            scene.accel().intersect_batch(&self.rays, &mut self.hits);
            let mut kept = 0;
            for i in 0..self.rays.len() {
                let (ray, (target, throughput)) = (self.rays[i], self.states[i]);
                let Some(hit) = &self.hits[i] else { continue };
                let Material { bsdf, emission, .. } = *scene.material(hit.triangle);
                if bsdf.is_diffuse() && emission.is_none() {
                    continue;
                }
                let at = scene.interaction(&ray, hit);
                if !at.point.position.is_finite() {
                    // As for the path of a sample: no ray can leave it.
                    add(target, Rgb::splat(f64::NAN));
                    continue;
                }
                let emitted = at.emitted();
                if !emitted.is_black() {
                    add(target, throughput * emitted);
                }
                let Bsdf::Mirror(reflectance) = bsdf else { continue };
                let throughput = throughput * reflectance.rgb();
                let cos = at.point.normal.dot(at.wo);
                if cos == 0.0 || throughput.is_black() {
                    continue;
                }
                self.rays[kept] = at.point.spawn(2.0 * cos * at.point.normal - at.wo);
                self.states[kept] = (target, throughput);
                kept += 1;
            }
            self.rays.truncate(kept);
            self.states.truncate(kept);
            if kept == 0 {
                break;
            }
        }
        self.rays.clear();
        self.states.clear();
    }
}
