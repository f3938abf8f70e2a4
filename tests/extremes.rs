//! Lights of extreme radiance and size: every accepted light is rendered correctly, with correct error
//! estimates.

use glam::DVec3;
use globillum::geom::{Accel, Triangle};
use globillum::integrator::{
    Estimator, Film, Model, PathReuse, PinholeCamera, RenderError, Sampler, Scene, Settings, render,
};
use globillum::material::{Emission, Material, Rgb, Sides};
use globillum_testkit::accelerators::RENDERED;
use globillum_testkit::scenes::LIGHT_OVER_FLOOR;
use globillum_testkit::scenes::{self, stare};
use globillum_testkit::shapes::quad;
use globillum_testkit::stats::{Estimate, Z_LIMIT, independent_pixels};

const ALL: [Estimator; 3] = [Estimator::Bsdf, Estimator::Light, Estimator::Mis];

/// The radiance at the middle of the floor under a square light of radiance 1.
const TRUTH: f64 = LIGHT_OVER_FLOOR;

/// `model` with lengths multiplied by `size` and emission by `radiance`; an error if the emission is refused.
fn scaled(model: &Model, size: f32, radiance: f64) -> Result<Model, RenderError> {
    let mut scaled = Model::default();
    for (index, triangle) in model.triangles().iter().enumerate() {
        let mut material = *model.material(index);
        let emitted = material.emission.toward(1.0) * radiance;
        material.emission = Emission::new(emitted, Sides::Front)?;
        scaled.add(material, [Triangle { vertices: triangle.vertices.map(|v| v * size) }]);
    }
    Ok(scaled)
}

fn scene(model: &Model) -> Scene<Box<dyn Accel>> {
    scenes::scene(model, RENDERED[0].1)
}

/// The camera at the floor under the square light, for a scene scaled by `size`.
fn camera(size: f64) -> PinholeCamera {
    stare(size * DVec3::new(0.1, 0.5, 0.2), DVec3::ZERO)
}

/// Asserts that a picture of the floor under the square light has the true mean within 2 %, and estimates its
/// error correctly.
fn assert_is_square_light(film: &Film, radiance: f64, what: &str) {
    let estimate = Estimate::of_film(film, |c| c.g);
    let margin = Z_LIMIT * estimate.std_err / (TRUTH * radiance);
    let difference = (estimate.mean / (TRUTH * radiance) - 1.0).abs();
    assert!(difference <= margin && 0.0 < margin && margin < 0.02, "{what}: {difference}, margin {margin}");
    let error = film.error();
    let [low, high] = error.interval_95;
    assert!(0.0 < low && low < error.relative_rmse && error.relative_rmse < high, "{what}: {error:?}");
    assert!(high < 0.5, "{what}: {error:?}");
    // All pixels show the same point, so their scatter is an independent estimate of the error. Both logarithms are about
    // normal: that of the scatter has a standard deviation by the kurtosis of the pixels, the other one by its interval.
    let squares = film.means().map(|mean| (mean.g / (TRUTH * radiance) - 1.0).powi(2));
    let count = f64::from(film.width() * film.height());
    let [variance, fourth] = squares
        .fold([0.0; 2], |[sum, fourth], square| [sum + square / count, fourth + square * square / count]);
    let of_scatter = ((fourth / (variance * variance) - 1.0) / count).sqrt() / 2.0;
    let of_error = (high / error.relative_rmse).ln() / 1.96;
    let apart = (variance.sqrt() / error.relative_rmse).ln() / of_scatter.hypot(of_error);
    assert!(apart.abs() < Z_LIMIT, "{what}: {apart} standard deviations, {variance}, {error:?}");
}

/// All estimators render correctly what `Emission` accepts; it refuses the rest.
#[test]
fn accepted_lights_are_rendered_correctly() {
    let (lengths, radiances) = ([1e-15, 1.0, 1e15], [1e-300, 1e-100, 1e-50, 1.0, 1e50, 1e100, 1e300]);
    let mut accepted = Vec::new();
    for radiance in radiances {
        for size in lengths {
            let Ok(model) = scaled(&scenes::light_over_floor(), size as f32, radiance) else { continue };
            accepted.push(radiance);
            let scene = scene(&model);
            for estimator in ALL {
                let mut settings = independent_pixels(32, 32, 128);
                settings.estimator = estimator;
                let what = format!("radiance {radiance:e}, size {size:e}, {estimator:?}");
                let picture = render(&scene, &camera(size), &settings);
                assert_is_square_light(&picture.expect(&what).film, radiance, &what);
            }
        }
    }
    accepted.dedup();
    assert_eq!(accepted, [1e-50, 1.0, 1e50]);
}

/// Scaling radiance or size by a power of two changes only exponents, in each mean and each error estimate,
/// for all estimators.
#[test]
fn powers_of_two_change_no_bit() {
    let mirrors = scenes::light_beside_mirror();
    for (sampler, path_reuse) in [(Sampler::Sobol, PathReuse::Tiles), (Sampler::Independent, PathReuse::Off)]
    {
        for estimator in ALL {
            let mut settings = Settings::new(16, 16, 40);
            (settings.sampler, settings.path_reuse, settings.estimator) = (sampler, path_reuse, estimator);
            let film = |size: i32, radiance: i32| {
                let (size, radiance) = (2.0_f64.powi(size), 2.0_f64.powi(radiance));
                let model = scaled(&mirrors, size as f32, radiance).expect("within the range");
                let (eye, target) = (DVec3::new(-0.7, 0.9, 1.5), DVec3::new(0.5, 0.1, 0.0));
                let camera =
                    PinholeCamera::look_at(size * eye, size * target, DVec3::Y, 1.2).expect("a view");
                let film = render(&scene(&model), &camera, &settings).expect("a good scene").film;
                let means: Vec<Rgb> = film.means().map(|mean| mean / radiance).collect();
                let variances: Vec<Rgb> =
                    film.variances_of_mean().map(|variance| variance / radiance / radiance).collect();
                (means, variances, film.error())
            };
            let usual = film(0, 0);
            assert!(usual.0.iter().any(|mean| !mean.is_black()));
            for (size, radiance) in [(0, -166), (0, 166), (-50, -166), (-50, 166), (50, -166), (50, 166)] {
                let what = format!("2^{size} in size, 2^{radiance} in radiance, {estimator:?}");
                assert_eq!(film(size, radiance), usual, "{what}");
            }
        }
    }
}

/// A light is sampled even beside one of 1e112 times its power that is not visible.
#[test]
fn a_dim_light_is_found_beside_a_strong_one() {
    let (dim, strong) = (1e-50, 1e50);
    let mut model = scaled(&scenes::light_over_floor(), 1.0, dim).expect("within the range");
    let p = |x: f64, z: f64| DVec3::new(x * 1e6, -1e6, z * 1e6);
    let below = quad(p(-1.0, -1.0), p(1.0, -1.0), p(1.0, 1.0), p(-1.0, 1.0));
    model.add(Material::light(Rgb::splat(strong)).expect("within the range"), below);
    let scene = scene(&model);
    for estimator in [Estimator::Bsdf, Estimator::Mis] {
        let mut settings = independent_pixels(32, 32, 128);
        settings.estimator = estimator;
        let film = render(&scene, &camera(1.0), &settings).expect("the scene is good").film;
        assert_is_square_light(&film, dim, &format!("{estimator:?}"));
    }
}
