//! Irradiance at points of a list: closed forms, points on rounded surfaces, and bits.
#![allow(clippy::print_stdout, reason = "figures for docs/measuring.md, with --nocapture")]

use glam::{DQuat, DVec3, Vec3};
use globillum::geom::Accel;
use globillum::integrator::{
    DeltaLight, Ending, Estimator, IrradiancePoints, Model, PathReuse, Picture, PointError, Reading, Render,
    RenderError, Sampler, Scene, Settings, Stop, Stream, render,
};
use globillum::material::{Material, Rgb};
use globillum_testkit::accelerators::{ACCELERATORS, RENDERED};
use globillum_testkit::effort;
use globillum_testkit::form_factor::corner;
use globillum_testkit::scenes;
use globillum_testkit::shapes::quad;
use globillum_testkit::stats::{Estimate, Z_LIMIT};
use globillum_testkit::{cornell, furnace};
use std::f64::consts::PI;

const ESTIMATORS: [Estimator; 3] = [Estimator::Bsdf, Estimator::Light, Estimator::Mis];
const SAMPLERS: [Sampler; 2] = [Sampler::Independent, Sampler::Sobol];

fn first_structure(model: &Model) -> Scene<Box<dyn Accel>> {
    scenes::scene(model, RENDERED[0].1)
}

fn readings(scene: &Scene<Box<dyn Accel>>, points: &IrradiancePoints, settings: &Settings) -> Vec<Reading> {
    let picture = render(scene, points, settings).expect("scene and points are good");
    points.readings(&picture.film).collect()
}

/// Points at height 0 within the square of half side `half`, which look up.
fn on_floor(count: u32, half: f64) -> IrradiancePoints {
    let place = |i| {
        let numbers = Stream::new(23, 0, i);
        let [x, z] = [0, 1].map(|axis| half * (2.0 * numbers.uniform(axis) - 1.0));
        (DVec3::new(x, 0.0, z), DVec3::Y)
    };
    IrradiancePoints::new((0..count).map(place)).expect("they are within the domain")
}

/// The form factor, from a point of the floor, of a rectangle at height `h`.
fn rectangle(at: DVec3, [x0, x1]: [f64; 2], [z0, z1]: [f64; 2], h: f64) -> f64 {
    let [a, b, c, d] = [(x0, at.x), (x1, at.x), (z0, at.z), (z1, at.z)].map(|(edge, at)| (edge - at) / h);
    corner(b, d) - corner(a, d) - corner(b, c) + corner(a, c)
}

/// What the points have measured together, relative to the truth.
fn relative(readings: &[Reading], truth: impl Fn(DVec3) -> f64) -> Estimate {
    let total: f64 = readings.iter().map(|r| truth(r.position)).sum();
    let mean = readings.iter().map(|r| r.irradiance.g).sum::<f64>() / total;
    let variance: f64 = readings.iter().map(|r| r.std_err.g.powi(2)).sum();
    Estimate { mean, std_err: variance.sqrt() / total, count: readings.len() as f64 }
}

/// Prints how single points deviate from the truth.
fn print_points(readings: &[Reading], truth: impl Fn(DVec3) -> f64) {
    let off = |r: &Reading| (r.irradiance.g - truth(r.position)).abs();
    let largest = readings.iter().map(|r| off(r) / r.std_err.g).fold(0.0, f64::max);
    let within = readings.iter().filter(|r| off(r) <= r.margin_95.g).count();
    let share = 100.0 * within as f64 / readings.len() as f64;
    println!(
        "{} points: largest z {largest:.2}; {share:.2} % hold the truth in their margins",
        readings.len()
    );
}

