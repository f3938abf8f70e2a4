//! Illumination in closed form, by Sobol' points: form factors, mirrors, shadows, and scenes in which every
//! sample is exact.

use crate::both_accelerators::film_by_both as film;
use glam::DVec3;
use globillum::integrator::{Estimator, LightSampling, Model, Settings, render};
use globillum::material::{Material, Rgb};
use globillum_testkit::accelerators::RENDERED;
use globillum_testkit::form_factor::corner;
use globillum_testkit::scenes::{self, stare};
use globillum_testkit::shapes::{cuboid, inside_out, quad};
use globillum_testkit::stats::{Estimate, independent_pixels};

use Estimator::{Bsdf, Light, Mis};
use LightSampling::{Area, SolidAngle};

const ALL: [Estimator; 3] = [Bsdf, Light, Mis];

/// Each estimator with its samples per pixel: BSDF sampling hits most lights rarely.
const MORE_BY_BSDF: [(Estimator, u32); 3] = [(Bsdf, 128), (Light, 32), (Mis, 32)];

/// 64 x 64 pixels of the same point, with two passes.
fn settings((estimator, samples): (Estimator, u32), bounces: u32) -> Settings {
    let mut settings = independent_pixels(64, 64, samples);
    (settings.estimator, settings.max_bounces, settings.pass_samples) =
        (estimator, Some(bounces), samples / 2);
    settings
}

/// Asserts the radiance of the floor at `target` after at most `bounces` bounces, by all of `estimators`, each
/// with its samples per pixel.
fn assert_floor(
    model: &Model,
    target: DVec3,
    bounces: u32,
    estimators: &[(Estimator, u32)],
    truth: f64,
    what: &str,
) {
    let camera = stare(target + DVec3::new(0.1, 0.5, 0.2), target);
    for &how in estimators {
        let film = film(model, &camera, &settings(how, bounces));
        Estimate::of_film(&film, |c| c.g).assert_is(truth, &format!("{what}, {how:?}"));
    }
}

#[test]
fn rectangular_lights_above_a_floor() {
    let centered = |half: f64, h: f64| 4.0 * corner(half / h, half / h);
    assert!((corner(1.0, 1.0) - 0.138_531_606).abs() < 1e-9);
    assert!((centered(0.5, 1.0) - 0.239_456_470).abs() < 1e-9);
    assert!((centered(1.0, 0.01) - 0.999_918_176).abs() < 1e-9);
    assert!((centered(1.0, 100.0) / 1.273_070e-4 - 1.0).abs() < 1e-6);
    let cases = [
        ([0.0, 1.0], 1.0, corner(1.0, 1.0), &MORE_BY_BSDF[..]),
        ([-0.5, 0.5], 1.0, centered(0.5, 1.0), &MORE_BY_BSDF),
        ([-1.0, 1.0], 0.01, centered(1.0, 0.01), &ALL.map(|estimator| (estimator, 32))),
        // BSDF sampling almost never hits so small a light.
        ([-1.0, 1.0], 100.0, centered(1.0, 100.0), &MORE_BY_BSDF[1..]),
    ];
    for (span, height, factor, estimators) in cases {
        let model = scenes::rectangle_over_floor(span, span, height);
        let camera_below = DVec3::new(0.001, 0.005, 0.002);
        for &how in estimators {
            let film = film(&model, &stare(camera_below, DVec3::ZERO), &settings(how, 1));
            let what = format!("{span:?}, height {height}, {how:?}");
            Estimate::of_film(&film, |c| c.g).assert_is(0.5 * factor, &what);
        }
    }
}

/// A light two million times as long as wide, which has parts though it is alone. From the middle, its ends are seen in nearly opposite directions.
#[test]
fn a_needle_above_a_floor() {
    let (half_length, half_width) = (1e4, 0.005);
    let model = scenes::rectangle_over_floor([-half_length, half_length], [-half_width, half_width], 1.0);
    let factor = 4.0 * corner(half_length, half_width);
    for how in [(Light, 64), (Mis, 64)] {
        let film = film(&model, &stare(DVec3::new(0.001, 0.005, 0.002), DVec3::ZERO), &settings(how, 1));
        Estimate::of_film(&film, |c| c.g).assert_is(0.5 * factor, &format!("{how:?}"));
    }
}

#[test]
fn a_light_and_its_image_in_a_mirror() {
    // Two bounces: floor, mirror, light. More bounces would add illumination by the floor itself.
    assert_floor(
        &scenes::light_beside_mirror(),
        DVec3::ZERO,
        2,
        &MORE_BY_BSDF,
        0.284_169_084,
        "a light beside a mirror",
    );
}

#[test]
fn a_half_hidden_light() {
    let estimators = ALL.map(|estimator| (estimator, 128));
    assert_floor(
        &scenes::light_half_hidden(),
        DVec3::ZERO,
        1,
        &estimators,
        0.138_531_606,
        "a half-hidden light",
    );
}

/// Near a light that stands on the floor, area sampling has unbounded variance; solid angle sampling does not.
#[test]
fn a_light_standing_on_the_floor() {
    let model = scenes::light_on_floor();
    let all = ALL.map(|estimator| (estimator, 64));
    let cases = [
        // BSDF sampling hits it too rarely.
        (1.0, 0.071_093_439, &all[1..]),
        (0.1, 0.422_544_860, &all),
        (0.01, 0.492_158_952, &all),
        (1e-3, 0.499_215_798, &all),
    ];
    for (x, factor, estimators) in cases {
        let target = DVec3::new(x, 0.0, 0.0);
        assert_floor(&model, target, 1, estimators, 0.5 * factor, &format!("{x} before the light"));
    }
    // These points are not compared with the truth, but NaN would be an error.
    for x in [0.0, 1e-12, 1e-6, 0.01] {
        for (estimator, sampling) in ALL.into_iter().flat_map(|e| [Area, SolidAngle].map(|s| (e, s))) {
            let camera = stare(DVec3::new(x + 0.1, 0.5, 0.2), DVec3::new(x, 0.0, 0.0));
            let mut settings = independent_pixels(16, 16, 16);
            (settings.estimator, settings.light_sampling) = (estimator, sampling);
            film(&model, &camera, &settings);
        }
    }
}

