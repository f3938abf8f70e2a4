//! Path guiding keeps the mean of every pixel, and lowers the variance where light is hard to find.
#![allow(clippy::print_stdout, reason = "figures for docs/estimators.md, with --nocapture")]

use glam::DVec3;
use globillum::geom::{Aabb, Accel, Hit, KdTree, Ray};
use globillum::integrator::{
    Ending, Estimator, Film, Guiding, IrradiancePoints, Model, Monitor, PathReuse, PinholeCamera, Render,
    Replay, Sampler, Scene, Sensor, Settings, Supersampling, render, replay_samples,
};
use globillum::material::{Emission, Material, Rgb, Sides};
use globillum_testkit::accelerators::{ACCELERATORS, RENDERED};
use globillum_testkit::pixels::{assert_same_means, largest_difference};
use globillum_testkit::shapes::{cuboid, inside_out, quad};
use globillum_testkit::{cornell, scenes};
use std::sync::atomic::{AtomicU64, Ordering};

/// Pixels along each side of a picture.
const SIDE: u32 = 16;
/// Passes of a picture whose pixels are compared.
const PASSES: u32 = 256;
fn lambert(albedo: Rgb) -> Material {
    Material::lambert(albedo).expect("an albedo")
}

fn look(eye: DVec3, target: DVec3) -> PinholeCamera {
    PinholeCamera::look_at(eye, target, DVec3::Y, 0.8).expect("they are apart")
}

fn scene(model: &Model) -> Scene<Box<dyn Accel>> {
    scenes::scene(model, RENDERED[0].1)
}

/// Two rooms with a lamp in the one and the camera in the other. A wall with a gap is between them.
fn two_rooms() -> (Model, PinholeCamera) {
    let p = DVec3::new;
    let mut model = Model::default();
    model.add(lambert(Rgb::new(0.8, 0.7, 0.6)), inside_out(cuboid(DVec3::ZERO, DVec3::ONE, 0.0)));
    model.add(lambert(Rgb::splat(0.6)), cuboid(p(-0.2, 0.0, -0.1), p(0.8, 1.0, 0.03), 0.0));
    let lamp = quad(p(-0.8, 0.98, -0.8), p(-0.4, 0.98, -0.8), p(-0.4, 0.98, -0.5), p(-0.8, 0.98, -0.5));
    model.add(Material::light(Rgb::new(20.0, 15.0, 10.0)).expect("in range"), lamp);
    (model, look(p(-0.5, 0.3, 0.9), p(-0.2, -0.6, 0.2)))
}

/// A room of which one wall emits, half of it near enough to the floor for both techniques to count.
fn bright_wall() -> (Model, PinholeCamera) {
    let p = DVec3::new;
    let mut model = Model::default();
    let walls = inside_out(cuboid(DVec3::ZERO, DVec3::ONE, 0.0));
    let emission = Emission::new(Rgb::new(1.0, 0.7, 0.4), Sides::Front).expect("finite");
    for (i, wall) in walls.chunks(2).enumerate() {
        let material = lambert(Rgb::new(0.3 + 0.1 * i as f64, 0.5, 0.8 - 0.1 * i as f64));
        model.add(if i == 0 { material.emitting(emission) } else { material }, wall.iter().copied());
    }
    (model, look(p(0.2, 0.3, 0.9), p(0.0, -0.9, -0.3)))
}

/// The box with a block that is a mirror.
fn mirror_box() -> (Model, PinholeCamera) {
    let model = cornell::with_blocks(true).expect("the box is good");
    (model, look(DVec3::new(0.0, 0.2, 3.0), DVec3::new(0.0, -0.4, 0.0)))
}

fn settings(guiding: Guiding, change: impl Fn(&mut Settings)) -> Settings {
    let mut settings = Settings::new(SIDE, SIDE, 12 * PASSES);
    (settings.guiding, settings.seed, settings.pass_samples) = (guiding, 1 + guiding as u64, 4);
    change(&mut settings);
    settings
}

fn film(scene: &Scene<Box<dyn Accel>>, sensor: &dyn Sensor, settings: &Settings) -> Film {
    render(scene, sensor, settings).expect("the scene is good").film
}

/// Asserts that each pixel has the same mean with and without a guide. `max_margin` bounds the tolerance of the picture's
/// mean, relative to it.
fn assert_same_mean(
    what: &str,
    (model, sensor): (&Model, &dyn Sensor),
    max_margin: f64,
    change: impl Fn(&mut Settings),
) {
    let scene = scene(model);
    let [without, with] =
        [Guiding::Off, Guiding::Trained].map(|guiding| film(&scene, sensor, &settings(guiding, &change)));
    assert_same_means(what, &without, &with, max_margin);
    // With equal random numbers, only a guide makes a difference.
    let [off, on] = [Guiding::Off, Guiding::Trained].map(|guiding| {
        let settings = settings(guiding, |s| {
            change(s);
            (s.seed, s.samples, s.sampler) = (9, s.pass_samples, Sampler::Independent);
        });
        film(&scene, sensor, &settings)
    });
    assert!(largest_difference(&off, &on) > 0.0, "{what}: there was no guide");
}

