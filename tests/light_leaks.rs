//! No path escapes from a closed room, and no light passes a wall.
//!
//! Exact results are compared to the bit. The environment variable `GLOBILLUM_EFFORT` multiplies the number
//! of paths; 20 gives 20 480 paths per furnace and ten million rays in the black box.

use glam::{DVec3, Vec3};
use globillum::geom::{Accel, Triangle};
use globillum::integrator::{Estimator, Film, Model, PinholeCamera, Scene, Settings, render};
use globillum::material::{Emission, Material, Rgb, Sides};
use globillum_testkit::accelerators::ACCELERATORS;
use globillum_testkit::effort;
use globillum_testkit::form_factor::corner;
use globillum_testkit::furnace::truncated_series;
use globillum_testkit::scenes::{self, stare};
use globillum_testkit::shapes::{self, Mesh, cuboid, inside_out, quad};
use globillum_testkit::stats::{Estimate, independent_pixels};

const ALL: [Estimator; 3] = [Estimator::Bsdf, Estimator::Light, Estimator::Mis];

const RHO: f64 = 0.8;

fn lambert(albedo: f64) -> Material {
    Material::lambert(Rgb::splat(albedo)).expect("an albedo below one")
}

fn emission(radiance: f64) -> Emission {
    Emission::new(Rgb::splat(radiance), Sides::Front).expect("a finite radiance")
}

fn light() -> Material {
    Material::light(Rgb::WHITE).expect("a finite radiance")
}

/// A camera with a field of view of 2.5 radians.
fn wide(eye: DVec3, target: DVec3) -> PinholeCamera {
    let up = (target - eye).normalize().any_orthogonal_vector();
    PinholeCamera::look_at(eye, target, up, 2.5).expect("eye and target are apart")
}

/// The scene in every accelerator. Brute force is left out above 50 triangles, where it takes too long.
fn scenes_of(model: &Model) -> Vec<(&'static str, Scene<Box<dyn Accel>>)> {
    let few = model.triangles().len() <= 50;
    let builders = ACCELERATORS.into_iter().filter(|&(name, _)| few || name != "brute force");
    builders.map(|(name, build)| (name, scenes::scene(model, build))).collect()
}

/// The film of a scene. Asserts that it is the same in every accelerator.
fn one_film(
    scenes: &[(&str, Scene<Box<dyn Accel>>)],
    camera: &PinholeCamera,
    settings: &Settings,
    what: &str,
) -> Film {
    let mut films = scenes
        .iter()
        .map(|(name, scene)| (name, render(scene, camera, settings).expect("the scene is good").film));
    let (_, first) = films.next().expect("there are accelerators");
    for (name, film) in films {
        assert_eq!(film, first, "{what}: a different picture in the {name}");
    }
    first
}

fn assert_black(film: &Film, what: &str) {
    let lit = film.means().filter(|&mean| mean != Rgb::BLACK).count();
    assert_eq!(lit, 0, "{what}: pixels are not black; the mean is {}", film.image_mean());
}

/// A furnace of a closed mesh that faces outward.
fn furnace(walls: Vec<Triangle>) -> Model {
    let mut model = Model::default();
    model.add(lambert(RHO).emitting(emission(1.0)), inside_out(walls));
    model
}

/// Asserts that every path in a furnace has all its bounces. A path that leaves the room, or hits a wall from
/// behind, has too little radiance.
fn assert_no_escape(model: &Model, camera: &PinholeCamera, what: &str) {
    // One sample per pixel: a sum of several equal samples would be rounded.
    let mut settings = independent_pixels(32, 32, 1);
    (settings.estimator, settings.max_bounces) = (Estimator::Bsdf, Some(64));
    settings.roulette.start = u32::MAX;
    let (truth, scenes) = (Rgb::splat(truncated_series(RHO, 64)), scenes_of(model));
    for seed in 0..effort() {
        settings.seed = seed.into();
        let film = one_film(&scenes, camera, &settings, what);
        let escapes = film.means().filter(|&mean| mean != truth).count();
        assert_eq!(
            escapes,
            0,
            "{what}, seed {seed}: escapes of 1024 paths; the mean is {}",
            film.image_mean()
        );
    }
}

fn assert_cube_is_closed(half: f64, center: DVec3) {
    let eye = center + half * DVec3::new(0.1, 0.2, 0.3);
    let camera = wide(eye, eye + half * DVec3::new(0.4, -0.3, 0.8));
    let model = scenes::furnace(RHO, half, center);
    assert_no_escape(&model, &camera, &format!("cube of half side {half} around {center}"));
}

