//! Supersampling of lights: more camera rays where pixels see the edge of a light.

use glam::{DVec2, DVec3};
use globillum::geom::{Accel, Triangle};
use globillum::integrator::{
    ElementSample, Film, Model, OrthographicCamera, PathReuse, PathStart, PinholeCamera, PixelFilter, Render,
    Sampler, Scene, Sensor, Settings, SphericalCamera, Supersampling, render,
};
use globillum::material::{Material, Rgb};
use globillum_testkit::accelerators::ACCELERATORS;
use globillum_testkit::shapes::{icosphere, quad};
use globillum_testkit::stats::{Estimate, Z_LIMIT, independent_pixels};
use globillum_testkit::{cornell, scenes};
use std::hash::Hasher;

const RADIANCE: f64 = 3.0;
const REFLECTANCE: f64 = 0.9;

fn scene(model: &Model) -> Scene<Box<dyn Accel>> {
    scenes::scene(model, ACCELERATORS[3].1)
}

fn film(scene: &Scene<Box<dyn Accel>>, camera: &dyn Sensor, settings: &Settings) -> Film {
    render(scene, camera, settings).expect("the scene is good").film
}

/// A rectangle in the plane at `z` whose right edge leans: `x` is `0.1 + 0.3 y` there. It faces the camera.
fn leaning(z: f64) -> [Triangle; 2] {
    let p = |x: f64, y: f64| DVec3::new(x, y, z);
    quad(p(-2.0, -2.0), p(-0.5, -2.0), p(0.7, 2.0), p(-2.0, 2.0))
}

fn light(triangles: impl IntoIterator<Item = Triangle>) -> Model {
    let mut model = Model::default();
    model.add(Material::light(Rgb::splat(RADIANCE)).expect("it is in range"), triangles);
    model
}

fn mirror() -> Material {
    Material::mirror(Rgb::splat(REFLECTANCE)).expect("it is in range")
}

/// A light's edge passes through every pixel, which are as wide as the picture. Of each, the light covers a trapezoid.
/// In the second scene the camera sees this in a mirror.
#[test]
fn an_edge_divides_pixels_by_area() {
    let look = |toward| OrthographicCamera::look_at(DVec3::ZERO, toward, DVec3::Y, 2.0).expect("it is good");
    let flipped = leaning(2.0).map(|Triangle { vertices: [a, b, c], .. }| Triangle::new(a, c, b));
    let mut mirrored = light(flipped);
    let p = |x: f64, y: f64| DVec3::new(x, y, -1.0);
    mirrored.add(mirror(), quad(p(-9.0, -9.0), p(9.0, -9.0), p(9.0, 9.0), p(-9.0, 9.0)));
    for (what, model, reflectance) in
        [("seen", light(leaning(-1.0)), 1.0), ("mirrored", mirrored, REFLECTANCE)]
    {
        let scene = scene(&model);
        for (sampler, precision) in [(Sampler::Sobol, 0.005), (Sampler::Independent, 0.02)] {
            // 256 passes: for as many, Student's distribution is about the normal one.
            let mut settings = independent_pixels(1, 8, if sampler == Sampler::Sobol { 1024 } else { 256 });
            (settings.sampler, settings.pass_samples) = (sampler, settings.samples / 256);
            // Pixels are not square: the camera's view is an eighth as wide as it is high.
            let film = film(&scene, &Stretched(look(-DVec3::Z)), &settings);
            for row in 0..8 {
                let middle = 1.0 - (f64::from(row) + 0.5) / 4.0;
                let truth = reflectance * RADIANCE * (1.0 + 0.1 + 0.3 * middle) / 2.0;
                let std_err = film.variance_of_mean(0, row).g.sqrt();
                let z = (film.mean(0, row).g - truth) / std_err;
                assert!(
                    z.abs() < Z_LIMIT && std_err < precision * truth,
                    "{what}, {sampler:?}, {row}: z = {z}"
                );
            }
        }
    }
}

