//! Several light samples at the first diffuse vertex: their number changes the variance and no mean.

use glam::DVec3;
use globillum::geom::Triangle;
use globillum::integrator::{
    DeltaLight, Estimator, Film, Model, PathReuse, PinholeCamera, Sampler, Settings, render,
};
use globillum::material::{Material, Rgb};
use globillum_testkit::accelerators::ACCELERATORS;
use globillum_testkit::polygon::form_factor;
use globillum_testkit::scenes::{self, stare};
use globillum_testkit::shapes::{icosphere, quad};
use globillum_testkit::stats::{Estimate, independent_pixels};

use Estimator::{Light, Mis};

const ALBEDO: f64 = 0.5;

/// The point of the floor in the picture.
const TARGET: DVec3 = DVec3::new(0.1, 0.0, -0.2);

/// A rectangle at height `y` that faces down.
fn level(y: f64, [x0, x1]: [f64; 2], [z0, z1]: [f64; 2]) -> [Triangle; 2] {
    let p = |x: f64, z: f64| DVec3::new(x, y, z);
    quad(p(x0, z0), p(x1, z0), p(x1, z1), p(x0, z1))
}

fn floor() -> [Triangle; 2] {
    let p = |x: f64, z: f64| DVec3::new(x, 0.0, z);
    quad(p(-2.0, 2.0), p(2.0, 2.0), p(2.0, -2.0), p(-2.0, -2.0))
}

/// Nine squares of unlike sizes and heights: eighteen lights, so that they are chosen in a tree.
fn squares() -> Vec<Triangle> {
    let square = |i: u32| {
        let (x, z) = (f64::from(i % 3) - 1.0, f64::from(i / 3) - 1.0);
        let side = 0.1 + 0.06 * f64::from(i);
        level(0.8 + 0.1 * f64::from(i % 4), [x, x + side], [z, z + side])
    };
    (0..9).flat_map(square).collect()
}

/// Strips close to the target, of which none hides another: six lights that a tree chooses in parts.
fn strips() -> Vec<Triangle> {
    let along_x = level(0.2, [-0.7, 1.3], [-0.3, -0.28]);
    let along_z = level(0.4, [0.3, 0.34], [0.0, 2.0]);
    let short = level(0.3, [-0.3, 0.2], [0.1, 0.11]);
    [along_x, along_z, short].concat()
}

fn lambert(albedo: f64) -> Material {
    Material::lambert(Rgb::splat(albedo)).expect("an albedo")
}

/// The floor under these lights.
fn under(lights: &[Triangle]) -> Model {
    let mut model = Model::default();
    model.add(lambert(ALBEDO), floor());
    model.add(Material::light(Rgb::WHITE).expect("a light"), lights.iter().copied());
    model
}

/// The same under the squares, with a point light, a sheet that hides some of the lights, and a ball beside it that
/// scatters or reflects.
fn crowded(ball: Material) -> Model {
    let mut model = under(&squares());
    model.add_delta_light(
        DeltaLight::point(DVec3::new(0.5, 0.7, 0.4).as_vec3(), Rgb::splat(0.1)).expect("a light"),
    );
    model.add(lambert(0.8), level(0.6, [-1.0, 0.0], [-1.0, 1.0]));
    model.add(ball, icosphere(2).placed(0.25, TARGET + DVec3::new(0.5, 0.3, 0.1)).triangles());
    model
}

fn camera() -> PinholeCamera {
    stare(TARGET + DVec3::new(0.02, 0.04, 0.01), TARGET)
}

fn film(model: &Model, settings: &Settings) -> Film {
    render(&scenes::scene(model, ACCELERATORS[3].1), &camera(), settings).expect("the scene is good").film
}

fn green(film: &Film) -> Estimate {
    Estimate::of_film(film, |c| c.g)
}

