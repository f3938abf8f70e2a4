//! Samples of lights, one at a time: which light is chosen, with which density, and what it brings.

use glam::{DVec3, Vec3};
use globillum::geom::{Accel, BruteForce, Ray, SphericalTriangle, Triangle};
use globillum::integrator::{
    AreaLightSample, DeltaLight, DeltaLightError, DeltaLightSample, LightSample, LightSampling, Model,
    PinholeCamera, Scene, Settings, Stream, render,
};
use globillum::material::{Emission, Material, Rgb, Sides};
use globillum_testkit::stats::Z_LIMIT;
use std::f32::consts::FRAC_PI_2 as FRAC_PI_2_F32;
use std::f64::consts::FRAC_PI_2;

const VALUE: Rgb = Rgb::new(3.0, 2.0, 1.0);

fn emitting(radiance: Rgb, sides: Sides) -> Material {
    Material::lambert(Rgb::BLACK).unwrap().emitting(Emission::new(radiance, sides).unwrap())
}

/// Triangles in a row along x, of area 1/2 each, that emit these radiances along z.
fn row(radiances: impl IntoIterator<Item = f64>) -> Model {
    let mut model = Model::default();
    for (i, radiance) in radiances.into_iter().enumerate() {
        let corner = Vec3::X * i as f32;
        let triangle = Triangle::new(corner, corner + Vec3::X, corner + Vec3::Y);
        model.add(Material::light(Rgb::splat(radiance)).unwrap(), [triangle]);
    }
    model
}

/// The scene of a model and these lights.
fn scene(mut model: Model, lights: &[DeltaLight]) -> Scene<BruteForce> {
    lights.iter().for_each(|&light| model.add_delta_light(light));
    Scene::build(model, |triangles| Ok(BruteForce::build(triangles))).unwrap()
}

/// Beside a triangle that does not emit.
fn alone(lights: &[DeltaLight]) -> Scene<BruteForce> {
    scene(row([0.0]), lights)
}

/// On a surface that faces the row of lights.
fn sample(scene: &Scene<BruteForce>, from: DVec3, choice: f64) -> Option<LightSample> {
    scene.light_sampler(LightSampling::Area, from, DVec3::NEG_Z).sample(choice, [0.25, 0.5])
}

/// What the only light of a scene, a delta light, brings to `from`.
fn sample_delta(scene: &Scene<BruteForce>, from: DVec3) -> Option<DeltaLightSample> {
    match sample(scene, from, 0.5)? {
        LightSample::Delta(light) => Some(light),
        LightSample::Area(light) => panic!("{light:?}"),
    }
}

/// The probability of choosing the triangle of area 1/2 that `light` lies on, sampled by area.
fn choice_prob_of(light: &AreaLightSample, from: DVec3) -> f64 {
    let cos = light.point.normal.dot(light.direction).abs();
    0.5 * light.pdf.0 * cos / light.point.position.distance_squared(from)
}

#[test]
fn a_point_light_falls_off_with_the_square_of_the_distance() {
    let scene = alone(&[DeltaLight::point(Vec3::new(1.0, 2.0, 3.0), VALUE).unwrap()]);
    let light = sample_delta(&scene, DVec3::new(1.0, 2.0, 7.0)).unwrap();
    assert_eq!((light.direction, light.irradiance), (DVec3::NEG_Z, VALUE / 16.0));
    assert_eq!((light.position, light.choice_prob), (Some(DVec3::new(1.0, 2.0, 3.0)), 1.0));
    assert_eq!(sample_delta(&scene, DVec3::new(1.0, 2.0, 3.0)), None);
}

#[test]
fn a_directional_light_is_the_same_everywhere() {
    let scene = alone(&[DeltaLight::directional(Vec3::new(0.0, -2.0, 0.0), VALUE).unwrap()]);
    for from in [DVec3::ZERO, DVec3::splat(1e18)] {
        let light = sample_delta(&scene, from).unwrap();
        assert_eq!((light.position, light.direction, light.irradiance), (None, DVec3::Y, VALUE));
    }
}

const CONES: [(f64, f64); 5] = [(0.0, 0.3), (0.2, 0.4), (0.3, 0.301), (0.0, 0.01), (0.5, FRAC_PI_2)];

