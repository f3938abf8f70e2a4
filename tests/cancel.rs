//! Cancelling a render, and invalid settings.

use globillum::geom::Triangle;
use globillum::glam::{DVec3, Vec3};
use globillum::integrator::{
    Model, Monitor, PinholeCamera, Progress, Render, RenderError, Roulette, Settings, render,
};
use globillum::material::{Material, Rgb};
use globillum_testkit::accelerators::RENDERED;
use globillum_testkit::{cornell, scenes, shapes};
use std::sync::atomic::{AtomicU64, Ordering};

/// Cancels after a given number of calls of [`Monitor::cancelled`].
struct CancelAt {
    limit: u64,
    calls: AtomicU64,
    tiles: AtomicU64,
}

impl CancelAt {
    fn call(limit: u64) -> Self {
        Self { limit, calls: AtomicU64::new(0), tiles: AtomicU64::new(0) }
    }
}

impl Monitor for CancelAt {
    fn progress(&self, _progress: Progress) {
        self.tiles.fetch_add(1, Ordering::Relaxed);
    }

    fn cancelled(&self) -> bool {
        self.calls.fetch_add(1, Ordering::Relaxed) >= self.limit
    }
}

#[test]
fn a_cancelled_render_returns_the_picture_of_its_whole_passes() {
    let scene = scenes::scene(&cornell::with_blocks(false).expect("the box is good"), RENDERED[0].1);
    let camera = cornell::camera().expect("the camera is good");
    let mut samples_seen = Vec::new();
    for limit in [0, 40, 1600] {
        let picture = Render::new(&scene, &camera, &Settings::new(40, 40, 64))
            .monitor(&CancelAt::call(limit))
            .run()
            .unwrap();
        assert!(picture.samples < 64);
        if picture.samples > 0 {
            let whole = render(&scene, &camera, &Settings::new(40, 40, picture.samples)).unwrap();
            assert_eq!(whole.film, picture.film);
        }
        samples_seen.push(picture.samples);
    }
    assert_eq!(samples_seen[0], 0);
    assert!(samples_seen[2] > 0, "{samples_seen:?}");
}

/// A path between perfect mirrors does not end by itself.
#[test]
fn cancelling_stops_within_a_tile() {
    let mut model = Model::default();
    let walls = shapes::inside_out(shapes::cuboid(DVec3::ZERO, DVec3::ONE, 0.0));
    model.add(Material::mirror(Rgb::WHITE).expect("a perfect mirror"), walls);
    let scene = scenes::scene(&model, RENDERED[0].1);
    let camera = scenes::stare(DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.3, 0.5, 1.0));
    let mut settings = Settings::new(4, 4, 1);
    settings.roulette.start = Settings::MAX_BOUNCES;
    let monitor = CancelAt::call(1000);
    assert_eq!(Render::new(&scene, &camera, &settings).monitor(&monitor).run().unwrap().samples, 0);
    assert_eq!(monitor.tiles.load(Ordering::Relaxed), 0, "no tile can have ended");
    settings.max_bounces = Some(10_000);
    let picture = render(&scene, &camera, &settings).unwrap();
    assert_eq!((picture.film.image_mean(), picture.counters.limit_ends), (Rgb::BLACK, 16));
}

#[test]
fn invalid_settings_are_refused() {
    let mut model = Model::default();
    model.add(Material::light(Rgb::WHITE).expect("a light"), [Triangle::new(Vec3::ZERO, Vec3::X, Vec3::Y)]);
    let scene = scenes::scene(&model, RENDERED[0].1);
    let camera = cornell::camera().expect("the camera is good");
    let good = Settings::new(2, 2, 1);
    type Spoil = fn(&mut Settings);
    let spoil: [(&str, Spoil); 12] = [
        ("width", |s| s.width = 0),
        ("height", |s| s.height = 0),
        ("samples", |s| s.samples = 0),
        ("width x height", |s| (s.width, s.height) = (1 << 20, 1 << 20)),
        ("pass_samples", |s| s.pass_samples = 0),
        ("threads", |s| s.threads = 1 << 20),
        ("bounces", |s| s.max_bounces = Some(u32::MAX)),
        ("bounces", |s| s.roulette.start = u32::MAX),
        ("threshold of roulette", |s| s.roulette.threshold = 0.0),
        ("threshold of roulette", |s| s.roulette.threshold = Roulette::MIN_THRESHOLD.next_down()),
        ("threshold of roulette", |s| s.roulette.threshold = 1.0 + f64::EPSILON),
        ("threshold of roulette", |s| s.roulette.threshold = f64::NAN),
    ];
    for (expected, spoil) in spoil {
        let mut settings = good;
        spoil(&mut settings);
        match render(&scene, &camera, &settings) {
            Err(RenderError::Param { name, .. }) => assert_eq!(name, expected),
            other => panic!("{expected}: {other:?}"),
        }
    }
    for threshold in [Roulette::MIN_THRESHOLD, good.roulette.threshold, 1.0] {
        let mut settings = good;
        settings.roulette.threshold = threshold;
        assert!(render(&scene, &camera, &settings).is_ok());
    }
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        let before = model.clone();
        assert!(model.set_environment(Rgb::splat(bad)).is_err());
        assert_eq!(model, before);
    }
}

/// Rows 86 to 88 of the table of bad input.
#[test]
fn cameras_without_a_view_are_refused() {
    let (eye, up) = (DVec3::new(1.0, 2.0, 3.0), DVec3::Y);
    for fov in [0.0, -1.0, std::f64::consts::PI, f64::NAN, f64::INFINITY] {
        let error =
            PinholeCamera::look_at(eye, DVec3::ZERO, up, fov).expect_err("the field of view is invalid");
        assert!(matches!(error, RenderError::Param { name: "fov_y", .. }), "{error}");
    }
    for (target, up) in [
        (eye, up),
        (DVec3::splat(f64::NAN), up),
        (DVec3::splat(f64::INFINITY), up),
        (DVec3::ZERO, eye),
        (DVec3::ZERO, DVec3::ZERO),
        (DVec3::ZERO, DVec3::splat(f64::NAN)),
    ] {
        let error = PinholeCamera::look_at(eye, target, up, 0.7).expect_err("the camera is degenerate");
        assert!(matches!(error, RenderError::Camera(_)), "{error}");
    }
}
