//! Scenes in radiative equilibrium. Every surface emits the complement of what it reflects, and the
//! environment has the same radiance. The radiance is then the same at every point and in every direction,
//! for any geometry. This tests geometry, materials, estimators and samplers together, without a closed form
//! for each scene.
//!
//! There are two kinds of stages. With BSDF sampling and without Russian roulette each sample is exact up to
//! rounding: the radiance still missing from a path is always its throughput times that radiance. All others
//! are exact on average; the limit is 5.85 standard errors, which must be at most 1 % of the truth.
#![allow(clippy::print_stdout, reason = "figures of each stage, with --nocapture")]

use glam::DVec3;
use globillum::geom::Triangle;
use globillum::integrator::{
    Estimator, Film, LightSampling, MirrorSampling, Model, PathReuse, PinholeCamera, PixelFilter, Sampler,
    Settings, Supersampling, render,
};
use globillum::material::{Emission, Material, Rgb, Sides};
use globillum_testkit::accelerators::ACCELERATORS;
use globillum_testkit::scenes;
use globillum_testkit::shapes::{cuboid, icosphere, inside_out, quad, statue, torus};
use globillum_testkit::stats::{Estimate, Z_LIMIT};

/// The largest allowed margin of a mean, relative to the truth.
const PRECISION: f64 = 0.01;

/// The radiance of all stages, different for each component.
const RADIANCE: Rgb = Rgb::new(2.5, 1.0, 0.375);

/// `material`, of reflectance `reflectance`, with the emission that makes its radiance [`RADIANCE`].
fn balanced(material: Material, reflectance: Rgb, sides: Sides) -> Material {
    let emitted = reflectance.map(|x| 1.0 - x) * RADIANCE;
    material.emitting(Emission::new(emitted, sides).expect("a finite radiance"))
}

fn diffuse(albedo: [f64; 3], sides: Sides) -> Material {
    let albedo = Rgb::from(albedo);
    balanced(Material::lambert(albedo).expect("an albedo"), albedo, sides)
}

fn mirror(reflectance: f64, sides: Sides) -> Material {
    let reflectance = Rgb::splat(reflectance);
    balanced(Material::mirror(reflectance).expect("a reflectance"), reflectance, sides)
}

fn look(eye: [f64; 3], target: [f64; 3]) -> PinholeCamera {
    PinholeCamera::look_at(eye.into(), target.into(), DVec3::new(0.1, 1.0, 0.05), 1.3)
        .expect("they are apart")
}

/// The six walls of a cube of half side 1, seen from within, each of two triangles.
fn walls() -> Vec<Triangle> {
    inside_out(cuboid(DVec3::ZERO, DVec3::ONE, 0.0))
}

/// A closed room that emits inward only. A path that leaves it or hits a wall from behind has too little
/// radiance.
fn room() -> (Model, PinholeCamera) {
    let albedos = [[0.7, 0.2, 0.1], [0.3, 0.6, 0.5], [0.5; 3], [0.0, 0.9, 0.4], [0.8, 0.7, 0.6], [0.4; 3]];
    let mut model = Model::default();
    for (wall, albedo) in walls().chunks(2).zip(albedos) {
        model.add(diffuse(albedo, Sides::Front), wall.iter().copied());
    }
    (model, look([0.6, -0.2, 0.8], [-0.2, 0.1, -0.4]))
}

/// A room with closed bodies, which emit outward only and occlude each other.
fn crowd() -> (Model, PinholeCamera) {
    let (mut model, camera) = room();
    let ball = icosphere(2).placed(0.3, DVec3::new(-0.5, 0.4, -0.3)).triangles();
    let ring = torus(16, 8).placed(0.3, DVec3::new(0.2, -0.3, -0.5)).triangles();
    model.add(diffuse([0.9, 0.5, 0.2], Sides::Front), cuboid(DVec3::splat(-0.4), DVec3::splat(0.25), 0.4));
    model.add(diffuse([0.2, 0.3, 0.8], Sides::Front), ball);
    model.add(diffuse([0.6; 3], Sides::Front), ring);
    (model, camera)
}

/// Two-sided sheets that intersect each other, surrounded by the environment only.
fn sheets() -> (Model, PinholeCamera) {
    let p = DVec3::new;
    let mut model = Model::default();
    let sheet = |albedo| diffuse(albedo, Sides::Both);
    model.add(
        sheet([0.9, 0.2, 0.6]),
        quad(p(-0.6, -0.6, 0.1), p(0.5, -0.5, -0.2), p(0.6, 0.6, 0.0), p(-0.5, 0.4, -0.1)),
    );
    model.add(
        sheet([0.5, 0.8, 0.7]),
        quad(p(0.05, -0.7, 0.4), p(-0.1, -0.7, -0.4), p(0.0, 0.7, -0.5), p(0.1, 0.6, 0.5)),
    );
    model.add(
        sheet([1.0, 0.6, 0.3]),
        quad(p(-0.8, -0.2, 0.7), p(0.8, -0.3, 0.7), p(0.7, 0.0, -0.7), p(-0.8, -0.1, -0.6)),
    );
    (model, look([0.7, 0.5, 1.2], [0.0, -0.1, 0.0]))
}

