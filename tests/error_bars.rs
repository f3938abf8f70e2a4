//! A picture's estimate of its error against its true error. The scene is a square light above a floor, whose
//! radiance is known. Seeds are fixed; each limit is derived where it is used.
#![allow(clippy::print_stdout, reason = "figures for docs/estimators.md, with --nocapture")]

use glam::DVec3;
use globillum::geom::Accel;
use globillum::integrator::{
    Estimator, Film, LightSampling, PathReuse, PinholeCamera, Render, Sampler, Scene, Settings, Stream,
    render,
};
use globillum::material::Rgb;
use globillum_testkit::accelerators::RENDERED;
use globillum_testkit::scenes::{self, stare};
use globillum_testkit::stats::{Estimate, independent_pixels};

const SAMPLERS: [Sampler; 2] = [Sampler::Independent, Sampler::Sobol];

/// Pixels along each side; all show the same point.
const SIDE: u32 = 64;

/// 5.85 standard deviations of a root mean square over 4096 normal variates; one is `1 / sqrt(2 * 4096)`.
const RMS_LIMIT: f64 = 0.0646;

/// Half of the form factor of four unit squares with a common corner at height 1.
fn truth() -> f64 {
    let corner = 2.0 * (1.0 / 2.0_f64.sqrt()) * (1.0 / 2.0_f64.sqrt()).atan() / std::f64::consts::TAU;
    0.5 * 4.0 * corner
}

const SAMPLINGS: [LightSampling; 2] = [LightSampling::Area, LightSampling::SolidAngle];

/// The variance of one sample at the point that the camera looks at, by quadrature.
fn variance_of(estimator: Estimator, sampling: LightSampling) -> f64 {
    match (estimator, sampling) {
        (Estimator::Bsdf, _) => 0.061_767_583,
        (Estimator::Light, LightSampling::Area) => 0.019_597_217,
        (Estimator::Light, _) => 0.001_112_191,
        (_, LightSampling::Area) => 0.013_025_137,
        _ => 0.005_770_205,
    }
}

fn scene() -> (Scene<Box<dyn Accel>>, PinholeCamera) {
    let camera = stare(DVec3::new(0.1, 0.5, 0.2), DVec3::ZERO);
    (scenes::scene(&scenes::light_over_floor(), RENDERED[0].1), camera)
}

fn settings(samples: u32, sampler: Sampler, estimator: Estimator) -> Settings {
    let mut settings = independent_pixels(SIDE, SIDE, samples);
    (settings.sampler, settings.estimator) = (sampler, estimator);
    settings
}

fn film(settings: &Settings) -> Film {
    let (scene, camera) = scene();
    render(&scene, &camera, settings).expect("the scene is good").film
}

