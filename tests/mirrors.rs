//! Illumination of a diffuse floor by plane mirrors. A mirror shows a point what the point's mirror image
//! sees through it as through a window, so form factors give the radiance. The lights themselves are hidden
//! from the point, so that all illumination is mirrored.

use glam::{DVec3, Vec3};
use globillum::geom::Triangle;
use globillum::integrator::{Estimator, Film, MirrorSampling, Model, PinholeCamera, Settings, render};
use globillum::material::{Material, Rgb};
use globillum_testkit::accelerators::{ACCELERATORS, Builder};
use globillum_testkit::polygon::form_factor;
use globillum_testkit::scenes::{self, stare};
use globillum_testkit::shapes::{icosphere, inside_out, quad};
use globillum_testkit::stats::{Estimate, PRECISION, independent_pixels};
use std::f64::consts::{SQRT_2, TAU};

use Estimator::{Bsdf, Light, Mis};
use MirrorSampling::{Images, Off};

/// The albedo of the floor, and the reflectance of mirrors.
const ALBEDO: f64 = 0.5;
const REFLECTANCE: f64 = 0.9;

/// The point of the floor in the picture.
const TARGET: DVec3 = DVec3::new(0.1, 0.0, -0.2);

/// A vertical rectangle at `x` that faces the floor's middle and spans the given ranges of `y` and `z`.
fn upright(x: f64, [y0, y1]: [f64; 2], [z0, z1]: [f64; 2]) -> [Triangle; 2] {
    let p = DVec3::new;
    let [a, b] = quad(p(x, y0, z1), p(x, y1, z1), p(x, y1, z0), p(x, y0, z0));
    if x > 0.0 { [a, b] } else { [inside_out([a])[0], inside_out([b])[0]] }
}

/// A rectangle at height `y` that faces down.
fn level(y: f64, [x0, x1]: [f64; 2], [z0, z1]: [f64; 2]) -> [Triangle; 2] {
    let p = |x: f64, z: f64| DVec3::new(x, y, z);
    quad(p(x0, z0), p(x1, z0), p(x1, z1), p(x0, z1))
}

/// A light at height 1, from -2 to 2 along z.
fn light(across: [f64; 2]) -> [Triangle; 2] {
    level(1.0, across, [-2.0, 2.0])
}

fn whole_light() -> [Triangle; 2] {
    light([-1.5, 0.25])
}

/// The part of [`whole_light`] that the target sees in a mirror at [`WALL`] in directions steeper than (1, 1).
fn nearer_part() -> [Triangle; 2] {
    light([-0.5, 0.25])
}

/// A sheet that hides [`whole_light`] from the target, but nothing of its image in a mirror at [`WALL`].
fn shade() -> [Triangle; 2] {
    level(0.05, [-0.2, 0.11], [-0.5, 0.2])
}

/// The `x` of most mirrors. The target sees [`whole_light`] in them in directions from (0.25, 1) to (2, 1).
const WALL: f64 = 0.3;

fn wall() -> [Triangle; 2] {
    upright(WALL, [0.0, 3.0], [-3.0, 3.0])
}

/// Triangles mirrored in the plane at `x`.
fn mirrored(triangles: &[Triangle], x: f64) -> Vec<Triangle> {
    let image = |v: Vec3| Vec3::new(2.0 * x as f32 - v.x, v.y, v.z);
    inside_out(triangles.iter().map(|t| Triangle { vertices: t.vertices.map(image) }))
}

/// A floor, lights of radiance 1, mirrors, and black sheets.
fn model(lights: &[Triangle], mirrors: &[Triangle], sheets: &[Triangle]) -> Model {
    let mut model = Model::default();
    let material = |albedo| Material::lambert(Rgb::splat(albedo)).expect("an albedo");
    let p = |x, z| DVec3::new(x, 0.0, z);
    model.add(material(ALBEDO), quad(p(-1.0, 1.0), p(1.0, 1.0), p(1.0, -1.0), p(-1.0, -1.0)));
    model.add(material(0.0), sheets.iter().copied());
    model.add(Material::mirror(Rgb::splat(REFLECTANCE)).expect("a reflectance"), mirrors.iter().copied());
    model.add(Material::light(Rgb::WHITE).expect("a light"), lights.iter().copied());
    model
}

