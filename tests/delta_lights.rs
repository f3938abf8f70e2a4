//! Point, spot and directional lights: radiance in closed form, alone and beside lights that are triangles.

use glam::{DVec3, Vec3};
use globillum::geom::{Accel, Triangle};
use globillum::integrator::{
    DeltaLight, Estimator, Film, LightSampling, MirrorSampling, Model, PathReuse, PinholeCamera, Sampler,
    Scene, Settings, Stream, render, replay_samples,
};
use globillum::material::{Emission, Material, Rgb, Sides};
use globillum_testkit::accelerators::{ACCELERATORS, RENDERED};
use globillum_testkit::cornell;
use globillum_testkit::scenes::LIGHT_OVER_FLOOR;
use globillum_testkit::scenes::{self, stare};
use globillum_testkit::shapes::{cuboid, inside_out, quad};
use globillum_testkit::stats::{Estimate, PRECISION, Z_LIMIT, independent_pixels};
use std::f64::consts::PI;

const ESTIMATORS: [Estimator; 3] = [Estimator::Bsdf, Estimator::Light, Estimator::Mis];

/// The ways to choose random numbers and to use paths.
const WAYS: [(Sampler, PathReuse); 2] =
    [(Sampler::Sobol, PathReuse::Tiles), (Sampler::Independent, PathReuse::Off)];

const INTENSITY: Rgb = Rgb::new(3.0, 2.0, 1.0);

fn lambert(albedo: f64) -> Material {
    Material::lambert(Rgb::splat(albedo)).unwrap()
}

/// A floor of albedo 0.5 at height 0, `half` its half side.
fn floor(half: f64) -> Model {
    let p = DVec3::new;
    let (lo, hi) = (-half, half);
    let mut model = Model::default();
    model.add(lambert(0.5), quad(p(lo, 0.0, hi), p(hi, 0.0, hi), p(hi, 0.0, lo), p(lo, 0.0, lo)));
    model
}

fn with(mut model: Model, lights: &[DeltaLight]) -> Model {
    lights.iter().for_each(|&light| model.add_delta_light(light));
    model
}

fn point(position: Vec3) -> DeltaLight {
    DeltaLight::point(position, INTENSITY).unwrap()
}

fn spot(position: Vec3, direction: Vec3) -> DeltaLight {
    DeltaLight::spot(position, direction, INTENSITY, 0.3, 0.6).unwrap()
}

fn directional(direction: Vec3) -> DeltaLight {
    DeltaLight::directional(direction, INTENSITY).unwrap()
}

fn film(model: &Model, camera: &PinholeCamera, settings: &Settings) -> Film {
    render(&scenes::scene(model, RENDERED[0].1), camera, settings).unwrap().film
}

#[test]
fn a_light_tells_what_it_is_and_takes_another_value() {
    let (position, direction) = (Vec3::new(1.0, 2.0, 3.0), Vec3::new(0.0, -4.0, 3.0));
    let unit = DVec3::new(0.0, -0.8, 0.6);
    let brighter = 2.0 * INTENSITY;
    for (light, at, along) in [
        (point(position), Some(position), None),
        (spot(position, direction), Some(position), Some(unit)),
        (directional(direction), None, Some(unit)),
    ] {
        assert_eq!((light.position(), light.value()), (at, INTENSITY));
        assert_eq!(light.direction().is_some(), along.is_some());
        assert!(light.direction().zip(along).is_none_or(|(a, b)| (a - b).length() < 1e-15), "{light:?}");
        let changed = light.with_value(brighter).unwrap();
        assert_eq!(
            (changed.position(), changed.direction(), changed.value()),
            (at, light.direction(), brighter)
        );
        assert_eq!(changed.with_value(INTENSITY), Ok(light));
        assert!(light.with_value(Rgb::splat(-1.0)).is_err());
    }
}

