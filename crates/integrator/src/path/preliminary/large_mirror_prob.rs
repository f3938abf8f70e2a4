//! The probability with which vertices after the first diffuse one sample lights in large mirrors. It follows from what
//! such samples and those without a mirror contribute to probes.

use super::path_starts::{capped_bounces, distances, patches, path_context, path_settings};
use crate::Settings;
use crate::path::counters::Counters;
use crate::path::radiance_sums::Contribution;
use crate::path::render_context::RenderContext;
use crate::path::tile_probes::TileProbes;
use crate::path::wavefront::Wavefront;
use crate::pixel_rect::PixelRect;
use rayon::prelude::*;
use std::ops::{AddAssign, Range};

/// About how many paths are traced.
const PATHS: u32 = 1 << 12;

/// The seed of their random numbers: `mirror` in ASCII.
const SEED: u64 = 0x6d69_7272_6f72;

/// The probability is this many times the ratio of the roots of sums of squares (measured, docs/estimators.md).
const FACTOR: f64 = 2.0;

/// The least probability: probes may miss where mirrors matter.
const MIN_PROB: f64 = 1.0 / 16.0;

/// Sums of squares of what light samples contribute at vertices after the first diffuse one of their path.
#[derive(Clone, Copy, Debug, Default)]
struct Squares {
    /// Of those without a mirror.
    direct: f64,
    /// Of those in large mirrors.
    large: f64,
}

impl AddAssign for Squares {
    fn add_assign(&mut self, Self { direct, large }: Self) {
        self.direct += direct;
        self.large += large;
    }
}

/// The probability for this picture.
///
/// Let `v` be the mean square of such samples if all are taken and `t` their time, `V` the variance without `v` and `T`
/// the time of all else. With probability `p`, variance times time is `(V + v / p) (T + p t)`, and least for
/// `p = sqrt(v T / (V t))`.
pub(super) fn of(context: &RenderContext<'_>) -> f64 {
    // A sample at the second diffuse vertex takes a third bounce, at the mirror.
    let has_later = context.settings.max_bounces.is_none_or(|max| max > 2);
    if context.large_mirrors().is_none() || !has_later {
        return 1.0;
    }
    let settings = probe_settings(context.settings);
    let context = path_context(context, &settings);
    let of_patch = |wavefront: &mut Wavefront, (patch, samples): (PixelRect, Range<u32>)| {
        wavefront.later_squares(&context, patch, samples)
    };
    let patches = patches(&settings, distances(&settings, PATHS), 1);
    let of_patches: Vec<_> = patches.into_par_iter().map_init(Wavefront::default, of_patch).collect();
    let mut squares = Squares::default();
    of_patches.into_iter().for_each(|of_patch| squares += of_patch);
    let prob = FACTOR * (squares.large / squares.direct).sqrt();
    // NaN if the probes found no light.
    if prob.is_nan() { 1.0 } else { prob.clamp(MIN_PROB, 1.0) }
}

/// The settings of the probes.
fn probe_settings(settings: &Settings) -> Settings {
    let samples = (u64::from(PATHS) / settings.pixel_count()).max(1).next_power_of_two() as u32;
    Settings { max_bounces: capped_bounces(settings), ..path_settings(settings, samples, SEED) }
}

impl Wavefront {
    /// The sums for these samples of a patch.
    fn later_squares(
        &mut self,
        context: &RenderContext<'_>,
        patch: PixelRect,
        samples: Range<u32>,
    ) -> Squares {
        self.start(context, &TileProbes::none(patch), samples);
        let mut is_later = vec![false; self.samples.count()];
        let mut squares = Squares::default();
        for bounce in 0.. {
            self.paths.iter().for_each(|path| is_later[path.target.sample() as usize] = !path.is_prefix());
            self.shade(context, bounce, &mut Counters::default());
            let direct = self.trace_light_samples(context);
            let large = direct..self.contributions.len();
            squares += Squares {
                direct: self.square_sum(0..direct, &is_later),
                large: self.square_sum(large, &is_later),
            };
            if self.paths.is_empty() {
                break;
            }
        }
        squares
    }

