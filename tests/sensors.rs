//! Sensors of one's own, and the cameras beside each other.

use glam::DVec3;
use globillum::geom::{Accel, Ray};
use globillum::integrator::{
    CheckpointError, CheckpointReader, CheckpointWriter, ElementSample, Estimates, IrradiancePoints, Merge,
    MergeError, OrthographicCamera, PathReuse, PathStart, Picture, PinholeCamera, Render, RenderError,
    Sampler, Scene, Sensor, Settings, SphericalCamera, render, replay_samples,
};
use globillum::material::Rgb;
use globillum_testkit::accelerators::RENDERED;
use globillum_testkit::stats::{Estimate, Z_LIMIT};
use globillum_testkit::{cornell, scenes};
use std::hash::Hasher;

fn the_box() -> Scene<Box<dyn Accel>> {
    scenes::scene(&cornell::with_blocks(true).expect("the box is good"), RENDERED[0].1)
}

/// A function as a sensor.
struct Starts<F>(F);

impl<F> std::fmt::Debug for Starts<F> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Starts")
    }
}

impl<F: Fn(&ElementSample) -> PathStart + Sync> Sensor for Starts<F> {
    fn start(&self, sample: &ElementSample) -> PathStart {
        (self.0)(sample)
    }

    fn hash(&self, key: &mut dyn Hasher) {
        key.write(b"a test's");
    }
}

/// Rays, points and nothing side by side, which share suffixes.
fn mixed() -> impl Sensor {
    let camera = cornell::camera().expect("the camera is good");
    Starts(move |sample: &ElementSample| match (sample.column + sample.row) % 3 {
        0 => PathStart::Ray(camera.ray(sample.x, sample.y, sample.aspect)),
        1 => PathStart::Irradiance {
            position: DVec3::new(0.9 * sample.x, 0.2, 0.9 * sample.y),
            normal: DVec3::Y,
        },
        _ => PathStart::Nowhere,
    })
}

#[test]
fn a_sensor_may_start_paths_in_any_way() {
    let (scene, sensor, camera) = (the_box(), mixed(), cornell::camera().expect("the camera is good"));
    let mut settings = Settings::new(24, 24, 256);
    settings.path_reuse = PathReuse::Off;
    let alone = render(&scene, &sensor, &settings).expect("all is good").film;
    let pixels = render(&scene, &camera, &settings).expect("all is good").film;
    settings.path_reuse = PathReuse::Tiles;
    let reused = render(&scene, &sensor, &settings).expect("all is good").film;
    let mut of_points = [0.0; 3];
    for (x, y) in (0..24).flat_map(|y| (0..24).map(move |x| (x, y))) {
        match (x + y) % 3 {
            0 => assert_eq!(alone.mean(x, y), pixels.mean(x, y), "a ray has the bits of the camera's"),
            1 => {
                of_points[0] += alone.mean(x, y).g;
                of_points[1] += reused.mean(x, y).g;
                of_points[2] += alone.variance_of_mean(x, y).g + 4.0 * reused.variance_of_mean(x, y).g;
            }
            _ => assert_eq!(alone.mean(x, y), Rgb::BLACK),
        }
    }
    let [alone, reused, variance] = of_points;
    let estimate = Estimate { mean: reused, std_err: variance.sqrt(), count: 1.0 };
    assert!(variance.sqrt() * Z_LIMIT < 0.02 * alone && estimate.z(alone).abs() < Z_LIMIT, "{of_points:?}");
}

#[test]
fn samples_of_any_start_are_replayed_to_the_bit() {
    let (scene, sensor) = (the_box(), mixed());
    for sampler in [Sampler::Sobol, Sampler::Independent] {
        let mut settings = Settings::new(8, 8, 8);
        (settings.sampler, settings.pass_samples) = (sampler, 8);
        let film = render(&scene, &sensor, &settings).expect("all is good").film;
        for (x, y) in (0..8).flat_map(|y| (0..8).map(move |x| (x, y))) {
            let paths = replay_samples(&scene, &sensor, &settings, (x, y), 0..8).expect("they exist");
            let sum = paths.iter().map(|path| path.radiance).sum::<Rgb>();
            assert_eq!(film.mean(x, y), sum / 8.0, "{x}, {y}");
            let path = &paths[0];
            let contributions =
                path.vertices.iter().fold(path.environment, |sum, v| sum + v.emitted + v.direct + v.mirrored);
            assert!((contributions.g - path.alone.g).abs() <= 1e-14 * path.alone.g);
            match (x + y) % 3 {
                0 => assert!(path.vertices.first().is_none_or(|v| v.triangle.is_some())),
                1 => {
                    assert_eq!(path.vertices[0].triangle, None);
                    assert_eq!(path.vertices[0].throughput, Rgb::splat(std::f64::consts::PI));
                }
                _ => assert!(path.vertices.is_empty()),
            }
        }
    }
}