fn assert_mesh_is_closed(mesh: Mesh, scale: f64, offset: DVec3, what: &str) {
    let mesh = mesh.placed(scale, offset);
    let eye = mesh.core[0];
    let camera = wide(eye, eye + scale * DVec3::new(0.3, 0.2, 0.9));
    let what = format!("{what} of size {scale} at {offset}");
    assert_no_escape(&furnace(mesh.triangles()), &camera, &what);
}

#[test]
fn no_path_escapes_a_furnace_of_any_size() {
    for half in [1e-12, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e12] {
        assert_cube_is_closed(half, DVec3::ZERO);
        assert_mesh_is_closed(shapes::icosphere(3), half, DVec3::ZERO, "icosphere");
    }
}

#[test]
fn no_path_escapes_a_curved_furnace() {
    for scale in [1e-6, 1e-3, 1.0, 1e3, 1e6] {
        assert_mesh_is_closed(shapes::torus(48, 20), scale, DVec3::ZERO, "torus");
        assert_mesh_is_closed(shapes::statue(4000), scale, DVec3::ZERO, "statue");
    }
}

#[test]
fn no_path_escapes_a_furnace_far_from_the_origin() {
    for offset in [1e4, 1e5, 1e6] {
        for axes in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::ONE] {
            assert_cube_is_closed(1.0, offset * axes);
        }
    }
    let far = DVec3::new(148_376.0, 1234.0, -223_423.0);
    assert_mesh_is_closed(shapes::icosphere(3), 2.0, far, "icosphere");
}

/// A cube of half side 1 whose faces are divided into `n` times `n` quadrilaterals.
fn cut_cube(n: usize) -> Vec<Triangle> {
    let at = |i: usize| 2.0 * i as f64 / n as f64 - 1.0;
    let mut walls = Vec::new();
    for (axis, side) in [(0, -1.0), (0, 1.0), (1, -1.0), (1, 1.0), (2, -1.0), (2, 1.0)] {
        let point = |i: usize, j: usize| {
            let mut p = DVec3::splat(side);
            (p[(axis + 1) % 3], p[(axis + 2) % 3]) = (side * at(i), at(j));
            p
        };
        let cells = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
        let quads =
            cells.map(|(i, j)| quad(point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)));
        walls.extend(quads.flatten());
    }
    walls
}

/// The closed box in a white environment, in every accelerator.
fn under_the_sky(albedo: f64) -> Vec<(&'static str, Scene<Box<dyn Accel>>)> {
    let mut model = Model::default();
    model.add(lambert(albedo), cut_cube(8));
    model.set_environment(Rgb::WHITE).expect("white is a radiance");
    scenes_of(&model)
}

#[test]
fn no_light_enters_a_closed_box() {
    let eye = DVec3::new(0.1, 0.2, 0.3);
    let camera = wide(eye, eye + DVec3::new(0.4, -0.3, 0.8));
    for (albedo, samples) in [(0.0, 31), (0.5, 4)] {
        let scenes = under_the_sky(albedo);
        let mut settings = Settings::new(128, 128, samples);
        for seed in 0..effort() {
            settings.seed = seed.into();
            let what = format!("albedo {albedo}, seed {seed}");
            assert_black(&one_film(&scenes, &camera, &settings, &what), &what);
        }
    }
}

#[test]
fn no_light_enters_a_closed_box_at_its_seams() {
    let eye = DVec3::new(0.1, 0.2, 0.3);
    let scenes = under_the_sky(0.0);
    let settings = Settings::new(16, 16, 1);
    // The first corner of every triangle, and a point of the edge after it.
    for triangle in cut_cube(8) {
        let [a, b, _] = triangle.vertices.map(|v| v.as_dvec3());
        for target in [a, a.lerp(b, 0.37)] {
            let up = (target - eye).any_orthogonal_vector();
            // All rays aim at the point, up to a few roundings.
            let camera = PinholeCamera::look_at(eye, target, up, 2e-15).expect("eye and target are apart");
            let what = format!("toward {target}");
            assert_black(&one_film(&scenes, &camera, &settings, &what), &what);
        }
    }
}

/// A horizontal square, `half` its half side, at height `y`, that faces down or up.
fn square(half: f64, y: f64, down: bool) -> Vec<Triangle> {
    let p = |x: f64, z: f64| DVec3::new(half * x, y, half * z);
    let faces_down = quad(p(-1.0, -1.0), p(1.0, -1.0), p(1.0, 1.0), p(-1.0, 1.0));
    if down { faces_down.to_vec() } else { inside_out(faces_down) }
}