#[test]
fn any_number_of_samples_has_the_radiance_of_the_form_factors() {
    assert_radiance_of_form_factors(&squares(), &[1, 2, 8, 16]);
    assert_radiance_of_form_factors(&strips(), &[4]);
}

fn assert_radiance_of_form_factors(lights: &[Triangle], light_samples: &[u32]) {
    let (model, truth) = (under(lights), ALBEDO * form_factor(TARGET, DVec3::Y, lights));
    for sampler in [Sampler::Sobol, Sampler::Independent] {
        for estimator in [Light, Mis] {
            for &light_samples in light_samples {
                let mut settings = independent_pixels(32, 32, 64);
                (settings.sampler, settings.estimator) = (sampler, estimator);
                (settings.light_samples, settings.max_bounces) = (light_samples, Some(1));
                let what = format!("{sampler:?}, {estimator:?}, {light_samples}");
                // Independent samples by `Mis` take more for this precision.
                settings.samples *= if sampler == Sampler::Independent { 8 } else { 1 };
                green(&film(&model, &settings)).assert_is(truth, &what);
            }
        }
    }
}

/// By way of diffuse surfaces and curved mirrors, with path reuse, limits on bounces, and tiles that are cut.
#[test]
fn the_number_of_samples_changes_no_mean() {
    let mirror = Material::mirror(Rgb::splat(0.9)).expect("a reflectance");
    for (what, ball) in [("a diffuse ball", lambert(0.7)), ("a mirror ball", mirror)] {
        let model = crowded(ball);
        for (sampler, path_reuse, max_bounces, estimator) in [
            (Sampler::Sobol, PathReuse::Tiles, None, Mis),
            (Sampler::Sobol, PathReuse::Tiles, Some(2), Light),
            (Sampler::Sobol, PathReuse::Off, Some(3), Mis),
            (Sampler::Independent, PathReuse::Tiles, Some(2), Mis),
        ] {
            let estimate = |seed, light_samples| {
                let mut settings = Settings::new(52, 37, 160);
                (settings.sampler, settings.path_reuse) = (sampler, path_reuse);
                (settings.max_bounces, settings.estimator) = (max_bounces, estimator);
                (settings.seed, settings.light_samples) = (seed, light_samples);
                green(&film(&model, &settings))
            };
            let (one, several) = (estimate(0, 1), estimate(1, 4));
            let what = format!("{what}, {sampler:?}, {path_reuse:?}, {max_bounces:?}, {estimator:?}");
            one.assert_agrees(&several, 0.015, &what);
        }
    }
}

/// Four independent samples of lights have a quarter of the variance of one. Estimated from half a million samples, the
/// ratio is within 3 %: five standard deviations, as long as the kurtosis of a sample is below ten.
#[test]
fn four_independent_samples_have_a_quarter_of_the_variance() {
    let variance = |light_samples| {
        let mut settings = independent_pixels(64, 64, 128);
        (settings.sampler, settings.estimator) = (Sampler::Independent, Light);
        (settings.light_samples, settings.max_bounces) = (light_samples, Some(1));
        green(&film(&under(&squares()), &settings)).sample_variance()
    };
    let ratio = variance(1) / variance(4);
    assert!((ratio / 4.0 - 1.0).abs() < 0.03, "{ratio}");
}

/// Where lights are few and no mirror is curved, there is one sample, and the setting changes no bit.
#[test]
fn few_lights_have_one_sample() {
    let mut model = Model::default();
    model.add(lambert(ALBEDO), floor());
    model.add(Material::light(Rgb::WHITE).expect("a light"), level(1.0, [-1.0, 1.0], [-1.0, 1.0]));
    let means = |light_samples| {
        let mut settings = Settings::new(17, 5, 16);
        settings.light_samples = light_samples;
        let film = film(&model, &settings);
        (0..5).flat_map(|y| (0..17).map(move |x| (x, y))).map(|(x, y)| film.mean(x, y)).collect::<Vec<_>>()
    };
    assert_eq!(means(1), means(16));
}
