//! Scenes of known radiance, and cameras that look at one point of them.

use crate::accelerators::{Builder, Measurable};
use crate::shapes::{cuboid, icosphere, inside_out, quad};
use glam::DVec3;
use globillum_geom::{Accel, Triangle};
use globillum_integrator::{Model, PinholeCamera, Scene};
use globillum_material::{Emission, Material, Rgb, Sides};

/// The scene of a valid model.
///
/// # Panics
/// If the model is not valid.
pub fn scene(model: &Model, build: Builder) -> Scene<Box<dyn Accel>> {
    let upcast = |accel: Box<dyn Measurable>| -> Box<dyn Accel> { accel };
    Scene::build(model.clone(), |triangles| build(triangles).map(upcast)).expect("the model is good")
}

/// The same in an environment of radiance `sky`.
///
/// # Panics
/// If the model is bad or no light may have this radiance.
pub fn scene_under(sky: Rgb, model: &Model, build: Builder) -> Scene<Box<dyn Accel>> {
    let mut model = model.clone();
    model.set_environment(sky).expect("a radiance");
    scene(&model, build)
}

/// A camera at `eye` whose whole picture shows one point, `target`, up to `1e-9` radians.
///
/// # Panics
/// If the two coincide.
pub fn stare(eye: DVec3, target: DVec3) -> PinholeCamera {
    let up = (target - eye).any_orthogonal_vector();
    PinholeCamera::look_at(eye, target, up, 1e-9).expect("eye and target are apart")
}

fn lambert(albedo: f64) -> Material {
    Material::lambert(Rgb::splat(albedo)).expect("an albedo below one")
}

fn mirror(reflectance: f64) -> Material {
    Material::mirror(Rgb::splat(reflectance)).expect("a reflectance below one")
}

fn glow(radiance: f64) -> Emission {
    Emission::new(Rgb::splat(radiance), Sides::Front).expect("a finite radiance")
}

/// Furnace: a closed cube, `half` its half side, around `center`, that emits radiance 1 inward and
/// has albedo `rho`. After `n` bounces the radiance is `(1 - rho^(n + 1)) / (1 - rho)`.
pub fn furnace(rho: f64, half: f64, center: DVec3) -> Model {
    let mut model = Model::default();
    let walls = inside_out(cuboid(center, DVec3::splat(half), 0.0));
    model.add(lambert(rho).emitting(glow(1.0)), walls);
    model
}

/// The radiance below the middle of the light of [`light_over_floor`]: the albedo times the form factor of the square.
pub const LIGHT_OVER_FLOOR: f64 = 0.277_063_212;

/// A light of 2 x 2 and radiance 1, at height 1, centered above a floor of albedo 0.5 at
/// height 0.
pub fn light_over_floor() -> Model {
    let p = DVec3::new;
    let mut model = Model::default();
    let (lo, hi) = (-1.0, 1.0);
    model.add(lambert(0.5), quad(p(lo, 0.0, hi), p(hi, 0.0, hi), p(hi, 0.0, lo), p(lo, 0.0, lo)));
    let light = Material::light(Rgb::WHITE).expect("a finite radiance");
    model.add(light, quad(p(lo, 1.0, lo), p(hi, 1.0, lo), p(hi, 1.0, hi), p(lo, 1.0, hi)));
    model
}

/// A square light of radiance 1 at the origin, facing down, and a floor of albedo 0.5 that lies
/// `height` below it.
pub fn distant_light(side: f64, height: f64) -> Model {
    let p = DVec3::new;
    let mut model = Model::default();
    let (h, w) = (side / 2.0, height);
    let light = Material::light(Rgb::WHITE).expect("a finite radiance");
    model.add(light, quad(p(-h, 0.0, -h), p(h, 0.0, -h), p(h, 0.0, h), p(-h, 0.0, h)));
    model.add(lambert(0.5), quad(p(-w, -w, w), p(w, -w, w), p(w, -w, -w), p(-w, -w, -w)));
    model
}

/// A unit box of four perfect mirrors, a floor of albedo `floor` and a ceiling of albedo
/// `ceiling` that emits radiance 1. The mirrors make both infinite.
pub fn kaleidoscope(floor: f64, ceiling: f64) -> Model {
    let mut model = Model::default();
    let walls = inside_out(cuboid(DVec3::splat(0.5), DVec3::splat(0.5), 0.0));
    for wall in walls {
        let normal = wall.normal();
        let material = match normal.y {
            y if y > 0.5 => lambert(floor),
            y if y < -0.5 => lambert(ceiling).emitting(glow(1.0)),
            _ => mirror(1.0),
        };
        model.add(material, [wall]);
    }
    model
}

