//! Scenes of known radiance, rendered by every applicable estimator in every accelerator.

use crate::both_accelerators::film_by_both;
use approx::assert_relative_eq;
use glam::DVec3;
use globillum::geom::Accel;
use globillum::integrator::{
    Estimator, Film, LightSampling, Model, PinholeCamera, Sampler, Scene, Settings, render,
};
use globillum::material::{Material, Rgb};
use globillum_testkit::accelerators::RENDERED;
use globillum_testkit::scenes::LIGHT_OVER_FLOOR;
use globillum_testkit::scenes::{self, stare};
use globillum_testkit::shapes::{cuboid, inside_out, quad};
use globillum_testkit::stats::{Estimate, Z_LIMIT, independent_pixels};

const ALL: [Estimator; 3] = [Estimator::Bsdf, Estimator::Light, Estimator::Mis];

/// 64 x 64 pixels, all of the same point, by independent samples.
fn settings(samples: u32) -> Settings {
    let mut settings = independent_pixels(64, 64, samples);
    settings.sampler = Sampler::Independent;
    settings
}

/// The estimate of the green component.
fn estimate(model: &Model, camera: &PinholeCamera, settings: &Settings) -> Estimate {
    Estimate::of_film(&film_by_both(model, camera, settings), |c| c.g)
}

fn film(scene: &Scene<Box<dyn Accel>>, camera: &PinholeCamera, settings: &Settings) -> Film {
    render(scene, camera, settings).expect("the scene is good").film
}

fn into_the_furnace() -> PinholeCamera {
    stare(DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.35, -0.2, 1.0))
}

#[test]
fn a_furnace_after_any_number_of_bounces() {
    let cases = [
        (0.5, [(Some(1), 12), (Some(5), 12), (None, 20)]),
        (0.8, [(Some(2), 12), (Some(8), 12), (None, 44)]),
    ];
    for (rho, limits) in cases {
        let model = scenes::furnace(rho, 1.0, DVec3::ZERO);
        for (limit, samples) in limits {
            let truth = match limit {
                Some(n) => (1.0 - f64::powi(rho, n as i32 + 1)) / (1.0 - rho),
                None => 1.0 / (1.0 - rho),
            };
            // Light sampling has infinite variance where emitting walls meet.
            for estimator in [Estimator::Bsdf, Estimator::Mis] {
                let mut s = settings(samples);
                (s.max_bounces, s.estimator) = (limit, estimator);
                let what = format!("rho {rho}, limit {limit:?}, {estimator:?}");
                estimate(&model, &into_the_furnace(), &s).assert_is(truth, &what);
            }
        }
    }
}

#[test]
fn roulette_from_the_first_bounce_has_the_known_variance() {
    for (rho, threshold) in [0.5, 0.9].into_iter().flat_map(|rho| [(rho, 1.0), (rho, 0.35)]) {
        let (variance, kurtosis) = furnace_moments(rho, threshold);
        // Over N samples the variance has a relative standard deviation of sqrt((kurtosis - 1) / N).
        let bound = 0.0118;
        let samples = (kurtosis - 1.0) * (Z_LIMIT / bound).powi(2) / (64.0 * 64.0);
        let mut s = settings(samples.ceil() as u32);
        (s.estimator, s.roulette.start, s.roulette.threshold) = (Estimator::Bsdf, 0, threshold);
        let estimate = estimate(&scenes::furnace(rho, 1.0, DVec3::ZERO), &into_the_furnace(), &s);
        estimate.assert_is(1.0 / (1.0 - rho), &format!("rho {rho}, threshold {threshold}"));
        let ratio = estimate.sample_variance() / variance;
        assert!((ratio - 1.0).abs() < bound, "rho {rho}, threshold {threshold}: {estimate:?}");
    }
}