/// The radiance of the target under these lights, each with a factor.
fn radiance(parts: &[(f64, &[Triangle])]) -> f64 {
    let factor =
        |&(factor, triangles): &(f64, &[Triangle])| factor * form_factor(TARGET, DVec3::Y, triangles);
    ALBEDO * parts.iter().map(factor).sum::<f64>()
}

/// A camera below the shade.
fn camera() -> PinholeCamera {
    stare(TARGET + DVec3::new(0.02, 0.04, 0.01), TARGET)
}

/// 32 x 32 pixels of the target, with two passes and paths of at most one reflection by a mirror.
fn settings(estimator: Estimator, mirror_sampling: MirrorSampling, samples: u32) -> Settings {
    let mut settings = independent_pixels(32, 32, samples);
    (settings.estimator, settings.mirror_sampling) = (estimator, mirror_sampling);
    (settings.max_bounces, settings.pass_samples) = (Some(2), samples / 2);
    settings
}

fn film(model: &Model, build: Builder, settings: &Settings) -> Film {
    render(&scenes::scene(model, build), &camera(), settings).expect("the scene is good").film
}

/// The target's radiance in accelerator number `turn`.
fn estimate(model: &Model, turn: usize, settings: &Settings) -> Estimate {
    let (_, build) = ACCELERATORS[turn];
    Estimate::of_film(&film(model, build, settings), |c| c.g)
}

/// Asserts the radiance of the target by these estimators and numbers of samples, each in another accelerator.
fn assert_radiance(what: &str, model: &Model, truth: f64, estimators: &[(Estimator, u32)]) {
    for (turn, &(estimator, samples)) in estimators.iter().enumerate() {
        let found = estimate(model, turn + 1, &settings(estimator, Images, samples));
        found.assert_is(truth, &format!("{what}, {estimator:?}"));
    }
}

#[test]
fn a_light_and_its_whole_image() {
    let light = whole_light();
    let truth = radiance(&[(REFLECTANCE, &mirrored(&light, WALL))]);
    let facing = model(&light, &wall(), &shade());
    assert_radiance("a whole image", &facing, truth, &[(Bsdf, 512), (Light, 128), (Mis, 128)]);
    assert_radiance(
        "its back",
        &model(&light, &inside_out(wall()), &shade()),
        truth,
        &[(Light, 128), (Mis, 128)],
    );
    let without_sampling = estimate(&facing, 1, &settings(Mis, Off, 512));
    without_sampling.assert_is(truth, "no sampling through mirrors");
}

#[test]
fn pictures_with_mirrors_are_the_same_in_all_accelerators() {
    let model = model(&whole_light(), &wall(), &shade());
    let [first, others @ ..] = ACCELERATORS.map(|(_, build)| film(&model, build, &settings(Mis, Images, 16)));
    assert!(others.iter().all(|other| *other == first));
}

/// Each mirror is chosen with probability one half, and the two show the light differently. They are low
/// enough not to block the light to each other.
#[test]
fn an_image_in_each_of_two_mirrors() {
    let (light, places) = (light([-0.3, 0.45]), [0.6, -0.4]);
    let walls = places.map(|x| upright(x, [0.0, 0.9], [-3.0, 3.0])).concat();
    let images = places.map(|x| mirrored(&light, x));
    let shade = level(0.05, [0.075, 0.125], [-0.5, 0.2]);
    let truth = radiance(&[(REFLECTANCE, &images[0]), (REFLECTANCE, &images[1])]);
    assert_radiance(
        "two mirrors",
        &model(&light, &walls, &shade),
        truth,
        &[(Bsdf, 1024), (Light, 256), (Mis, 256)],
    );
}

