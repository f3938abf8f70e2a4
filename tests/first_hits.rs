//! The buffers of the first hit of every pixel.

use glam::{DVec3, Vec3};
use globillum::geom::Triangle;
use globillum::integrator::{FirstHit, FirstHits, Model, PinholeCamera, RenderError, Settings};
use globillum::material::{Material, Rgb};
use globillum_testkit::accelerators::ACCELERATORS;
use globillum_testkit::{cornell, scenes};

const GREY: Rgb = Rgb::splat(0.5);

/// A wall at depth 2 that fills a picture of 8 x 8 pixels to the right of `left`, in pixels. Its front is turned
/// away from the camera.
fn wall(left: f64) -> FirstHits {
    let [x, far] = [(left / 4.0 - 1.0) as f32, 9.0];
    let corners = [(x, -far), (x, far), (far, far), (far, -far)].map(|(x, y)| Vec3::new(2.0 * x, y, -2.0));
    let [a, b, c, d] = corners;
    let mut model = Model::default();
    model.add(Material::light(Rgb::WHITE).unwrap(), []);
    model.add(Material::lambert(GREY).unwrap(), Triangle::quad(a, b, c, d));
    let scene = scenes::scene(&model, ACCELERATORS[0].1);
    // A field of view of 90 degrees: half the picture is as wide as it is far.
    let camera =
        PinholeCamera::look_at(DVec3::ZERO, -DVec3::Z, DVec3::Y, std::f64::consts::FRAC_PI_2).unwrap();
    FirstHits::of(&scene, &camera, &Settings::new(8, 8, 1)).unwrap()
}

#[test]
fn a_wall_has_one_depth_and_faces_the_camera() {
    for hit in wall(-1.0).pixels {
        assert!((hit.depth - 2.0).abs() < 1e-12 && (hit.normal - DVec3::Z).length() < 1e-12, "{hit:?}");
        assert!((hit.albedo.g - 0.5).abs() < 1e-12 && hit.triangle.is_some_and(|index| index < 2), "{hit:?}");
        assert_eq!(hit.material, Some(1));
    }
}

#[test]
fn means_are_those_of_the_pixels_square_and_indices_those_of_its_center() {
    for (left, covered) in [(2.25, 0.75), (2.75, 0.25)] {
        let hits = wall(left);
        assert_eq!(hits.pixels[8 + 1], FirstHit::NOTHING, "the wall begins in the next pixel");
        let hit = hits.pixels[8 + 2];
        assert!((hit.depth - 2.0).abs() < 1e-12, "{hit:?}");
        assert!(
            (hit.normal.z - covered).abs() < 1e-12 && (hit.albedo.r - 0.5 * covered).abs() < 1e-12,
            "{hit:?}"
        );
        assert_eq!((hit.triangle.is_some(), hit.material), (covered > 0.5, (covered > 0.5).then_some(1)));
    }
}

#[test]
fn accelerators_and_threads_change_no_bit() {
    let camera = cornell::camera().unwrap();
    let mut first = None;
    for (name, build) in ACCELERATORS {
        let scene = scenes::scene(&cornell::with_blocks(true).unwrap(), build);
        for threads in [1, 3] {
            let mut settings = Settings::new(37, 20, 1);
            settings.threads = threads;
            let hits = FirstHits::of(&scene, &camera, &settings).unwrap();
            assert_eq!(*first.get_or_insert_with(|| hits.clone()), hits, "{name}, {threads} threads");
        }
    }
    let scene = scenes::scene(&cornell::with_blocks(false).unwrap(), ACCELERATORS[0].1);
    let error = FirstHits::of(&scene, &camera, &Settings::new(0, 8, 1));
    assert!(matches!(error, Err(RenderError::Param { name: "width", .. })), "{error:?}");
}