/// [`ESTIMATORS`] in [`WAYS`].
fn each_setting(side: u32, samples: u32) -> impl Iterator<Item = Settings> {
    ESTIMATORS.into_iter().flat_map(move |estimator| {
        WAYS.map(|(sampler, path_reuse)| {
            let mut settings = Settings::new(side, side, samples);
            (settings.estimator, settings.sampler, settings.path_reuse) = (estimator, sampler, path_reuse);
            settings
        })
    })
}

fn seeded(settings: &Settings, seed: u64) -> Settings {
    let mut seeded = *settings;
    seeded.seed = seed;
    seeded
}

/// A settings' part that tests go through, for messages.
fn named(settings: &Settings) -> String {
    format!("{:?}, {:?}, {:?}", settings.estimator, settings.sampler, settings.path_reuse)
}

fn assert_components(film: &Film, truth: Rgb, what: &str) {
    let components: [fn(Rgb) -> f64; 3] = [|c| c.r, |c| c.g, |c| c.b];
    for component in components {
        Estimate::of_film(film, component).assert_is(component(truth), what);
    }
}

/// Each of the lights alone, and the irradiance that it brings to the floor at the origin.
fn lights_and_irradiances() -> Vec<(&'static str, DeltaLight, Rgb)> {
    let (position, distance_sq) = (Vec3::new(0.5, 1.0, -1.0), 2.25);
    // Toward the origin, and past it by an angle between the two of the cone.
    let cos = 1.0 / 1.5;
    let aside = DVec3::new(-0.5, -1.0, 1.0) / 1.5;
    let turned = |angle: f64| {
        let across = aside.cross(DVec3::X).normalize();
        (aside * angle.cos() + across * angle.sin()).as_vec3()
    };
    let falloff = (f64::cos(0.45) - f64::cos(0.6)) / (f64::cos(0.3) - f64::cos(0.6));
    let from_point = INTENSITY * (cos / distance_sq);
    vec![
        ("a point light", point(position), from_point),
        ("on the axis of a spot light", spot(position, turned(0.0)), from_point),
        ("within the inner cone", spot(position, turned(0.29)), from_point),
        ("between the cones", spot(position, turned(0.45)), from_point * (falloff * falloff)),
        ("beyond the outer cone", spot(position, turned(0.61)), Rgb::BLACK),
        ("a directional light", directional(Vec3::new(4.0, -3.0, 12.0)), INTENSITY * (3.0 / 13.0)),
        ("a directional light from below", directional(Vec3::new(4.0, 3.0, 12.0)), Rgb::BLACK),
        ("a directional light along the floor", directional(Vec3::X), Rgb::BLACK),
    ]
}

/// Every sample is exact but for the rounding of cones, positions and the view.
#[test]
fn one_light_over_a_floor() {
    let camera = stare(DVec3::new(0.1, 0.5, 0.2), DVec3::ZERO);
    for (what, light, irradiance) in lights_and_irradiances() {
        let model = with(floor(1e6), &[light]);
        for settings in each_setting(8, 2) {
            let truth = irradiance * (0.5 / PI);
            for mean in film(&model, &camera, &settings).means() {
                for (mean, truth) in mean.to_array().into_iter().zip(truth.to_array()) {
                    let error = (mean - truth).abs();
                    assert!(error <= 1e-6 * truth, "{what}, {}: {mean} is not {truth}", named(&settings));
                }
            }
        }
    }
}