#[test]
fn a_mirrors_edge_cuts_the_image() {
    // The whole mirror shows the light, so it has the light's radiance.
    let small = upright(WALL, [0.15, 0.6], [-0.4, 0.0]);
    let truth = radiance(&[(REFLECTANCE, &small)]);
    assert_radiance(
        "a small mirror",
        &model(&whole_light(), &small, &shade()),
        truth,
        &[(Bsdf, 1024), (Light, 512), (Mis, 512)],
    );
    // In x and y, the direction from the target to the mirror's lower edge is (1, 1).
    let high = upright(WALL, [0.2, 3.0], [-3.0, 3.0]);
    let truth = radiance(&[(REFLECTANCE, &mirrored(&nearer_part(), WALL))]);
    assert_radiance(
        "a high mirror",
        &model(&whole_light(), &high, &shade()),
        truth,
        &[(Bsdf, 512), (Light, 128), (Mis, 256)],
    );
}

/// Asserts that mirrors, sampled with this number of samples, show the target what BSDF sampling alone finds.
fn assert_agrees_with_scattering(model: &Model, samples: u32) {
    let scattered = estimate(model, 1, &settings(Bsdf, Off, 1024));
    for (turn, estimator) in [(2, Light), (3, Mis)] {
        let mut settings = settings(estimator, Images, samples);
        settings.seed = 1;
        let found = estimate(model, turn, &settings);
        scattered.assert_agrees(&found, SQRT_2 * PRECISION, &format!("{estimator:?}"));
    }
}

/// A tilted triangle has no closed form; the reference is BSDF sampling.
#[test]
fn a_tilted_mirror_agrees_with_bsdf_sampling() {
    let p = Vec3::new;
    let tilted = [Triangle::new(p(0.3, 0.1, 0.3), p(0.25, 0.6, -0.1), p(0.35, 0.1, -0.7))];
    let model = model(&whole_light(), &tilted, &shade());
    assert_agrees_with_scattering(&model, 256);
}

/// A low mirror in front of the wall hides the lower part of it, and shows the further part of the light itself.
#[test]
fn a_mirror_hides_another_one() {
    let low = upright(0.2, [0.0, 0.1], [-9.0, 9.0]);
    let truth = radiance(&[
        (REFLECTANCE, &mirrored(&nearer_part(), WALL)),
        (REFLECTANCE, &mirrored(&light([-1.5, -0.7]), 0.2)),
    ]);
    assert_radiance(
        "a mirror before another",
        &model(&whole_light(), &[wall(), low].concat(), &shade()),
        truth,
        &[(Bsdf, 1024), (Mis, 1024)],
    );
}

/// A mirror that is small beside two lights shows both. Each is sampled by itself.
#[test]
fn a_small_mirror_shows_several_lights() {
    let lights = [light([-1.5, -0.7]), light([-0.6, 0.25])];
    let small = upright(WALL, [0.1, 0.5], [-1.0, 1.0]);
    let model = model(&lights.concat(), &small, &shade());
    assert_agrees_with_scattering(&model, 2048);
}

/// One light on each side of a mirror wall. The light behind is visible neither in the mirror nor through it,
/// although rays from the target's image through that light reach the wall above it, where nothing blocks
/// them.
#[test]
fn a_light_behind_a_mirror_is_not_visible_in_it() {
    let (front, behind) = (light([-1.5, -0.3]), light([0.32, 0.42]));
    let shade = level(0.05, [-0.2, 0.085], [-0.5, 0.2]);
    let truth = radiance(&[(REFLECTANCE, &mirrored(&front, WALL))]);
    assert_radiance(
        "a light behind",
        &model(&[front, behind].concat(), &wall(), &shade),
        truth,
        &[(Bsdf, 1024), (Light, 128), (Mis, 256)],
    );
}

