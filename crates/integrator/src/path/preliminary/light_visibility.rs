//! Which lights are visible: probes sample lights, and those that they rarely see are chosen
//! less often. Otherwise a strong light behind a wall takes the samples of all others.

use super::path_starts::probe_starts;
use crate::light::{ChosenLight, LightTree, Lights, VisibilityCount};
use crate::path::diffuse_vertex::{diffuse_vertex, scattered_ray};
use crate::path::render_context::RenderContext;
use crate::sampler::ReservedStream;
use crate::{Interaction, PathStart, Stream};
use rayon::prelude::*;

/// Paths along each side of the picture.
const PATHS_PER_SIDE: u32 = 64;

/// The most diffuse vertices of a path that sample lights.
const VERTICES: u32 = 3;

/// Light samples of a vertex.
const LIGHT_SAMPLES: usize = 2;

/// Dimensions of the random numbers of a vertex.
const DIMENSIONS: u32 = 2 + 3 * LIGHT_SAMPLES as u32;

/// The lights, chosen by their visibility too; `None` if that changes nothing.
pub(super) fn lights(context: &RenderContext<'_>) -> Option<Lights> {
    let lights = context.scene.lights();
    let tree = lights.tree().filter(|_| context.samples_lights)?;
    let of_row = |row| samples_of_row(context, tree, row);
    let of_rows: Vec<_> = (0..PATHS_PER_SIDE).into_par_iter().map(of_row).collect();
    let mut counts = vec![VisibilityCount::default(); tree.len()];
    of_rows.into_iter().flatten().for_each(|(light, is_visible)| counts[light as usize].add(is_visible));
    lights.by_visibility(&counts)
}

/// The light samples of the paths of a row: the index of each one's light in the tree, and whether it is visible.
fn samples_of_row(context: &RenderContext<'_>, tree: &LightTree, row: u32) -> Vec<(u32, bool)> {
    let mut samples = Vec::new();
    let most = context.settings.max_bounces.map_or(VERTICES, |max| max.min(VERTICES));
    for (column, start) in (0..).zip(probe_starts(context, PATHS_PER_SIDE, row)) {
        let numbers = Stream::reserved(ReservedStream::LightProbes, row * PATHS_PER_SIDE + column);
        let mut start = Some(start);
        for first in (0..most).map(|vertex| vertex * DIMENSIONS) {
            let Some(at) = start.and_then(|start| diffuse_vertex(context, start, |_| true)) else { break };
            // A black surface samples no lights that matter.
            let Some((scattered, _)) = scattered_ray(&at, numbers.uniform_pair(first)) else { break };
            start = Some(PathStart::Ray(scattered));
            let dimensions: [u32; LIGHT_SAMPLES] = std::array::from_fn(|k| first + 2 + 3 * k as u32);
            let chosen = tree.choose(at.receiver(), dimensions.map(|dimension| numbers.uniform(dimension)));
            samples.extend(chosen.into_iter().zip(dimensions).map(|(chosen, dimension)| {
                (chosen.index, is_visible(context, &at, chosen, numbers.uniform_pair(dimension + 1)))
            }));
        }
    }
    samples
}