/// A lamp of which a room is lit is found beside one of `1e12` or `1e24` times its power in another room, and a dim sun
/// beside one that shines from below the floor.
#[test]
fn a_dim_light_is_found_beside_a_strong_one_that_is_hidden() {
    let (near, below) = (Vec3::new(0.5, 1.0, -1.0), DVec3::new(0.0, -10.0, 0.0));
    let from_point = INTENSITY.g / 1.5 / 2.25;
    let sun = |irradiance: f64, y: f32| DeltaLight::directional(Vec3::Y * y, Rgb::splat(irradiance)).unwrap();
    let strong = |intensity| DeltaLight::point(below.as_vec3(), Rgb::splat(intensity)).unwrap();
    let cases = [
        ("1e12", from_point, [point(near), strong(1e12)]),
        ("1e24", from_point, [point(near), strong(1e24)]),
        ("suns", 3.0, [sun(3.0, -1.0), sun(1e12, 1.0)]),
    ];
    for (what, irradiance, lights) in cases {
        let mut model = with(floor(1e6), &lights);
        model.add(lambert(0.5), cuboid(below, DVec3::ONE, 0.0));
        let mut settings = independent_pixels(32, 32, 256);
        settings.max_bounces = Some(1);
        let film = film(&model, &stare(DVec3::new(0.1, 0.5, 0.2), DVec3::ZERO), &settings);
        let estimate = Estimate::of_film(&film, |c| c.g);
        let truth = irradiance * 0.5 / PI;
        assert!(
            (estimate.mean - truth).abs() < Z_LIMIT * estimate.std_err,
            "{what}: {estimate:?}, not {truth}"
        );
        assert!(estimate.std_err < 0.05 * truth, "{what}: {estimate:?}");
    }
}

/// A thousand lights with powers over twelve orders of magnitude.
#[test]
fn many_lights_of_unlike_power() {
    let mut model = floor(1.0);
    let mut irradiance = 0.0;
    for i in 0..1000 {
        let numbers = Stream::new(7, 0, i);
        let angle = 2.0 * PI * numbers.uniform(0);
        let position = DVec3::new(angle.cos(), 1.0 + 0.5 * numbers.uniform(1), angle.sin()).as_vec3();
        let power = 10.0_f64.powi(i as i32 % 13 - 6);
        model.add_delta_light(DeltaLight::point(position, Rgb::splat(power)).unwrap());
        let position = position.as_dvec3();
        irradiance += power * position.y / position.length().powi(3);
    }
    let truth = 0.5 / PI * irradiance;
    let camera = stare(DVec3::new(0.1, 0.5, 0.2), DVec3::ZERO);
    for estimator in ESTIMATORS {
        let mut settings = independent_pixels(64, 64, 64);
        settings.estimator = estimator;
        let film = film(&model, &camera, &settings);
        Estimate::of_film(&film, |c| c.g).assert_is(truth, &format!("{estimator:?}"));
        let pixels = (0..64).flat_map(|y| (0..64).map(move |x| (x, y)));
        let holds = |&(x, y): &(u32, u32)| (film.mean(x, y).g - truth).abs() <= film.margin_95(x, y).g;
        let share = pixels.filter(holds).count() as f64 / 4096.0;
        assert!((share - 0.95).abs() < 0.04, "{estimator:?}: {share} of the intervals hold the truth");
    }
}

/// Lights beside the square light, of about its power and effect. None is between the floor's middle and another.
fn beside_the_square() -> [DeltaLight; 3] {
    let dim = INTENSITY * 0.5;
    [
        DeltaLight::point(Vec3::new(0.5, 0.5, -0.5), dim),
        DeltaLight::spot(Vec3::new(-0.75, 0.5, 0.0), Vec3::new(0.75, -0.5, 0.0), INTENSITY, 1.2, 1.5),
        DeltaLight::directional(Vec3::new(2.0, -1.0, 0.0), dim),
    ]
    .map(Result::unwrap)
}