fn spot(inner: f64, outer: f64) -> Result<DeltaLight, DeltaLightError> {
    DeltaLight::spot(Vec3::new(1.0, 5.0, 2.0), Vec3::NEG_Y, VALUE, inner, outer)
}

/// The equations of KHR_lights_punctual as the extension prints them.
fn falloff(cos: f64, inner: f64, outer: f64) -> f64 {
    let scale = 1.0 / f64::max(0.001, inner.cos() - outer.cos());
    (cos * scale - outer.cos() * scale).clamp(0.0, 1.0).powi(2)
}

#[test]
fn a_spot_light_falls_off_by_the_equations_of_the_extension() {
    for (inner, outer) in CONES {
        let scene = alone(&[spot(inner, outer).unwrap()]);
        for angle in (0..300).map(|i| 0.01 * f64::from(i)) {
            let from = DVec3::new(1.0 + 2.0 * angle.sin(), 5.0 - 2.0 * angle.cos(), 2.0);
            let expected = falloff(angle.cos(), inner, outer) / 4.0;
            let found = sample_delta(&scene, from).map_or(0.0, |light| light.irradiance.r / VALUE.r);
            let error = (found - expected).abs();
            assert!(error <= 1e-12 || error <= 1e-9 * expected, "{inner}, {outer}, {angle}: {found}");
        }
    }
}

/// In a light tree, by what it brings along its axis, where seven point lights beside it bring as much.
#[test]
fn a_spot_light_among_many_is_chosen_by_its_irradiance() {
    for (inner, outer) in CONES {
        let intensity = VALUE * falloff(1.0, inner, outer);
        let beside = |k: u8| Vec3::new(1.0 + 1e-3 * f32::from(k), 5.0, 2.0);
        let points = (1..8).map(|k| DeltaLight::point(beside(k), intensity).unwrap());
        let scene = alone(&[spot(inner, outer).unwrap()].into_iter().chain(points).collect::<Vec<_>>());
        let lights = scene.light_sampler(LightSampling::Area, DVec3::new(1.0, 3.0, 2.0), DVec3::Y);
        for i in 0..8 {
            let light = lights.sample((f64::from(i) + 0.5) / 8.0, [0.25, 0.5]);
            let Some(LightSample::Delta(light)) = light else { panic!("{light:?}") };
            assert!((8.0 * light.choice_prob - 1.0).abs() < 1e-3, "{inner}, {outer}, {i}: {light:?}");
        }
    }
}

/// Two triangles are chosen by power: those behind the surface give no sample, and of those that cross its plane the points
/// in front do.
#[test]
fn a_light_behind_the_surface_gives_no_sample() {
    let square = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| Vec3::new(x, y, 0.0));
    let [a, b, c, d] = square;
    let mut model = Model::default();
    model.add(emitting(Rgb::WHITE, Sides::Both), Triangle::quad(a, b, c, d));
    let scene = scene(model, &[]);
    let samples = |sampling, from: DVec3, normal: DVec3| {
        let sampler = scene.light_sampler(sampling, from, normal);
        let of_sample = |i| {
            let stream = Stream::new(3, 0, i);
            let light = sampler.sample(stream.uniform(0), stream.uniform_pair(1))?;
            Some(light.direction().dot(normal) > 0.0)
        };
        (0..1000).map(of_sample).collect::<Vec<_>>()
    };
    for sampling in [LightSampling::Area, LightSampling::SolidAngle] {
        let count = |from, normal, of| samples(sampling, from, normal).iter().filter(|&&s| s == of).count();
        assert_eq!(count(DVec3::Z, DVec3::Z, None), 1000, "{sampling:?}: behind");
        assert_eq!(count(DVec3::Z, DVec3::NEG_Z, Some(true)), 1000, "{sampling:?}: in front");
        // The plane x = 0 through both triangles.
        let in_front = count(DVec3::Z, DVec3::X, Some(true));
        assert!((430..570).contains(&in_front), "{sampling:?}: {in_front} in front of a plane between");
        assert_eq!(count(DVec3::Z, DVec3::X, None), 0, "{sampling:?}: both triangles are partly in front");
    }
}

