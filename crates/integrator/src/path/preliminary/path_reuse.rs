//! Whether path reuse pays, by the part of the variance of pixels that suffixes bring to probes.

use super::path_starts::{capped_bounces, distances, patches, path_context, path_settings};
use crate::Settings;
use crate::path::counters::Counters;
use crate::path::radiance_sums::Target;
use crate::path::render_context::RenderContext;
use crate::path::tile_probes::TileProbes;
use crate::path::wavefront::Wavefront;
use crate::pixel_rect::PixelRect;
use rayon::prelude::*;
use std::ops::Range;

/// About how many paths are traced.
const PATHS: u32 = 1 << 12;

/// Paths of each pixel, of which a variance is estimated.
const SAMPLES: u32 = 4;

/// The seed of their random numbers: `reuse` in ASCII.
const SEED: u64 = 0x72_6575_7365;

/// The least part of the variance with which reuse pays. It takes 1.4 to 2.5 times the time, and leaves about a sixth of what
/// suffixes bring (docs/estimators.md).
const MIN_SHARE: f64 = 0.5;

/// Whether path reuse lowers the variance by more than it raises the time. True where the paths tell nothing, and in scenes
/// with mirrors, where shared caustics may bring more than these paths find.
pub(super) fn pays(context: &RenderContext<'_>) -> bool {
    let is_certain = !context.reuses_paths() || context.scene.has_mirrors();
    is_certain || share_of_suffixes(context).is_none_or(|share| share >= MIN_SHARE)
}

/// The part of a pixel's variance that its suffixes bring, as the mean over pixels that vary; `None` if none does. No pixel
/// counts for more than others, so the few that find rare bright light do not decide.
fn share_of_suffixes(context: &RenderContext<'_>) -> Option<f64> {
    let &Settings { path_reuse, light_samples, .. } = context.settings;
    let paths = path_settings(context.settings, SAMPLES, SEED);
    let max_bounces = capped_bounces(context.settings);
    let settings = Settings { path_reuse, light_samples, max_bounces, ..paths };
    let context = path_context(context, &settings);
    let of_patch = |wavefront: &mut Wavefront, (patch, samples): (PixelRect, Range<u32>)| {
        wavefront.shares_of_suffixes(&context, patch, samples)
    };
    let patches = patches(&settings, distances(&settings, PATHS / SAMPLES), SAMPLES);
    let shares: Vec<_> = patches.into_par_iter().map_init(Wavefront::default, of_patch).collect();
    let shares = shares.concat();
    (!shares.is_empty()).then(|| shares.iter().sum::<f64>() / shares.len() as f64)
}

impl Wavefront {
    /// The part of the variance of these samples that suffixes bring, for each pixel of a patch that varies.
    fn shares_of_suffixes(
        &mut self,
        context: &RenderContext<'_>,
        patch: PixelRect,
        samples: Range<u32>,
    ) -> Vec<f64> {
        self.start(context, &TileProbes::none(patch), samples);
        self.advance_to_end(context, &mut Counters::default(), || false);
        let of_pixel = |pixel: u32| {
            let samples = self.samples.of_pixel(pixel);
            let before = samples.clone().map(|sample| self.radiance.samples[sample as usize].luminance());
            let after = samples.map(|sample| {
                let throughput = self.prefixes.throughput_before(Target::AfterPrefix(sample));
                (throughput * self.radiance.after_prefix(sample)).luminance()
            });
            let [before, after] = [squared_deviations(before), squared_deviations(after)];
            let all = before + after;
            (all > 0.0 && all.is_finite()).then(|| after / all)
        };
        (0..patch.pixel_count() as u32).filter_map(of_pixel).collect()
    }
}

