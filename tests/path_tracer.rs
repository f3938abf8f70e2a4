//! `examples/path_tracer.rs`, a path tracer on the library's public interface, compared with the library's own.

#[allow(dead_code, reason = "its `main` is not called")]
#[path = "../examples/path_tracer.rs"]
mod example;

use example::radiance;
use glam::DVec3;
use globillum::geom::Accel;
use globillum::integrator::{DeltaLight, Estimator, Model, PinholeCamera, Scene, Stream, render};
use globillum::material::{Emission, Material, Rgb, Sides};
use globillum_testkit::accelerators::RENDERED;
use globillum_testkit::scenes::{self, stare};
use globillum_testkit::shapes::quad;
use globillum_testkit::stats::{Estimate, independent_pixels};

/// A square light over a floor, half of it hidden by a sheet. A second light is far away, emits on both sides
/// and reflects. A third emits away from the floor. The fourth is a point light. A mirror reflects them to the floor.
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
    let mirror = quad(p(1.0, 0.0, -2.0), p(1.0, 0.0, 2.0), p(1.0, 2.0, 2.0), p(1.0, 2.0, -2.0));
    model.add(Material::mirror(Rgb::splat(0.8)).expect("a reflectance"), mirror);
    model.add_delta_light(DeltaLight::point(position, Rgb::new(3.0, 2.0, 1.0)).expect("in range"));
    model
}

const TARGET: DVec3 = DVec3::new(-0.4, 0.0, 0.1);

fn camera() -> PinholeCamera {
    stare(DVec3::new(-0.5, 0.4, 0.3), TARGET)
}

/// Mean and standard error of each component of the radiance from [`TARGET`], by the example's path tracer.
fn own(scene: &Scene<Box<dyn Accel>>) -> [Estimate; 3] {
    let count = 400_000;
    let (mut sums, mut squares) = (Rgb::BLACK, Rgb::BLACK);
    for i in 0..count {
        let value = radiance(scene, camera().ray(0.0, 0.0, 1.0), Stream::new(9, 0, i));
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

#[test]
fn the_example_agrees_with_the_library() {
    let scene = scenes::scene_under(Rgb::new(0.2, 0.3, 0.4), &model(), RENDERED[0].1);
    let own = own(&scene);
    let mut settings = independent_pixels(64, 64, 64);
    for (estimator, precision) in [(Estimator::Light, 0.04), (Estimator::Mis, 0.02)] {
        settings.estimator = estimator;
        let film = render(&scene, &camera(), &settings).expect("the scene is good").film;
        let components: [fn(Rgb) -> f64; 3] = [|c| c.r, |c| c.g, |c| c.b];
        for (own, component) in own.iter().zip(components) {
            let other = Estimate::of_film(&film, component);
            other.assert_agrees(own, precision, &format!("{estimator:?}"));
        }
    }
}