/// Each of the two techniques of multiple importance sampling must take the choice among all lights into account.
#[test]
fn a_square_light_and_delta_lights_over_a_floor() {
    let [by_point, by_spot] = [0.75, 0.8125].map(|distance_sq| 0.5 / f64::powf(distance_sq, 1.5));
    let by_sun = f64::sqrt(0.2);
    let of_deltas = INTENSITY * (0.5 / PI * (0.5 * by_point + by_spot + 0.5 * by_sun));
    let truth = Rgb::splat(LIGHT_OVER_FLOOR) + of_deltas;
    let model = with(scenes::light_over_floor(), &beside_the_square());
    let camera = stare(DVec3::new(0.1, 0.5, 0.2), DVec3::ZERO);
    for light_sampling in [LightSampling::Area, LightSampling::SolidAngle] {
        for mut settings in each_setting(64, 48) {
            // BSDF sampling chooses no points on lights.
            if (settings.estimator, light_sampling) == (Estimator::Bsdf, LightSampling::SolidAngle) {
                continue;
            }
            settings.samples = match (settings.sampler, settings.estimator) {
                (Sampler::Independent, Estimator::Light) => 144,
                (Sampler::Independent, _) => 176,
                _ => settings.samples,
            };
            (settings.light_sampling, settings.path_reuse) = (light_sampling, PathReuse::Off);
            let what = format!("{light_sampling:?}, {}", named(&settings));
            assert_components(&film(&model, &camera, &settings), truth, &what);
        }
    }
}

/// What a closed box of albedo `rho` absorbs is what its lights emit, after any number of bounces: over its
/// walls, the irradiance of power `P` has the mean `P / (area (1 - rho))`. A camera in the middle of a cube sees
/// each wall whole, and equal parts of it in equal parts of the picture.
#[test]
fn what_lights_emit_in_a_closed_box_is_absorbed() {
    let (rho, area) = (0.5, 24.0);
    let lights =
        [point(Vec3::new(0.3, -0.2, 0.4)), spot(Vec3::new(-0.5, 0.1, 0.2), Vec3::new(1.0, -0.5, 0.3))];
    let of_spot = 2.0 * PI * ((1.0 - f64::cos(0.3)) + (f64::cos(0.3) - f64::cos(0.6)) / 3.0);
    let of_lights = INTENSITY * (4.0 * PI + of_spot);
    for radiance in [0.0, 0.4] {
        let emission = Emission::new(Rgb::splat(radiance), Sides::Front).unwrap();
        let mut model = with(Model::default(), &lights);
        model.add(lambert(rho).emitting(emission), inside_out(cuboid(DVec3::ZERO, DVec3::ONE, 0.0)));
        let power = of_lights + Rgb::splat(PI * radiance * area);
        let truth = Rgb::splat(radiance) + power * (rho / PI / (area * (1.0 - rho)));
        for mut settings in each_setting(32, 64) {
            settings.pass_samples = 16;
            if settings.sampler == Sampler::Sobol {
                settings.samples = 32;
            }
            // Choosing points on lights has infinite variance where walls that shine meet.
            if radiance > 0.0 && settings.estimator == Estimator::Light {
                continue;
            }
            assert_mean_of_walls(&model, &settings, truth.g, &format!("{radiance}, {}", named(&settings)));
        }
    }
}

/// Asserts that the walls of a cube around the origin have the mean radiance `truth`.
fn assert_mean_of_walls(model: &Model, settings: &Settings, truth: f64, what: &str) {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|axis| [axis, -axis]);
    let walls = axes.zip(0..).map(|(axis, seed)| {
        let camera =
            PinholeCamera::look_at(DVec3::ZERO, axis, axis.any_orthogonal_vector(), PI / 2.0).unwrap();
        Estimate::of_film(&film(model, &camera, &seeded(settings, seed)), |c| c.g)
    });
    let walls: Vec<Estimate> = walls.collect();
    let mean = walls.iter().map(|wall| wall.mean).sum::<f64>() / 6.0;
    let std_err = walls.iter().map(|wall| wall.std_err.powi(2)).sum::<f64>().sqrt() / 6.0;
    let count = walls.iter().map(|wall| wall.count).sum();
    Estimate { mean, std_err, count }.assert_is(truth, what);
}

/// The model without the emission of its triangles.
fn darkened(model: &Model) -> Model {
    let mut dark = Model::default();
    for (index, &triangle) in model.triangles().iter().enumerate() {
        dark.add(Material { emission: Emission::NONE, ..*model.material(index) }, [triangle]);
    }
    dark
}