#[test]
fn lights_above_a_floor_have_the_irradiance_of_the_closed_form() {
    for (span, height) in [([-1.0, 1.0], 1.0), ([0.0, 1.0], 1.0), ([-1.0, 1.0], 0.1)] {
        let scene = first_structure(&scenes::rectangle_over_floor(span, span, height));
        let points = on_floor(200 * effort(), 0.9);
        let truth = |at| PI * rectangle(at, span, span, height);
        for (estimator, sampler) in ESTIMATORS.into_iter().flat_map(|e| SAMPLERS.map(|s| (e, s))) {
            // What takes long is left to more effort.
            let is_first = (span, height) == ([-1.0, 1.0], 1.0);
            let is_slow = sampler == Sampler::Independent || estimator == Estimator::Bsdf && span[0] == 0.0;
            if effort() == 1 && !is_first && is_slow {
                continue;
            }
            let samples = match estimator {
                Estimator::Bsdf if span[0] == 0.0 => 100_000,
                Estimator::Bsdf => 10_240,
                Estimator::Light => 1536,
                _ => 2048,
            };
            let mut settings = points.settings((samples / effort()).max(1024));
            (settings.estimator, settings.sampler, settings.max_bounces) = (estimator, sampler, Some(1));
            let readings = readings(&scene, &points, &settings);
            let mean = relative(&readings, truth);
            let what = format!("{span:?} at {height}, {estimator:?}, {sampler:?}");
            println!("{what}: {:.6} of the truth, z {:.2}", mean.mean, mean.z(1.0));
            print_points(&readings, truth);
            mean.assert_is(1.0, &what);
        }
    }
}

/// The point counts as the first bounce, as a floor does that a camera sees: mirror and shadow are those that the
/// point sees.
#[test]
fn a_point_sees_mirrors_and_shadows() {
    let origin = IrradiancePoints::new([(DVec3::ZERO, DVec3::Y); 64]).expect("it is a point");
    // Radiance of a floor of albedo 1/2, times pi over that.
    let cases = [
        ("mirror", scenes::light_beside_mirror(), 2, 0.284_169_084, &[32_768, 4096, 4096][..]),
        ("shadow", scenes::light_half_hidden(), 1, 0.138_531_606, &[0, 10_240, 10_240]),
    ];
    for (what, model, bounces, radiance, samples) in cases {
        let scene = first_structure(&model);
        for (estimator, &samples) in ESTIMATORS.into_iter().zip(samples).filter(|(_, samples)| **samples > 0)
        {
            let mut settings = origin.settings(samples);
            (settings.estimator, settings.max_bounces) = (estimator, Some(bounces));
            let readings = readings(&scene, &origin, &settings);
            relative(&readings, |_| 2.0 * PI * radiance).assert_is(1.0, &format!("{what}, {estimator:?}"));
        }
    }
}

/// In a furnace all directions have one radiance, so that each sample is exact but for rounding: at points in the air,
/// on walls, on edges and in corners, also if they are rounded.
#[test]
fn every_sample_in_a_furnace_is_exact() {
    let scene = first_structure(&scenes::furnace(0.5, 1.0, DVec3::ZERO));
    let diagonal = DVec3::ONE.normalize();
    let points = [
        (DVec3::ZERO, DVec3::X),
        (DVec3::new(0.3, -1.0, 0.7), DVec3::Y),
        (DVec3::new(1.0, 0.1, 0.2), DVec3::NEG_X),
        (DVec3::NEG_ONE, diagonal),
        (DVec3::new(0.0, 1.0 + 1e-7, 0.0), DVec3::NEG_Y),
    ];
    let points = IrradiancePoints::new(points).expect("they are good");
    let mut settings = points.settings(64);
    (settings.estimator, settings.max_bounces) = (Estimator::Bsdf, Some(12));
    settings.roulette.start = Settings::MAX_BOUNCES;
    for reading in readings(&scene, &points, &settings) {
        let error = reading.irradiance.g / (PI * furnace::truncated_series(0.5, 11)) - 1.0;
        assert!(error.abs() < 1e-14, "{reading:?}");
    }
}