/// A room with a perfect mirror and one of reflectance 0.9 as walls, and a block of mirrors.
fn mirrors() -> (Model, PinholeCamera) {
    let (_, camera) = room();
    let mut model = Model::default();
    for (i, wall) in walls().chunks(2).enumerate() {
        let material = match i {
            0 => mirror(1.0, Sides::Front),
            3 => mirror(0.9, Sides::Front),
            _ => diffuse([0.3, 0.5, 0.7], Sides::Front),
        };
        model.add(material, wall.iter().copied());
    }
    let block = cuboid(DVec3::new(-0.2, -0.5, -0.3), DVec3::new(0.2, 0.4, 0.3), 0.3);
    model.add(mirror(0.8, Sides::Front), block);
    model.add(
        diffuse([0.6, 0.2, 0.9], Sides::Front),
        cuboid(DVec3::new(0.5, 0.4, 0.0), DVec3::splat(0.2), 0.8),
    );
    (model, camera)
}

/// A room with a mirror ball and a mirror ring.
fn curved_mirrors() -> (Model, PinholeCamera) {
    let (mut model, camera) = room();
    let ball = icosphere(2).placed(0.4, DVec3::new(-0.4, 0.3, -0.3)).triangles();
    let ring = torus(16, 8).placed(0.3, DVec3::new(0.3, -0.4, -0.3)).triangles();
    model.add(mirror(0.95, Sides::Front), ball);
    model.add(mirror(0.7, Sides::Front), ring);
    (model, camera)
}

/// A statue on a floor, in the open.
fn statue_in_the_open() -> (Model, PinholeCamera) {
    let mut model = Model::default();
    let p = DVec3::new;
    let floor = quad(p(-2.0, -1.0, 2.0), p(2.0, -1.0, 2.0), p(2.0, -1.0, -2.0), p(-2.0, -1.0, -2.0));
    model.add(diffuse([0.5, 0.7, 0.9], Sides::Both), floor);
    model.add(diffuse([0.8, 0.6, 0.3], Sides::Front), statue(4000).triangles());
    (model, look([1.5, 0.8, 2.2], [0.0, -0.2, 0.0]))
}

/// A white floor, which does not emit, under black sheets, which do not reflect, and a mirror. No reflecting
/// surface touches a light, so the variance of `Light` is finite.
fn white_floor() -> (Model, PinholeCamera) {
    let (mut model, p) = (Model::default(), DVec3::new);
    let floor = quad(p(-1.0, 0.0, 1.0), p(1.0, 0.0, 1.0), p(1.0, 0.0, -1.0), p(-1.0, 0.0, -1.0));
    model.add(diffuse([1.0; 3], Sides::Both), floor);
    let black = diffuse([0.0; 3], Sides::Both);
    model.add(black, quad(p(-0.9, 0.8, -0.9), p(0.2, 0.8, -0.9), p(0.2, 0.9, 0.5), p(-0.9, 0.7, 0.5)));
    model.add(black, quad(p(0.4, 0.6, -0.2), p(0.8, 0.6, -0.2), p(0.8, 0.6, 0.1), p(0.4, 0.7, 0.1)));
    model.add(black, quad(p(1.4, 0.5, -0.4), p(1.4, 0.5, 0.4), p(1.4, 1.5, 0.4), p(1.4, 1.5, -0.4)));
    let upright = quad(p(-1.2, 0.4, -0.8), p(-1.3, 1.8, -0.8), p(-1.3, 1.8, 0.8), p(-1.2, 0.4, 0.8));
    model.add(mirror(0.8, Sides::Both), upright);
    (model, look([0.3, 1.1, 2.4], [0.0, 0.3, 0.0]))
}

/// A room whose walls are fans of slivers.
fn slivers() -> (Model, PinholeCamera) {
    let (_, camera) = room();
    let mut model = Model::default();
    for (i, [a, b, c]) in walls().iter().map(|wall| wall.vertices).enumerate() {
        let at = |k: u16| b.as_dvec3().lerp(c.as_dvec3(), f64::from(k) / 97.0).as_vec3();
        let albedo = 0.2 + 0.05 * i as f64;
        model.add(
            diffuse([albedo, 0.5, 0.9 - albedo], Sides::Front),
            (0..97).map(|k| Triangle::new(a, at(k), at(k + 1))),
        );
    }
    (model, camera)
}