/// A camera of square view, whatever the size of the picture.
#[derive(Debug)]
struct Stretched(OrthographicCamera);

impl Sensor for Stretched {
    fn start(&self, sample: &ElementSample) -> PathStart {
        PathStart::Ray(self.0.ray(sample.x, sample.y, 1.0))
    }

    fn hash(&self, key: &mut dyn Hasher) {
        key.write(b"stretched");
        self.0.hash(key);
    }
}

/// Two mirrors that face each other, a floor, a mirror ball and a light, seen along the mirrors.
fn between_mirrors() -> Model {
    let p = DVec3::new;
    let mut model = light(quad(p(-0.3, 0.4, -2.0), p(0.3, 0.4, -2.0), p(0.3, 0.8, -2.0), p(-0.3, 0.8, -2.0)));
    for x in [-0.5, 0.5] {
        model.add(mirror(), quad(p(x, -1.0, 3.0), p(x, -1.0, -3.0), p(x, 2.0, -3.0), p(x, 2.0, 3.0)));
    }
    model.add(mirror(), icosphere(1).placed(0.2, p(0.1, 0.0, -1.0)).triangles());
    let floor = quad(p(-0.5, -0.5, 3.0), p(0.5, -0.5, 3.0), p(0.5, -0.5, -3.0), p(-0.5, -0.5, -3.0));
    model.add(Material::lambert(Rgb::splat(0.5)).expect("it is in range"), floor);
    model
}

/// The nearer `z` is to 1.5, the more mirrors are between the camera and the light.
fn between_mirrors_camera(z: f64) -> PinholeCamera {
    let eye = DVec3::new(-0.2, 0.5, 1.5);
    PinholeCamera::look_at(eye, DVec3::new(0.5, 0.4, z), DVec3::Y, 0.9).expect("the camera is good")
}

/// Small lamps that face downward, one in four of them a long one. In pictures of 37 x 29 pixels the pinhole camera sees them
/// with 1/1900 to 1/39 of the area of a pixel.
fn small_lamps() -> Vec<[Triangle; 2]> {
    let lamp = |k: u32| {
        let [x, y, z] = [0.755, 0.57, 0.431].map(|step| 2.0 * (f64::from(k) * step).fract() - 1.0);
        let half = [if k.is_multiple_of(4) { 0.1 } else { 0.004 }, 0.004];
        let corner = |i: f64, j: f64| DVec3::new(x + i * half[0], 0.4 * y, z + j * half[1]);
        quad(corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0))
    };
    (0..60).map(lamp).collect()
}

/// Whether a lamp is none of the long ones.
fn is_square([triangle, _]: &[Triangle; 2]) -> bool {
    triangle.area() < 1e-4
}

/// Sees the lamps from a little below.
fn small_lamps_eye() -> DVec3 {
    DVec3::new(0.2, -0.45, 4.0)
}

fn small_lamps_camera() -> PinholeCamera {
    PinholeCamera::look_at(small_lamps_eye(), DVec3::ZERO, DVec3::Y, 0.6).expect("the camera is good")
}

/// A camera that does not tell where it sees a point.
#[derive(Debug)]
struct Unprojected(PinholeCamera);

impl Sensor for Unprojected {
    fn start(&self, sample: &ElementSample) -> PathStart {
        self.0.start(sample)
    }

    fn hash(&self, key: &mut dyn Hasher) {
        key.write(b"unprojected");
        self.0.hash(key);
    }
}