#[test]
fn impossible_delta_lights_are_refused() {
    let limit = Triangle::MAX_COORDINATE;
    for x in [f32::NAN, f32::INFINITY, -limit * 1.01] {
        let error = DeltaLight::point(Vec3::new(0.0, x, 0.0), VALUE).unwrap_err();
        assert!(matches!(error, DeltaLightError::Position(_)), "{error}");
    }
    assert!(DeltaLight::point(Vec3::splat(-limit), VALUE).is_ok());
    for direction in [Vec3::ZERO, Vec3::new(1.0, f32::NAN, 0.0), Vec3::new(0.0, 0.0, f32::INFINITY)] {
        let error = DeltaLight::directional(direction, VALUE).unwrap_err();
        assert!(matches!(error, DeltaLightError::Direction(_)), "{error}");
    }
    for direction in [Vec3::X * f32::from_bits(1), Vec3::splat(f32::MAX)] {
        assert!(DeltaLight::directional(direction, VALUE).is_ok());
    }
    for value in [-1.0, 1e-51, 1e51, f64::NAN, f64::INFINITY] {
        let error = DeltaLight::point(Vec3::ZERO, Rgb::new(1.0, value, 1.0)).unwrap_err();
        assert!(matches!(error, DeltaLightError::Value(_)), "{error}");
    }
    assert!(DeltaLight::point(Vec3::ZERO, Rgb::new(0.0, 1e-50, 1e50)).is_ok());
    let beyond = f64::from(FRAC_PI_2_F32).next_up();
    let wrong =
        [(-0.1, 0.2), (0.2, 0.2), (0.3, 0.2), (0.0, beyond), (0.0, 1e-9), (f64::NAN, 1.0), (0.0, f64::NAN)];
    for (inner, outer) in wrong {
        let error = spot(inner, outer).unwrap_err();
        assert!(matches!(error, DeltaLightError::Cone { .. }), "{error}");
    }
    assert_eq!(spot(0.0, f64::from(FRAC_PI_2_F32)), spot(0.0, FRAC_PI_2));
}

#[test]
fn pictures_under_lights_with_other_numbers_have_other_keys() {
    let lights = [
        DeltaLight::point(Vec3::ZERO, VALUE),
        DeltaLight::point(Vec3::X, VALUE),
        DeltaLight::point(Vec3::ZERO, Rgb::WHITE),
        spot(0.1, 0.4),
        spot(0.2, 0.4),
        spot(0.2, 0.5),
        DeltaLight::directional(Vec3::X, VALUE),
        DeltaLight::directional(Vec3::Y, VALUE),
        DeltaLight::directional(Vec3::Y, Rgb::WHITE),
    ];
    let camera = PinholeCamera::look_at(DVec3::Z, DVec3::ZERO, DVec3::Y, 1.0).unwrap();
    let key = |light: Result<DeltaLight, _>| {
        render(&alone(&[light.unwrap()]), &camera, &Settings::new(1, 1, 1)).unwrap().key
    };
    let mut keys = lights.map(key);
    keys.sort_unstable();
    assert!(keys.windows(2).all(|pair| pair[0] != pair[1]));
}

/// Points in the air measure it.
#[test]
fn a_directional_light_without_triangles_is_kept() {
    let sun = DeltaLight::directional(Vec3::X, Rgb::WHITE).unwrap();
    assert_eq!(scene(Model::default(), &[sun]).lights().delta_lights().collect::<Vec<_>>(), [&sun]);
}

/// The least power that a light may have beside the greatest: neither is lost.
#[test]
fn the_weakest_light_has_a_chance_beside_the_strongest() {
    let mut model = Model::default();
    for (size, material) in [
        (f32::from_bits(1), emitting(Rgb::new(0.0, 0.0, Emission::MIN_RADIANCE), Sides::Front)),
        (Triangle::MAX_COORDINATE, emitting(Rgb::splat(Emission::MAX_RADIANCE), Sides::Both)),
    ] {
        let corners = [Vec3::NEG_ONE, Vec3::new(1.0, -1.0, 1.0), Vec3::ONE];
        model.add(material, [Triangle { vertices: corners.map(|v| v * size) }]);
    }
    // In a light tree, too.
    let mut model_of_ten = Model::default();
    (0..5).for_each(|_| model_of_ten.append(&model));
    let scene_of_ten = scene(model_of_ten, &[]);
    for i in 0..1000 {
        let from = DVec3::new(-1.0, 0.0, 1.0) * 2.0_f64.powi(55);
        let light = sample(&scene_of_ten, from, (f64::from(i) + 0.5) / 1000.0);
        let Some(LightSample::Area(light)) = light else { panic!("{light:?}") };
        assert!(light.pdf.0.is_normal(), "{light:?}");
    }
    let scene = scene(model, &[]);
    for (choice, radiance) in [(0.0, Emission::MIN_RADIANCE), (0.75, Emission::MAX_RADIANCE)] {
        let light = sample(&scene, DVec3::new(-1.0, 0.0, 1.0) * 2.0_f64.powi(55), choice);
        let Some(LightSample::Area(light)) = light else { panic!("{light:?}") };
        assert!(light.radiance.b == radiance && light.pdf.0.is_normal(), "{light:?}");
    }
}

