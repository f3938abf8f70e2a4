//! A replayed sample has the bits of the sample in the picture.

use glam::DVec3;
use globillum::geom::{Accel, Triangle};
use globillum::integrator::{
    Estimator, MirrorSampling, Model, PathReuse, PinholeCamera, PixelFilter, Replay, Sampler, Scene,
    Settings, render, replay, replay_samples,
};
use globillum::material::{Bsdf, Material, Rgb};
use globillum_testkit::accelerators::RENDERED;
use globillum_testkit::shapes::{quad, torus};
use globillum_testkit::{cornell, scenes};

fn the_box() -> Scene<Box<dyn Accel>> {
    scenes::scene(&cornell::with_blocks(true).expect("the box is good"), RENDERED[0].1)
}

/// All samples of a pixel of the box.
fn replays(scene: &Scene<Box<dyn Accel>>, settings: &Settings, pixel: (u32, u32)) -> Vec<Replay> {
    let camera = cornell::camera().expect("the camera is good");
    replay_samples(scene, &camera, settings, pixel, 0..settings.samples).expect("the samples exist")
}

#[test]
fn the_samples_of_a_pixel_add_up_to_it() {
    let (scene, camera) = (the_box(), cornell::camera().expect("the camera is good"));
    for sampler in [Sampler::Independent, Sampler::Sobol] {
        for (estimator, filter) in [
            (Estimator::Mis, PixelFilter::Box),
            (Estimator::Bsdf, PixelFilter::Tent),
            (Estimator::Light, PixelFilter::Box),
        ] {
            // The last pass is incomplete.
            let mut settings = Settings::new(20, 18, 11);
            (settings.sampler, settings.estimator, settings.filter) = (sampler, estimator, filter);
            (settings.pass_samples, settings.seed) = (8, 3);
            let film = render(&scene, &camera, &settings).expect("the scene is good").film;
            for (x, y) in [(0, 0), (10, 3), (13, 12), (19, 17)] {
                let replays = replays(&scene, &settings, (x, y));
                let sum = |of: &[Replay]| of.iter().map(|path| path.radiance).sum::<Rgb>();
                assert_eq!(
                    film.mean(x, y),
                    (sum(&replays[..8]) + sum(&replays[8..])) / 11.0,
                    "{sampler:?}, {estimator:?}, {x}, {y}"
                );
                let one = replay(&scene, &camera, &settings, (x, y), 7).expect("the sample exists");
                assert_eq!(one, replays[7]);
            }
        }
    }
}

#[test]
fn a_replay_lists_the_vertices_of_the_path() {
    let (scene, settings) = (the_box(), Settings::new(64, 64, 64));
    let (mut seen_mirror, mut seen_direct, mut seen_mirrored, mut seen_shared) = (false, false, false, false);
    for path in replays(&scene, &settings, (26, 40)) {
        let contributions =
            path.vertices.iter().fold(Rgb::BLACK, |sum, v| sum + v.emitted + v.direct + v.mirrored);
        assert!((contributions.g - path.alone.g).abs() <= 1e-15 * path.alone.g);
        seen_shared |= path.alone != path.radiance;
        assert_eq!(path.vertices[0].throughput, Rgb::WHITE);
        for pair in path.vertices.windows(2) {
            seen_mirror |= matches!(pair[0].material.bsdf, Bsdf::Mirror(_));
            seen_direct |= pair[0].direct.g > 0.0;
            seen_mirrored |= pair[0].mirrored.g > 0.0;
        }
        assert!(path.to_string().lines().count() > 2 * path.vertices.len());
    }
    assert!(seen_mirror && seen_direct && seen_mirrored && seen_shared);
}

#[test]
fn samples_outside_the_picture_are_refused() {
    let (scene, camera) = (the_box(), cornell::camera().expect("the camera is good"));
    let settings = Settings::new(4, 3, 2);
    for (pixel, sample, name) in [((4, 0), 0, "x"), ((0, 3), 0, "y"), ((3, 2), 2, "sample")] {
        let error = replay(&scene, &camera, &settings, pixel, sample).expect_err("there is no such sample");
        assert!(error.to_string().starts_with(name), "{error}");
    }
    let error = replay(&scene, &camera, &settings, (0, 0), u32::MAX).expect_err("there is no such sample");
    assert!(error.to_string().starts_with("sample"), "{error}");
    let of = |samples| replay_samples(&scene, &camera, &settings, (3, 2), samples);
    let error = of(1..3).expect_err("there is no sample 2");
    assert!(error.to_string().starts_with("sample = 2"), "{error}");
    assert_eq!(of(5..5), Ok(Vec::new()));
}

/// Two mirrors that face each other.
fn facing_mirrors() -> Vec<Triangle> {
    let p = DVec3::new;
    let wall = |x: f64| quad(p(x, 0.0, -1.0), p(x, 1.5, -1.0), p(x, 1.5, 1.0), p(x, 0.0, 1.0));
    [wall(-1.0), wall(1.0)].concat()
}