/// With a mirror, by every technique: also those that find the light of triangles by way of mirrors, of which
/// delta lights have no part.
#[test]
fn a_scene_of_both_kinds_is_the_sum_of_two() {
    let of_areas = scenes::light_beside_mirror();
    let of_deltas = with(darkened(&of_areas), &beside_the_square());
    let of_both = with(of_areas.clone(), &beside_the_square());
    let camera = PinholeCamera::look_at(DVec3::new(0.2, 0.9, 0.1), DVec3::ZERO, DVec3::Z, 1.0).unwrap();
    for (estimator, mirror_sampling) in [
        (Estimator::Bsdf, MirrorSampling::Off),
        (Estimator::Light, MirrorSampling::Images),
        (Estimator::Mis, MirrorSampling::Images),
    ] {
        let [areas, deltas, both] = [(&of_areas, 1), (&of_deltas, 2), (&of_both, 3)].map(|(model, seed)| {
            let mut settings = independent_pixels(64, 64, 32);
            (settings.estimator, settings.mirror_sampling, settings.seed) =
                (estimator, mirror_sampling, seed);
            Estimate::of_film(&film(model, &camera, &settings), |c| c.g)
        });
        let what = format!("{estimator:?}, {mirror_sampling:?}: {areas:?}, {deltas:?}, {both:?}");
        let apart = (areas.mean + deltas.mean - both.mean).abs();
        let margin = Z_LIMIT * areas.std_err.hypot(deltas.std_err).hypot(both.std_err);
        assert!(apart <= margin && margin <= PRECISION * both.mean, "{what}");
    }
}

/// What the mirror reflects of a delta light onto the floor is left out, by all settings alike. What the camera
/// sees in the mirror is there.
#[test]
fn mirrors_make_no_caustics_of_delta_lights() {
    let p = DVec3::new;
    let light = point(Vec3::new(0.0, 1.0, 0.0));
    let mut model = with(floor(10.0), &[light]);
    let mirror = Material::mirror(Rgb::splat(0.8)).unwrap();
    model.add(mirror, quad(p(1.0, 0.0, 3.0), p(1.0, 3.0, 3.0), p(1.0, 3.0, -3.0), p(1.0, 0.0, -3.0)));
    let direct = INTENSITY * (0.5 / PI);
    let eye = p(-0.5, 0.5, 0.0);
    for (target, truth) in [(DVec3::ZERO, direct), (p(2.0, 0.0, 0.0), direct * 0.8)] {
        for mut settings in each_setting(8, 8) {
            for mirror_sampling in [MirrorSampling::Off, MirrorSampling::Images] {
                settings.mirror_sampling = mirror_sampling;
                let film = film(&model, &stare(eye, target), &settings);
                for mean in film.means() {
                    assert!((mean.g / truth.g - 1.0).abs() < 1e-6, "{mean}, {}", named(&settings));
                }
            }
        }
    }
    // Straight at the light.
    let film = film(&model, &stare(p(-0.5, 1.0, 0.0), p(0.0, 1.0, 0.0)), &Settings::new(8, 8, 1));
    assert!(film.means().all(Rgb::is_black));
}

/// A shadow ends exactly where the edge is in line with the light.
#[test]
fn a_shadow_has_the_edge_of_what_casts_it() {
    let p = DVec3::new;
    for (what, light) in [
        ("point", point(Vec3::new(0.0, 2.0, 0.0))),
        ("spot", spot(Vec3::new(0.0, 2.0, 0.0), Vec3::NEG_Y)),
        ("directional", directional(Vec3::NEG_Y)),
    ] {
        let mut model = with(floor(4.0), &[light]);
        let sheet = quad(p(-1.0, 1.0, 1.0), p(0.0, 1.0, 1.0), p(0.0, 1.0, -1.0), p(-1.0, 1.0, -1.0));
        model.add(lambert(0.0), sheet);
        for (x, is_lit) in [(-1e-6, false), (1e-6, true)] {
            let camera = stare(p(0.3, 0.5, 0.1), p(x, 0.0, 0.2));
            let film = film(&model, &camera, &Settings::new(8, 8, 4));
            assert!(film.means().all(|mean| mean.is_black() != is_lit), "{what}, {x}");
        }
    }
}