/// Whether the point of the chosen light that `u` samples is visible from a vertex, on the side of its surface that counts.
fn is_visible(context: &RenderContext<'_>, at: &Interaction<'_>, chosen: ChosenLight, u: [f64; 2]) -> bool {
    let sample = context.light_sampler(at.receiver()).sample_chosen(&context.lights().chosen(chosen), u);
    let in_front = sample.filter(|sample| sample.direction().dot(at.facing_normal()) > 0.0);
    let shadow_ray = in_front.and_then(|sample| sample.shadow_ray(&at.point));
    shadow_ray.is_some_and(|ray| !context.scene.accel().occluded(&ray))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::Receiver;
    use crate::path::preliminary::prepare;
    use crate::path::test_rooms::{assert_equal_means, built, radiance_sum};
    use crate::pixel_rect::PixelRect;
    use crate::{Estimator, Model, PathReuse, PinholeCamera, Scene, Settings};
    use glam::{DVec3, Vec3};
    use globillum_geom::KdTree;
    use globillum_geom::conformance::shapes::quad;
    use globillum_material::{Material, Rgb};
    use std::sync::Arc;

    const TILE: PixelRect = PixelRect { x: 0, y: 0, width: 12, height: 12 };

    /// A floor before a mirror, a lamp above its left half, and one of this radiance above its right half. A wall between
    /// them may have a hole at the floor. The camera sees the left half.
    fn scene(radiance: f64, has_hole: bool) -> Scene<KdTree> {
        let p = DVec3::new;
        let mut model = Model::default();
        let white = Material::lambert(Rgb::splat(0.7)).unwrap();
        model.add(white, quad(p(-2.0, 0.0, 1.0), p(2.0, 0.0, 1.0), p(2.0, 0.0, -1.0), p(-2.0, 0.0, -1.0)));
        let low = if has_hole { 0.6 } else { -1.0 };
        model.add(white, quad(p(0.0, low, 3.0), p(0.0, low, -3.0), p(0.0, 3.0, -3.0), p(0.0, 3.0, 3.0)));
        let mirror = quad(p(-2.0, 0.0, -1.0), p(2.0, 0.0, -1.0), p(2.0, 2.0, -1.0), p(-2.0, 2.0, -1.0));
        model.add(Material::mirror(Rgb::splat(0.9)).unwrap(), mirror);
        for (x, radiance) in [(-1.0, 1.0), (1.0, radiance)] {
            let [a, b, c, d] =
                [(-0.7, -0.7), (0.7, -0.7), (0.7, 0.7), (-0.7, 0.7)].map(|(i, j)| p(x + i, 1.0, j));
            model.add(Material::light(Rgb::splat(radiance)).unwrap(), quad(a, b, c, d));
        }
        built(model)
    }

    fn camera() -> PinholeCamera {
        PinholeCamera::look_at(DVec3::new(-1.2, 0.8, 2.6), DVec3::new(-0.8, 0.3, 0.0), DVec3::Y, 0.7).unwrap()
    }

    fn settings(seed: u64) -> Settings {
        Settings { seed, path_reuse: PathReuse::Off, ..Settings::new(12, 12, 4) }
    }

    fn found(scene: &Scene<KdTree>, settings: &Settings) -> Option<Arc<Lights>> {
        prepare(scene, &camera(), settings, None, || false)
            .continue_value()
            .expect("nothing cancels it")
            .lights_by_visibility
    }

    /// The probability of the lamp on the right for a point of the floor on the left.
    fn prob_of_right(scene: &Scene<KdTree>, lights: &Lights) -> f64 {
        let receiver = Receiver { position: DVec3::new(-0.8, 0.0, 0.2), normal: Vec3::Y };
        let prob = |triangle| {
            let point = scene.triangles().surface_point(triangle, 0.3, 0.3);
            lights.light_at(&point, scene.triangles(), receiver).expect("it emits").1.prob
        };
        prob(8) + prob(9)
    }

    #[test]
    fn a_strong_light_behind_a_wall_takes_few_samples() {
        for (radiance, least) in [(1e2, 20.0), (1e3, 25.0), (1e5, 5.0)] {
            let hidden = scene(radiance, false);
            let by_visibility = found(&hidden, &settings(0)).expect("one lamp is hidden");
            // The odds of the other lamp.
            let odds =
                [hidden.lights(), &by_visibility].map(|lights| 1.0 / prob_of_right(&hidden, lights) - 1.0);
            assert!(odds[1] > least * odds[0], "{radiance}: {odds:?}");
        }
        let hidden = scene(1e3, false);
        assert!(found(&scene(1.0, true), &settings(0)).is_none());
        let without_lights = Settings { estimator: Estimator::Bsdf, ..settings(0) };
        assert!(found(&hidden, &without_lights).is_none());
    }

    /// Neither the seed nor the number of samples changes it, so all parts of a picture have the same.
    #[test]
    fn it_follows_from_the_scene() {
        let hidden = scene(1e3, false);
        let other = Settings { seed: 5, samples: 64, pass_samples: 64, ..settings(0) };
        let probs = [settings(0), other]
            .map(|settings| Some(prob_of_right(&hidden, found(&hidden, &settings)?.as_ref())));
        assert!(probs[0].is_some() && probs[0] == probs[1], "{probs:?}");
    }

    /// As if no sample had found the lamp on the right, which lights both halves, and the left one by way of a mirror too.
    /// The same seeds, so that most other light cancels.
    #[test]
    fn the_mean_does_not_depend_on_what_samples_have_found() {
        let (scene, camera) = (scene(2.0, true), camera());
        let counts = [1000, 1000, 0, 0].map(|visible| VisibilityCount::new(1000, visible));
        let misled = scene.lights().by_visibility(&counts).map(Arc::new);
        let misled = misled.expect("one lamp is thought to be hidden");
        let [before, after] = [scene.lights(), &misled].map(|lights| prob_of_right(&scene, lights));
        assert!(after < 0.1 * before, "{before}, {after}");
        assert_equal_means(2e-3, |seed| {
            let settings = settings(seed);
            [None, Some(misled.clone())].map(|lights_by_visibility| {
                let context = RenderContext::new(&scene, &camera, &settings);
                assert!(context.large_mirrors().is_some());
                radiance_sum(&RenderContext { lights_by_visibility, ..context }, TILE)
            })
        });
    }
}
