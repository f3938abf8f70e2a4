//! Light that plane mirrors throw on a diffuse floor: a point sees in a mirror what its image sees
//! through the mirror as through a window, so form factors tell it.

use glam::{DVec3, Vec3};
use globillum::geom::Triangle;
use globillum::integrator::{Camera, Estimator, Film, MirrorSampling, Model, Settings, render};
use globillum::material::{Material, Rgb};
use globillum_testkit::accelerators::{ACCELERATORS, Builder};
use globillum_testkit::polygon::form_factor;
use globillum_testkit::scenes::{self, stare};
use globillum_testkit::shapes::{inside_out, quad};
use globillum_testkit::stats::{Estimate, PRECISION, Z_LIMIT};

use Estimator::{Bsdf, Light, Mis};
use MirrorSampling::{Off, Planes};

const ALL: [Estimator; 3] = [Bsdf, Light, Mis];

/// The albedo of the floor, and the reflectance of mirrors.
const ALBEDO: f64 = 0.5;
const REFLECTANCE: f64 = 0.9;

/// Where the floor is looked at.
const TARGET: DVec3 = DVec3::new(0.1, 0.0, -0.2);

/// A rectangle at `x`, which faces the floor's middle; it spans `y` and `z`.
fn upright(x: f64, [y0, y1]: [f64; 2], [z0, z1]: [f64; 2]) -> [Triangle; 2] {
    let p = DVec3::new;
    let [a, b] = quad(p(x, y0, z1), p(x, y1, z1), p(x, y1, z0), p(x, y0, z0));
    if x > 0.0 { [a, b] } else { [inside_out([a])[0], inside_out([b])[0]] }
}

/// A rectangle at height 1 that faces down, from -1 to 1 along z.
fn lamp([x0, x1]: [f64; 2]) -> [Triangle; 2] {
    let p = |x: f64, z: f64| DVec3::new(x, 1.0, z);
    quad(p(x0, -1.0), p(x1, -1.0), p(x1, 1.0), p(x0, 1.0))
}

/// Triangles mirrored in the plane at `x`.
fn mirrored(triangles: &[Triangle], x: f32) -> Vec<Triangle> {
    let image = |v: Vec3| Vec3::new(2.0 * x - v.x, v.y, v.z);
    inside_out(triangles.iter().map(|t| Triangle { vertices: t.vertices.map(image) }))
}

/// A floor, lamps of radiance 1, mirrors, and black sheets.
fn model(lamps: &[Triangle], mirrors: &[Triangle], sheets: &[Triangle]) -> Model {
    let mut model = Model::default();
    let material = |albedo| Material::lambert(Rgb::splat(albedo)).expect("an albedo");
    let p = |x, z| DVec3::new(x, 0.0, z);
    model.add(material(ALBEDO), quad(p(-1.0, 1.0), p(1.0, 1.0), p(1.0, -1.0), p(-1.0, -1.0)));
    model.add(material(0.0), sheets.iter().copied());
    model.add(Material::mirror(Rgb::splat(REFLECTANCE)).expect("a reflectance"), mirrors.iter().copied());
    model.add(Material::lamp(Rgb::WHITE).expect("a lamp"), lamps.iter().copied());
    model
}

/// What the target receives from these, each with a factor, as its radiance.
fn radiance(parts: &[(f64, &[Triangle])]) -> f64 {
    let factor =
        |&(factor, triangles): &(f64, &[Triangle])| factor * form_factor(TARGET, DVec3::Y, triangles);
    ALBEDO * parts.iter().map(factor).sum::<f64>()
}

fn camera() -> Camera {
    stare(TARGET + DVec3::new(0.05, 0.1, 0.02), TARGET)
}

/// 64 x 64 pixels of the target, two long passes each, light of one bounce off a mirror.
fn settings(estimator: Estimator, mirror_sampling: MirrorSampling) -> Settings {
    // What is left to scattering is met by few samples.
    let scattered = estimator == Bsdf || mirror_sampling == Off;
    let mut settings = Settings::new(64, 64, if scattered { 256 } else { 64 });
    (settings.estimator, settings.mirror_sampling) = (estimator, mirror_sampling);
    (settings.max_bounces, settings.pass_samples) = (Some(2), settings.samples / 2);
    settings
}

fn film(model: &Model, build: Builder, settings: &Settings) -> Film {
    render(&scenes::scene(model, build), &camera(), settings, &()).expect("the scene is good").film
}

/// The target's radiance in the accelerator that is number `turn`.
fn estimate(model: &Model, turn: usize, settings: &Settings) -> Estimate {
    let (_, build) = ACCELERATORS[turn % ACCELERATORS.len()];
    Estimate::of_film(&film(model, build, settings), |c| c.g)
}

/// Asserts the radiance of the target by every estimator, each in another accelerator.
fn assert_radiance(what: &str, model: &Model, truth: f64) {
    for (turn, estimator) in ALL.into_iter().enumerate() {
        let found = estimate(model, turn + 1, &settings(estimator, Planes));
        found.assert_is(truth, &format!("{what}, {estimator:?}"));
    }
}