/// Under an evenly bright sky every sample of a point on an open surface is pi times its radiance. Vertices and
/// points are rounded to `f32`, each on its own, or the point lies a little below.
#[test]
fn points_on_rounded_surfaces_see_what_is_above() {
    for (turn, (size, place)) in
        (0..40).flat_map(|turn| [(1.0, 0.0), (1e-3, 1.0), (1e3, 1e3), (1e6, 1.0)].map(|sizes| (turn, sizes)))
    {
        let numbers = Stream::new(7, 0, turn);
        let axis = DVec3::from_array([0, 1, 2].map(|i| numbers.uniform(i) - 0.5)).normalize();
        let turned = DQuat::from_axis_angle(axis, PI * numbers.uniform(3));
        let middle = place * DVec3::from_array([4, 5, 6].map(|i| numbers.uniform(i) - 0.5));
        let [a, b, c, d] = [(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)]
            .map(|(x, z)| middle + turned * (DVec3::new(x, 0.0, z) * size));
        let mut model = Model::default();
        model.add(Material::lambert(Rgb::splat(0.5)).expect("an albedo"), quad(a, b, c, d));
        let scene = scenes::scene_under(Rgb::WHITE, &model, RENDERED[0].1);
        let normal = turned * DVec3::Y;
        let on_surface = |i: u32| {
            let [x, z] = [7 + 2 * i, 8 + 2 * i].map(|i| 1.9 * numbers.uniform(i) - 0.95);
            (middle + turned * (DVec3::new(x, 0.0, z) * size)).as_vec3().as_dvec3()
        };
        let reach = [a, b, c, d].into_iter().fold(DVec3::ZERO, |reach, v| reach.max(v.abs()));
        // Half of what the library allows; the rest is for the rounding of point and vertices.
        let below = normal * (normal.abs().dot(reach) / f64::from(1 << 23));
        let points = (0..8).flat_map(|i| {
            let at = on_surface(i);
            [(at, normal), (at, -normal), (at - below, normal), (at + below, -normal)]
        });
        let points = IrradiancePoints::new(points).expect("they are good");
        for reading in readings(&scene, &points, &points.settings(64)) {
            // A sample that hits the surface would be missing.
            assert!((reading.irradiance.g / PI - 1.0).abs() < 1e-14, "{size} at {place}: {reading:?}");
        }
    }
}

#[test]
fn delta_lights_have_the_irradiance_of_the_closed_form() {
    let (toward, lamp) = (Vec3::new(0.3, -1.0, 0.2), Vec3::new(0.5, 2.0, 0.1));
    let mut model = Model::default();
    let [a, b, c, d] =
        [(-9.0, 9.0), (9.0, 9.0), (9.0, -9.0), (-9.0, -9.0)].map(|(x, z)| DVec3::new(x, 0.0, z));
    model.add(Material::lambert(Rgb::splat(0.5)).expect("an albedo"), quad(a, b, c, d));
    model.add_delta_light(DeltaLight::directional(toward, Rgb::splat(3.0)).expect("a direction"));
    model.add_delta_light(DeltaLight::point(lamp, Rgb::splat(5.0)).expect("an intensity"));
    let points = on_floor(16, 3.0);
    let truth = |at: DVec3| {
        let between = lamp.as_dvec3() - at;
        3.0 * -toward.as_dvec3().normalize().y + 5.0 * between.normalize().y / between.length_squared()
    };
    for (estimator, sampler) in ESTIMATORS.into_iter().flat_map(|e| SAMPLERS.map(|s| (e, s))) {
        let mut settings = points.settings(8192);
        (settings.estimator, settings.sampler) = (estimator, sampler);
        let readings = readings(&first_structure(&model), &points, &settings);
        relative(&readings, truth).assert_is(1.0, &format!("{estimator:?}, {sampler:?}"));
    }
}

/// Without a triangle in the scene, points in the air measure the same.
#[test]
fn delta_lights_reach_points_where_there_is_nothing_else() {
    let points = IrradiancePoints::new([(DVec3::ZERO, DVec3::Y)]).expect("a unit normal");
    let sun = DeltaLight::directional(Vec3::new(3.0, -4.0, 0.0), Rgb::splat(5.0)).expect("a direction");
    let lamp = DeltaLight::point(Vec3::new(0.0, 2.0, 0.0), Rgb::splat(8.0)).expect("an intensity");
    for (lights, truth) in [(vec![sun], 4.0), (vec![lamp], 2.0), (vec![sun, lamp], 6.0)] {
        let mut model = Model::default();
        lights.into_iter().for_each(|light| model.add_delta_light(light));
        let measured = readings(&first_structure(&model), &points, &points.settings(4096));
        assert!((measured[0].irradiance.g / truth - 1.0).abs() < 1e-3, "{truth}: {measured:?}");
    }
}

#[test]
#[should_panic(expected = "a film of points has one column")]
fn the_film_of_a_picture_has_no_readings() {
    let points = on_floor(16, 1.0);
    let camera = scenes::stare(DVec3::Z, DVec3::ZERO);
    let scene = first_structure(&Model::default());
    let picture = render(&scene, &camera, &Settings::new(2, 2, 1)).expect("scene and camera are good");
    let _ = points.readings(&picture.film).count();
}

