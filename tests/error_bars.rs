//! What a picture says of its own error, beside its true error: the scene is C3, whose radiance is
//! known. Random numbers are fixed, limits those of docs/testing.md.

use glam::DVec3;
use globillum::geom::Accel;
use globillum::integrator::{Camera, Estimator, Film, Sampler, Scene, Settings, render};
use globillum_testkit::accelerators::STRUCTURES;
use globillum_testkit::scenes::{self, stare};
use globillum_testkit::stats::Estimate;

const SAMPLERS: [Sampler; 2] = [Sampler::Independent, Sampler::Sobol];

/// Pixels along each side, all of the same point.
const SIDE: u32 = 64;

/// Five standard deviations of a root mean square over that many normal variates.
const RMS_LIMIT: f64 = 0.055;

/// Half of the form factor of four unit squares with a common corner at height 1 (C5).
fn truth() -> f64 {
    let corner = 2.0 * (1.0 / 2.0_f64.sqrt()) * (1.0 / 2.0_f64.sqrt()).atan() / std::f64::consts::TAU;
    0.5 * 4.0 * corner
}

/// The variance of one sample at the point that the camera looks at (C3v).
fn variance_of(estimator: Estimator) -> f64 {
    match estimator {
        Estimator::Bsdf => 0.061_767_583,
        Estimator::Light => 0.019_597_217,
        _ => 0.014_040_614,
    }
}

fn scene() -> (Scene<Box<dyn Accel>>, Camera) {
    let camera = stare(DVec3::new(0.1, 0.5, 0.2), DVec3::ZERO);
    (scenes::scene(&scenes::lamp_over_floor(), STRUCTURES[0].1), camera)
}

fn settings(samples: u32, sampler: Sampler, estimator: Estimator) -> Settings {
    let mut settings = Settings::new(SIDE, SIDE, samples);
    (settings.sampler, settings.estimator) = (sampler, estimator);
    settings
}

fn film(settings: &Settings) -> Film {
    let (scene, camera) = scene();
    render(&scene, &camera, settings, &()).expect("the scene is good").film
}

/// The true error of the film's pixels.
fn rmse(film: &Film) -> f64 {
    let squares: f64 = film.means().map(|mean| (mean.g - truth()).powi(2)).sum();
    (squares / f64::from(SIDE * SIDE)).sqrt()
}

/// Slope of the logarithm of the error over that of the number of samples, by least squares.
fn slope(errors: &[(u32, f64)]) -> f64 {
    let points: Vec<_> = errors.iter().map(|&(n, error)| (f64::from(n).ln(), error.ln())).collect();
    let n = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / n, y + p.1 / n));
    let covariance: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    covariance / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}

#[test]
fn c3v_one_sample_has_the_known_variance() {
    for estimator in [Estimator::Bsdf, Estimator::Light, Estimator::Mis] {
        let film = film(&settings(16, Sampler::Independent, estimator));
        let variance = Estimate::of_film(&film, |c| c.g).sample_variance();
        assert!((variance / variance_of(estimator) - 1.0).abs() < 0.055, "{estimator:?}: {variance}");
    }
}

#[test]
fn independent_samples_converge_as_their_square_root() {
    let errors = [4, 16, 64, 256, 1024].map(|samples| {
        let mut settings = settings(samples, Sampler::Independent, Estimator::Light);
        settings.seed = samples.into();
        (samples, rmse(&film(&settings)))
    });
    for (samples, error) in errors {
        let expected = (variance_of(Estimator::Light) / f64::from(samples)).sqrt();
        assert!((error / expected - 1.0).abs() < RMS_LIMIT, "{samples} samples: {error}, not {expected}");
    }
    let slope = slope(&errors);
    assert!((-0.5126..=-0.4874).contains(&slope), "{slope}");
}

/// A pixel without edges, and one decision that matters: what stratification can do. The slope is
/// a measured one; a square root's is -0.5.
#[test]
fn sobol_points_converge_faster() {
    let errors = [4, 16, 64, 256, 1024].map(|samples| {
        let mut settings = settings(samples, Sampler::Sobol, Estimator::Light);
        (settings.seed, settings.pass_samples) = (samples.into(), samples);
        (samples, rmse(&film(&settings)))
    });
    let slope = slope(&errors);
    assert!((-1.3..=-1.15).contains(&slope), "{slope}: {errors:?}");
}

#[test]
fn a_picture_knows_its_error() {
    for (sampler, estimator) in
        SAMPLERS.into_iter().flat_map(|s| [(s, Estimator::Light), (s, Estimator::Mis)])
    {
        let film = film(&settings(128, sampler, estimator));
        let (told, truly) = (film.error(), rmse(&film) / truth());
        let what = format!("{sampler:?}, {estimator:?}: {told:?}, truly {truly}");
        assert!((told.relative_rmse / truly - 1.0).abs() < RMS_LIMIT, "{what}");
        let [low, high] = told.interval_95;
        assert!(low < told.relative_rmse && told.relative_rmse < high && high < 1.05 * low, "{what}");
    }
}

/// A pass cut short is stratified less than its share, so its mean spreads more than its weight
/// allows for: the error told is then too large, by as much as the variances of both kinds of pass
/// make it, and never too small.
#[test]
fn a_last_pass_cut_short_makes_the_error_no_smaller() {
    let render = |samples| film(&settings(samples, Sampler::Sobol, Estimator::Light));
    let film = render(6 * 16 + 5);
    assert_eq!((film.samples(), film.observations()), (101, 7));
    Estimate::of_film(&film, |c| c.g).assert_is(truth(), "101 samples");
    // Variances of the means of a whole pass and of the short one.
    let (whole, short) = (rmse(&render(16)).powi(2), rmse(&render(5)).powi(2));
    let truly = (6.0 * 256.0 * whole + 25.0 * short) / (101.0 * 101.0);
    // The expectation of the weighted spread about the mean.
    let told = (6.0 * 16.0 * whole + 5.0 * short - 101.0 * truly) / (6.0 * 101.0);
    assert!(told > truly, "{told} {truly}");
    let (error, expected) = (film.error().relative_rmse, told.sqrt() / truth());
    assert!((error / expected - 1.0).abs() < RMS_LIMIT, "{error}, not {expected}");
}

/// Over 200 seeds an interval of 95 % misses 10 times, give or take 3.
#[test]
fn the_interval_of_95_percent_holds_the_truth_that_often() {
    let (scene, camera) = scene();
    for sampler in SAMPLERS {
        for (samples, estimator) in [(64, Estimator::Light), (128, Estimator::Mis), (1024, Estimator::Mis)] {
            let mut settings = Settings::new(1, 1, samples);
            (settings.sampler, settings.estimator) = (sampler, estimator);
            let holding = (0..200).filter(|&seed| {
                settings.seed = seed;
                let film = render(&scene, &camera, &settings, &()).expect("the scene is good").film;
                (film.mean(0, 0).g - truth()).abs() <= film.margin_95(0, 0).g
            });
            let holding = holding.count();
            assert!(
                (182..=198).contains(&holding),
                "{sampler:?}, {samples} samples, {estimator:?}: {holding}"
            );
        }
    }
}