/// The triangles with the coordinates of every vertex rotated cyclically by `axes`.
fn turned(triangles: Vec<Triangle>, axes: usize) -> Vec<Triangle> {
    let turn = |v: Vec3| Vec3::from([0, 1, 2].map(|i| v[(i + axes) % 3]));
    triangles.into_iter().map(|t| Triangle { vertices: t.vertices.map(turn) }).collect()
}

#[test]
fn a_cover_sheet_blocks_all_light() {
    for (size, gap) in [1e-6, 1.0, 1e6].into_iter().flat_map(|s| GAPS.map(|gap| (s, gap))) {
        for axes in 0..3 {
            for spread in [1.0, 1.5] {
                let (lit, covered) = cover(size, gap, spread, axes);
                assert_covered(&lit, &covered, size, axes, &format!("size {size}, gap {gap}, axes {axes}"));
            }
        }
    }
}

const GAPS: [f64; 4] = [1e-3, 1e-6, 1e-9, 1e-12];

/// A light over a floor, without and with a sheet at distance `gap` before the light, `spread` times as wide
/// as it. The light is at height 0, where `f32` resolves any gap.
fn cover(size: f64, gap: f64, spread: f64, axes: usize) -> (Model, Model) {
    let mut lit = Model::default();
    lit.add(lambert(0.5), turned(square(size, -size, false), axes));
    lit.add(light(), turned(square(size, 0.0, true), axes));
    let mut covered = lit.clone();
    covered.add(lambert(0.0), turned(square(spread * size, -gap * size, true), axes));
    (lit, covered)
}

fn assert_covered(lit: &Model, covered: &Model, size: f64, axes: usize, what: &str) {
    let at = |x: f64, y: f64, z: f64| size * DVec3::from([0, 1, 2].map(|i| [x, y, z][(i + axes) % 3]));
    let floor = wide(at(0.3, -0.5, 0.2), at(0.1, -1.0, 0.3));
    let mut settings = Settings::new(32, 32, effort());
    for estimator in ALL {
        settings.estimator = estimator;
        let what = format!("{what}, {estimator:?}");
        assert!(one_film(&scenes_of(lit), &floor, &settings, &what).image_mean().g > 0.1, "{what}: too dark");
        assert_black(&one_film(&scenes_of(covered), &floor, &settings, &what), &what);
    }
}

/// The radiance at `x`, `z` of a floor of albedo 0.5 under a light of half side 1 and radiance 1 at height 1.
fn under_a_square_light(x: f64, z: f64) -> f64 {
    let sides = |x: f64| [1.0 - x, 1.0 + x];
    let corners = sides(x).into_iter().flat_map(|a| sides(z).map(|b| corner(a, b)));
    0.5 * corners.sum::<f64>()
}

/// A light of half side 1 above a floor, without and with a black ceiling of half side `half` at height 0.
/// The light is `drop` below the ceiling, the floor 1 below. The floor gives both scenes the same extent.
fn light_in_ceiling(drop: f64, half: f64, ceiling_first: bool) -> (Model, Model) {
    let mut open = Model::default();
    open.add(lambert(0.5), square(half.max(4.0), -1.0, false));
    open.add(light(), square(1.0, -drop, true));
    let mut ceiling = Model::default();
    ceiling.add(lambert(0.0), square(half, 0.0, true));
    let (mut closed, last) = if ceiling_first { (ceiling, &open) } else { (open.clone(), &ceiling) };
    closed.append(last);
    (open, closed)
}

/// Points of the floor: below the light, and at an oblique angle to it.
const PLACES: [(f64, f64); 2] = [(0.0, 0.0), (2.5, 0.7)];

fn toward_floor((x, z): (f64, f64)) -> PinholeCamera {
    let target = DVec3::new(x, -1.0, z);
    stare(target + DVec3::new(0.1, 0.5, 0.2), target)
}

/// Asserts that the floor has the same radiance with and without the ceiling, to the bit.
fn assert_hides_nothing(models: &(Model, Model), estimator: Estimator, what: &str) {
    for place in PLACES {
        let mut settings = Settings::new(64, 64, 4 * effort());
        settings.estimator = estimator;
        let what = format!("{what}, {estimator:?}, at {place:?}");
        let [open, closed] = [&models.0, &models.1]
            .map(|model| one_film(&scenes_of(model), &toward_floor(place), &settings, &what));
        let (light, rest) = (open.image_mean().g, closed.image_mean().g);
        assert!(open == closed, "{what}: the ceiling hides {} of {light}", light - rest);
    }
}