#[test]
fn guides_change_no_mean() {
    let ((rooms, front), (bright, floor), (mirrors, whole)) = (two_rooms(), bright_wall(), mirror_box());
    let longer = |s: &mut Settings| (s.samples, s.pass_samples) = (24 * PASSES, 16);
    assert_same_mean("two rooms", (&rooms, &front), 0.05, longer);
    assert_same_mean("two rooms, pixels alone", (&rooms, &front), 0.12, |s| s.path_reuse = PathReuse::Off);
    for estimator in [Estimator::Mis, Estimator::Bsdf, Estimator::Light] {
        let what = format!("a bright wall, {estimator:?}");
        assert_same_mean(&what, (&bright, &floor), 0.03, |s| s.estimator = estimator);
    }
    assert_same_mean("a bright wall, two bounces", (&bright, &floor), 0.02, |s| {
        (s.max_bounces, s.sampler) = (Some(2), Sampler::Independent);
    });
    assert_same_mean("a mirror", (&mirrors, &whole), 0.02, |_| {});
}

/// The first vertex of a path is then the point itself.
#[test]
fn guides_change_no_irradiance() {
    let points = [(-0.6, 0.5), (0.3, 0.7), (0.6, 0.2)].map(|(x, z)| (DVec3::new(x, -0.999, z), DVec3::Y));
    let points = IrradiancePoints::new(points).expect("unit normals");
    let change = |s: &mut Settings| (s.width, s.height, s.samples, s.pass_samples) = (1, 3, 64 * PASSES, 64);
    assert_same_mean("points in the dark room", (&two_rooms().0, &points), 0.2, change);
    assert_same_mean("points before a bright wall", (&bright_wall().0, &points), 0.03, change);
}

#[test]
fn a_guide_finds_the_gap_to_the_bright_room() {
    let (model, camera) = two_rooms();
    let scene = scene(&model);
    let [without, with] = [Guiding::Off, Guiding::Trained].map(|guiding| {
        let settings = settings(guiding, |s| (s.samples, s.pass_samples) = (512, 16));
        film(&scene, &camera, &settings).error().relative_rmse.powi(2)
    });
    println!("variance with a guide over that without: {:.2}", with / without);
    assert!(with < 0.6 * without, "{with}, {without}");
}

/// Neither threads nor accelerators, passes or crops change a bit, and a replayed sample has those of the picture.
#[test]
fn guided_pictures_have_the_same_bits_in_parts() {
    let (model, camera) = two_rooms();
    let settings = settings(Guiding::Trained, |s| (s.width, s.height, s.samples) = (21, 34, 8));
    let with = |threads, accelerator| {
        let scene = scenes::scene(&model, accelerator);
        let mut settings = settings;
        settings.threads = threads;
        film(&scene, &camera, &settings)
    };
    let whole = with(1, ACCELERATORS[0].1);
    let means = |film: &Film| -> Vec<Rgb> {
        (0..film.height()).flat_map(|y| (0..film.width()).map(move |x| film.mean(x, y))).collect()
    };
    for &(name, accelerator) in &ACCELERATORS {
        assert_eq!(means(&with(3, accelerator)), means(&whole), "{name}");
    }
    let scene = scene(&model);
    let part = |passes| Render::new(&scene, &camera, &settings).passes(passes).run().expect("it is good");
    let first = part(0..1);
    let mut merged = part(1..2);
    merged.merge(first.clone()).expect("they fit");
    assert_eq!(means(&merged.film), means(&whole));
    let resumed = Render::new(&scene, &camera, &settings).resume(first).run().expect("it fits");
    assert_eq!(means(&resumed.film), means(&whole));
    let crop = Render::new(&scene, &camera, &settings).crop(0..16, 0..16).run().expect("it is good").film;
    assert_eq!(crop.mean(9, 14), whole.mean(9, 14));
    let paths = replay_samples(&scene, &camera, &settings, (9, 14), 0..8).expect("the samples exist");
    let sum = |paths: &[Replay]| paths.iter().map(|path| path.radiance).sum::<Rgb>();
    assert_eq!((sum(&paths[..4]) + sum(&paths[4..])) / 8.0, whole.mean(9, 14));
}

/// A k-d tree that counts its rays.
#[derive(Debug)]
struct CountsRays {
    inner: KdTree,
    rays: AtomicU64,
}

impl Accel for CountsRays {
    fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.rays.fetch_add(1, Ordering::Relaxed);
        self.inner.intersect(ray)
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.rays.fetch_add(1, Ordering::Relaxed);
        self.inner.occluded(ray)
    }

    fn bounds(&self) -> Aabb {
        self.inner.bounds()
    }

    fn bytes(&self) -> usize {
        self.inner.bytes()
    }
}

/// Cancels at once.
struct CancelsAtOnce;

impl Monitor for CancelsAtOnce {
    fn cancelled(&self) -> bool {
        true
    }
}

#[test]
fn training_can_be_cancelled() {
    let (model, camera) = two_rooms();
    let settings = settings(Guiding::Trained, |s| s.supersampling = Supersampling::Off);
    let scene = Scene::build(model, |triangles| {
        Ok(CountsRays { inner: KdTree::build(triangles)?, rays: AtomicU64::new(0) })
    });
    let scene = scene.expect("the model is good");
    let picture =
        Render::new(&scene, &camera, &settings).monitor(&CancelsAtOnce).run().expect("the scene is good");
    assert_eq!((picture.ending, picture.samples), (Ending::Cancelled, 0));
    assert_eq!(scene.accel().rays.load(Ordering::Relaxed), 0, "training began");
}