/// Variance and kurtosis of one sample of a furnace of unit emission, with Russian roulette from the first
/// bounce on. The number of bounces determines the radiance of a path. At a threshold of 1 the variance is
/// `rho / (1 - rho)^2`.
fn furnace_moments(rho: f64, threshold: f64) -> (f64, f64) {
    let (mut throughput, mut radiance, mut reach_prob, mut moments) = (1.0, 1.0, 1.0, [0.0; 2]);
    let mean = 1.0 / (1.0 - rho);
    for _ in 0..1000 {
        let survive_prob = f64::min(throughput * rho / threshold, 0.999);
        let end_prob = reach_prob * (1.0 - survive_prob);
        let deviation: f64 = radiance - mean;
        moments = [moments[0] + end_prob * deviation.powi(2), moments[1] + end_prob * deviation.powi(4)];
        throughput *= rho / survive_prob;
        radiance += throughput;
        reach_prob *= survive_prob;
    }
    (moments[0], moments[1] / moments[0].powi(2))
}

/// A white room into which the sky shines through a hole in the ceiling, a 1/49 of its surface: the radiance is that of the
/// sky everywhere. Paths find the hole after 48 bounces on average; if roulette ended one in twenty at each, the variance
/// would be infinite.
#[test]
fn a_white_room_with_a_hole() {
    let walls = cuboid(DVec3::ZERO, DVec3::ONE, 0.0).into_iter();
    let open = walls.filter(|wall| wall.vertices.iter().any(|vertex| vertex.y < 1.0));
    let at = |x: f64, z: f64| DVec3::new(x, 1.0, z);
    let strip = |[x0, x1]: [f64; 2], [z0, z1]: [f64; 2]| quad(at(x0, z0), at(x1, z0), at(x1, z1), at(x0, z1));
    let (below, hole, above) = ([-1.0, -0.35], [-0.35, 0.35], [0.35, 1.0]);
    let frame =
        [strip(below, [-1.0, 1.0]), strip(above, [-1.0, 1.0]), strip(hole, below), strip(hole, above)];
    let mut model = Model::default();
    model.add(Material::lambert(Rgb::WHITE).expect("an albedo"), open.chain(frame.into_iter().flatten()));
    let scene = scenes::scene_under(Rgb::WHITE, &model, RENDERED[0].1);
    let film = film(&scene, &into_the_furnace(), &settings(24));
    Estimate::of_film(&film, |c| c.g).assert_is(1.0, "the white room");
}

/// Roulette ends one path in a thousand at each bounce from the third on: after 1001 bounces on average, with a standard
/// deviation of 999.
#[test]
fn paths_between_perfect_mirrors_end() {
    let mut model = Model::default();
    let mirror = Material::mirror(Rgb::WHITE).expect("a perfect mirror");
    model.add(mirror, inside_out(cuboid(DVec3::ZERO, DVec3::ONE, 0.0)));
    let scene = scenes::scene(&model, RENDERED[0].1);
    let mut s = settings(2);
    s.max_bounces = Some(20_000);
    let counters = render(&scene, &into_the_furnace(), &s).expect("the scene is good").counters;
    let paths = counters.camera_rays as f64;
    let bounces = counters.bounce_rays as f64 / paths;
    assert!((bounces - 1001.0).abs() < Z_LIMIT * 999.0 / paths.sqrt(), "{bounces} bounces, {counters:?}");
}

#[test]
fn a_square_light_above_a_floor() {
    let camera = stare(DVec3::new(0.1, 0.5, 0.2), DVec3::ZERO);
    for estimator in ALL {
        let mut s = settings(if estimator == Estimator::Bsdf { 320 } else { 64 });
        s.estimator = estimator;
        let estimate = estimate(&scenes::light_over_floor(), &camera, &s);
        estimate.assert_is(LIGHT_OVER_FLOOR, &format!("{estimator:?}"));
    }
}