/// Parallel rays show each lamp with its area times the cosine, as no lamp hides another.
#[test]
fn small_lamps_are_seen_with_their_area() {
    let scene = scene(&light(small_lamps().into_iter().flatten()));
    let forward = DVec3::new(0.1, 0.3, -1.0).normalize();
    let camera = OrthographicCamera::look_at(-4.0 * forward, DVec3::ZERO, DVec3::Y, 4.0).expect("it is good");
    let area: f64 = small_lamps().iter().flatten().map(|triangle| triangle.area()).sum();
    let truth = RADIANCE * area * forward.y / (4.0 * 4.0 * 37.0 / 29.0);
    for (sampler, precision) in [(Sampler::Sobol, 0.01), (Sampler::Independent, 0.02)] {
        let mut settings = Settings::new(37, 29, 1024);
        settings.sampler = sampler;
        let estimate = Estimate::of_film(&film(&scene, &camera, &settings), |c| c.g);
        let z = (estimate.mean - truth) / estimate.std_err;
        assert!(
            z.abs() < Z_LIMIT && estimate.std_err < precision * truth,
            "{sampler:?}: {estimate:?}, {truth}"
        );
    }
}

/// A grid of probes misses most of these lamps.
#[test]
fn lamps_that_are_smaller_than_the_distance_between_probes_are_supersampled() {
    let scene = scene(&light(small_lamps().into_iter().filter(is_square).flatten()));
    let variance = |camera: &dyn Sensor, supersampling| {
        let mut settings = Settings::new(37, 29, 64);
        (settings.supersampling, settings.max_bounces) = (supersampling, Some(0));
        film(&scene, camera, &settings).variances_of_mean().map(|v| v.g).sum::<f64>()
    };
    let ratio =
        |camera: &dyn Sensor| variance(camera, Supersampling::Lights) / variance(camera, Supersampling::Off);
    let (eye, target) = (small_lamps_eye(), DVec3::new(0.0, -0.1, 0.0));
    let parallel = OrthographicCamera::look_at(eye, target, DVec3::Y, 2.0).expect("it is good");
    let around =
        SphericalCamera::look_at(DVec3::new(0.0, -0.45, 0.0), DVec3::Z, DVec3::Y).expect("it is good");
    let ratios = [&small_lamps_camera() as &dyn Sensor, &parallel, &around].map(ratio);
    assert!(ratios.iter().all(|&ratio| ratio < 0.1), "{ratios:?}");
    let unprojected = ratio(&Unprojected(small_lamps_camera()));
    assert!(unprojected > 0.5, "{unprojected}");
}

/// Needles of half a picture's length and up to a twentieth of a pixel's width, of which the grid of probes finds a part.
#[test]
fn long_thin_lamps_are_supersampled_from_end_to_end() {
    let p = DVec3::new;
    let needle = |k: u32| {
        let (sin, cos) = (0.3 + f64::from(k)).sin_cos();
        let (along, aside) = (p(cos, sin, 0.0), 0.001 * p(-sin, cos, 0.0));
        Triangle::new((0.1 * along + aside).as_vec3(), (0.1 * along - aside).as_vec3(), along.as_vec3())
    };
    let scene = scene(&light((0..6).map(needle)));
    let camera = OrthographicCamera::look_at(DVec3::Z, DVec3::ZERO, DVec3::Y, 2.0).expect("it is good");
    let variance = |camera: &dyn Sensor, supersampling| {
        let mut settings = Settings::new(48, 48, 64);
        settings.supersampling = supersampling;
        film(&scene, camera, &settings).variances_of_mean().map(|v| v.g).sum::<f64>()
    };
    let [on, off] = [Supersampling::Lights, Supersampling::Off].map(|mode| variance(&camera, mode));
    assert!(on < 0.05 * off, "{on} and {off}");
}

/// A strip in the middle of a ceiling, from behind the camera far to the front.
#[test]
fn a_strip_that_passes_the_camera_is_supersampled() {
    let p = |x: f64, z: f64| DVec3::new(x, 0.05, z);
    let scene = scene(&light(quad(p(-2e-4, -20.0), p(2e-4, -20.0), p(2e-4, 3.0), p(-2e-4, 3.0))));
    let camera = PinholeCamera::look_at(DVec3::ZERO, -DVec3::Z, DVec3::Y, 1.0).expect("it is good");
    let variance = |supersampling| {
        let mut settings = Settings::new(47, 47, 64);
        settings.supersampling = supersampling;
        let film = film(&scene, &camera, &settings);
        // At the top the strip is wide enough for the grid of probes.
        (0..47)
            .flat_map(|x| (10..47).map(move |y| (x, y)))
            .map(|(x, y)| film.variance_of_mean(x, y).g)
            .sum::<f64>()
    };
    let (on, off) = (variance(Supersampling::Lights), variance(Supersampling::Off));
    assert!(on < 0.05 * off, "{on} and {off}");
}

