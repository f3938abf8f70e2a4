//! An estimator of direct illumination built on the library's public interface to lights, compared with the
//! library's own.

use glam::DVec3;
use globillum::geom::{Accel, Frame, Ray};
use globillum::integrator::{
    Camera, DeltaLight, Estimator, Film, Interaction, LightSampler, LightSampling, Model, Scene, Stream,
    render,
};
use globillum::material::{Density, Emission, Material, Rgb, Sides};
use globillum_testkit::accelerators::STRUCTURES;
use globillum_testkit::scenes::{self, stare};
use globillum_testkit::shapes::quad;
use globillum_testkit::stats::{Estimate, Z_LIMIT, independent_pixels};

/// A square light over a floor, half of it hidden by a sheet. A second light is far away, emits on both sides
/// and reflects. A third emits away from the floor. The fourth is a point light.
fn model() -> Model {
    let p = DVec3::new;
    let mut model = scenes::light_half_hidden();
    let both = Emission::new(Rgb::new(5.0, 4.0, 3.0), Sides::Both).expect("a radiance");
    let grey = Material::lambert(Rgb::splat(0.4)).expect("an albedo");
    model.add(
        grey.emitting(both),
        quad(p(-4.0, 2.0, -1.0), p(-4.0, 2.0, 1.0), p(-4.0, 4.0, 1.0), p(-4.0, 4.0, -1.0)),
    );
    let up = quad(p(-3.0, 0.5, 1.0), p(-2.0, 0.5, 1.0), p(-2.0, 0.5, 0.0), p(-3.0, 0.5, 0.0));
    model.add(Material::light(Rgb::splat(3.0)).expect("a radiance"), up);
    let position = DVec3::new(-1.5, 1.2, 0.8).as_vec3();
    model.add_delta_light(DeltaLight::point(position, Rgb::new(3.0, 2.0, 1.0)).expect("in range"));
    model
}

const TARGET: DVec3 = DVec3::new(-0.4, 0.0, 0.1);

fn camera() -> Camera {
    stare(DVec3::new(-0.5, 0.4, 0.3), TARGET)
}

/// Light sampling at `at`, weighted by the power heuristic.
fn by_light<A: Accel>(
    scene: &Scene<A>,
    at: &Interaction<'_>,
    lights: &LightSampler<'_>,
    numbers: Stream,
) -> Rgb {
    let Some(light) = lights.sample(numbers.uniform(0), numbers.uniform_pair(1)) else { return Rgb::BLACK };
    let Some(shadow_ray) = light.shadow_ray(&at.point) else { return Rgb::BLACK };
    if scene.accel().occluded(&shadow_ray) {
        return Rgb::BLACK;
    }
    let frame = Frame::around(at.point.normal);
    let (wo, wi) = (frame.to_local(at.wo), frame.to_local(light.direction()));
    let scattered = at.material.bsdf.pdf(wo, wi);
    at.material.bsdf.eval(wo, wi) * light.irradiance() * (wi.z.abs() * light.power_heuristic(scattered))
}

/// BSDF sampling at `at`, weighted by the power heuristic.
fn by_bsdf<A: Accel>(
    scene: &Scene<A>,
    at: &Interaction<'_>,
    lights: &LightSampler<'_>,
    numbers: Stream,
) -> Rgb {
    let frame = Frame::around(at.point.normal);
    let Some(sample) = at.material.bsdf.sample(frame.to_local(at.wo), numbers.uniform_pair(3)) else {
        return Rgb::BLACK;
    };
    let Density::SolidAngle(scattered) = sample.density else { panic!("the floor is not a mirror") };
    let ray = at.point.spawn(frame.to_world(sample.wi));
    let Some(hit) = scene.accel().intersect(&ray) else { return scene.environment() };
    let met = scene.interaction(&ray, &hit);
    sample.weight * met.emitted() * scattered.power_heuristic(lights.pdf(&met))
}

/// Mean and standard error of each component of direct illumination at [`TARGET`], by this file's estimator.
fn own(scene: &Scene<Box<dyn Accel>>, sampling: LightSampling) -> [Estimate; 3] {
    let ray: Ray = camera().ray(0.0, 0.0, 1.0);
    let hit = scene.accel().intersect(&ray).expect("the floor");
    let at = scene.interaction(&ray, &hit);
    let lights = scene.light_sampler(sampling, at.point.position, at.side());
    let count = 400_000;
    let (mut sums, mut squares) = (Rgb::BLACK, Rgb::BLACK);
    for i in 0..count {
        let numbers = Stream::new(9, 0, i);
        let value = by_light(scene, &at, &lights, numbers) + by_bsdf(scene, &at, &lights, numbers);
        sums += value;
        squares += value * value;
    }
    let count = f64::from(count);
    let (means, squares) = ((sums / count).to_array(), (squares / count).to_array());
    [0, 1, 2].map(|i| {
        let std_err = ((squares[i] - means[i] * means[i]) / count).sqrt();
        Estimate { mean: means[i], std_err, count }
    })
}

fn reference(scene: &Scene<Box<dyn Accel>>, estimator: Estimator) -> Film {
    let mut settings = independent_pixels(64, 64, 64);
    (settings.estimator, settings.max_bounces) = (estimator, Some(1));
    render(scene, &camera(), &settings, &()).expect("the scene is good").film
}

#[test]
fn an_estimator_on_the_public_interface_agrees_with_the_library() {
    let scene = scenes::scene(&model(), STRUCTURES[0].1);
    assert_eq!(scene.lights().len(), 7);
    assert!(scene.lights().triangles().eq([2, 3, 6, 7, 8, 9]));
    for sampling in [LightSampling::Area, LightSampling::SolidAngle] {
        let own = own(&scene, sampling);
        for (estimator, precision) in [(Estimator::Light, 0.04), (Estimator::Mis, 0.02)] {
            let film = reference(&scene, estimator);
            let components: [fn(Rgb) -> f64; 3] = [|c| c.r, |c| c.g, |c| c.b];
            for (own, component) in own.iter().zip(components) {
                let other = Estimate::of_film(&film, component);
                let margin = Z_LIMIT * own.std_err.hypot(other.std_err);
                let difference = (own.mean - other.mean).abs();
                assert!(difference < margin, "{sampling:?}, {estimator:?}: {own:?}, {other:?}");
                assert!(margin < precision * other.mean, "{sampling:?}, {estimator:?}: {own:?}, {other:?}");
            }
        }
    }
}