/// The sum of squared deviations from the mean.
fn squared_deviations(values: impl ExactSizeIterator<Item = f64> + Clone) -> f64 {
    let count = values.len() as f64;
    let mean = values.clone().sum::<f64>() / count;
    values.map(|value| (value - mean) * (value - mean)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::preliminary::prepare;
    use crate::path::test_rooms::{built, camera};
    use crate::{DeltaLight, Model, PathReuse, Sampler, Scene, Stream};
    use glam::{DVec3, Vec3};
    use globillum_geom::conformance::shapes::quad;
    use globillum_geom::{KdTree, Triangle};
    use globillum_material::{Material, Rgb};

    /// Leaves much smaller than pixels, under a directional light.
    fn foliage() -> Scene<KdTree> {
        let leaf = |i: u32| {
            let numbers = Stream::new(31, 0, i);
            let vector = |first: u32| {
                DVec3::from_array([0, 1, 2].map(|axis| 2.0 * numbers.uniform(first + axis) - 1.0))
            };
            let middle = vector(0);
            Triangle { vertices: [3, 6, 9].map(|first| (middle + 0.02 * vector(first)).as_vec3()) }
        };
        let mut model = Model::default();
        model.add(Material::lambert(Rgb::splat(0.5)).unwrap(), (0..20_000).map(leaf));
        model.add_delta_light(DeltaLight::directional(Vec3::new(0.3, -1.0, -0.2), Rgb::splat(3.0)).unwrap());
        built(model)
    }

    /// A floor and two walls under a light.
    fn corner() -> Scene<KdTree> {
        let p = DVec3::new;
        let mut model = Model::default();
        let white = Material::lambert(Rgb::splat(0.7)).unwrap();
        model.add(white, quad(p(-1.0, 0.0, 1.0), p(1.0, 0.0, 1.0), p(1.0, 0.0, -1.0), p(-1.0, 0.0, -1.0)));
        model.add(white, quad(p(-1.0, 0.0, -1.0), p(1.0, 0.0, -1.0), p(1.0, 2.0, -1.0), p(-1.0, 2.0, -1.0)));
        model.add(white, quad(p(1.0, 0.0, -1.0), p(1.0, 0.0, 1.0), p(1.0, 2.0, 1.0), p(1.0, 2.0, -1.0)));
        let light = quad(p(-0.1, 1.9, -0.1), p(0.1, 1.9, -0.1), p(0.1, 1.9, 0.1), p(-0.1, 1.9, 0.1));
        model.add(Material::light(Rgb::splat(50.0)).unwrap(), light);
        built(model)
    }

    #[test]
    fn paths_are_reused_where_suffixes_bring_most_of_the_variance() {
        let camera = camera(0.9);
        for (what, scene, expected) in [("foliage", foliage(), false), ("a corner", corner(), true)] {
            let mut settings = Settings::new(40, 30, 4);
            settings.sampler = Sampler::Independent;
            let pixels = [PathReuse::Tiles, PathReuse::Off].map(|path_reuse| {
                let settings = Settings { path_reuse, ..settings };
                let context = prepare(&scene, &camera, &settings, None, || false).continue_value().unwrap();
                assert_eq!(context.reuses_paths(), expected && path_reuse == PathReuse::Tiles, "{what}");
                let tile = PixelRect { x: 16, y: 0, width: 16, height: 16 };
                let mut wavefront = Wavefront::default();
                wavefront.trace(&context, &TileProbes::of(&context, tile), 0..4, || false);
                wavefront.radiance().to_vec()
            });
            assert_eq!(pixels[0] != pixels[1], expected, "{what}");
            assert!(pixels[1].iter().any(|radiance| !radiance.is_black()), "{what}");
        }
    }

    #[test]
    fn paths_are_reused_where_no_pixel_varies() {
        let mut model = Model::default();
        model.add(
            Material::light(Rgb::WHITE).unwrap(),
            [Triangle { vertices: [Vec3::X, Vec3::Y, Vec3::Z].map(|v| v + 50.0) }],
        );
        let (scene, camera, settings) = (built(model), camera(0.9), Settings::new(8, 8, 4));
        let context = RenderContext::new(&scene, &camera, &settings);
        assert_eq!((share_of_suffixes(&context), pays(&context)), (None, true));
    }
}