/// The light is near enough for solid angle sampling, the default.
#[test]
fn a_square_light_sampled_by_area() {
    let camera = stare(DVec3::new(0.1, 0.5, 0.2), DVec3::ZERO);
    let scene = scenes::scene(&scenes::light_over_floor(), RENDERED[0].1);
    for estimator in [Estimator::Light, Estimator::Mis] {
        let mut s = settings(128);
        (s.estimator, s.light_sampling) = (estimator, LightSampling::Area);
        let film = film(&scene, &camera, &s);
        Estimate::of_film(&film, |c| c.g).assert_is(LIGHT_OVER_FLOOR, &format!("{estimator:?}"));
    }
}

/// A light of 1e-12 sr, and one less far away, which are nearly points.
#[test]
fn a_small_light_far_away() {
    for (side, height) in [(1.0, 100.0), (1e-3, 1e3)] {
        let model = scenes::distant_light(side, height);
        let eye = DVec3::new(0.1 * height, -0.5 * height, 0.2 * height);
        let camera = stare(eye, DVec3::new(0.0, -height, 0.0));
        // Half of the irradiance over pi; the light's extent is a correction of second order.
        let solid_angle = (side / height) * (side / height);
        let truth = 0.5 / std::f64::consts::PI * solid_angle * (1.0 - solid_angle / 3.0);
        for estimator in [Estimator::Light, Estimator::Mis] {
            let mut s = settings(1);
            s.estimator = estimator;
            let estimate = estimate(&model, &camera, &s);
            let error = (estimate.mean / truth - 1.0).abs();
            // The contribution of BSDF sampling is too small to occur in this number of samples.
            assert!(error < 1e-4, "{side}, {height}, {estimator:?}: {estimate:?} is not {truth}");
        }
    }
}

#[test]
fn a_kaleidoscope_of_mirrors() {
    let model = scenes::kaleidoscope(0.5, 0.8);
    // `Light` chooses one of four mirrors for a light as large as a wall.
    let targets = [
        (DVec3::new(0.3, 1.0, 0.6), 1.0 / 0.6, [6, 13, 10]),
        (DVec3::new(0.3, 0.0, 0.6), 0.5 / 0.6, [20, 60, 40]),
    ];
    for (target, truth, samples) in targets {
        for (estimator, samples) in ALL.into_iter().zip(samples) {
            let mut s = settings(samples);
            // Earlier Russian roulette would end many paths between the mirrors and raise the variance.
            (s.estimator, s.roulette.start) = (estimator, 24);
            let camera = stare(DVec3::new(0.4, 0.45, 0.4), target);
            estimate(&model, &camera, &s).assert_is(truth, &format!("{estimator:?}"));
        }
    }
}

#[test]
fn ten_bounces_in_a_corridor_of_mirrors() {
    let camera = stare(DVec3::new(0.0, 0.5, 0.0), DVec3::new(1.0, 1.53, 0.0));
    let model = scenes::mirror_corridor(0.9, 10.0);
    let mut s = independent_pixels(2, 2, 1);
    s.roulette.start = Settings::MAX_BOUNCES;
    for (_, build) in RENDERED {
        for estimator in ALL {
            s.estimator = estimator;
            for pixel in film(&scenes::scene(&model, build), &camera, &s).means() {
                assert_relative_eq!(pixel.r, 0.348_678_440_1, epsilon = 1e-12);
            }
        }
    }
}

#[test]
fn bsdf_sampling_makes_every_furnace_sample_exact() {
    let model = scenes::furnace(0.5, 1.0, DVec3::ZERO);
    for bounces in [0, 1, 5, 30] {
        let mut s = settings(4);
        (s.estimator, s.max_bounces, s.roulette.start) =
            (Estimator::Bsdf, Some(bounces), Settings::MAX_BOUNCES);
        for (name, build) in RENDERED {
            let film = film(&scenes::scene(&model, build), &into_the_furnace(), &s);
            let truth = Rgb::splat(2.0 - 0.5_f64.powi(bounces as i32));
            for (x, y) in (0..64).flat_map(|y| (0..64).map(move |x| (x, y))) {
                assert_eq!(film.mean(x, y), truth, "{bounces} bounces in the {name}");
                assert_eq!(film.variance_of_mean(x, y), Rgb::BLACK);
            }
        }
    }
}