/// Every path scattered by a convex body leaves the scene.
#[test]
fn a_convex_body_under_a_white_sky_shows_its_albedo() {
    let camera = stare(DVec3::new(3.0, 2.5, 2.0), DVec3::new(1.0, 0.3, 0.2));
    for rho in [0.25, 1.0] {
        for (estimator, (_, build)) in ALL.into_iter().flat_map(|e| RENDERED.map(|s| (e, s))) {
            let scene = scenes::scene_under(Rgb::WHITE, &scenes::cube(rho), build);
            let mut settings = independent_pixels(16, 16, 16);
            settings.estimator = estimator;
            let film = render(&scene, &camera, &settings).expect("the scene is good").film;
            assert!(film.means().all(|mean| mean == Rgb::splat(rho)), "{rho}, {estimator:?}");
        }
    }
}

fn lambert(albedo: f64) -> Material {
    Material::lambert(Rgb::splat(albedo)).expect("an albedo")
}

#[test]
fn invisible_lights_contribute_nothing() {
    let p = DVec3::new;
    let floor = quad(p(-1.0, 0.0, 1.0), p(1.0, 0.0, 1.0), p(1.0, 0.0, -1.0), p(-1.0, 0.0, -1.0));
    let below = quad(p(-1.0, -1.0, -1.0), p(1.0, -1.0, -1.0), p(1.0, -1.0, 1.0), p(-1.0, -1.0, 1.0));
    let facing_up = quad(p(-1.0, 1.0, 1.0), p(1.0, 1.0, 1.0), p(1.0, 1.0, -1.0), p(-1.0, 1.0, -1.0));
    let in_its_plane = quad(p(2.0, 0.0, 1.0), p(3.0, 0.0, 1.0), p(3.0, 0.0, -1.0), p(2.0, 0.0, -1.0));
    for light in [below, facing_up, in_its_plane] {
        let mut model = Model::default();
        model.add(lambert(0.5), floor);
        model.add(Material::light(Rgb::WHITE).expect("a light"), light);
        for estimator in ALL {
            let mut settings = independent_pixels(32, 32, 16);
            settings.estimator = estimator;
            let film = film(&model, &stare(p(0.1, 0.5, 0.2), p(0.05, 0.0, -0.1)), &settings);
            assert!(film.means().all(|mean| mean == Rgb::BLACK), "{estimator:?}, {light:?}");
        }
    }
}

/// Samples that are exact for any random numbers, and pictures one pixel wide or high.
#[test]
fn scenes_in_which_every_sample_is_exact() {
    let emission = globillum::material::Emission::new(Rgb::WHITE, globillum::material::Sides::Front);
    let emission = emission.expect("a finite radiance");
    let camera = stare(DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.35, -0.2, 1.0));
    let walls = inside_out(cuboid(DVec3::ZERO, DVec3::ONE, 0.0));
    for (width, height) in [(1, 1), (1, 40), (40, 1), (16, 16)] {
        for estimator in ALL {
            let mut model = Model::default();
            model.add(lambert(0.0).emitting(emission), walls.clone());
            let mut settings = independent_pixels(width, height, 16);
            settings.estimator = estimator;
            assert!(film(&model, &camera, &settings).means().all(|mean| mean == Rgb::WHITE), "{estimator:?}");
        }
        let mut model = Model::default();
        model.add(lambert(1.0).emitting(emission), walls.clone());
        let mut settings = independent_pixels(width, height, 16);
        (settings.estimator, settings.max_bounces, settings.roulette.start) = (Bsdf, Some(30), 30);
        let film_of_31 = film(&model, &camera, &settings);
        assert!(film_of_31.means().all(|mean| mean == Rgb::splat(31.0)));
        assert!(film_of_31.error().relative_rmse.is_infinite() && film_of_31.observations() == 1);
        // Without a limit Russian roulette ends every path.
        settings.max_bounces = None;
        settings.roulette.start = 0;
        film(&model, &camera, &settings);
    }
}

#[test]
fn ten_thousand_bounces_between_perfect_mirrors_lose_nothing() {
    let camera = stare(DVec3::new(0.0, 0.5, 0.0), DVec3::new(1.0, 1000.8, 0.0));
    let mut settings = independent_pixels(1, 1, 1);
    settings.roulette.start = Settings::MAX_BOUNCES;
    let film = film(&scenes::mirror_corridor(1.0, 10.0), &camera, &settings);
    assert_eq!(film.mean(0, 0), Rgb::WHITE);
}

/// Russian roulette changes the variance and not the mean.
#[test]
fn roulette_does_not_change_the_mean() {
    let model = scenes::furnace(0.5, 1.0, DVec3::ZERO);
    let camera = stare(DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.35, -0.2, 1.0));
    for (start, threshold) in [(0, 1.0), (0, 0.1), (3, 1.0), (3, 0.35)] {
        let mut settings = independent_pixels(64, 64, 80);
        (settings.estimator, settings.roulette.start) = (Bsdf, start);
        settings.roulette.threshold = threshold;
        let estimate = Estimate::of_film(&film(&model, &camera, &settings), |c| c.g);
        estimate.assert_is(2.0, &format!("roulette from bounce {start} at {threshold}"));
    }
}
