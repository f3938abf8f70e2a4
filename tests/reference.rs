//! The Cornell box beside pictures by an independent renderer (Mitsuba 3.9.1).

use globillum::geom::WideKdTree;
use globillum::integrator::{Scene, Settings, render};
use globillum_testkit::cornell;
use globillum_testkit::reference::Reference;

/// Largest distance of a block in standard errors: four pictures of 256 blocks and three channels
/// may raise a false alarm with probability 2e-5 together.
const Z_LIMIT: f64 = 5.85;

/// Largest relative error of the image mean.
const MEAN_LIMIT: f64 = 0.003;

fn check(reference: &str, specular: bool, max_bounces: Option<u32>, samples: u32) {
    let reference = Reference::parse(reference);
    let blocks = if max_bounces.is_some() { &reference.direct } else { &reference.path };
    let model = cornell::with_blocks(specular).expect("the box is good");
    let scene = Scene::build(&model, WideKdTree::build).expect("the box is good");
    let mut settings = Settings::new(reference.resolution, reference.resolution, samples);
    settings.max_bounces = max_bounces;
    let camera = cornell::camera().expect("the camera is good");
    let film = render(&scene, &camera, &settings, &()).expect("the box is good").film;
    let deviation = reference.deviation(&film, blocks);
    assert!(deviation.largest_z < Z_LIMIT, "{deviation:?}");
    assert!(deviation.image_mean < MEAN_LIMIT, "{deviation:?}");
}

const BOX: &str = include_str!("reference/box.json");
const BOX_MIRROR: &str = include_str!("reference/box_mirror.json");

#[test]
fn the_box_in_full_light() {
    check(BOX, false, None, 1024);
}

#[test]
fn the_box_in_direct_light() {
    check(BOX, false, Some(1), 1024);
}

#[test]
fn the_box_with_a_mirror_in_full_light() {
    // Light that a mirror throws is found rarely: fewer samples would not be nearly normal.
    check(BOX_MIRROR, true, None, 4096);
}

#[test]
fn the_box_with_a_mirror_in_direct_light() {
    check(BOX_MIRROR, true, Some(1), 1024);
}
