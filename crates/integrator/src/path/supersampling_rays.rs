use super::emission_rays::{EmissionRays, FoundEmission, max_reflections};
use super::light_edges::LightEdges;
use super::pixel_rect::PixelRect;
use super::render_context::RenderContext;
use crate::Sampler;
use globillum_material::Rgb;
use std::ops::Range;

/// Rays that are traced at once.
const BATCH: usize = 1024;

/// Camera rays that find emission only: those of supersampling.
#[derive(Debug, Default)]
pub(super) struct SupersamplingRays {
    rays: EmissionRays,
    /// What was found, by the sample that it is for.
    pub(super) found: Vec<(u32, Rgb)>,
}

impl SupersamplingRays {
    /// Finds the emission that camera rays see at the edges: for each sample of each of their pixels, the mean of the
    /// sample's rays. Returns the number of camera rays.
    pub(super) fn find(
        &mut self,
        context: &RenderContext<'_>,
        (tile, edges): (PixelRect, &LightEdges),
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
            let add = |emission: FoundEmission<'_>| found[emission.target as usize].1 += emission.radiance;
            self.rays.trace(context, max_reflections(context), add, |_, _| {});
            found[before..].iter_mut().for_each(|(_, sum)| *sum = *sum / Sampler::RAYS as f64);
            self.found = found;
        }
        camera_rays
    }

    /// Begins the rays of these pixels.
    #[inline(always)]
    fn begin(&mut self, context: &RenderContext<'_>, tile: PixelRect, pixels: &[u32], samples: &Range<u32>) {
        let settings = context.settings;
        let pass = settings.pass_of(samples.start);
        for &pixel in pixels {
            let (x, y) = tile.pixel(pixel);
            let net = u64::from(y) * u64::from(settings.width) + u64::from(x);
            for (sample, i) in samples.clone().zip(pixel * samples.len() as u32..) {
                for u in settings.sampler.ray_positions(settings.seed, net, sample, &pass) {
                    let start = context.path_start((x, y), u);
                    self.rays.push_start(start, self.found.len() as u32);
                }
                self.found.push((i, Rgb::BLACK));
            }
        }
    }
}
