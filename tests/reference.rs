//! The Cornell box beside pictures by an independent renderer (Mitsuba 3.9.1).

use globillum::geom::{KdOptions, KdTree};
use globillum::integrator::{Estimator, Scene, Settings, render};
use globillum_testkit::cornell;
use globillum_testkit::reference::{Blocks, Reference};
use globillum_testkit::stats::Z_LIMIT;

/// Largest relative error of the image mean.
const MEAN_LIMIT: f64 = 0.003;

fn check(reference: &str, specular: bool, max_bounces: Option<u32>, blocks: impl Fn(&Reference) -> &Blocks) {
    let reference = Reference::parse(reference);
    let model = cornell::with_blocks(specular).expect("the box is good");
    let scene = Scene::build(&model, |t| KdTree::build(t, &KdOptions::default())).expect("the box is good");
    for estimator in [Estimator::Light, Estimator::Mis] {
        let mut settings = Settings::new(reference.resolution, reference.resolution, 512);
        (settings.max_bounces, settings.estimator) = (max_bounces, estimator);
        let camera = cornell::camera().expect("the camera is good");
        let film = render(&scene, &camera, &settings, &()).expect("the box is good").film;
        let deviation = reference.deviation(&film, blocks(&reference));
        println!("{estimator:?}, bounces {max_bounces:?}, specular {specular}: {deviation:?}");
        assert!(deviation.largest_z < Z_LIMIT, "{estimator:?}: {deviation:?}");
        assert!(deviation.image_mean < MEAN_LIMIT, "{estimator:?}: {deviation:?}");
    }
}

const BOX: &str = include_str!("reference/box.json");
const BOX_MIRROR: &str = include_str!("reference/box_mirror.json");

#[test]
fn the_box_in_full_light() {
    check(BOX, false, None, |r| &r.path);
}

#[test]
fn the_box_in_direct_light() {
    check(BOX, false, Some(1), |r| &r.direct);
}

#[test]
fn the_box_with_a_mirror_in_full_light() {
    check(BOX_MIRROR, true, None, |r| &r.path);
}

#[test]
fn the_box_with_a_mirror_in_direct_light() {
    check(BOX_MIRROR, true, Some(1), |r| &r.direct);
}