/// A floor among `mirrors`, under a small light and `ceiling`, and a camera that sees the floor.
fn floor_among(mirrors: Vec<Triangle>, ceiling: Vec<Triangle>) -> (Scene<Box<dyn Accel>>, PinholeCamera) {
    let p = DVec3::new;
    let mut model = Model::default();
    let floor = quad(p(-2.0, 0.0, 2.0), p(2.0, 0.0, 2.0), p(2.0, 0.0, -2.0), p(-2.0, 0.0, -2.0));
    model.add(Material::lambert(Rgb::new(0.8, 0.6, 0.0)).expect("an albedo"), floor);
    model.add(Material::lambert(Rgb::splat(0.7)).expect("an albedo"), ceiling);
    model.add(Material::mirror(Rgb::splat(0.9)).expect("a reflectance"), mirrors);
    let light = quad(p(-0.1, 2.0, -0.1), p(0.1, 2.0, -0.1), p(0.1, 2.0, 0.1), p(-0.1, 2.0, 0.1));
    model.add(Material::light(Rgb::splat(5.0)).expect("finite"), light);
    let camera =
        PinholeCamera::look_at(p(0.2, 1.9, 0.3), p(0.2, 0.0, 0.0), DVec3::Y, 0.3).expect("they are apart");
    (scenes::scene(&model, RENDERED[0].1), camera)
}

/// What arrives by way of two mirrors depends on the direction, so it is not reused. By way of one it is.
#[test]
fn path_reuse_keeps_the_radiance_of_two_mirrors() {
    let p = DVec3::new;
    let ceiling = quad(p(-2.0, 2.5, -2.0), p(2.0, 2.5, -2.0), p(2.0, 2.5, 2.0), p(-2.0, 2.5, 2.0));
    let (scene, camera) = floor_among(facing_mirrors(), ceiling.to_vec());
    let mut settings = Settings::new(16, 16, 1024);
    settings.sampler = Sampler::Independent;
    let [mut kept, mut shared] = [0, 0];
    for path in replay_samples(&scene, &camera, &settings, (5, 8), 0..1024).expect("the samples exist") {
        let mirrors =
            path.vertices.iter().skip(1).take_while(|vertex| vertex.material.bsdf.is_delta()).count();
        let end = path.vertices.get(1 + mirrors);
        if end.is_none_or(|end| !end.emitted.is_black()) {
            continue;
        }
        if mirrors > 1 {
            assert!(path.radiance.g >= path.alone.g * (1.0 - 1e-12), "{path}");
            kept += 1;
        }
        shared += u32::from(mirrors == 1 && path.radiance.g < path.alone.g * (1.0 - 1e-9));
    }
    assert!(kept > 3 && shared > 3, "{kept}, {shared}");
}

/// The picture is narrow, so a tile has several squares, in which pixels share caustics. Where mirrors are not sampled,
/// a torus shows the light. Where they are, samples find nearly all light by way of one mirror, and two that face each other
/// show it by way of both, which few paths find.
#[test]
fn shared_caustics_are_those_of_the_picture() {
    let ring = torus(48, 24).placed(1.0, DVec3::new(0.0, 0.3, 0.0)).triangles();
    for (mirrors, sampling, samples) in
        [(ring, MirrorSampling::Off, 16), (facing_mirrors(), MirrorSampling::Images, 64)]
    {
        let (scene, camera) = floor_among(mirrors, Vec::new());
        let mut settings = Settings::new(7, 40, samples);
        settings.pass_samples = samples;
        settings.mirror_sampling = sampling;
        let film = render(&scene, &camera, &settings).expect("the scene is good").film;
        let mut shared = 0;
        for (x, y) in (0..40).flat_map(|y| (0..7).map(move |x| (x, y))) {
            let mut sum = Rgb::BLACK;
            let paths = replay_samples(&scene, &camera, &settings, (x, y), 0..samples);
            for path in paths.expect("the samples exist") {
                sum += path.radiance;
                let mirrors =
                    path.vertices.iter().skip(1).take_while(|vertex| vertex.material.bsdf.is_delta());
                let end = path.vertices.get(mirrors.count() + 1);
                let caustic = end.is_some_and(|end| path.vertices.len() > 2 && !end.emitted.is_black());
                shared += u32::from(caustic && path.radiance.r < path.alone.r * (1.0 - 1e-9));
            }
            assert_eq!(film.mean(x, y), sum / f64::from(samples), "{sampling:?}: {x}, {y}");
        }
        assert!(shared > 0, "{sampling:?}: no caustic is shared");
    }
}

#[test]
fn without_path_reuse_a_path_has_the_whole_radiance_of_its_sample() {
    let scene = the_box();
    let mut settings = Settings::new(64, 64, 64);
    settings.path_reuse = PathReuse::Off;
    for path in replays(&scene, &settings, (26, 40)) {
        assert_eq!(path.alone, path.radiance);
    }
}