#[test]
fn a_lamp_and_its_whole_image() {
    let lamp = lamp([-1.0, 1.0]);
    let wall = upright(1.5, [0.0, 3.0], [-3.0, 3.0]);
    let truth = radiance(&[(1.0, &lamp), (REFLECTANCE, &mirrored(&lamp, 1.5))]);
    let facing = model(&lamp, &wall, &[]);
    for estimator in ALL {
        let settings = settings(estimator, Planes);
        let [first, others @ ..] = ACCELERATORS.map(|(_, build)| film(&facing, build, &settings));
        assert!(others.iter().all(|other| *other == first), "{estimator:?}: the accelerators differ");
        Estimate::of_film(&first, |c| c.g).assert_is(truth, &format!("{estimator:?}"));
    }
    let left_to_scattering = estimate(&facing, 1, &settings(Mis, Off));
    left_to_scattering.assert_is(truth, "mirrors left to scattering");
    assert_radiance("the back of a mirror is a mirror", &model(&lamp, &inside_out(wall), &[]), truth);
}

/// The chance of either mirror is a half, and the two show different things.
#[test]
fn an_image_in_each_of_two_mirrors() {
    let lamp = lamp([-0.9, 0.5]);
    let walls = [upright(1.5, [0.0, 3.0], [-3.0, 3.0]), upright(-1.1, [0.0, 3.0], [-3.0, 3.0])].concat();
    let images = [1.5, -1.1].map(|x| mirrored(&lamp, x));
    let truth = radiance(&[(1.0, &lamp), (REFLECTANCE, &images[0]), (REFLECTANCE, &images[1])]);
    assert_radiance("two mirrors", &model(&lamp, &walls, &[]), truth);
}

#[test]
fn a_mirrors_edge_cuts_the_image() {
    let (lamp, part) = (lamp([-1.0, 1.0]), lamp([0.1, 1.0]));
    // All of the mirror shows the lamp, so it is as bright as that.
    let small = upright(1.5, [0.45, 0.65], [-0.3, 0.2]);
    let truth = radiance(&[(1.0, &lamp), (REFLECTANCE, &small)]);
    assert_radiance("a small mirror", &model(&lamp, &small, &[]), truth);
    // The line from the target over the edge, at height 0.5, meets the image at x = 2.9.
    let high = upright(1.5, [0.5, 3.0], [-3.0, 3.0]);
    let seen = mirrored(&part, 1.5);
    let truth = radiance(&[(1.0, &lamp), (REFLECTANCE, &seen)]);
    assert_radiance("a high mirror", &model(&lamp, &high, &[]), truth);
    // A triangle that cuts it aslant, beside what scattering finds in it.
    let p = Vec3::new;
    let aslant = [Triangle::new(p(1.5, 0.2, 0.9), p(1.45, 0.9, 0.1), p(1.55, 0.3, -1.0))];
    let model = model(&lamp, &aslant, &[]);
    let scattered = estimate(&model, 1, &settings(Bsdf, Off));
    let direct = radiance(&[(1.0, &lamp)]);
    for (turn, estimator) in [(2, Light), (3, Mis)] {
        let mut settings = settings(estimator, Planes);
        settings.seed = 1;
        let found = estimate(&model, turn, &settings);
        let margin = Z_LIMIT * found.std_err.hypot(scattered.std_err);
        let what = format!("{estimator:?}: {found:?}, {scattered:?}, {direct} without the mirror");
        assert!(margin < 2.0_f64.sqrt() * PRECISION * scattered.mean, "too wide: {what}");
        assert!((found.mean - scattered.mean).abs() < margin, "{what}");
        assert!(scattered.mean - direct > 5.0 * margin, "nothing to be seen: {what}");
    }
}

/// One lamp on each side of a wall of mirror: nothing of the one behind is to be seen, in the mirror or
/// through it.
#[test]
fn a_lamp_behind_a_mirror_is_not_in_it() {
    let (front, behind) = (lamp([-0.5, 0.5]), lamp([1.6, 2.2]));
    let wall = upright(1.5, [0.0, 3.0], [-3.0, 3.0]);
    let truth = radiance(&[(1.0, &front), (REFLECTANCE, &mirrored(&front, 1.5))]);
    assert_radiance("a lamp behind", &model(&[front, behind].concat(), &wall, &[]), truth);
}

/// A black sheet stands between the floor and the mirror, or between the mirror and the lamp, and
/// hides nothing else of either.
#[test]
fn either_way_can_be_barred() {
    let lamp = lamp([-1.0, 0.5]);
    let wall = upright(1.5, [0.0, 3.0], [-3.0, 3.0]);
    let truth = radiance(&[(1.0, &lamp)]);
    for (what, heights) in [("floor to mirror", [0.1, 0.4]), ("mirror to lamp", [0.45, 0.98])] {
        let sheet = upright(0.8, heights, [-3.0, 3.0]);
        assert_radiance(what, &model(&lamp, &wall, &sheet), truth);
    }
    // Where two triangles coincide, rays meet the one that comes first.
    assert_radiance("a mirror under a sheet", &model(&lamp, &wall, &wall), truth);
}