    /// The sum of squares of the luminances of these contributions, where they are not occluded, to samples of which
    /// `is_later` holds.
    fn square_sum(&self, range: Range<usize>, is_later: &[bool]) -> f64 {
        let square = |(contribution, &occluded): (&Contribution, &bool)| {
            let counts = !occluded && is_later[contribution.target.sample() as usize];
            let luminance = if counts { contribution.radiance.luminance() } else { 0.0 };
            // A radiance that is not finite is reported when the picture is rendered.
            if luminance.is_finite() { luminance * luminance } else { 0.0 }
        };
        self.contributions[range.clone()].iter().zip(&self.occluded[range]).map(square).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::preliminary::path_starts::PATCH_SIDE;
    use crate::path::preliminary::prepare;
    use crate::path::test_rooms::{assert_equal_means, built, radiance_sum};
    use crate::{Model, PathReuse, PinholeCamera, Scene};
    use glam::DVec3;
    use globillum_geom::KdTree;
    use globillum_geom::conformance::shapes::{icosphere, quad};
    use globillum_material::{Material, Rgb};

    const TILE: PixelRect = PixelRect { x: 0, y: 0, width: 12, height: 12 };

    /// A floor and a wall under a square light of this size. Another wall is a mirror, and so is a small ball. The light may
    /// be hidden from the wall by a box that is open below.
    fn scene(size: f64, is_hidden: bool) -> Scene<KdTree> {
        let p = DVec3::new;
        let mut model = Model::default();
        let white = Material::lambert(Rgb::splat(0.8)).unwrap();
        model.add(white, quad(p(-1.0, 0.0, 1.0), p(1.0, 0.0, 1.0), p(1.0, 0.0, -1.0), p(-1.0, 0.0, -1.0)));
        model.add(white, quad(p(-1.0, 0.0, -1.0), p(1.0, 0.0, -1.0), p(1.0, 2.0, -1.0), p(-1.0, 2.0, -1.0)));
        let mirror = Material::mirror(Rgb::splat(0.9)).unwrap();
        model.add(mirror, quad(p(-1.0, 0.0, -1.0), p(-1.0, 2.0, -1.0), p(-1.0, 2.0, 1.0), p(-1.0, 0.0, 1.0)));
        model.add(mirror, icosphere(2).placed(0.4, p(0.3, 0.5, 0.1)).triangles());
        let corner = |x: f64, z: f64| p(0.5 * size * x, 1.5, 0.5 * size * z);
        let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        model.add(
            Material::light(Rgb::splat(5.0)).unwrap(),
            quad(corners[0], corners[1], corners[2], corners[3]),
        );
        if is_hidden {
            for (from, to) in [(0, 1), (1, 2), (2, 3), (3, 0)].map(|(i, j)| (corners[i], corners[j])) {
                let (up, down) = (0.1 * DVec3::Y, 1.4 * DVec3::NEG_Y);
                model.add(white, quad(from + up, to + up, to + down, from + down));
            }
        }
        built(model)
    }

    fn camera() -> PinholeCamera {
        PinholeCamera::look_at(DVec3::new(0.4, 1.0, 2.2), DVec3::new(0.1, 0.4, 0.0), DVec3::Y, 0.9).unwrap()
    }

    fn settings(seed: u64) -> Settings {
        Settings { seed, path_reuse: PathReuse::Off, ..Settings::new(12, 12, 4) }
    }

    /// The same seeds, so that most other light cancels. The light is large, so that scattering finds it too.
    #[test]
    fn the_mean_does_not_depend_on_the_probability() {
        let (scene, camera) = (scene(1.9, false), camera());
        assert_equal_means(5e-4, |seed| {
            let settings = settings(seed);
            [1.0, 0.2].map(|large_mirror_prob| {
                let context = RenderContext::new(&scene, &camera, &settings);
                radiance_sum(&RenderContext { large_mirror_prob, ..context }, TILE)
            })
        });
    }

    fn found(scene: &Scene<KdTree>, settings: &Settings) -> f64 {
        prepare(scene, &camera(), settings, None, || false)
            .continue_value()
            .expect("nothing cancels it")
            .large_mirror_prob
    }

    #[test]
    fn mirrors_are_sampled_as_often_as_they_matter() {
        let settings = settings(0);
        let bare = found(&scene(0.6, false), &settings);
        assert!((0.5..1.0).contains(&bare), "{bare}");
        assert_eq!(found(&scene(0.6, true), &settings), MIN_PROB);
        let off = Settings { mirror_sampling: crate::MirrorSampling::Off, ..settings };
        assert_eq!(found(&scene(0.6, true), &off), 1.0);
    }

    /// Neither the seed nor the number of samples changes it, so all parts of a picture have the same.
    #[test]
    fn it_follows_from_the_scene() {
        let scene = scene(0.6, false);
        let first = found(&scene, &settings(0));
        let other = Settings { seed: 5, samples: 64, pass_samples: 64, ..settings(0) };
        assert_eq!(found(&scene, &other), first);
    }

    #[test]
    fn a_picture_of_any_size_has_about_as_many_probes() {
        let sizes =
            [(1, 1), (7, 9), (64, 64), (100, 65), (1920, 1080), (16_384, 3), (16, 1 << 20), (1, 1 << 27)];
        for (width, height) in sizes {
            let settings = probe_settings(&Settings::new(width, height, 1));
            let patches = patches(&settings, distances(&settings, PATHS), 1);
            let paths: usize = patches.iter().map(|(patch, _)| patch.pixel_count()).sum();
            let least = PATHS as usize / if width.min(height) < PATCH_SIDE { 16 } else { 4 };
            assert!((least..=2 * PATHS as usize).contains(&paths), "{width} x {height}: {paths}");
        }
    }
}