/// The floor of the box reflects its irradiance: what the camera sees is that, times albedo over pi.
#[test]
fn a_camera_sees_the_irradiance_that_is_measured() {
    let model = cornell::with_blocks(false).expect("the box is good");
    let scene = first_structure(&model);
    let ground = model.triangles().iter().flat_map(|t| t.vertices).fold(0.0, |low: f32, v| low.min(v.y));
    let at = DVec3::new(-0.5, ground.into(), 0.6);
    let points = IrradiancePoints::new([(at, DVec3::Y); 256]).expect("they are good");
    let measured = readings(&scene, &points, &points.settings(2048));
    let camera = scenes::stare(DVec3::new(-0.4, 0.2, 0.9), at);
    let settings = globillum_testkit::stats::independent_pixels(16, 16, 2048);
    let seen = render(&scene, &camera, &settings).expect("the scene is good").film;
    let index = scene.accel().intersect(&camera.ray(0.0, 0.0, 1.0)).expect("the floor").triangle;
    let globillum::material::Bsdf::Lambert(albedo) = model.material(index as usize).bsdf else {
        panic!("matte")
    };
    for component in 0..3 {
        let of = |rgb: Rgb| rgb.to_array()[component];
        let seen = Estimate::of_film(&seen, of);
        let scale = of(albedo.rgb()) / PI;
        let n = measured.len() as f64;
        let mean = scale * measured.iter().map(|r| of(r.irradiance)).sum::<f64>() / n;
        let variance = measured.iter().map(|r| (scale * of(r.std_err)).powi(2)).sum::<f64>() / (n * n);
        let std_err = (variance + seen.std_err.powi(2)).sqrt();
        let estimate = Estimate { mean, std_err, count: n };
        assert!(Z_LIMIT * std_err < 0.03 * seen.mean, "component {component}: {estimate:?} is too wide");
        assert!(estimate.z(seen.mean).abs() < Z_LIMIT, "component {component}: {estimate:?}, {seen:?}");
    }
}

/// Points of the box: on its floor, in the air, and in a corner.
fn in_the_box() -> IrradiancePoints {
    let place = |i| {
        let numbers = Stream::new(5, 0, i);
        let at = DVec3::from_array([0, 1, 2].map(|axis| 1.8 * numbers.uniform(axis) - 0.9));
        (at, [DVec3::X, DVec3::NEG_Y, DVec3::Y, DVec3::ONE.normalize()][i as usize % 4])
    };
    IrradiancePoints::new((0..300).map(place)).expect("they are good")
}

#[test]
fn bits_depend_on_no_accelerator_thread_pass_or_part() {
    let (model, points) = (cornell::with_blocks(true).expect("the box is good"), in_the_box());
    let mut settings = points.settings(12);
    (settings.pass_samples, settings.seed) = (4, 3);
    let mut first = None;
    for (name, build) in ACCELERATORS {
        let scene = scenes::scene(&model, build);
        for threads in [1, 3] {
            settings.threads = threads;
            let bytes = render(&scene, &points, &settings).expect("all is good").to_bytes();
            assert!(*first.get_or_insert_with(|| bytes.clone()) == bytes, "{name}, {threads} threads");
        }
    }
    let scene = first_structure(&model);
    assert_eq!(settings.path_reuse, PathReuse::Tiles, "it is asked for, and has no effect on points");
    let film = render(&scene, &points, &settings).expect("all is good").film;
    assert_eq!(film.path_reuse(), PathReuse::Off);
    let mut alone = settings;
    alone.path_reuse = PathReuse::Off;
    assert_eq!(Render::new(&scene, &points, &alone).key(), Render::new(&scene, &points, &settings).key());
    let render = || Render::new(&scene, &points, &settings);
    let part = |passes| render().passes(passes).run().expect("all is good").to_bytes();
    let mut merged = Picture::from_bytes(&part(1..3)).expect("its bytes are good");
    merged.merge(Picture::from_bytes(&part(0..1)).expect("its bytes are good")).expect("one picture");
    assert!(first == Some(merged.to_bytes()), "parts");
    let resumed = render().resume(Picture::from_bytes(&part(0..2)).expect("its bytes are good"));
    assert!(first == Some(resumed.run().expect("all is good").to_bytes()), "resumed");
}