/// Two mirrors of reflectance `r` at heights 0 and 1 along x, and a light of radiance 1 that
/// closes the corridor between them at `x = length`.
pub fn mirror_corridor(r: f64, length: f64) -> Model {
    let p = DVec3::new;
    let mut model = Model::default();
    for y in [0.0, 1.0] {
        let floor = quad(p(-1.0, y, 1.0), p(length, y, 1.0), p(length, y, -1.0), p(-1.0, y, -1.0));
        model.add(mirror(r), floor);
    }
    let light = Material::light(Rgb::WHITE).expect("a finite radiance");
    let end = [p(length, 0.0, -1.0), p(length, 0.0, 1.0), p(length, 1.0, 1.0), p(length, 1.0, -1.0)];
    model.add(light, quad(end[0], end[1], end[2], end[3]));
    model
}

/// A light of radiance 1 from (x0, h, z0) to (x1, h, z1), facing down, above a floor of albedo
/// 0.5 at height 0.
pub fn rectangle_over_floor([x0, x1]: [f64; 2], [z0, z1]: [f64; 2], h: f64) -> Model {
    let p = DVec3::new;
    let mut model = Model::default();
    model.add(lambert(0.5), quad(p(-1.0, 0.0, 1.0), p(1.0, 0.0, 1.0), p(1.0, 0.0, -1.0), p(-1.0, 0.0, -1.0)));
    let light = Material::light(Rgb::WHITE).expect("a finite radiance");
    model.add(light, quad(p(x0, h, z0), p(x1, h, z0), p(x1, h, z1), p(x0, h, z1)));
    model
}

/// [`light_over_floor`] with a mirror of reflectance 0.9 at x = 1.5 that faces the light.
pub fn light_beside_mirror() -> Model {
    let p = DVec3::new;
    let mut model = light_over_floor();
    let wall = quad(p(1.5, 0.0, 3.0), p(1.5, 3.0, 3.0), p(1.5, 3.0, -3.0), p(1.5, 0.0, -3.0));
    model.add(mirror(0.9), wall);
    model
}

/// [`light_over_floor`] with a black sheet at height 0.7 that hides the half of the light at x > 0.
pub fn light_half_hidden() -> Model {
    let p = DVec3::new;
    let mut model = light_over_floor();
    let sheet = quad(p(0.0, 0.7, -3.0), p(3.0, 0.7, -3.0), p(3.0, 0.7, 3.0), p(0.0, 0.7, 3.0));
    model.add(lambert(0.0), sheet);
    model
}

/// A light of radiance 1, one unit wide and high, that stands on a floor of albedo 0.5 at
/// x = 0 and faces +x.
pub fn light_on_floor() -> Model {
    let p = DVec3::new;
    let mut model = Model::default();
    model.add(lambert(0.5), quad(p(-2.0, 0.0, 2.0), p(2.0, 0.0, 2.0), p(2.0, 0.0, -2.0), p(-2.0, 0.0, -2.0)));
    let light = Material::light(Rgb::WHITE).expect("a finite radiance");
    model.add(light, quad(p(0.0, 0.0, 0.5), p(0.0, 0.0, -0.5), p(0.0, 1.0, -0.5), p(0.0, 1.0, 0.5)));
    model
}

/// A regular polygon of `sides` sides in the unit circle around the y axis, at `height`,
/// its front down or up.
pub fn disc(height: f64, sides: u32, down: bool) -> Vec<Triangle> {
    let corner = |i: u32| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / f64::from(sides)).sin_cos();
        DVec3::new(cos, height, sin).as_vec3()
    };
    let center = DVec3::new(0.0, height, 0.0).as_vec3();
    let part = |i: u32| Triangle::new(center, corner(i), corner(i + 1));
    let fan = (0..sides).map(part);
    if down { fan.collect() } else { inside_out(fan) }
}

/// `light`, of radiance 1, above a floor of albedo 0.5 at height 0, `half` its half side.
pub fn light_above_floor(light: impl IntoIterator<Item = Triangle>, half: f64) -> Model {
    let mut model = Model::default();
    let (lo, hi) = (-half, half);
    let p = DVec3::new;
    model.add(lambert(0.5), quad(p(lo, 0.0, hi), p(hi, 0.0, hi), p(hi, 0.0, lo), p(lo, 0.0, lo)));
    model.add(Material::light(Rgb::WHITE).expect("a finite radiance"), light);
    model
}

/// Integrating sphere: an icosphere of `20 * 4^levels` triangles and albedo 0.6, seen from within. A connected
/// quarter of it emits radiance 4. In an exact sphere the reflected radiance is 1.5 everywhere.
pub fn integrating_sphere(levels: u32) -> Model {
    let mut walls = inside_out(icosphere(levels).triangles());
    let light = walls.split_off(walls.len() / 4 * 3);
    let mut model = Model::default();
    model.add(lambert(0.6), walls);
    model.add(lambert(0.6).emitting(glow(4.0)), light);
    model
}

/// A cube of albedo `rho` around the origin, its sides 2 long.
pub fn cube(rho: f64) -> Model {
    let mut model = Model::default();
    model.add(lambert(rho), cuboid(DVec3::ZERO, DVec3::ONE, 0.0));
    model
}
