//! Compares the Cornell box with pictures by an independent renderer (Mitsuba 3.9.1).

use globillum::integrator::{Estimator, PathReuse, Settings, render};
use globillum_testkit::accelerators::RENDERED;
use globillum_testkit::reference::{Deviation, MEAN_LIMIT, Reference};
use globillum_testkit::stats::Z_LIMIT;
use globillum_testkit::{cornell, scenes};

use Estimator::{Bsdf, Light, Mis};
use PathReuse::{Off, Tiles};

/// The deviation of the box from `reference`. Asserts that its mean is within [`MEAN_LIMIT`].
fn deviation(
    reference: &str,
    specular: bool,
    (estimator, path_reuse): (Estimator, PathReuse),
    max_bounces: Option<u32>,
    samples: u32,
) -> Deviation {
    let reference = Reference::parse(reference);
    let blocks = if max_bounces.is_some() { &reference.direct } else { &reference.path };
    let model = cornell::with_blocks(specular).expect("the box is good");
    let scene = scenes::scene(&model, RENDERED[0].1);
    let mut settings = Settings::new(reference.resolution, reference.resolution, samples);
    (settings.estimator, settings.path_reuse, settings.max_bounces) = (estimator, path_reuse, max_bounces);
    let camera = cornell::camera().expect("the camera is good");
    let film = render(&scene, &camera, &settings).expect("the box is good").film;
    let deviation = reference.deviation(&film, blocks);
    assert!(deviation.image_mean < MEAN_LIMIT, "{deviation:?}");
    deviation
}

/// Asserts the deviation in terms of the film's own error estimate, which is reliable where lights are sampled.
fn check(
    reference: &str,
    specular: bool,
    how: (Estimator, PathReuse),
    max_bounces: Option<u32>,
    samples: u32,
) {
    let deviation = deviation(reference, specular, how, max_bounces, samples);
    assert!(deviation.largest_z_by_film < Z_LIMIT, "{deviation:?}");
}

const BOX: &str = include_str!("reference/box.json");
const BOX_MIRROR: &str = include_str!("reference/box_mirror.json");

#[test]
fn the_box_in_global_illumination() {
    for path_reuse in [Off, Tiles] {
        check(BOX, false, (Mis, path_reuse), None, 256);
    }
}

#[test]
fn the_box_in_direct_illumination() {
    check(BOX, false, (Mis, Off), Some(1), 1024);
}

#[test]
fn the_box_with_a_mirror_in_global_illumination() {
    for how in [(Light, Off), (Mis, Off), (Mis, Tiles)] {
        check(BOX_MIRROR, true, how, None, 256);
    }
    // BSDF sampling hits the light rarely, especially by way of a mirror. Means of fewer samples would not be
    // nearly normal.
    let scattered = deviation(BOX_MIRROR, true, (Bsdf, Off), None, 2048);
    assert!(scattered.largest_z < Z_LIMIT, "{scattered:?}");
}

#[test]
fn the_box_with_a_mirror_in_direct_illumination() {
    check(BOX_MIRROR, true, (Mis, Off), Some(1), 1024);
}