/// Two triangles are chosen by power, the weaker one as if it had a 64th of the mean. What does not emit is never chosen.
#[test]
fn two_triangles_are_chosen_by_their_power() {
    for (weak, least) in [(2.0, 0.0), (1e-15, 1.0 / 64.0)] {
        let two = scene(row([0.0, weak, 0.0, 3.0, 0.0]), &[]);
        assert!(two.lights().triangles().eq([1, 3]));
        let mean = 0.5 * (weak + 3.0);
        let weight = f64::max(weak, least * mean);
        let (from, n) = (DVec3::new(2.5, 0.5, 2.0), 100_000);
        let mut count = 0;
        for i in 0..n {
            let light = sample(&two, from, (f64::from(i) + 0.5) / f64::from(n));
            let Some(LightSample::Area(light)) = light else { panic!("{light:?}") };
            let is_weak = light.radiance.g == weak;
            let expected = if is_weak { weight } else { 3.0 } / (weight + 3.0);
            assert!((choice_prob_of(&light, from) / expected - 1.0).abs() < 1e-12, "{light:?}, {expected}");
            count += i32::from(is_weak);
        }
        // Evenly spaced numbers are as many for each light as its probability says.
        let share = f64::from(count) / f64::from(n);
        assert!((share - weight / (weight + 3.0)).abs() < 2.0 / f64::from(n), "{weak}: {share}");
    }
}

/// A delta light that is black is none, so the other one is alone.
#[test]
fn a_black_delta_light_is_never_chosen() {
    let point = |value| DeltaLight::point(Vec3::new(1.0, 5.0, 2.0), value).unwrap();
    let scene = alone(&[point(Rgb::BLACK), point(VALUE)]);
    assert_eq!((scene.lights().len(), scene.lights().is_empty()), (1, false));
    let light = sample_delta(&scene, DVec3::new(1.0, 3.0, 2.0)).unwrap();
    assert_eq!((light.choice_prob, light.irradiance), (1.0, VALUE / 4.0));
}

/// A narrow spot light of little power beside a strong point light: within its cone it is chosen about as often as its
/// irradiance says, and outside hardly ever.
#[test]
fn a_spot_light_beside_another_light_is_chosen_where_it_shines() {
    let outer = 0.05;
    let point = DeltaLight::point(Vec3::new(1.0, 5.0, 12.0), VALUE * 20.0).unwrap();
    let scene = alone(&[spot(0.0, outer).unwrap(), point]);
    let share = |from| {
        let is_spot = |light: &Option<LightSample>| matches!(light, Some(LightSample::Delta(light)) if light.position == Some(DVec3::new(1.0, 5.0, 2.0)));
        let lights = scene.light_sampler(LightSampling::Area, from, DVec3::Y);
        (0..1000).map(|i| lights.sample((f64::from(i) + 0.5) / 1000.0, [0.25, 0.5])).filter(is_spot).count()
    };
    // At a distance of 3 below the spot light, and of the root of 109 from the other.
    let irradiances = [1.0 / 9.0, 20.0 / 109.0 * 3.0 / 109.0_f64.sqrt()];
    let expected = 1000.0 * irradiances[0] / (irradiances[0] + irradiances[1]);
    let found = share(DVec3::new(1.0, 2.0, 2.0)) as f64;
    assert!((0.8 * expected..1.2 * expected).contains(&found), "{found}, {expected}");
    assert!(share(DVec3::new(4.0, 2.0, 2.0)) < 10);
}

