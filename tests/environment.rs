//! Path reuse of the environment: every pixel keeps its mean, in rooms with an opening and in the open, and varies less.
#![allow(clippy::print_stdout, reason = "figures for docs/estimators.md, with --nocapture")]

use glam::DVec3;
use globillum::geom::Accel;
use globillum::integrator::{
    Film, Guiding, Model, OrthographicCamera, PathReuse, PinholeCamera, Render, Sampler, Scene, Sensor,
    Settings, render, replay_samples,
};
use globillum::material::{Material, Rgb};
use globillum_testkit::accelerators::RENDERED;
use globillum_testkit::pixels::{PIXEL_LIMIT, largest_z};
use globillum_testkit::scenes;
use globillum_testkit::shapes::{cuboid, icosphere, inside_out, quad};

const SKY: Rgb = Rgb { r: 2.0, g: 3.0, b: 4.0 };

fn lambert(r: f64, g: f64, b: f64) -> Material {
    Material::lambert(Rgb::new(r, g, b)).expect("an albedo")
}

fn in_sky(model: &Model) -> Scene<Box<dyn Accel>> {
    scenes::scene_under(SKY, model, RENDERED[0].1)
}

fn mirror_ball(radius: f64, center: DVec3) -> (Material, Vec<globillum::geom::Triangle>) {
    let mirror = Material::mirror(Rgb::new(0.9, 0.8, 0.7)).expect("a reflectance");
    (mirror, icosphere(2).placed(radius, center).triangles())
}

/// A room whose window is half of one wall, perhaps with a mirror ball.
fn room(has_ball: bool) -> (Scene<Box<dyn Accel>>, PinholeCamera) {
    let p = DVec3::new;
    let mut model = Model::default();
    let mut walls = inside_out(cuboid(DVec3::ZERO, DVec3::ONE, 0.0));
    walls.remove(1);
    for (i, wall) in walls.into_iter().enumerate() {
        model.add(lambert(0.3 + 0.05 * i as f64, 0.5, 0.7), [wall]);
    }
    if has_ball {
        let (mirror, ball) = mirror_ball(0.3, p(0.3, -0.5, -0.4));
        model.add(mirror, ball);
    }
    let camera = PinholeCamera::look_at(p(0.9, 0.3, 0.9), p(0.0, -0.5, 0.0), DVec3::Y, 0.5);
    (in_sky(&model), camera.expect("they are apart"))
}

/// A floor with a block and a mirror ball.
fn plain() -> (Scene<Box<dyn Accel>>, PinholeCamera) {
    let p = DVec3::new;
    let mut model = Model::default();
    let floor = quad(p(-9.0, 0.0, 9.0), p(9.0, 0.0, 9.0), p(9.0, 0.0, -9.0), p(-9.0, 0.0, -9.0));
    model.add(lambert(0.8, 0.5, 0.3), floor);
    model.add(lambert(0.2, 0.6, 0.4), cuboid(p(0.6, 0.5, 0.0), p(0.3, 0.5, 0.3), 0.4));
    let (mirror, ball) = mirror_ball(0.6, p(-0.6, 0.7, 0.2));
    model.add(mirror, ball);
    let camera = PinholeCamera::look_at(p(0.3, 1.6, 3.0), p(0.0, 0.4, 0.0), DVec3::Y, 0.8);
    (in_sky(&model), camera.expect("they are apart"))
}

/// A picture of 16 x 16 pixels and 256 passes.
fn picture(
    (scene, camera): &(Scene<Box<dyn Accel>>, PinholeCamera),
    path_reuse: PathReuse,
    change: impl Fn(&mut Settings),
) -> Film {
    let mut settings = Settings::new(16, 16, 4096);
    (settings.path_reuse, settings.seed) = (path_reuse, path_reuse as u64);
    change(&mut settings);
    render(scene, camera, &settings).expect("the scene is good").film
}

/// Asserts that each pixel with path reuse has the same mean as `without`; the ratio of both variances.
fn variance_with_reuse(
    what: &str,
    view: &(Scene<Box<dyn Accel>>, PinholeCamera),
    without: &Film,
    change: impl Fn(&mut Settings),
) -> f64 {
    let with = picture(view, PathReuse::Tiles, change);
    let z = largest_z(without, &with);
    let [without, with] =
        [without, &with].map(|film| film.variances_of_mean().map(|variance| variance.g).sum::<f64>());
    println!("{what}: z {z:.2}, variance {:.3} of that without path reuse", with / without);
    assert!(z < PIXEL_LIMIT, "{what}: {z}");
    with / without
}