/// The cameras find the place of what they show at a place.
#[test]
fn cameras_project_points_to_where_they_show_them() {
    let (eye, target, up) =
        (DVec3::new(1.0, -2.0, 3.0), DVec3::new(-4.0, 0.5, 1.0), DVec3::new(0.1, 1.0, 0.2));
    let pinhole = PinholeCamera::look_at(eye, target, up, 1.1).expect("it is good");
    let parallel = OrthographicCamera::look_at(eye, target, up, 7.0).expect("it is good");
    let around = SphericalCamera::look_at(eye, target, up).expect("it is good");
    for camera in [&pinhole as &dyn Sensor, &parallel, &around] {
        for (column, row) in (0..23).flat_map(|column| (0..17).map(move |row| (column, row))) {
            let sample = ElementSample::new((column, row), [0.3, 0.9], [23, 17]);
            let PathStart::Ray(ray) = camera.start(&sample) else { panic!("{sample:?} has no ray") };
            for distance in [1e-3, 0.7, 1e4] {
                let position = camera.project(ray.at(distance), sample.aspect).expect("it is in front");
                let error = position.distance(DVec2::new(sample.x, sample.y));
                assert!(error < 1e-10, "{camera:?}, {sample:?}: {position}");
            }
        }
    }
    let behind = eye - (target - eye);
    assert_eq!([pinhole.project(behind, 1.0), parallel.project(behind, 1.0)], [None; 2]);
}

/// Directly seen, in mirrors that face each other, with more reflections than supersampling follows, and in a ball; with
/// limits on bounces, in pictures of odd sizes.
#[test]
fn supersampling_changes_no_mean() {
    let cornell = (cornell::with_blocks(true).expect("it is good"), cornell::camera().expect("it is good"));
    let mirrors = (between_mirrors(), between_mirrors_camera(0.4));
    let many = (between_mirrors(), between_mirrors_camera(1.2));
    let cases = [
        ("the box", &cornell, Sampler::Sobol, PathReuse::Tiles, PixelFilter::Tent, None),
        ("the box without bounces", &cornell, Sampler::Sobol, PathReuse::Off, PixelFilter::Box, Some(0)),
        ("the box and one bounce", &cornell, Sampler::Sobol, PathReuse::Tiles, PixelFilter::Box, Some(1)),
        ("mirrors", &mirrors, Sampler::Sobol, PathReuse::Tiles, PixelFilter::Box, None),
        (
            "mirrors and two bounces",
            &mirrors,
            Sampler::Independent,
            PathReuse::Off,
            PixelFilter::Tent,
            Some(2),
        ),
        ("mirrors and eleven bounces", &many, Sampler::Sobol, PathReuse::Off, PixelFilter::Box, Some(11)),
    ];
    for (what, (model, camera), sampler, path_reuse, filter, max_bounces) in cases {
        let scene = scene(model);
        let estimate = |supersampling, seed, samples| {
            let mut settings = Settings::new(37, 29, samples);
            (settings.sampler, settings.path_reuse, settings.filter) = (sampler, path_reuse, filter);
            (settings.supersampling, settings.max_bounces, settings.seed) =
                (supersampling, max_bounces, seed);
            Estimate::of_film(&film(&scene, camera, &settings), |c| c.g)
        };
        let (on, off) = (estimate(Supersampling::Lights, 1, 192), estimate(Supersampling::Off, 2, 1024));
        off.assert_agrees(&on, 0.04, what);
    }
}