/// [`crowd`], scaled by `size` and centered at `center`.
fn crowd_at(size: f64, center: DVec3) -> (Model, PinholeCamera) {
    let (crowd, _) = crowd();
    let mut model = Model::default();
    for (index, triangle) in crowd.triangles().iter().enumerate() {
        let vertices = triangle.vertices.map(|v| (size * v.as_dvec3() + center).as_vec3());
        model.add(*crowd.material(index), [Triangle { vertices }]);
    }
    let [eye, target] = [DVec3::new(0.6, -0.2, 0.8), DVec3::new(-0.2, 0.1, -0.4)].map(|v| size * v + center);
    (model, PinholeCamera::look_at(eye, target, DVec3::Y, 1.3).expect("they are apart"))
}

/// The reflectance of all surfaces of [`grey`].
const GREY: f64 = 0.6;

/// A room of diffuse surfaces and mirrors of one reflectance. With a limit of `n` bounces the radiance is too
/// low by the fraction `GREY^(n + 1)`.
fn grey() -> (Model, PinholeCamera) {
    let (_, camera) = room();
    let mut model = Model::default();
    model.add(diffuse([GREY; 3], Sides::Front), walls());
    let block = cuboid(DVec3::new(-0.3, -0.5, -0.2), DVec3::new(0.2, 0.4, 0.3), 0.3);
    model.add(mirror(GREY, Sides::Front), block);
    model.add(
        diffuse([GREY; 3], Sides::Front),
        icosphere(1).placed(0.3, DVec3::new(0.4, 0.2, -0.3)).triangles(),
    );
    (model, camera)
}

/// A scene in equilibrium with its settings.
struct Stage {
    what: &'static str,
    scene: fn() -> (Model, PinholeCamera),
    /// Changes [`Settings::new`].
    change: fn(&mut Settings),
    /// Whether every sample is exact.
    is_exact: bool,
}

const fn stage(
    what: &'static str,
    scene: fn() -> (Model, PinholeCamera),
    change: fn(&mut Settings),
) -> Stage {
    Stage { what, scene, change, is_exact: false }
}

/// A stage with BSDF sampling and without Russian roulette.
const fn exact(
    what: &'static str,
    scene: fn() -> (Model, PinholeCamera),
    change: fn(&mut Settings),
) -> Stage {
    Stage { what, scene, change, is_exact: true }
}

fn size(s: &mut Settings, width: u32, height: u32, samples: u32) {
    (s.width, s.height, s.samples) = (width, height, samples);
}

const STAGES: [Stage; 28] = [
    stage("a room, BSDF sampling, roulette from the first bounce", room, |s| {
        size(s, 33, 31, 100);
        (s.estimator, s.sampler, s.roulette.start) = (Estimator::Bsdf, Sampler::Independent, 0);
    }),
    stage("a room, defaults, the last pass incomplete", room, |s| size(s, 17, 33, 102)),
    stage("a room, area sampling of lights", room, |s| {
        size(s, 50, 3, 100);
        (s.light_sampling, s.path_reuse) = (LightSampling::Area, PathReuse::Off);
    }),
    stage("a room, a single pixel", room, |s| size(s, 1, 1, 1 << 15)),
    stage("a crowd, roulette from the first bounce", crowd, |s| {
        size(s, 31, 37, 70);
        (s.roulette.start, s.roulette.threshold) = (0, 1.0);
        s.path_reuse = PathReuse::Off;
    }),
    stage("a crowd, early roulette, path reuse", crowd, |s| {
        size(s, 30, 33, 176);
        (s.roulette.start, s.roulette.threshold) = (1, 1.0);
    }),
    stage("a crowd, BSDF sampling", crowd, |s| {
        size(s, 32, 32, 80);
        s.estimator = Estimator::Bsdf;
    }),
    stage("a crowd, tent filter, independent samples", crowd, |s| {
        size(s, 19, 53, 30);
        (s.filter, s.sampler, s.path_reuse) = (PixelFilter::Tent, Sampler::Independent, PathReuse::Off);
    }),
    stage("a crowd, passes of one sample", crowd, |s| {
        size(s, 23, 29, 240);
        s.pass_samples = 1;
    }),
    exact("sheets, BSDF sampling", sheets, |s| size(s, 97, 51, 1)),
    stage("sheets, defaults", sheets, |s| size(s, 33, 31, 20)),
    stage("sheets, area sampling of lights", sheets, |s| {
        size(s, 33, 31, 20);
        (s.light_sampling, s.path_reuse) = (LightSampling::Area, PathReuse::Off);
    }),
    stage("mirrors, BSDF sampling", mirrors, |s| {
        size(s, 31, 29, 160);
        s.estimator = Estimator::Bsdf;
    }),
    stage("mirrors, defaults", mirrors, |s| size(s, 31, 29, 192)),
    stage("mirrors, no sampling through mirrors", mirrors, |s| {
        size(s, 31, 29, 40);
        (s.mirror_sampling, s.path_reuse) = (MirrorSampling::Off, PathReuse::Off);
    }),
    stage("mirrors, roulette from the first bounce", mirrors, |s| {
        size(s, 31, 29, 50);
        (s.roulette.start, s.path_reuse) = (0, PathReuse::Off);
    }),
    stage("a grey room, two bounces", grey, |s| {
        size(s, 31, 29, 40);
        s.max_bounces = Some(2);
    }),
    stage("a grey room, five bounces, early roulette", grey, |s| {
        size(s, 29, 31, 48);
        (s.max_bounces, s.roulette.start) = (Some(5), 1);
    }),
    exact("a grey room, five bounces, BSDF sampling", grey, |s| {
        size(s, 71, 43, 1);
        s.max_bounces = Some(5);
    }),
    stage("curved mirrors", curved_mirrors, |s| size(s, 37, 23, 128)),
    exact("a statue, BSDF sampling", statue_in_the_open, |s| size(s, 63, 65, 1)),
    stage("a statue, defaults", statue_in_the_open, |s| size(s, 31, 33, 48)),
    stage("a white floor, light sampling", white_floor, |s| {
        size(s, 33, 31, 28);
        s.estimator = Estimator::Light;
    }),
    stage("a white floor, light sampling by area", white_floor, |s| {
        size(s, 31, 35, 24);
        (s.estimator, s.light_sampling) = (Estimator::Light, LightSampling::Area);
        (s.sampler, s.path_reuse) = (Sampler::Independent, PathReuse::Off);
    }),
    stage("a white floor, defaults", white_floor, |s| size(s, 5, 201, 20)),
    stage("slivers", slivers, |s| size(s, 29, 31, 36)),
    stage("a tiny crowd", || crowd_at(1e-12, DVec3::ZERO), |s| size(s, 31, 33, 80)),
    stage("a crowd far away", || crowd_at(1.0, DVec3::new(9000.0, -4000.0, 7000.0)), |s| size(s, 31, 33, 80)),
];