#[test]
fn what_cannot_be_traced_is_an_error_that_names_the_element() {
    let scene = the_box();
    let nan = DVec3::splat(f64::NAN);
    let bad = [
        PathStart::Ray(Ray::new(nan, DVec3::X)),
        PathStart::Ray(Ray::new(DVec3::ZERO, DVec3::ZERO)),
        PathStart::Irradiance { position: nan, normal: DVec3::X },
        PathStart::Irradiance { position: 1e100 * DVec3::X, normal: DVec3::X },
        PathStart::Irradiance { position: DVec3::ZERO, normal: nan },
        PathStart::Irradiance { position: DVec3::ZERO, normal: DVec3::ZERO },
        PathStart::Irradiance { position: DVec3::ZERO, normal: 1.001 * DVec3::X },
    ];
    for start in bad {
        let sensor = Starts(|sample: &ElementSample| match (sample.column, sample.row) {
            (18, 3) => start,
            _ => PathStart::Nowhere,
        });
        let error = render(&scene, &sensor, &Settings::new(20, 20, 2)).expect_err("it is bad");
        assert_eq!(error, RenderError::NonFinite { x: 18, y: 3, sample: 0 });
    }
}

#[test]
fn sensors_have_keys_of_their_own() {
    let scene = the_box();
    let (eye, target, up) = (DVec3::Z, DVec3::ZERO, DVec3::Y);
    let sensors: [Box<dyn Sensor>; 7] = [
        Box::new(PinholeCamera::look_at(eye, target, up, 0.7).expect("good")),
        Box::new(PinholeCamera::look_at(eye, target, up, 0.8).expect("good")),
        Box::new(OrthographicCamera::look_at(eye, target, up, 2.0).expect("good")),
        Box::new(OrthographicCamera::look_at(eye, target, up, 3.0).expect("good")),
        Box::new(SphericalCamera::look_at(eye, target, up).expect("good")),
        Box::new(IrradiancePoints::new([(eye, up)]).expect("good")),
        Box::new(IrradiancePoints::new([(eye, -up)]).expect("good")),
    ];
    let settings = Settings::new(1, 1, 1);
    let mut keys = sensors.each_ref().map(|sensor| Render::new(&scene, &**sensor, &settings).key()).to_vec();
    keys.sort_unstable();
    keys.dedup();
    assert_eq!(keys.len(), 7);
}

#[test]
fn bad_cameras_are_refused() {
    let (eye, up) = (DVec3::Z, DVec3::Y);
    assert!(matches!(SphericalCamera::look_at(eye, eye, up), Err(RenderError::Camera(_))));
    assert!(matches!(OrthographicCamera::look_at(eye, DVec3::ZERO, eye, 1.0), Err(RenderError::Camera(_))));
    for height in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = OrthographicCamera::look_at(eye, DVec3::ZERO, up, height).expect_err("it is bad");
        assert!(matches!(error, RenderError::Param { name: "height", .. }));
    }
}

/// A picture put together from crops with these ends of columns and rows.
fn pasted(render: impl Fn() -> Render<'static>, columns: &[u32], rows: &[u32]) -> Estimates {
    let mut whole = Estimates::unknown(columns[columns.len() - 1], rows[rows.len() - 1]);
    for (x, y) in columns.windows(2).flat_map(|x| rows.windows(2).map(move |y| (x[0]..x[1], y[0]..y[1]))) {
        let film = render().crop(x.clone(), y.clone()).run().expect("all is good").film;
        assert_eq!((film.width(), film.height()), (x.end - x.start, y.end - y.start));
        assert_eq!((film.full_size(), film.origin()), ([whole.width, whole.height], [x.start, y.start]));
        whole.paste(&Estimates::of(&film));
    }
    whole
}