/// Three triangles, and a directional light beside another, are chosen by what they bring to the shading point. A
/// directional light is chosen by its irradiance, not by the size of the scene.
#[test]
fn three_lights_and_the_sun_are_chosen_by_the_shading_point() {
    let sun = |direction| [DeltaLight::directional(direction, Rgb::splat(5.0)).unwrap()];
    // How many of `n` evenly spaced numbers choose the light beside `from`.
    let count_of_nearest = |scene: &Scene<BruteForce>, n: u32| {
        let from = DVec3::new(0.3, 0.3, 1.0);
        let samples = (0..n).map(|i| sample(scene, from, (f64::from(i) + 0.5) / f64::from(n)));
        let is_nearest = |light: &Option<LightSample>| match light {
            Some(LightSample::Area(light)) => light.point.position.x < 1.0,
            _ => false,
        };
        samples.filter(is_nearest).count()
    };
    let distant = |count| std::iter::once(1.0).chain(vec![0.0; 30]).chain(vec![1.0; count]);
    assert_eq!(count_of_nearest(&scene(row(distant(1)), &[]), 1000), 500);
    assert!(count_of_nearest(&scene(row(distant(2)), &[]), 1000) > 980);
    // The light's irradiance is about 0.5, that of the sun 5, at any size of the scene.
    for floor in [30, 3000] {
        let row = row(std::iter::once(1.0).chain(vec![0.0; floor]));
        let count = count_of_nearest(&scene(row.clone(), &sun(Vec3::Z)), 1000);
        assert!((60..120).contains(&count), "{count}");
        // Behind the surface, the sun has the least probability: 2^-16.
        let n = 1 << 17;
        assert_eq!(count_of_nearest(&scene(row, &sun(Vec3::NEG_Z)), n), n as usize - 2);
    }
}

/// Of a million lights whose powers differ by a factor of 1e12 all can be chosen, but mostly those nearby.
#[test]
fn of_a_million_lights_those_nearby_are_chosen() {
    let scene = scene(row((0..1_000_000).map(|i| 10.0_f64.powi(i % 13 - 6))), &[]);
    let (mut nearby, draws) = (0, 20_000);
    for i in 0..draws {
        let numbers = Stream::new(2, 0, i);
        let from = DVec3::new(1e6 * numbers.uniform(1), numbers.uniform(2), 1.0);
        let light = sample(&scene, from, numbers.uniform(0));
        let Some(LightSample::Area(light)) = light else { panic!("{light:?}") };
        let choice_prob = choice_prob_of(&light, from);
        assert!(choice_prob > 1e-12 && choice_prob <= 1.0 + 1e-9, "{light:?}");
        nearby += i32::from((light.point.position.x - from.x).abs() < 100.0);
    }
    // By power alone there would be four. Beyond shine lights of a million times the power of most nearby.
    assert!(nearby > 9_000, "{nearby}");
}

/// Lights of several sizes, radiances and sides around the origin, and what does not emit. A delta light has
/// half of the power.
fn around_the_origin() -> Scene<BruteForce> {
    let mut model = Model::default();
    let mut add = |vertices: [[f32; 3]; 3], radiance: f64, sides: Sides| {
        model.add(emitting(Rgb::splat(radiance), sides), [Triangle { vertices: vertices.map(Vec3::from) }]);
    };
    add([[-1.0, 1.0, -1.0], [1.0, 1.0, -1.0], [0.0, 1.0, 1.0]], 10.0, Sides::Front);
    add([[-2.0, -3.0, 0.0], [-2.0, 3.0, 1.0], [-2.0, 0.0, 4.0]], 0.0, Sides::Both);
    add([[2.0, 0.0, 0.0], [2.0, 1.0, 0.0], [2.0, 0.0, 3.0]], 5.0, Sides::Both);
    add([[30.0, 0.0, 1.0], [30.0, 1.0, 0.0], [30.0, 0.0, 0.0]], 20.0, Sides::Both);
    scene(model, &[DeltaLight::point(Vec3::new(0.0, -2.0, 0.0), Rgb::new(8.0, 16.0, 32.0)).unwrap()])
}