impl Stage {
    fn settings(&self) -> Settings {
        let mut settings = Settings::new(1, 1, 1);
        if self.is_exact {
            // Every path has the same radiance, but not its parts.
            settings.supersampling = Supersampling::Off;
            (settings.estimator, settings.path_reuse) = (Estimator::Bsdf, PathReuse::Off);
            settings.roulette.start = Settings::MAX_BOUNCES;
        }
        (self.change)(&mut settings);
        settings
    }

    /// The stage's picture, in the accelerator that `number` selects.
    fn film(&self, settings: &Settings, number: usize) -> Film {
        let (model, camera) = (self.scene)();
        let (_, build) = ACCELERATORS[1 + number % (ACCELERATORS.len() - 1)];
        let scene = scenes::scene_under(RADIANCE, &model, build);
        render(&scene, &camera, settings).expect("the scene is good").film
    }

    /// A description of the failure, if the stage fails.
    fn fault(&self, number: usize) -> Option<String> {
        let settings = self.settings();
        let film = self.film(&settings, number);
        let lacking = settings.max_bounces.map_or(0.0, |max| GREY.powi(max as i32 + 1));
        let truth = (RADIANCE * (1.0 - lacking)).to_array();
        if self.is_exact {
            let is_off = |mean: &Rgb| {
                mean.to_array().into_iter().zip(truth).any(|(mean, truth)| (mean / truth - 1.0).abs() > 1e-13)
            };
            let off = film.means().filter(is_off).count();
            println!("{}: exact", self.what);
            return (off > 0).then(|| format!("{}: {off} samples are not exact", self.what));
        }
        let components: [fn(Rgb) -> f64; 3] = [|c| c.r, |c| c.g, |c| c.b];
        let judged = components.into_iter().zip(truth).map(|(component, truth)| {
            let estimate = Estimate::of_film(&film, component);
            (estimate.z(truth), Z_LIMIT * estimate.std_err / truth)
        });
        let judged: Vec<(f64, f64)> = judged.collect();
        let [z, margin] =
            [0, 1].map(|i| judged.iter().map(|&(z, margin)| [z.abs(), margin][i]).fold(0.0, f64::max));
        println!("{}: {z:.2} standard errors, margin {:.2} %", self.what, 100.0 * margin);
        let right = z < Z_LIMIT && margin < PRECISION;
        (!right).then(|| format!("{}: {z:.2} standard errors, margin {:.2} %", self.what, 100.0 * margin))
    }
}

#[test]
fn every_stage_is_in_equilibrium() {
    let faults: Vec<String> = STAGES.iter().enumerate().filter_map(|(i, stage)| stage.fault(i)).collect();
    assert!(faults.is_empty(), "{faults:#?}");
}