/// No shadow ray slips between the triangles of a sheet, also not those that pass exactly through their edges
/// and vertices. The sheet is 1 above the floor, the light 1 above the sheet or infinitely far away.
#[test]
fn a_sheet_of_triangles_lets_nothing_through() {
    let p = DVec3::new;
    let mut sheet = Model::default();
    for (i, k) in (-8..8).flat_map(|i| (-8..8).map(move |k| (i, k))) {
        let [x0, x1, z0, z1] = [i, i + 1, k, k + 1].map(|n| f64::from(n) / 8.0);
        sheet.add(lambert(0.5), quad(p(x0, 1.0, z1), p(x1, 1.0, z1), p(x1, 1.0, z0), p(x0, 1.0, z0)));
    }
    for light in [
        point(Vec3::new(0.0, 2.0, 0.0)),
        spot(Vec3::new(0.0, 2.0, 0.0), Vec3::NEG_Y),
        directional(Vec3::NEG_Y),
    ] {
        let mut model = with(floor(1.0), &[light]);
        model.append(&sheet);
        for (name, build) in ACCELERATORS {
            let scene = scenes::scene(&model, build);
            // Each 1/16 of the floor is below an edge, a vertex or the middle of a square.
            for (i, k) in (1..32).flat_map(|i| (1..32 - i).map(move |k| (i, k))) {
                for triangle in [0, 1] {
                    let [u, v] = [i, k].map(|n| f64::from(n) / 32.0);
                    let at = scene.triangles().surface_point(triangle, u, v);
                    let sampler = scene.light_sampler(LightSampling::Area, at.position, at.normal);
                    let Some(sample) = sampler.sample(0.5, [0.5; 2]) else { continue };
                    let shadow_ray = sample.shadow_ray(&at).unwrap();
                    assert!(scene.accel().occluded(&shadow_ray), "{name}, {light:?}, {}", at.position);
                }
            }
        }
        let camera = PinholeCamera::look_at(p(0.1, 0.9, 0.2), DVec3::ZERO, DVec3::X, 1.0).unwrap();
        let film = film(&model, &camera, &Settings::new(32, 32, 16));
        assert!(film.means().all(Rgb::is_black), "{light:?}");
    }
}

/// Rounding decides what such lights illuminate, but every sample is a number.
#[test]
fn a_light_on_a_surface_does_no_harm() {
    let camera = PinholeCamera::look_at(DVec3::new(0.3, 2.0, 0.2), DVec3::ZERO, DVec3::X, 1.2).unwrap();
    for position in [Vec3::ZERO, Vec3::new(1.0, 0.0, 1.0), Vec3::new(0.25, 0.0, 0.125), Vec3::splat(1e-30)] {
        for light in [point(position), spot(position, Vec3::X), spot(position, Vec3::Y)] {
            let model = with(floor(1.0), &[light]);
            for settings in each_setting(16, 16) {
                assert!(film(&model, &camera, &settings).means().all(Rgb::is_finite), "{light:?}");
            }
        }
    }
}

/// The box with a mirror, and lights of all kinds.
fn the_box() -> Model {
    let lights = [
        point(Vec3::new(0.5, 0.3, 0.5)),
        spot(Vec3::new(-0.6, 0.7, 0.5), Vec3::new(0.3, -1.0, -0.4)),
        directional(Vec3::new(0.3, -0.5, -1.0)),
    ];
    with(cornell::with_blocks(true).unwrap(), &lights)
}