#[test]
fn a_ceiling_hides_nothing_of_the_light_in_its_plane() {
    for half in [1.0, 3.0, 10.0, 100.0, 1e4] {
        for ceiling_first in [false, true] {
            let models = light_in_ceiling(0.0, half, ceiling_first);
            let what = format!("ceiling {half}, first {ceiling_first}");
            assert_hides_nothing(&models, Estimator::Light, &what);
        }
    }
}

#[test]
fn a_ceiling_hides_nothing_of_the_light_just_below_it() {
    for (drop, half) in [(1e-9, 1.0), (1e-9, 3.0), (1e-12, 3.0), (1e-9, 1e3)] {
        let models = light_in_ceiling(drop, half, true);
        for estimator in ALL {
            assert_hides_nothing(&models, estimator, &format!("drop {drop}, ceiling {half}"));
        }
    }
}

#[test]
fn a_light_in_a_ceiling_gives_the_known_radiance() {
    let (center, oblique) = (PLACES[0], PLACES[1]);
    let cases = [
        (0.0, Estimator::Light, center, 32),
        (0.0, Estimator::Light, oblique, 32),
        (1e-9, Estimator::Light, center, 32),
        (1e-9, Estimator::Light, oblique, 32),
        (1e-9, Estimator::Mis, center, 32),
        (1e-9, Estimator::Mis, oblique, 48),
        // At the oblique point, BSDF sampling hits the light too rarely.
        (1e-9, Estimator::Bsdf, center, 48),
    ];
    for (drop, estimator, (x, z), samples) in cases {
        let mut settings = independent_pixels(64, 64, samples);
        settings.estimator = estimator;
        let what = format!("{estimator:?}, drop {drop}, at {x}, {z}");
        let (_, model) = light_in_ceiling(drop, 3.0, true);
        // The test above shows with fewer samples that all accelerators give the same film.
        let film = one_film(&scenes_of(&model)[..1], &toward_floor((x, z)), &settings, &what);
        Estimate::of_film(&film, |c| c.g).assert_is(under_a_square_light(x, z), &what);
    }
}

/// A grey box, and a box beside it that emits inside and touches its face at `x = 1`. `at` places them and
/// must be exact in `f32`.
fn two_boxes(half: f64, dark_first: bool, at: impl Fn(DVec3) -> DVec3) -> Model {
    let place = |walls: Vec<Triangle>| {
        let place = |t: Triangle| Triangle { vertices: t.vertices.map(|v| at(v.as_dvec3()).as_vec3()) };
        inside_out(walls).into_iter().map(place).collect::<Vec<_>>()
    };
    let dark = place(cuboid(DVec3::ZERO, DVec3::ONE, 0.0));
    let bright = place(cuboid(DVec3::X * (1.0 + half), DVec3::splat(half), 0.0));
    let emitting = lambert(RHO).emitting(emission(1.0));
    let mut boxes = [(lambert(RHO), dark), (emitting, bright)];
    if !dark_first {
        boxes.reverse();
    }
    let mut model = Model::default();
    for (material, walls) in boxes {
        model.add(material, walls);
    }
    model
}

#[test]
fn no_light_crosses_between_boxes_that_touch() {
    // Upright; far away; rotated by the angle whose tangent is 4/3, which is exact.
    type Place = fn(DVec3) -> DVec3;
    let places: [(&str, Place); 4] = [
        ("upright", |p| p),
        ("far", |p| p + 1e5),
        ("turned", |p| DVec3::new(3.0 * p.x - 4.0 * p.y, 4.0 * p.x + 3.0 * p.y, 5.0 * p.z)),
        ("turned far", |p| DVec3::new(3.0 * p.x - 4.0 * p.y, 4.0 * p.x + 3.0 * p.y, 5.0 * p.z) + 1e5),
    ];
    for (name, at) in places {
        for (half, dark_first) in [(1.0, false), (1.0, true), (2.0, false), (2.0, true)] {
            let model = two_boxes(half, dark_first, at);
            for estimator in ALL {
                let what = format!("{name}, half side {half}, dark first {dark_first}, {estimator:?}");
                assert_boxes_are_apart(&model, at, estimator, &what);
            }
        }
    }
}

fn assert_boxes_are_apart(model: &Model, at: impl Fn(DVec3) -> DVec3, estimator: Estimator, what: &str) {
    let mut settings = Settings::new(32, 32, 2 * effort());
    settings.estimator = estimator;
    let scenes = scenes_of(model);
    let within = |x: f64| wide(at(DVec3::new(x, 0.2, 0.3)), at(DVec3::new(x + 0.5, 0.1, 0.2)));
    assert!(one_film(&scenes, &within(1.5), &settings, what).image_mean().g > 1.0, "{what}: too dark");
    assert_black(&one_film(&scenes, &within(0.1), &settings, what), what);
}