/// Strips around the origin: a tree chooses among parts of them.
fn strips() -> Scene<BruteForce> {
    let mut model = Model::default();
    let mut add = |corner: [f32; 3], along: [f32; 3], across: [f32; 3], sides| {
        let [corner, along, across] = [corner, along, across].map(Vec3::from);
        let strip = Triangle::quad(corner, corner + along, corner + along + across, corner + across);
        model.add(emitting(Rgb::splat(3.0), sides), strip);
    };
    add([-2.0, 0.3, -0.1], [4.0, 0.0, 0.0], [0.0, 0.0, 0.05], Sides::Front);
    add([-0.4, 0.4, -3.0], [0.0, 0.1, 5.0], [0.01, 0.0, 0.0], Sides::Both);
    add([-0.6, 0.8, 0.2], [1.2, 0.1, 0.0], [0.0, 0.02, 0.04], Sides::Both);
    scene(model, &[])
}

/// The density of a hit point, which multiple importance sampling asks for, is that of the sample: in front of
/// all lights, beside an edge, behind a light, and far away.
#[test]
fn the_density_asked_for_is_that_of_the_sample() {
    [around_the_origin(), strips()].iter().for_each(densities_are_those_of_samples);
}

fn densities_are_those_of_samples(scene: &Scene<BruteForce>) {
    let places = [[0.0; 3], [1.999, 0.5, -1e-5], [0.1, 2.0, 0.2], [500.0, -700.0, 300.0]].map(DVec3::from);
    for (sampling, from) in
        [LightSampling::Area, LightSampling::SolidAngle].into_iter().flat_map(|s| places.map(|p| (s, p)))
    {
        let (lights, mut compared) = (scene.light_sampler(sampling, from, DVec3::Y), 0);
        for i in 0..1000 {
            let numbers = Stream::new(3, 0, i);
            let light = lights.sample(numbers.uniform(0), numbers.uniform_pair(1));
            let Some(LightSample::Area(light)) = light else { continue };
            assert!(light.pdf.0 > 0.0 && (light.direction.length() - 1.0).abs() < 1e-14, "{light:?}");
            let ray = Ray::new(from, light.direction);
            let Some(hit) = scene.accel().intersect(&ray) else { continue };
            let at = scene.interaction(&ray, &hit);
            // Another triangle may be in between.
            if at.point.position.distance(light.point.position) < 1e-9 * from.distance(light.point.position) {
                let asked = lights.pdf(&at);
                assert!(
                    (asked.0 / light.pdf.0 - 1.0).abs() < 1e-6,
                    "{sampling:?}, {from}: {asked:?}, {light:?}"
                );
                compared += 1;
            }
        }
        assert!(compared > 50, "{sampling:?}, {from}: {compared}");
    }
}

/// The mean of one over the density is the solid angle of what emits toward the shading point.
#[test]
fn densities_cover_what_is_seen_of_the_lights() {
    let solid_angle = |scene: &Scene<BruteForce>, i| {
        SphericalTriangle::new(scene.triangles().get(i), DVec3::ZERO).unwrap().solid_angle()
    };
    let scene = strips();
    densities_cover(&scene, (0..6).map(|i| solid_angle(&scene, i)).sum());
    let scene = around_the_origin();
    // The third and the fourth emit on both sides; the first faces the origin.
    // Far away: its area by the cosine over the squared distance, at its center.
    let center = DVec3::new(30.0, 1.0 / 3.0, 1.0 / 3.0);
    let far = 0.5 * 30.0 / center.length().powi(3);
    densities_cover(&scene, solid_angle(&scene, 0) + solid_angle(&scene, 2) + far);
}

fn densities_cover(scene: &Scene<BruteForce>, truth: f64) {
    for sampling in [LightSampling::Area, LightSampling::SolidAngle] {
        let lights = scene.light_sampler(sampling, DVec3::ZERO, DVec3::Y);
        let (mut sum, mut sum_sq, n) = (0.0, 0.0, 2_000_000);
        for i in 0..n {
            let numbers = Stream::new(4, 0, i);
            let light = lights.sample(numbers.uniform(0), numbers.uniform_pair(1));
            let Some(LightSample::Area(light)) = light else { continue };
            (sum, sum_sq) = (sum + 1.0 / light.pdf.0, sum_sq + light.pdf.0.powi(-2));
        }
        let n = f64::from(n);
        let (mean, std_err) = (sum / n, ((sum_sq / n - (sum / n).powi(2)) / n).sqrt());
        assert!((mean - truth).abs() < Z_LIMIT * std_err, "{sampling:?}: {mean} +- {std_err}, not {truth}");
        assert!(Z_LIMIT * std_err < 0.01 * truth, "{sampling:?}: {std_err}");
    }
}