#[test]
fn every_accelerator_and_thread_count_makes_the_same_picture() {
    let camera = cornell::camera().unwrap();
    let mut first = None;
    for (name, build) in ACCELERATORS {
        let scene = scenes::scene(&the_box(), build);
        for threads in [1, 3] {
            let mut settings = Settings::new(40, 30, 4);
            settings.threads = threads;
            let film = render(&scene, &camera, &settings).unwrap().film;
            assert_eq!(*first.get_or_insert_with(|| film.clone()), film, "{name}, {threads} threads");
        }
    }
}

/// Of size and of radiance: in each mean, in each error. The intensity of a point light of the same effect grows
/// with the square of the size.
#[test]
fn powers_of_two_change_no_bit() {
    for settings in each_setting(16, 40) {
        let film = |size: i32, radiance: i32| {
            let (size, radiance) = (2.0_f64.powi(size), 2.0_f64.powi(radiance));
            let place = |x: f32, y: f32, z: f32| Vec3::new(x, y, z) * size as f32;
            let intensity = INTENSITY * (radiance * size * size);
            let mut model = Model::default();
            let usual = scenes::light_beside_mirror();
            for (index, triangle) in usual.triangles().iter().enumerate() {
                let mut material = *usual.material(index);
                let emitted = material.emission.toward(1.0) * radiance;
                material.emission = Emission::new(emitted, Sides::Front).unwrap();
                model.add(material, [Triangle { vertices: triangle.vertices.map(|v| v * size as f32) }]);
            }
            let axis = Vec3::new(1.0, -1.0, 0.0);
            let lights = [
                DeltaLight::point(place(0.5, 0.5, -0.5), intensity),
                DeltaLight::spot(place(-0.5, 0.8, 0.1), axis, intensity, 0.3, 0.7),
                DeltaLight::directional(axis, INTENSITY * radiance),
            ];
            let model = with(model, &lights.map(Result::unwrap));
            let (eye, target) = (DVec3::new(-0.7, 0.9, 1.5), DVec3::new(0.5, 0.1, 0.0));
            let camera = PinholeCamera::look_at(size * eye, size * target, DVec3::Y, 1.2).unwrap();
            let film = film(&model, &camera, &settings);
            let means: Vec<Rgb> = film.means().map(|mean| mean / radiance).collect();
            let variances: Vec<Rgb> =
                film.variances_of_mean().map(|variance| variance / radiance / radiance).collect();
            (means, variances, film.error())
        };
        let usual = film(0, 0);
        assert!(usual.0.iter().any(|mean| !mean.is_black()));
        for (size, radiance) in [(0, -160), (0, 160), (-40, -60), (40, 60)] {
            let what = format!("2^{size} in size, 2^{radiance} in radiance, {}", named(&settings));
            assert_eq!(film(size, radiance), usual, "{what}");
        }
    }
}

/// By BSDF sampling alone as well.
#[test]
fn replays_add_up_to_the_picture() {
    let (scene, camera): (Scene<Box<dyn Accel>>, _) = (
        scenes::scene(&with(darkened(&the_box()), the_box().delta_lights()), RENDERED[0].1),
        cornell::camera().unwrap(),
    );
    for settings in each_setting(20, 16) {
        let film = render(&scene, &camera, &settings).unwrap().film;
        for (x, y) in [(4, 15), (10, 3), (13, 12)] {
            let paths = replay_samples(&scene, &camera, &settings, (x, y), 0..16).unwrap();
            let sum = paths.iter().map(|path| path.radiance).sum::<Rgb>();
            assert_eq!(film.mean(x, y), sum / 16.0, "{}, {x}, {y}", named(&settings));
            assert!(paths.iter().all(|path| path.alone == direct(path)), "{}", named(&settings));
            assert!(paths.iter().any(|path| !path.alone.is_black()), "{}, {x}, {y}", named(&settings));
        }
    }
}

/// What next events at the vertices of a path add to it.
fn direct(path: &globillum::integrator::Replay) -> Rgb {
    path.vertices.iter().map(|vertex| vertex.direct).sum()
}
