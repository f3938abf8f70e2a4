//! Form factors between finite surfaces in closed form: polygonal discs and spheres, squares and discs,
//! closed boxes, an integrating sphere.

use glam::DVec3;
use globillum::geom::Triangle;
use globillum::integrator::{Estimator, Model, PinholeCamera, render};
use globillum::material::{Emission, Material, Rgb, Sides};
use globillum_testkit::accelerators::RENDERED;
use globillum_testkit::polygon;
use globillum_testkit::scenes::{self, disc, stare};
use globillum_testkit::shapes::{cuboid, icosphere, inside_out, quad};
use globillum_testkit::stats::{Estimate, Z_LIMIT, independent_pixels};

use Estimator::{Bsdf, Light, Mis};

/// The mean radiance of the picture with one bounce, by Sobol' points.
fn estimate(model: &Model, camera: &PinholeCamera, estimator: Estimator, samples: u32) -> Estimate {
    let scene = scenes::scene(model, RENDERED[0].1);
    let mut settings = independent_pixels(64, 64, samples);
    (settings.estimator, settings.max_bounces) = (estimator, Some(1));
    let film = render(&scene, camera, &settings).expect("the scene is good").film;
    Estimate::of_film(&film, |c| c.g)
}

/// The truth is the form factor of the polygons themselves, which is near that of discs and spheres.
#[test]
fn polygonal_discs_and_spheres() {
    let moved = |triangles: Vec<Triangle>, by: DVec3| -> Vec<Triangle> {
        let moved = |t: Triangle| {
            let [a, b, c] = t.vertices.map(|v| (v.as_dvec3() + by).as_vec3());
            Triangle::new(a, b, c)
        };
        triangles.into_iter().map(moved).collect()
    };
    let sphere = icosphere(3).placed(1.0, DVec3::new(0.0, 3.0, 0.0)).triangles();
    let cases = [
        ("a disc at height 1", disc(1.0, 64, true), 0.5),
        ("a disc at height 2", disc(2.0, 64, true), 0.2),
        ("a disc beside the point", moved(disc(1.0, 64, true), DVec3::new(2.0, 0.0, 0.0)), 0.052_786_405),
        ("a sphere", sphere, 1.0 / 9.0),
    ];
    let camera = stare(DVec3::new(0.1, 0.5, 0.2), DVec3::ZERO);
    for (what, light, limit) in cases {
        let truth = polygon::form_factor(DVec3::ZERO, DVec3::Y, &light);
        assert!((truth / limit - 1.0).abs() < 0.01, "{what}: {truth}");
        let model = scenes::light_above_floor(light, 0.5);
        for estimator in [Bsdf, Light, Mis] {
            // BSDF sampling hits small lights too rarely.
            if estimator == Bsdf && truth < 0.2 {
                continue;
            }
            let samples = match (what, estimator) {
                // Half of a sphere's triangles face away; they are sampled equally often.
                ("a sphere", Light) => 192,
                ("a sphere", _) => 112,
                ("a disc beside the point", _) => 64,
                _ => 32,
            };
            let found = estimate(&model, &camera, estimator, samples);
            found.assert_is(0.5 * truth, &format!("{what}, {estimator:?}"));
        }
    }
}

/// A camera above the square of half side `half` around the origin of the floor. The square fills the
/// picture, and all pixels cover equal parts of it.
fn above_square(half: f64, height: f64) -> PinholeCamera {
    let fov = 2.0 * (half / height).atan();
    PinholeCamera::look_at(DVec3::new(0.0, height, 0.0), DVec3::ZERO, DVec3::Z, fov).expect("it looks down")
}

fn square(height: f64) -> [Triangle; 2] {
    let p = |x: f64, z: f64| DVec3::new(0.5 * x, height, 0.5 * z);
    quad(p(-1.0, -1.0), p(1.0, -1.0), p(1.0, 1.0), p(-1.0, 1.0))
}

