//! Supersampling of lights: more camera rays where neighbouring pixels see different emission.
//!
//! Which pixels these are depends on probes at fixed places, never on samples, so the mean is that of one camera ray
//! per sample.

use super::emission_rays::{EmissionRays, MAX_REFLECTIONS};
use super::render_context::RenderContext;
use super::tile_bounds::Tile;
use crate::{PathStart, Sampler, Settings};
use globillum_material::Rgb;
use std::ops::Range;

/// Probes along each side of a pixel.
const PROBES: u32 = 4;

/// Rays that are traced at once.
const BATCH: usize = 1024;

/// The pixels of a tile that may see the edge of a light, as indices into [`Tile::pixels`], in ascending order.
#[derive(Debug, Default)]
pub(crate) struct LightEdges {
    pub(super) pixels: Vec<u32>,
}

/// Camera rays that find emission only.
#[derive(Debug, Default)]
pub(super) struct LightRays {
    rays: EmissionRays,
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
                push(&mut rays, i * PROBES * PROBES + probe, context.path_start((x, y), u));
            }
        }
        let probes = seen.as_flattened_mut();
        rays.trace(context, max_reflections(context), |found| {
            probes[found.target as usize] += found.radiance
        });
        let differs = |(x, y): (u32, u32)| {
            let own = seen[around.index(x, y)][0];
            let near = Tile { x, y, width: 1, height: 1 }.grown(width, height);
            near.pixels().any(|(x, y)| seen[around.index(x, y)].iter().any(|&other| other != own))
        };
        let pixels = (0..).zip(tile.pixels()).filter(|&(_, pixel)| differs(pixel)).map(|(i, _)| i).collect();
        Self { pixels }
    }
}

impl LightRays {
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
            self.rays.trace(context, max_reflections(context), |emission| {
                found[emission.target as usize].1 += emission.radiance;
            });
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
                    let start = context.path_start((x, y), u);
                    push(&mut self.rays, self.found.len() as u32, start);
                }
                self.found.push((i, Rgb::BLACK));
            }
        }
    }
}

/// By way of how many mirrors a camera ray finds lights.
fn max_reflections(context: &RenderContext<'_>) -> u32 {
    context.settings.max_bounces.unwrap_or(u32::MAX).min(MAX_REFLECTIONS)
}

/// Adds the camera ray that begins at `start`.
#[inline(always)]
fn push(rays: &mut EmissionRays, target: u32, start: PathStart) {
    match start {
        PathStart::Ray(ray) if ray.is_traceable() => rays.push(ray, target, Rgb::WHITE),
        // The path of the sample tells of a ray that is not traceable.
        _ => {}
    }
}