/// Both in a room, where what lies outside is shared, and in the open, where the environment is a control variate. Without
/// the one, the first ratio is about 0.86; without the other, the last is about 1.4.
#[test]
fn pixels_under_a_sky_keep_their_means_and_vary_less() {
    let views = [("room", room(false), 0.5), ("room with a ball", room(true), 1.0), ("plain", plain(), 1.0)];
    for (what, view, most) in views {
        let without = picture(&view, PathReuse::Off, |_| {});
        let ratio = variance_with_reuse(what, &view, &without, |_| {});
        assert!(ratio < most, "{what}: {ratio}");
        let independent = |s: &mut Settings| s.sampler = Sampler::Independent;
        variance_with_reuse(&format!("{what}, independent samples"), &view, &without, independent);
        let guided = |s: &mut Settings| s.guiding = Guiding::Trained;
        variance_with_reuse(&format!("{what}, guided"), &view, &without, guided);
        let short = |s: &mut Settings| s.max_bounces = Some(2);
        let without = picture(&view, PathReuse::Off, short);
        variance_with_reuse(&format!("{what}, at most 2 bounces"), &view, &without, short);
    }
}

/// A wall in the open, whose lower part is the end of a tunnel: the lowest sixteen rows of a picture of 64.
fn wall_and_tunnel() -> (Scene<Box<dyn Accel>>, OrthographicCamera) {
    let p = DVec3::new;
    let mut model = Model::default();
    let wall = quad(p(-1.0, -1.0, 0.0), p(1.0, -1.0, 0.0), p(1.0, 3.0, 0.0), p(-1.0, 3.0, 0.0));
    model.add(lambert(0.7, 0.6, 0.5), wall);
    let tunnel = inside_out(cuboid(p(0.0, -0.5, 1.5), p(0.5, 0.5, 1.5), 0.0));
    let in_front =
        |triangle: &globillum::geom::Triangle| triangle.vertices.iter().any(|vertex| vertex.z < 3.0);
    model.add(lambert(0.4, 0.8, 0.6), tunnel.into_iter().filter(in_front));
    let camera = OrthographicCamera::look_at(p(0.0, 1.0, 10.0), p(0.0, 1.0, 0.0), DVec3::Y, 4.0);
    (in_sky(&model), camera.expect("they are apart"))
}

/// A picture of eight columns has tiles of two squares, of which one lies in the open and one does not.
#[test]
fn squares_of_a_tile_have_the_bits_of_the_squares_alone() {
    let (scene, camera) = wall_and_tunnel();
    let settings = Settings::new(8, 64, 16);
    let whole = Render::new(&scene, &camera, &settings).run().expect("the scene is good").film;
    for rows in [16..48, 48..64] {
        let strip = Render::new(&scene, &camera, &settings).rows(rows.clone()).run();
        let strip = strip.expect("the scene is good").film;
        let places = rows.clone().flat_map(|y| (0..8).map(move |x| (x, y)));
        assert!(strip.means().eq(places.map(|(x, y)| whole.mean(x, y))), "{rows:?}");
    }
    for (x, y) in [(3, 20), (5, 40), (2, 55)] {
        let sensor: &dyn Sensor = &camera;
        let paths = replay_samples(&scene, sensor, &settings, (x, y), 0..16).expect("the samples exist");
        let sum = paths.iter().map(|path| path.radiance).sum::<Rgb>();
        assert_eq!(whole.mean(x, y), sum / 16.0, "{x}, {y}");
    }
}

/// A path that leaves the scene lists what it finds there.
#[test]
fn a_replay_tells_of_the_environment() {
    for (scene, camera) in [room(false), plain()] {
        let settings = Settings::new(16, 16, 64);
        let mut found = 0;
        let paths = replay_samples(&scene, &camera, &settings, (7, 9), 0..64).expect("the samples exist");
        for (sample, path) in paths.iter().enumerate() {
            let sum = path.vertices.iter().fold(path.environment, |sum, v| sum + v.emitted + v.direct);
            assert!((sum.g - path.alone.g).abs() <= 1e-15 * path.alone.g, "{sample}: {path}");
            let throughput = path.vertices.last().map_or(Rgb::WHITE, |v| v.throughput);
            // Neither roulette nor a limit ends a path at its first vertex.
            assert!(path.vertices.len() > 1 || !path.environment.is_black(), "{sample}: {path}");
            if !path.environment.is_black() {
                found += 1;
                assert!(path.environment.g <= throughput.g * SKY.g, "{sample}: {path}");
            }
        }
        assert!(found > 4, "{found}");
    }
}