#[test]
fn form_factors_of_whole_squares_and_discs() {
    let p = DVec3::new;
    let wall = quad(p(0.5, 0.0, 0.5), p(0.5, 1.0, 0.5), p(0.5, 1.0, -0.5), p(0.5, 0.0, -0.5));
    let cases = [
        ("squares at 1", square(1.0), 0.199_824_896),
        ("squares at 0.5", square(0.5), 0.415_253_284),
        ("squares at 0.1", square(0.1), 0.826_994_522),
        ("squares at 10", square(10.0), 0.003_162_057),
        ("squares at a right angle", wall, 0.200_043_776),
    ];
    for (what, light, truth) in cases {
        let height = light[0].vertices[0].y.max(1.0) as f64;
        let model = scenes::light_above_floor(light, 1.0);
        for estimator in [Light, Mis] {
            let camera = above_square(0.5, 0.05 * height);
            let what = format!("{what}, {estimator:?}");
            estimate(&model, &camera, estimator, 48).assert_is(0.5 * truth, &what);
        }
    }
    // A white disc on a black floor fills pi / 4 of the picture. Each polygon of 256 sides is smaller than
    // its circle by a ten-thousandth.
    let mut model = scenes::light_above_floor(disc(1.0, 256, true), 0.0);
    model.add(Material::lambert(Rgb::WHITE).expect("an albedo"), disc(0.0, 256, false));
    let truth = std::f64::consts::FRAC_PI_4 * 0.381_966_011;
    for estimator in [Light, Mis] {
        let found = estimate(&model, &above_square(1.0, 0.5), estimator, 128);
        let (error, margin) = (found.mean / truth - 1.0, Z_LIMIT * found.std_err / truth);
        assert!(
            margin < 0.005 && error.abs() < margin + 3e-4,
            "discs, {estimator:?}: {found:?}, not {truth}"
        );
    }
}

/// The form factors from a face of a closed box to all other faces have the sum 1, so its radiance is its
/// albedo.
#[test]
fn the_form_factors_of_a_box_add_up_to_one() {
    let glow = Emission::new(Rgb::WHITE, Sides::Front).expect("a finite radiance");
    let mut model = Model::default();
    for wall in inside_out(cuboid(DVec3::new(0.0, 0.5, 0.0), DVec3::splat(0.5), 0.0)) {
        let floor = Material::lambert(Rgb::splat(0.5)).expect("an albedo");
        let light = Material::lambert(Rgb::BLACK).expect("an albedo").emitting(glow);
        model.add(if wall.normal().y > 0.5 { floor } else { light }, [wall]);
    }
    // A little less than the whole floor, without the walls at its edge.
    let camera = above_square(0.499_999, 0.5);
    for (estimator, samples) in [(Bsdf, 32), (Light, 384), (Mis, 32)] {
        let found = estimate(&model, &camera, estimator, samples);
        found.assert_is(0.5, &format!("{estimator:?}"));
        assert!(estimator != Bsdf || found.std_err < 1e-12, "every direction hits a light: {found:?}");
    }
}

/// Every point of a sphere receives the same irradiance from any light on it. For an icosphere of 5120
/// triangles this holds within half a percent.
#[test]
fn an_integrating_sphere() {
    let model = scenes::integrating_sphere(4);
    // The middle of a triangle that is not a light.
    let middle = model.triangles()[0].vertices.map(|v| v.as_dvec3()).iter().sum::<DVec3>() / 3.0;
    let scene = scenes::scene(&model, RENDERED[0].1);
    let mut settings = independent_pixels(64, 64, 64);
    settings.estimator = Mis;
    let film = render(&scene, &stare(DVec3::ZERO, middle), &settings).expect("the scene is good").film;
    let found = Estimate::of_film(&film, |c| c.g);
    assert!(Z_LIMIT * found.std_err < 0.005 * 1.5, "{found:?}");
    assert!((found.mean / 1.5 - 1.0).abs() < 0.005, "{found:?}");
}
