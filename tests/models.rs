//! Models and cameras: bounds, transforms, and what is refused.

use glam::{DAffine3, DMat3, DVec3, Vec3};
use globillum::geom::{Aabb, GeomError, Triangle};
use globillum::integrator::{DeltaLight, DeltaLightError, Model, PinholeCamera, RenderError};
use globillum::material::{Material, Rgb};
use globillum_testkit::accelerators::RENDERED;
use globillum_testkit::scenes;
use std::f64::consts::FRAC_PI_2;

fn model() -> Model {
    let mut model = Model::default();
    let grey = Material::lambert(Rgb::splat(0.5)).unwrap();
    model.add(grey, [Triangle::new(Vec3::ZERO, Vec3::X, Vec3::Y)]);
    model.add(grey, [Triangle::new(Vec3::Z, Vec3::new(0.0, 3.0, 1.0), Vec3::new(-2.0, 0.0, 1.0))]);
    model
}

fn model_with(lights: impl IntoIterator<Item = DeltaLight>) -> Model {
    let mut model = model();
    lights.into_iter().for_each(|light| model.add_delta_light(light));
    model
}

#[test]
fn bounds_hold_all_vertices() {
    assert_eq!(model().bounds(), Aabb { min: Vec3::new(-2.0, 0.0, 0.0), max: Vec3::new(1.0, 3.0, 1.0) });
    assert!(Model::default().bounds().is_empty());
}

/// A normal goes through the inverse transpose; a mirrored one must come out on the same side.
#[test]
fn fronts_stay_where_they_were() {
    let turn = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.8);
    for scale in [DVec3::ONE, DVec3::new(-1.0, 1.0, 1.0), DVec3::new(2.0, -3.0, 0.5), DVec3::splat(-1.5)] {
        let matrix3 = turn * DMat3::from_diagonal(scale);
        let mut moved = model();
        moved.transform(&DAffine3 { matrix3, translation: DVec3::new(5.0, -1.0, 2.0) }).unwrap();
        let normals = matrix3.inverse().transpose();
        for (before, after) in model().triangles().iter().zip(moved.triangles()) {
            let expected = (normals * before.normal()).normalize();
            assert!((after.normal() - expected).length() < 1e-6, "{scale}");
        }
    }
}

#[test]
fn delta_lights_move_with_the_triangles() {
    let value = Rgb::splat(2.0);
    let lights = |position: Vec3, direction: Vec3| {
        [
            DeltaLight::point(position, value),
            DeltaLight::spot(position, direction, value, 0.2, 0.4),
            DeltaLight::directional(direction, value),
        ]
        .map(Result::unwrap)
    };
    let mut moved = model_with(lights(Vec3::new(1.0, 2.0, 3.0), Vec3::X));
    assert_eq!(moved.bounds(), model().bounds());
    // Mirrors x, doubles lengths, then turns x to y.
    let turn = DMat3::from_cols(DVec3::Y, DVec3::NEG_X, DVec3::Z);
    let matrix3 = turn * DMat3::from_diagonal(DVec3::new(-2.0, 2.0, 2.0));
    moved.transform(&DAffine3 { matrix3, translation: DVec3::new(0.0, 0.0, 1.0) }).unwrap();
    assert_eq!(moved.delta_lights(), lights(Vec3::new(-4.0, -2.0, 7.0), Vec3::NEG_Y));
    let mut both = model();
    both.append(&moved);
    assert_eq!(both.delta_lights(), moved.delta_lights());
}

#[test]
fn the_environment_is_that_of_the_model() {
    let (sky, other) = (Rgb::new(1.0, 2.0, 3.0), Rgb::splat(4.0));
    let mut under_a_sky = model();
    assert_eq!(under_a_sky.environment(), Rgb::BLACK);
    under_a_sky.set_environment(sky).unwrap();
    let mut appended = model();
    appended.set_environment(other).unwrap();
    under_a_sky.append(&appended);
    under_a_sky.transform(&DAffine3::from_scale(DVec3::splat(2.0))).unwrap();
    assert_eq!(under_a_sky.environment(), sky);
    assert_eq!(scenes::scene(&under_a_sky, RENDERED[0].1).environment(), sky);
}

/// The error names the first triangle or the delta light, and the model is unchanged.
#[test]
fn a_transform_out_of_the_domain_is_refused() {
    let far = DeltaLight::point(Vec3::splat(1e17), Rgb::WHITE).unwrap();
    let sun = DeltaLight::directional(Vec3::X, Rgb::WHITE).unwrap();
    let position = DeltaLightError::Position(DVec3::splat(100.0 * f64::from(1e17_f32)));
    let direction = DeltaLightError::Direction(DVec3::ZERO);
    let cases: [(Model, DVec3, RenderError); 5] = [
        (model_with([far]), DVec3::splat(100.0), position.into()),
        (model_with([sun]), DVec3::new(0.0, 1.0, 1.0), direction.into()),
        (model(), DVec3::splat(1e18), GeomError::Domain { triangle: 1, vertex: 1, value: 3e18 }.into()),
        (model(), DVec3::splat(1e300), GeomError::NonFinite { triangle: 0, vertex: 1 }.into()),
        (model(), DVec3::NAN, GeomError::NonFinite { triangle: 0, vertex: 0 }.into()),
    ];
    for (before, scale, expected) in cases {
        let mut moved = before.clone();
        let error = moved.transform(&DAffine3::from_scale(scale)).unwrap_err();
        assert_eq!((error, moved), (expected, before), "{scale}");
    }
}

#[test]
fn corners_of_the_film_see_the_corners_of_the_view() {
    let camera = PinholeCamera::look_at(DVec3::ZERO, -DVec3::Z, DVec3::Y, FRAC_PI_2).unwrap();
    let corner = camera.ray(1.0, 1.0, 2.0).direction;
    assert!((corner - DVec3::new(2.0, 1.0, -1.0)).length() < 1e-15);
}

#[test]
fn a_camera_that_looks_along_up_is_refused_at_any_rounding() {
    let view = DVec3::new(0.3, -0.7, 0.2);
    for i in 1..100 {
        let up = view * 0.1 * f64::from(i);
        assert!(PinholeCamera::look_at(DVec3::ZERO, view, up, 1.0).is_err(), "{up}");
    }
}
