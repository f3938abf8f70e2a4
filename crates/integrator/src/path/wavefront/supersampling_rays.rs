use crate::path::emission_rays::{EmissionRays, FoundEmission};
use crate::path::mirrors_left::mirrors_left;
use crate::path::render_context::RenderContext;
use crate::path::tile_probes::LightEdges;
use crate::path::tile_samples::TileSamples;
use globillum_material::Rgb;

/// The number of rays of one sample, in a pixel that sees no curved mirror.
const PLAIN: usize = 16;

/// The same where it sees one, in which lights are often much smaller than the pixel.
const IN_CURVED_MIRRORS: usize = 32;

/// Rays that are traced at once.
const RAYS_AT_ONCE: usize = 1024;

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
        edges: &LightEdges,
        samples: &TileSamples,
    ) -> u64 {
        self.found.clear();
        self.find_by::<PLAIN>(context, &edges.plain, samples)
            + self.find_by::<IN_CURVED_MIRRORS>(context, &edges.in_curved_mirrors, samples)
    }

    /// The same for some pixels, by `N` rays for each sample.
    fn find_by<const N: usize>(
        &mut self,
        context: &RenderContext<'_>,
        pixels: &[u32],
        samples: &TileSamples,
    ) -> u64 {
        let at_once = 1.max(RAYS_AT_ONCE / (samples.in_pixel.len() * N));
        let mut camera_rays = 0;
        for pixels in pixels.chunks(at_once) {
            let before = self.found.len();
            context.simd.run(
                #[inline(always)]
                || self.begin::<N>(context, pixels, samples),
            );
            camera_rays += self.rays.len() as u64;
            let mut found = std::mem::take(&mut self.found);
            let add = |emission: FoundEmission<'_>| found[emission.tag as usize].1 += emission.radiance;
            self.rays.trace(context, mirrors_left(context.settings, 0), add, |_, _| {});
            found[before..].iter_mut().for_each(|(_, sum)| *sum /= N as f64);
            self.found = found;
        }
        camera_rays
    }

    /// Begins the rays of these pixels, `N` for each sample.
    #[inline(always)]
    fn begin<const N: usize>(&mut self, context: &RenderContext<'_>, pixels: &[u32], samples: &TileSamples) {
        let settings = context.settings;
        let pass = settings.pass_of(samples.in_pixel.start);
        let samples_of_pass = settings.samples_of(pass..pass + 1);
        for &pixel in pixels {
            let (x, y) = samples.tile.pixel(pixel);
            let net = settings.pixel_index(x, y);
            for (sample, index) in samples.of_pixel(pixel).zip(samples.in_pixel.clone()) {
                for u in settings.sampler.ray_positions::<N>(settings.seed, net, index, &samples_of_pass) {
                    let start = context.path_start((x, y), u);
                    self.rays.push_start(start, self.found.len() as u32);
                }
                self.found.push((sample, Rgb::BLACK));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::test_rooms::built;
    use crate::pixel_rect::PixelRect;
    use crate::{Model, PinholeCamera, Settings};
    use glam::DVec3;
    use globillum_geom::conformance::shapes::{icosphere, quad};
    use globillum_material::Material;

    /// A light that the camera sees, and a mirror ball that shows it.
    #[test]
    fn samples_of_curved_mirrors_have_twice_as_many_rays() {
        let p = |x, y| DVec3::new(x, y, 0.0);
        let mut model = Model::default();
        let light = quad(p(0.1, -0.3), p(0.6, -0.3), p(0.6, 0.3), p(0.1, 0.3));
        model.add(Material::light(Rgb::WHITE).unwrap(), light);
        let ball = icosphere(4).placed(0.3, DVec3::new(-0.4, 0.0, 0.5)).triangles();
        model.add(Material::mirror(Rgb::WHITE).unwrap(), ball);
        let scene = built(model);
        let camera = PinholeCamera::look_at(DVec3::new(0.0, 0.0, 4.0), DVec3::ZERO, DVec3::Y, 0.4).unwrap();
        let settings = Settings::new(16, 16, 3);
        let context = RenderContext::new(&scene, &camera, &settings);
        let tile = PixelRect { x: 0, y: 0, width: 16, height: 16 };
        let edges = LightEdges::of(&context, tile);
        let [plain, in_curved_mirrors] = [&edges.plain, &edges.in_curved_mirrors].map(|pixels| pixels.len());
        assert!(plain > 5 && in_curved_mirrors > 5, "{plain} and {in_curved_mirrors} pixels");
        let mut rays = SupersamplingRays::default();
        let traced = rays.find(&context, &edges, &TileSamples { tile, in_pixel: 0..3 });
        assert_eq!(traced, 3 * (16 * plain + 32 * in_curved_mirrors) as u64);
        assert_eq!(rays.found.len(), 3 * (plain + in_curved_mirrors));
    }
}