/// Rows follow a curve through space, whatever the order of the list; crops and strips hold the readings of their rows.
#[test]
fn readings_do_not_depend_on_the_order_of_the_list() {
    let scene = first_structure(&scenes::light_over_floor());
    let mut list: Vec<_> = on_floor(600, 0.9).points().collect();
    let points = IrradiancePoints::new(list.iter().copied()).expect("they are good");
    let settings = points.settings(16);
    let in_order = readings(&scene, &points, &settings);
    assert!(in_order.iter().map(|r| (r.position, r.normal)).eq(list.iter().copied()), "in order");
    list.reverse();
    let reversed = IrradiancePoints::new(list).expect("they are good");
    assert!(readings(&scene, &reversed, &settings).iter().rev().eq(&in_order), "reversed");

    let render = || Render::new(&scene, &points, &settings);
    let parts =
        [render().rows(0..256), render().crop(0..1, 128..384).rows(128..256), render().crop(0..1, 384..600)];
    let parts =
        parts.map(|part| points.readings(&part.run().expect("all is good").film).collect::<Vec<Reading>>());
    assert_eq!(parts.each_ref().map(Vec::len), [256, 128, 216]);
    assert!(in_order.iter().all(|r| parts.iter().filter(|part| part.contains(r)).count() == 1), "parts");
}

/// A goal for the error ends a measurement, and margins hold the truth 19 times of 20: a share of 1,000 points may
/// deviate by 5.85 of its standard deviations.
#[test]
fn margins_hold_the_truth() {
    let scene = first_structure(&scenes::light_over_floor());
    let points = on_floor(1000, 0.9);
    let truth = |at| PI * rectangle(at, [-1.0, 1.0], [-1.0, 1.0], 1.0);
    for sampler in SAMPLERS {
        let mut settings = points.settings(1 << 20);
        (settings.sampler, settings.pass_samples) = (sampler, 8);
        let mut stop = Stop::default();
        stop.relative_rmse = Some(0.02);
        let picture = Render::new(&scene, &points, &settings).until(stop).run().expect("all is good");
        assert_eq!(picture.ending, Ending::Goals);
        let readings: Vec<Reading> = points.readings(&picture.film).collect();
        let off = |r: &Reading| r.irradiance.g - truth(r.position);
        let within = readings.iter().filter(|r| off(r).abs() <= r.margin_95.g).count() as f64;
        let deviation = (within - 950.0) / (1000.0 * 0.95 * 0.05_f64).sqrt();
        println!("{sampler:?}: {within} of 1,000, {} samples", picture.samples);
        assert!(deviation.abs() <= Z_LIMIT, "{sampler:?}: {within} of 1,000");
        let squares: f64 = readings.iter().map(|r| off(r).powi(2)).sum();
        let mean = readings.iter().map(|r| truth(r.position)).sum::<f64>() / 1000.0;
        assert!((squares / 1000.0).sqrt() < 0.025 * mean, "{sampler:?}");
    }
}

#[test]
fn points_out_of_range_are_named() {
    let (at, up) = (DVec3::ONE, DVec3::Y);
    let error =
        |points: &[(DVec3, DVec3)]| IrradiancePoints::new(points.iter().copied()).expect_err("it is bad");
    assert_eq!(error(&[]), PointError::Empty);
    for position in [DVec3::NAN, DVec3::X * f64::INFINITY, DVec3::X * 2_f64.powi(61)] {
        let found = error(&[(at, up), (position, up)]);
        assert!(matches!(found, PointError::Position { index: 1, .. }), "{found}");
    }
    for normal in [DVec3::ZERO, DVec3::Y * 2.0, DVec3::Y * 0.99, DVec3::NAN, DVec3::X * f64::INFINITY] {
        let found = error(&[(at, up), (at, up), (at, normal)]);
        assert!(matches!(found, PointError::Normal { index: 2, .. }), "{found}");
    }
    let rounded =
        IrradiancePoints::new([(at, DVec3::splat(0.577))]).expect("it is rounded to three decimals");
    assert!(rounded.points().all(|(_, normal)| (normal.length() - 1.0).abs() < 1e-15));
}

#[test]
fn settings_of_another_size_are_refused() {
    let (scene, points) = (first_structure(&scenes::light_over_floor()), on_floor(3, 1.0));
    let error = render(&scene, &points, &Settings::new(3, 1, 1)).expect_err("it has one column");
    assert_eq!(error, RenderError::SensorSize { settings: [3, 1], sensor: [1, 3] });
}
