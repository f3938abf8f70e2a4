//! The start of paths, where the sensor says.

use super::Wavefront;
use super::numbers::draw_numbers;
use crate::PathStart;
use crate::path::mis::MisContext;
use crate::path::path_state::Path;
use crate::path::render_context::RenderContext;
use crate::path::reuse::Groups;
use crate::path::tile_probes::TileProbes;
use crate::path::tile_samples::TileSamples;
use crate::sampler::{Member, Numbers};
use globillum_material::Rgb;
use std::ops::Range;

impl Wavefront {
    /// Starts the paths of these samples of each pixel of the tile.
    pub(in crate::path) fn start(
        &mut self,
        context: &RenderContext<'_>,
        probes: &TileProbes,
        samples: Range<u32>,
    ) {
        let (settings, tile) = (context.settings, probes.tile);
        let pass = settings.pass_of(samples.start);
        let samples_of_pass = settings.samples_of(pass..pass + 1);
        let groups = context.stratifies_groups().then(|| Groups::of_pass(pass));
        self.samples = TileSamples { tile, in_pixel: samples };
        self.paths.clear();
        for (x, y) in tile.pixels_by_block() {
            let alone = || Member::alone(settings.pixel_index(x, y));
            let member = groups.map_or_else(alone, |groups| groups.member(x, y, settings.width));
            let pixel = tile.index(x, y) as u32;
            let supersampled = probes.edges.contain(pixel);
            for (sample, index) in self.samples.of_pixel(pixel).zip(self.samples.in_pixel.clone()) {
                let numbers = settings.sampler.numbers(settings.seed, member, index, &samples_of_pass);
                self.paths.push(Path::new(sample, numbers, MisContext::of_camera(supersampled)));
            }
        }
        #[expect(
            clippy::redundant_closure,
            reason = "functions are not compiled for the instruction set, closures are"
        )]
        draw_numbers(
            context.simd,
            &self.paths,
            &mut self.position_numbers,
            #[inline(always)]
            |samples| Numbers::pixel_positions(samples),
        );
        self.prefixes.start(context, &self.samples);
        self.radiance.reset(self.paths.len(), self.prefixes.len());
        self.caustics.clear();
        self.place(context);
    }

    /// Asks the sensor where the paths begin. Keeps those that begin with a ray, in order, and those that begin at a point
    /// by themselves.
    fn place(&mut self, context: &RenderContext<'_>) {
        self.rays.clear();
        self.from_points.clear();
        self.points.clear();
        let TileSamples { tile, in_pixel } = &self.samples;
        let elements = tile.pixels_by_block().zip(self.position_numbers.chunks_exact(in_pixel.len()));
        let samples = elements.flat_map(|(element, numbers)| numbers.iter().map(move |&u| (element, u)));
        let mut kept = 0;
        for (i, (element, u)) in samples.enumerate() {
            match context.path_start(element, u) {
                start if !start.is_valid() => {
                    *self.radiance.at(self.paths[i].target) = Rgb::splat(f64::NAN);
                }
                PathStart::Ray(ray) => {
                    self.paths[kept] = self.paths[i];
                    self.rays.push(ray);
                    kept += 1;
                }
                PathStart::Irradiance { position, normal } => {
                    self.from_points.push(self.paths[i]);
                    self.points.push(context.scene.triangles().given_point(position, normal));
                }
                PathStart::Nowhere => {}
            }
        }
        self.paths.truncate(kept);
    }
}