#[test]
fn nine_crops_have_the_bits_of_the_whole() {
    let scene: &'static Scene<_> = Box::leak(Box::new(the_box()));
    let camera: &'static PinholeCamera = Box::leak(Box::new(cornell::camera().expect("the camera is good")));
    for (path_reuse, columns, rows) in [
        (PathReuse::Tiles, [0, 16, 32, 53], [0, 16, 32, 46]),
        (PathReuse::Off, [0, 9, 26, 53], [0, 17, 18, 46]),
    ] {
        let mut settings = Settings::new(53, 46, 20);
        settings.path_reuse = path_reuse;
        let settings: &'static Settings = Box::leak(Box::new(settings));
        let whole = render(scene, camera, settings).expect("all is good").film;
        let mut pasted = pasted(|| Render::new(scene, camera, settings), &columns, &rows);
        let expected = Estimates::of(&whole);
        if path_reuse == PathReuse::Off {
            // Crops within a block of pixels do not know its error.
            assert!(pasted.block_errors != expected.block_errors);
            pasted.block_errors.clone_from(&expected.block_errors);
        }
        assert!(pasted == expected, "{path_reuse:?}");
    }
}

#[test]
fn crops_are_pictures_of_their_own() {
    let (scene, camera, settings) =
        (the_box(), cornell::camera().expect("the camera is good"), Settings::new(50, 60, 32));
    let render = || Render::new(&scene, &camera, &settings);
    let crop = || render().crop(16..50, 16..48);
    let whole = crop().run().expect("all is good");
    assert_eq!((whole.film.width(), whole.height), (34, 32));
    let strip = |rows: std::ops::Range<u32>| crop().rows(rows).run().expect("all is good").to_bytes();
    let (upper, lower) = (strip(0..16), strip(16..32));
    let readers = [&upper, &lower].map(|bytes| CheckpointReader::new(&bytes[..]).expect("good bytes"));
    let merge = Merge::new(readers.into()).expect("they are of one picture");
    let mut merged = CheckpointWriter::new(Vec::new(), merge.header()).expect("memory");
    merge.run(|rows| merged.write(rows)).expect("they fit");
    let merged = merged.finish().expect("memory");
    assert!(merged == whole.to_bytes());
    let read = Picture::from_bytes(&merged).expect("it is whole");
    assert_eq!((read.film.full_size(), read.film.origin()), ([50, 60], [16, 16]));
    let lower = Picture::from_bytes(&lower).expect("it is whole");
    assert_eq!(lower.film.origin(), [16, 32]);
    // The key is that of the crop, the pixels are others.
    let mut upper = render().crop(16..50, 0..32).run().expect("all is good");
    upper.key = crop().key();
    let bytes = [upper.to_bytes(), merged];
    let readers = bytes.each_ref().map(|bytes| CheckpointReader::new(&bytes[..]).expect("good bytes"));
    assert!(matches!(Merge::new(readers.into()), Err(MergeError::Input { index: 1, .. })));
    let error = crop().resume(upper).run().expect_err("it is of other pixels");
    assert!(matches!(error, RenderError::Checkpoint(CheckpointError::Mismatch("size"))), "{error}");
    assert_ne!(crop().key(), render().key());
    assert_ne!(crop().key(), render().crop(16..50, 32..48).key());
    for (columns, rows, refused) in [
        (0..50, 16..16, "rows of the crop 16..16 must be a range within 0..60"),
        (0..50, 16..64, "rows of the crop 16..64 must be a range within 0..60"),
        (0..50, 8..32, "rows of the crop 8..32 must be a range within 0..60"),
        (0..51, 16..32, "columns of the crop 0..51 must be a range within 0..50"),
        (16..26, 16..32, "columns of the crop 16..26 must be a range within 0..50"),
    ] {
        let error = render().crop(columns, rows).run().expect_err("it is bad").to_string();
        let ends = if refused.starts_with("rows") { 60 } else { 50 };
        let multiples = format!(", whose ends are multiples of 16 or {ends}");
        assert_eq!(error, format!("{refused} with at least one element{multiples}"));
    }
}