/// The true error of the film's pixels.
fn rmse(film: &Film) -> f64 {
    let squares: f64 = film.means().map(|mean| (mean.g - truth()).powi(2)).sum();
    (squares / f64::from(film.width() * film.height())).sqrt()
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
fn one_sample_has_the_known_variance() {
    for (estimator, sampling) in [Estimator::Bsdf, Estimator::Light, Estimator::Mis]
        .into_iter()
        .flat_map(|e| SAMPLINGS.map(|s| (e, s)))
    {
        let mut settings = settings(16, Sampler::Independent, estimator);
        settings.light_sampling = sampling;
        let variance = Estimate::of_film(&film(&settings), |c| c.g).sample_variance();
        let ratio = variance / variance_of(estimator, sampling);
        assert!((ratio - 1.0).abs() < 0.055, "{estimator:?}, {sampling:?}: {variance}");
    }
}

/// The point lies below the middle of a light, at a hundredth of its half side. The variances of one sample, by
/// quadrature, are 1060.8 for area sampling and 0.0804 for solid angle sampling.
#[test]
fn solid_angle_sampling_bounds_the_variance_near_a_light() {
    let model = scenes::rectangle_over_floor([-1.0, 1.0], [-1.0, 1.0], 0.01);
    let scene = scenes::scene(&model, RENDERED[0].1);
    let camera = stare(DVec3::new(0.001, 0.005, 0.002), DVec3::ZERO);
    let mut settings = settings(16, Sampler::Independent, Estimator::Light);
    let [area, solid_angle] = SAMPLINGS.map(|sampling| {
        (settings.light_sampling, settings.max_bounces) = (sampling, Some(1));
        let film = render(&scene, &camera, &settings).expect("the scene is good").film;
        Estimate::of_film(&film, |c| c.g).sample_variance()
    });
    assert!((solid_angle / 0.080_373 - 1.0).abs() < 0.055, "{solid_angle}");
    assert!(area > 1000.0 * solid_angle, "{area}");
}

#[test]
fn the_error_of_independent_samples_falls_with_their_square_root() {
    let errors = [4, 16, 64, 256, 1024].map(|samples| {
        let mut settings = settings(samples, Sampler::Independent, Estimator::Light);
        (settings.seed, settings.light_sampling) = (samples.into(), LightSampling::Area);
        (samples, rmse(&film(&settings)))
    });
    for (samples, error) in errors {
        let expected = (variance_of(Estimator::Light, LightSampling::Area) / f64::from(samples)).sqrt();
        assert!((error / expected - 1.0).abs() < RMS_LIMIT, "{samples} samples: {error}, not {expected}");
    }
    let slope = slope(&errors);
    assert!((-0.5126..=-0.4874).contains(&slope), "{slope}");
}

/// A smooth integrand of two dimensions, a best case of stratification. The ranges of slopes are from
/// measurements; independent samples have -0.5.
#[test]
fn sobol_points_converge_faster() {
    for (sampling, slopes) in SAMPLINGS.into_iter().zip([-1.3..=-1.15, -1.42..=-1.26]) {
        let errors = [4, 16, 64, 256, 1024].map(|samples| {
            let mut settings = settings(samples, Sampler::Sobol, Estimator::Light);
            (settings.seed, settings.pass_samples) = (samples.into(), samples);
            // An error by 1024 pixels is known to 2.2 %, the slope to 0.006.
            (settings.width, settings.height) = (SIDE / 2, SIDE / 2);
            settings.light_sampling = sampling;
            (samples, rmse(&film(&settings)))
        });
        let slope = slope(&errors);
        println!("{sampling:?}: {slope}, {errors:?}");
        assert!(slopes.contains(&slope), "{sampling:?}, {slope}: {errors:?}");
    }
}

#[test]
fn a_pictures_estimate_of_its_error_is_correct() {
    for (sampler, estimator) in
        SAMPLERS.into_iter().flat_map(|s| [(s, Estimator::Light), (s, Estimator::Mis)])
    {
        let film = film(&settings(128, sampler, estimator));
        let (estimate, rmse) = (film.error(), rmse(&film) / truth());
        let what = format!("{sampler:?}, {estimator:?}: {estimate:?}, true error {rmse}");
        assert!((estimate.relative_rmse / rmse - 1.0).abs() < RMS_LIMIT, "{what}");
        let [low, high] = estimate.interval_95;
        assert!(low < estimate.relative_rmse && estimate.relative_rmse < high && high < 1.05 * low, "{what}");
    }
}

/// An incomplete pass is less stratified, so the variance of its mean is larger than its weight assumes. The
/// estimated error is then too large, by an amount that follows from the variances of both kinds of pass, and
/// never too small.
#[test]
fn an_incomplete_last_pass_does_not_lower_the_estimated_error() {
    let render = |samples| film(&settings(samples, Sampler::Sobol, Estimator::Light));
    let film = render(6 * 16 + 5);
    assert_eq!((film.samples(), film.observations()), (101, 7));
    Estimate::of_film(&film, |c| c.g).assert_is(truth(), "101 samples");
    // The variances of the means of a whole pass and of the incomplete one.
    let (whole, short) = (rmse(&render(16)).powi(2), rmse(&render(5)).powi(2));
    let variance = (6.0 * 256.0 * whole + 25.0 * short) / (101.0 * 101.0);
    // The expectation of the weighted sample variance of the mean.
    let estimated = (6.0 * 16.0 * whole + 5.0 * short - 101.0 * variance) / (6.0 * 101.0);
    assert!(estimated > variance, "{estimated} {variance}");
    let (error, expected) = (film.error().relative_rmse, estimated.sqrt() / truth());
    assert!((error / expected - 1.0).abs() < RMS_LIMIT, "{error}, not {expected}");
}

/// The share of pixels whose error is at most their margin.
fn coverage(film: &Film, margins: impl Iterator<Item = f64>) -> f64 {
    let holds = |(mean, margin): &(Rgb, f64)| (mean.g - truth()).abs() <= *margin;
    film.means().zip(margins).filter(holds).count() as f64 / f64::from(SIDE * SIDE)
}

/// The share of 4096 pixels whose 95 % interval contains the truth has a standard deviation of 0.34 %. The
/// tolerance is 5.85 of them.
#[test]
fn the_95_percent_interval_contains_the_truth_with_that_frequency() {
    for (samples, estimator) in [(64, Estimator::Light), (128, Estimator::Mis), (512, Estimator::Mis)] {
        let film = film(&settings(samples, Sampler::Independent, estimator));
        let share = coverage(&film, film.margins_95().map(|margin| margin.g));
        println!("independent, {samples} samples, {estimator:?}: {:.1} %", 100.0 * share);
        assert!((share - 0.95).abs() < 0.02, "{samples} samples, {estimator:?}: {share}");
    }
}

/// The means of the blocks of 4 x 4 pixels, less the truth.
fn block_errors(film: &Film) -> Vec<f64> {
    let starts = |size: u32| (0..size).step_by(4);
    let pixels = |x: u32, y: u32| (y..y + 4).flat_map(move |y| (x..x + 4).map(move |x| (x, y)));
    let mean = |(x, y)| pixels(x, y).map(|(x, y)| film.mean(x, y).g).sum::<f64>() / 16.0;
    let blocks = starts(film.height()).flat_map(|y| starts(film.width()).map(move |x| (x, y)));
    blocks.map(|block| mean(block) - truth()).collect()
}

/// The pixels of a block are stratified together: their means converge as if each had all of the block's samples. With
/// independent pixels a block's error has a deviation of a quarter of a pixel's.
#[test]
fn errors_of_a_block_cancel() {
    let rms_of = |path_reuse| {
        let mut settings = settings(64, Sampler::Sobol, Estimator::Light);
        settings.path_reuse = path_reuse;
        let film = film(&settings);
        let errors = block_errors(&film);
        let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
        rms / rmse(&film)
    };
    let (off, shared) = (rms_of(PathReuse::Off), rms_of(PathReuse::Tiles));
    println!("a block's error over a pixel's: {off} without, {shared} with shared points");
    // 5.85 standard deviations of a root mean square over 256 blocks.
    assert!((off / 0.25 - 1.0).abs() < 0.26, "{off}");
    assert!(shared < 0.5 * off, "{shared}, {off}");
}

/// The share of 1024 blocks whose 95 % interval contains the truth has a standard deviation of 0.68 %. The tolerance is
/// 5.85 of them. By the errors of pixels, as if these were independent, it is 100 %.
#[test]
fn intervals_of_blocks_contain_the_truth_with_that_frequency() {
    for (sampler, samples, quantile) in
        [(Sampler::Sobol, 128, 2.364_624), (Sampler::Independent, 64, 1.998_341)]
    {
        let mut settings = settings(samples, sampler, Estimator::Light);
        settings.path_reuse = PathReuse::Tiles;
        (settings.width, settings.height) = (2 * SIDE, 2 * SIDE);
        let film = film(&settings);
        let errors = block_errors(&film);
        let holds = |(error, variance): &(&f64, Rgb)| error.abs() <= quantile * variance.g.sqrt();
        let held = errors.iter().zip(film.block_variances_of_mean()).filter(holds).count();
        let share = held as f64 / errors.len() as f64;
        println!("blocks, {sampler:?}: {:.1} %", 100.0 * share);
        assert!((share - 0.95).abs() < 0.04, "{sampler:?}: {share}");
    }
}

const DRAWS: u64 = 200_000;

/// The share of intervals of `quantile` standard errors to each side that contain the mean of `pass_means`.
/// Each interval follows from `passes` independent draws from `pass_means`.
fn coverage_of_draws(pass_means: &[f64], passes: u32, quantile: f64) -> f64 {
    let truth = pass_means.iter().sum::<f64>() / pass_means.len() as f64;
    let n = f64::from(passes);
    let holds = |&trial: &u64| {
        let draw = |i| pass_means[(Stream::new(1, trial, i).uniform(0) * pass_means.len() as f64) as usize];
        let mean = (0..passes).map(draw).sum::<f64>() / n;
        let spread: f64 = (0..passes).map(|i| (draw(i) - mean).powi(2)).sum();
        (mean - truth).abs() <= quantile * (spread / (n * (n - 1.0))).sqrt()
    };
    (0..DRAWS).filter(holds).count() as f64 / DRAWS as f64
}

/// The means of passes are not normally distributed. For `Mis` they cluster by the number of the pass's 16
/// BSDF samples that hit the light. Student's interval of few such means contains the truth with a frequency
/// near 95 % (Brown, Cai and DasGupta 2001). Independent draws of the same means give the exact frequency.
#[test]
fn intervals_of_sobol_passes_have_the_coverage_of_independent_draws() {
    let (scene, camera) = scene();
    for (passes, quantile, estimator) in
        [(4, 3.182_446, Estimator::Light), (8, 2.364_624, Estimator::Mis), (32, 2.039_513, Estimator::Mis)]
    {
        let settings = settings(16 * passes, Sampler::Sobol, estimator);
        let pass = |i| Render::new(&scene, &camera, &settings).passes(i..i + 1).run();
        let mut whole = pass(0).expect("the scene is good");
        let mut pass_means: Vec<f64> = whole.film.means().map(|mean| mean.g).collect();
        for next in (1..passes).map(|i| pass(i).expect("the scene is good")) {
            pass_means.extend(next.film.means().map(|mean| mean.g));
            whole.merge(next).expect("they are disjoint");
        }
        let students = whole.film.variances_of_mean().map(|variance| quantile * variance.g.sqrt());
        let share = coverage(&whole.film, students);
        let expected = coverage_of_draws(&pass_means, passes, quantile);
        let what = format!("{passes} passes, {estimator:?}: {share}, independent draws {expected}");
        println!("{what}");
        // Standard deviations are 0.38 % for 4096 pixels and 0.05 % for the draws; the tolerance is 5.85 of
        // both.
        assert!((share - expected).abs() < 0.0225, "{what}");
        assert!((expected - 0.95).abs() < 0.02, "{what}");
    }
}
