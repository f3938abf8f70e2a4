//! A picture's bits depend only on scene, camera and settings.
#![allow(clippy::print_stderr, reason = "reports skipped tests")]

use glam::{DVec3, Vec3};
use globillum::geom::{Accel, Triangle};
use globillum::integrator::{
    Film, Guiding, IrradiancePoints, Model, PinholeCamera, Scene, Sensor, Settings, render,
};
use globillum_testkit::accelerators::{ACCELERATORS, RENDERED};
use globillum_testkit::{cornell, scenes, shapes};

fn settings(samples: u32) -> Settings {
    let mut settings = Settings::new(50, 40, samples);
    settings.seed = 7;
    settings
}

fn film(scene: &Scene<Box<dyn Accel>>, settings: &Settings) -> Film {
    let camera = cornell::camera().expect("the camera is good");
    render(scene, &camera, settings).expect("the scene is good").film
}

/// Asserts the same film, to the bit, in every accelerator and for several numbers of threads.
fn assert_one_picture(model: &Model, with_brute_force: bool) {
    let mut first = None;
    for (name, build) in ACCELERATORS.into_iter().skip(usize::from(!with_brute_force)) {
        let scene = scenes::scene(model, build);
        for threads in [1, 2, 3, 7] {
            let mut settings = settings(6);
            settings.threads = threads;
            let film = film(&scene, &settings);
            assert_eq!(*first.get_or_insert_with(|| film.clone()), film, "{name}, {threads} threads");
        }
    }
}

#[test]
fn every_accelerator_and_thread_count_renders_the_same_box() {
    for specular in [false, true] {
        assert_one_picture(&cornell::with_blocks(specular).expect("the box is good"), true);
    }
}

#[test]
fn every_accelerator_and_thread_count_renders_the_same_statue() {
    let statue = shapes::statue(20_000).triangles();
    assert_one_picture(&cornell::with_mesh(&statue, false).expect("the box is good"), false);
}

#[test]
fn every_accelerator_and_thread_count_renders_the_same_scanned_mesh() {
    for (_, mesh) in crate::scans::scans() {
        for specular in [false, true] {
            let model = cornell::with_mesh(&mesh, specular).expect("the box is good");
            assert_one_picture(&model, false);
        }
    }
}

#[test]
fn scaling_by_powers_of_two_changes_no_bit() {
    let mesh = shapes::statue(2000).triangles();
    let blocks = cornell::with_blocks(false).expect("the box is good");
    let statue = cornell::with_mesh(&mesh, true).expect("the box is good");
    let every = [&blocks, &statue].into_iter().flat_map(|m| ACCELERATORS.map(|accel| (m, accel)));
    for (model, (name, build)) in every {
        let films = [0, 40, -40].map(|exponent| {
            let scale = 2.0_f32.powi(exponent);
            let scene = scenes::scene(&scaled(model, scale), build);
            let eye = DVec3::new(0.0, 0.0, 3.9) * f64::from(scale);
            let camera = PinholeCamera::look_at(eye, DVec3::ZERO, DVec3::Y, 0.7).expect("the camera is good");
            let samples = if name == "brute force" { 2 } else { 8 };
            render(&scene, &camera, &settings(samples)).expect("the scene is good").film
        });
        assert_eq!(films[0], films[1], "2^40, {name}");
        assert_eq!(films[0], films[2], "2^-40, {name}");
    }
}

/// The films of a guided picture and of points of irradiance.
#[test]
fn scaling_by_powers_of_two_changes_no_bit_of_guides_and_irradiance() {
    let model = cornell::with_blocks(true).expect("the box is good");
    let films = [0, 40, -40].map(|exponent| {
        let scale = 2.0_f32.powi(exponent);
        let scene = scenes::scene(&scaled(&model, scale), RENDERED[0].1);
        let [eye, point] =
            [DVec3::new(0.0, 0.0, 3.9), DVec3::new(0.1, -0.9, 0.4)].map(|p| p * f64::from(scale));
        let camera = PinholeCamera::look_at(eye, DVec3::ZERO, DVec3::Y, 0.7).expect("the camera is good");
        let points = IrradiancePoints::new([(point, DVec3::Y)]).expect("a point");
        let sensors: [(&dyn Sensor, Settings); 2] = [(&camera, settings(8)), (&points, points.settings(64))];
        sensors.map(|(sensor, mut settings)| {
            settings.guiding = Guiding::Trained;
            render(&scene, sensor, &settings).expect("the scene is good").film
        })
    });
    assert!(films[0] == films[1] && films[0] == films[2]);
}

fn scaled(model: &Model, scale: f32) -> Model {
    let mut scaled = Model::default();
    for (index, triangle) in model.triangles().iter().enumerate() {
        let vertices = triangle.vertices.map(|v: Vec3| v * scale);
        scaled.add(*model.material(index), [Triangle { vertices }]);
    }
    scaled
}