/// Supersampling follows eight reflections, and the picture has light from more.
#[test]
fn more_reflections_than_are_followed_are_seen() {
    let (scene, camera) = (scene(&between_mirrors()), between_mirrors_camera(1.2));
    let mean = |max_bounces| {
        let mut settings = Settings::new(37, 29, 64);
        settings.max_bounces = Some(max_bounces);
        film(&scene, &camera, &settings).image_mean().g
    };
    let [more, followed] = [mean(11), mean(8)];
    assert!(more > 1.02 * followed, "{more}, {followed}");
}

/// In the box most of the variance is at the light's edge.
#[test]
fn the_variance_falls_where_lights_have_edges() {
    let scene = scene(&cornell::with_blocks(false).expect("it is good"));
    let camera = cornell::camera().expect("it is good");
    let variance = |supersampling| {
        let mut settings = Settings::new(64, 64, 64);
        settings.supersampling = supersampling;
        let film = film(&scene, &camera, &settings);
        film.variances_of_mean().map(|v| v.g).sum::<f64>()
    };
    let (on, off) = (variance(Supersampling::Lights), variance(Supersampling::Off));
    assert!(on < 0.3 * off, "{on} and {off}");
}

#[test]
fn crops_strips_and_passes_have_the_bits_of_the_picture() {
    let (cornell, camera) = (cornell::with_blocks(true), cornell::camera());
    let cornell = (cornell.expect("it is good"), camera.expect("it is good"));
    let lamps = (light(small_lamps().into_iter().flatten()), small_lamps_camera());
    for (model, camera) in [cornell, lamps] {
        let scene = scene(&model);
        let mut settings = Settings::new(40, 36, 8);
        settings.pass_samples = 2;
        let whole = film(&scene, &camera, &settings);
        settings.threads = 1;
        // The light of the box is between the columns 15 and 25 and above row 6.
        for (columns, rows) in [(16..32, 0..16), (0..16, 16..32), (0..40, 0..36)] {
            let crop = Render::new(&scene, &camera, &settings).crop(columns.clone(), rows.clone()).run();
            let crop = crop.expect("it is good").film;
            for (x, y) in rows.clone().flat_map(|y| columns.clone().map(move |x| (x, y))) {
                assert_eq!(crop.mean(x - columns.start, y - rows.start), whole.mean(x, y), "{x}, {y}");
            }
        }
        let strip = Render::new(&scene, &camera, &settings).rows(0..16).run().expect("it is good").film;
        assert!((0..16).all(|y| (0..40).all(|x| strip.mean(x, y) == whole.mean(x, y))));
    }
}

/// Elements that are no neighbours, and a scene without lights, have one ray per sample.
#[test]
fn without_neighbours_or_lights_nothing_is_supersampled() {
    #[derive(Debug)]
    struct Apart(PinholeCamera);

    impl Sensor for Apart {
        fn has_neighbours(&self) -> bool {
            false
        }

        fn start(&self, sample: &ElementSample) -> PathStart {
            self.0.start(sample)
        }

        fn hash(&self, key: &mut dyn Hasher) {
            key.write(b"apart");
        }
    }

    let camera = cornell::camera().expect("it is good");
    let rays = |scene: &Scene<Box<dyn Accel>>, sensor: &dyn Sensor| {
        let picture = render(scene, sensor, &Settings::new(24, 24, 1)).expect("it is good");
        picture.counters.camera_rays
    };
    let scene_with = scene(&cornell::with_blocks(false).expect("it is good"));
    assert_eq!(rays(&scene_with, &Apart(camera)), 24 * 24);
    assert!(rays(&scene_with, &camera) > 24 * 24);
    let mut dark = Model::default();
    dark.add(mirror(), leaning(-1.0));
    dark.set_environment(Rgb::WHITE).expect("it is in range");
    let dark = scene(&dark);
    assert_eq!(rays(&dark, &camera), 24 * 24);
}