/// A black sheet between the floor and the mirror, one between the mirror and the light, or another mirror
/// hides what the target sees in directions flatter than (1, 1).
#[test]
fn either_segment_of_a_mirrored_path_can_be_blocked() {
    let light_and_wall = |sheets: &[Triangle]| model(&whole_light(), &wall(), sheets);
    let truth = radiance(&[(REFLECTANCE, &mirrored(&nearer_part(), WALL))]);
    for (what, x, heights) in [("floor to mirror", 0.2, [0.04, 0.1]), ("mirror to light", 0.0, [0.2, 0.5])] {
        let sheet = upright(x, heights, [-3.0, 3.0]);
        assert_radiance(
            what,
            &light_and_wall(&[sheet, shade()].concat()),
            truth,
            &[(Light, 128), (Mis, 256)],
        );
    }
    // From below, this one shows no light.
    let level_mirror = level(0.1, [0.2, WALL], [-3.0, 3.0]);
    let mirrors = [level_mirror, wall()].concat();
    let hidden = model(&whole_light(), &mirrors, &shade());
    assert_radiance("a mirror to another", &hidden, truth, &[(Light, 128), (Mis, 256)]);
    // Of two coincident triangles, rays hit the one with the smaller index.
    let direct = radiance(&[(1.0, &whole_light())]);
    assert_radiance("a mirror under a sheet", &light_and_wall(&wall()), direct, &[(Light, 128), (Mis, 128)]);
}

/// An open column around a point of its lower end, of this radius, height and number of facets.
fn column(base: DVec3, radius: f64, height: f64, facets: u32) -> Vec<Triangle> {
    let corner = |i: u32, y: f64| {
        let (sin, cos) = f64::sin_cos(TAU * f64::from(i) / f64::from(facets));
        base + DVec3::new(radius * cos, y, radius * sin)
    };
    let facet = |i| quad(corner(i, height), corner(i + 1, height), corner(i + 1, 0.0), corner(i, 0.0));
    (0..facets).flat_map(facet).collect()
}

/// Curved mirrors and hard lights: next event estimation by way of mirrors changes no mean.
#[test]
fn mirror_sampling_changes_no_mean() {
    let ball = || icosphere(2).placed(0.3, DVec3::new(0.65, 0.4, -0.2)).triangles();
    let walls = || [0.6, -0.4].map(|x| upright(x, [0.0, 0.9], [-3.0, 3.0])).concat();
    // The target and the light are close to the center of a dish.
    let dish = inside_out(icosphere(3).placed(1.0, TARGET).triangles());
    let dish: Vec<_> = dish.into_iter().filter(|t| t.vertices.iter().all(|v| v.y > 0.3)).collect();
    let at_focus = inside_out(level(0.1, [0.13, 0.19], [-0.25, -0.15]));
    let edge_on = inside_out(upright(TARGET.x, [0.3, 0.8], [-0.5, 0.5]));
    let shade = shade();
    let column = || column(DVec3::new(0.6, 0.0, -0.2), 0.2, 0.9, 40);
    let cases: [(&str, Model, u32); 6] = [
        ("a column of long facets", model(&whole_light(), &column(), &shade), 2),
        ("a ball", model(&whole_light(), &ball(), &shade), 2),
        ("a ball and a light edge-on", model(&edge_on, &ball(), &[]), 2),
        ("mirrors facing mirrors", model(&light([-0.3, 0.45]), &[walls(), ball()].concat(), &shade), 3),
        ("a ball, one bounce more than its light needs", model(&whole_light(), &ball(), &shade), 3),
        ("a concave mirror", model(&at_focus, &dish, &[]), 2),
    ];
    for (what, model, max_bounces) in cases {
        let estimate = |seed, estimator, mirror_sampling, samples| {
            let mut settings = settings(estimator, mirror_sampling, samples);
            (settings.seed, settings.max_bounces) = (seed, Some(max_bounces));
            estimate(&model, 3, &settings)
        };
        let off = estimate(0, Bsdf, Off, 1024);
        for (seed, estimator) in [(1, Light), (2, Mis)] {
            let on = estimate(seed, estimator, Images, 128);
            off.assert_agrees(&on, 0.03, &format!("{what}, {estimator:?}"));
        }
    }
}

/// Light by way of a mirror takes two bounces.
#[test]
fn a_limit_on_bounces_counts_the_mirror() {
    let model = model(&whole_light(), &wall(), &shade());
    for (max_bounces, is_dark) in [(1, true), (2, false)] {
        for mirror_sampling in [Off, Images] {
            let mut settings = settings(Mis, mirror_sampling, 64);
            settings.max_bounces = Some(max_bounces);
            let film = film(&model, ACCELERATORS[3].1, &settings);
            assert_eq!(film.image_mean().is_black(), is_dark, "{max_bounces}, {mirror_sampling:?}");
        }
    }
}
