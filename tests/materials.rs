//! Materials: what is accepted, what emits and reflects where, and the sRGB encoding.

use glam::{DVec2, DVec3};
use globillum::geom::PdfSolidAngle;
use globillum::integrator::Stream;
use globillum::material::warp::CosineHemisphere;
use globillum::material::{Bsdf, Density, Emission, Material, Reflectance, Rgb, Sides, srgb_encode};

#[test]
fn impossible_materials_are_refused() {
    for bad in [-0.1, 1.1, f64::NAN, f64::INFINITY] {
        assert!(Material::lambert(Rgb::new(0.5, bad, 0.5)).is_err(), "{bad}");
        assert!(Material::mirror(Rgb::new(bad, 0.5, 0.5)).is_err(), "{bad}");
    }
    for bad in [-0.1, 5e-324, 1e-300, 0.9e-50, 1.1e50, 1e300, f64::NAN, f64::INFINITY] {
        let error = Material::light(Rgb::new(0.5, bad, 0.5)).unwrap_err().to_string();
        assert!(error.ends_with(") has a component that is neither 0 nor within [1e-50, 1e50]"), "{error}");
    }
    let extremes = [f32::from_bits(1), f32::MAX].map(f64::from);
    for good in [0.0, -0.0, 1e-50, 1000.0, 1e50].into_iter().chain(extremes) {
        assert!(Material::light(Rgb::new(0.5, good, 0.5)).is_ok(), "{good}");
    }
}

#[test]
fn a_light_shines_from_its_front_unless_double_sided() {
    let [front, both] = [Sides::Front, Sides::Both].map(|sides| Emission::new(Rgb::WHITE, sides).unwrap());
    assert_eq!([0.1, -0.1].map(|cos| front.toward(cos)), [Rgb::WHITE, Rgb::BLACK]);
    assert_eq!([0.1, -0.1, 0.0].map(|cos| both.toward(cos)), [Rgb::WHITE, Rgb::WHITE, Rgb::BLACK]);
    assert_eq!(both.exitance().r, 2.0 * front.exitance().r);
}

#[test]
fn a_mirror_is_a_delta_and_nothing_else() {
    let mirror = Bsdf::Mirror(Reflectance::new(Rgb::splat(0.9)).unwrap());
    let wo = DVec3::new(0.6, 0.0, -0.8);
    let sample = mirror.sample(wo, [0.1, 0.2]).unwrap();
    assert_eq!((sample.wi, sample.density), (DVec3::new(-0.6, 0.0, -0.8), Density::Delta));
    assert_eq!((mirror.eval(wo, sample.wi), mirror.pdf(wo, sample.wi)), (Rgb::BLACK, PdfSolidAngle(0.0)));
}

#[test]
fn nothing_passes_through_or_along_the_surface() {
    let lambert = Bsdf::Lambert(Reflectance::new(Rgb::splat(0.5)).unwrap());
    assert_eq!(lambert.eval(DVec3::Z, -DVec3::Z), Rgb::BLACK);
    assert_eq!(lambert.pdf(DVec3::Z, -DVec3::Z), PdfSolidAngle(0.0));
    assert_eq!(lambert.sample(DVec3::X, [0.5, 0.5]), None);
}

/// Also where the angle or the sine rounds to a full turn or to one.
#[test]
fn inverted_directions_are_numbers_below_one() {
    let horizon = (0..1000).map(|i| DVec2::from_angle(f64::from(i)).extend(0.0));
    for w in horizon.chain([DVec3::new(1.0, -1e-20, 0.0), DVec3::Z]) {
        let u = CosineHemisphere::invert(w);
        assert!(u.iter().all(|x| (0.0..1.0).contains(x)), "{w}: {u:?}");
    }
}

#[test]
fn cosine_samples_are_unit_vectors_and_invert() {
    for i in 0..10_000 {
        let [a, b] = Stream::new(16, 0, i).uniform_pair(0);
        let w = CosineHemisphere::sample([a, b]);
        assert!((w.length() - 1.0).abs() < 1e-15, "{a}, {b}");
        let [x, y] = CosineHemisphere::invert(w);
        let turn = (y - b).abs();
        assert!((x - a).abs() < 1e-15 && (a < 1e-20 || turn.min(1.0 - turn) < 1e-15), "{a}, {b}: {x}, {y}");
    }
}

#[test]
fn the_srgb_encoding_has_the_tabulated_values() {
    let table = [
        (0.0, 0.0),
        (0.001, 0.01292),
        (0.003_130_8, 0.040_449_94),
        (0.003_130_8_f64.next_up(), 0.040_449_94),
        (0.18, 0.461_356),
        (0.214_041_14, 0.5),
        (0.5, 0.735_357),
        (1.0, 1.0),
    ];
    for (linear, encoded) in table {
        assert!((srgb_encode(linear) - encoded).abs() < 1e-6, "{linear}");
    }
}

#[test]
fn srgb_bytes_are_rounded_to_nearest() {
    let table = [(-1.0, 0), (0.0, 0), (0.000_151, 0), (0.000_153, 1), (0.5, 188), (1.0, 255), (7.0, 255)];
    for (linear, byte) in table {
        assert_eq!(Rgb::new(0.0, linear, 1.0).to_srgb8(), [0, byte, 255], "{linear}");
    }
    assert_eq!(Rgb::new(f64::NAN, f64::INFINITY, f64::NEG_INFINITY).to_srgb8(), [0, 255, 0]);
}
