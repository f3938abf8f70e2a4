//! The error of a picture against the truth, and its slope over the number of samples.

use globillum::integrator::{Estimates, Film};
use globillum::material::Rgb;
use std::collections::BTreeMap;

/// The true or reference picture.
#[derive(Clone, Debug)]
pub(crate) struct Truth {
    means: Vec<Rgb>,
    /// The variance of each mean; zero where it is exact.
    variances: Vec<Rgb>,
    /// The pixels that are compared.
    counted: Vec<bool>,
    /// Pixels along each side of the tiles within which errors depend on each other; 1 if all are independent.
    tile_side: u32,
}

impl Truth {
    /// A closed form, pixel by pixel.
    pub(crate) fn exact(means: Vec<Rgb>) -> Self {
        let (variances, counted) = (vec![Rgb::BLACK; means.len()], vec![true; means.len()]);
        Self { means, variances, counted, tile_side: 1 }
    }

    /// The result of a long run: the film's means and its estimates of their variances.
    pub(crate) fn of_film(film: &Film) -> Self {
        let means: Vec<Rgb> = film.means().collect();
        let counted = vec![true; means.len()];
        let tile_side = film.path_reuse().tile_side();
        Self { means, variances: film.variances_of_mean().collect(), counted, tile_side }
    }

    /// Restricts the comparison to the pixels whose entry in `counted` is true.
    ///
    /// # Panics
    /// If the number of entries is not that of pixels, or if none is true.
    #[must_use]
    pub(crate) fn counting(self, counted: Vec<bool>) -> Self {
        assert_eq!(counted.len(), self.means.len(), "an entry for every pixel");
        assert!(counted.contains(&true), "at least one pixel is compared");
        Self { counted, ..self }
    }

    /// The values of the compared pixels, of values for all pixels.
    fn of_counted<'a, T: 'a>(&'a self, all: impl Iterator<Item = T> + 'a) -> impl Iterator<Item = T> + 'a {
        all.zip(&self.counted).filter_map(|(x, counted)| counted.then_some(x))
    }

    /// The radiance of every pixel, row by row from the top.
    pub(crate) fn means(&self) -> &[Rgb] {
        &self.means
    }

    /// The mean over all compared pixels and all components.
    pub(crate) fn mean(&self) -> f64 {
        mean(self.of_counted(self.means.iter().map(|mean| mean.mean())))
    }

    /// Root of the mean squared standard error, divided by [`Truth::mean`]; 0 for a closed form.
    pub(crate) fn relative_std_err(&self) -> f64 {
        self.relative_rmse(self.variances.iter().copied())
    }

    /// A film's own estimate of its relative RMSE over the compared pixels, relative to [`Truth::mean`];
    /// infinite before it has two observations.
    pub(crate) fn estimated_rmse(&self, film: &Film) -> f64 {
        self.relative_rmse(film.variances_of_mean())
    }

    fn relative_rmse(&self, variances: impl Iterator<Item = Rgb>) -> f64 {
        let (sum, count) =
            self.of_counted(variances).fold((0.0, 0.0), |(sum, n), v| (sum + v.mean(), n + 1.0));
        f64::sqrt(sum / count) / self.mean()
    }
}

/// The tile or block, of this side, that each pixel of a picture belongs to, row by row.
fn tiles_of_pixels(width: u32, height: u32, side: u32) -> impl Iterator<Item = u32> {
    (0..height).flat_map(move |y| (0..width).map(move |x| y / side * width.div_ceil(side) + x / side))
}

/// The mean of some numbers, each with its tile, and its standard error, if tiles are independent of each other; NaN for
/// a single tile.
fn mean_of_tiles(numbers: impl Iterator<Item = (u32, f64)>) -> (f64, f64) {
    let numbers: Vec<(u32, f64)> = numbers.collect();
    let mean = mean(numbers.iter().map(|(_, x)| *x));
    let mut deviations = BTreeMap::new();
    let mut count = 0.0;
    for (tile, x) in numbers {
        *deviations.entry(tile).or_insert(0.0) += x - mean;
        count += 1.0;
    }
    let squares: f64 = deviations.values().map(|deviation: &f64| deviation * deviation).sum();
    let tiles = deviations.len() as f64;
    let std_err = if tiles > 1.0 { (squares * tiles / (tiles - 1.0)).sqrt() / count } else { f64::NAN };
    (mean, std_err)
}

/// The mean of some numbers, updated with each (Welford 1962).
fn mean(numbers: impl Iterator<Item = f64>) -> f64 {
    (1..).zip(numbers).fold(0.0, |mean, (count, x)| mean + (x - mean) / f64::from(count))
}

/// A film's errors over the compared pixels, relative to their true mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Errors {
    /// Mean squared error over pixels and components, minus the truth's own mean squared error. It may be
    /// negative if the film's error is small beside the truth's.
    pub(crate) mse: f64,
    /// The same over the means of blocks of 4 x 4 pixels, of those that are compared.
    pub(crate) block_mse: f64,
    /// Standard error of `mse`, by the sample variance over the pixels, or over tiles of dependent ones.
    pub(crate) mse_std_err: f64,
    /// Mean error over its standard error, by the sample variance as well. It contains the errors of the film and of the
    /// truth. It is normally distributed for an unbiased film of many pixels.
    pub(crate) z: f64,
    /// The share of the pixel with the largest error in the sum of squared errors. Near 1 that pixel alone
    /// determines `mse` and `z`, and neither is reliable.
    pub(crate) largest_share: f64,
    /// The truth's own mean squared error, divided by the mean squared difference of film and truth.
    pub(crate) truth_share: f64,
}

impl Errors {
    /// Compares `film` with `truth`.
    ///
    /// # Panics
    /// If they differ in size.
    pub(crate) fn of(film: &Film, truth: &Truth) -> Self {
        let pixels: Vec<Rgb> = film.means().collect();
        assert_eq!(pixels.len(), truth.means.len(), "the film has the truth's size");
        let scale = truth.mean();
        let differences =
            || truth.of_counted(pixels.iter().zip(&truth.means)).map(|(&x, &r)| (x + r * -1.0) / scale);
        let square = |x: f64| x * x;
        let squares = || differences().map(|e| e.map(square).mean());
        let own = || truth.of_counted(truth.variances.iter()).map(|v| v.mean() / square(scale));
        let side = film.path_reuse().tile_side().max(truth.tile_side);
        let tiles = || truth.of_counted(tiles_of_pixels(film.width(), film.height(), side));
        let (mse, mse_std_err) = mean_of_tiles(tiles().zip(squares().zip(own()).map(|(e, own)| e - own)));
        let (error, std_err) = mean_of_tiles(tiles().zip(differences().map(|e| e.mean())));
        let in_blocks = |values: Vec<f64>| {
            let blocks =
                truth.of_counted(tiles_of_pixels(film.width(), film.height(), Estimates::BLOCK_SIDE));
            let mut sums = BTreeMap::new();
            for (block, value) in blocks.zip(values) {
                let (sum, count) = sums.entry(block).or_insert((0.0, 0.0));
                (*sum, *count) = (*sum + value, *count + 1.0);
            }
            sums.into_values()
        };
        let component = |c: usize| in_blocks(differences().map(|e| e.to_array()[c]).collect());
        let block_squares = (0..3).flat_map(component).map(|(sum, count)| square(sum / count));
        let block_own = in_blocks(own().collect()).map(|(sum, count)| sum / square(count));
        let block_mse = mean(block_squares) - mean(block_own);
        let (sum, largest) = squares().fold((0.0, 0.0_f64), |(sum, max), e| (sum + e, max.max(e)));
        let over = |x: f64, y: f64| if x == 0.0 { 0.0 } else { x / y };
        Self {
            mse,
            block_mse,
            mse_std_err,
            z: over(error, std_err),
            largest_share: over(largest, sum),
            truth_share: over(own().sum::<f64>(), sum),
        }
    }

    /// The root of [`Errors::mse`]; 0 if that is negative.
    pub(crate) fn rmse(&self) -> f64 {
        self.mse.max(0.0).sqrt()
    }

    /// The root of [`Errors::block_mse`]; 0 if that is negative.
    pub(crate) fn block_rmse(&self) -> f64 {
        self.block_mse.max(0.0).sqrt()
    }

    /// The 95 % confidence interval of [`Errors::rmse`].
    pub(crate) fn interval_95(&self) -> [f64; 2] {
        [-1.96, 1.96].map(|z| (self.mse + z * self.mse_std_err).max(0.0).sqrt())
    }
}

/// The slope of the logarithm of the error over that of the number of samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Slope {
    /// -0.5 for independent samples without bias.
    pub(crate) value: f64,
    /// Its standard error, propagated from those of the errors.
    pub(crate) std_err: f64,
}

impl Slope {
    /// Errors with a larger [`Errors::truth_share`] are not used for a slope.
    const MAX_TRUTH_SHARE: f64 = 0.25;

    /// Fits a line by least squares to `errors`, pairs of a number of samples and the errors of an independent
    /// film. Returns `None` if fewer than three of them clearly exceed the truth's own error.
    ///
    /// All errors have equal weights: weights by precision would favour errors that are small by chance.
    pub(crate) fn fit(errors: &[(u32, Errors)]) -> Option<Self> {
        let usable = errors.iter().filter(|(_, e)| e.truth_share <= Self::MAX_TRUTH_SHARE && e.mse > 0.0);
        let points: Vec<_> = usable
            .map(|(n, e)| (f64::from(*n).ln(), 0.5 * e.mse.ln(), 0.5 * e.mse_std_err / e.mse))
            .collect();
        if points.len() < 3 {
            return None;
        }
        let middle = mean(points.iter().map(|p| p.0));
        let width: f64 = points.iter().map(|p| (p.0 - middle).powi(2)).sum();
        let weight = |x: f64| (x - middle) / width;
        let value = points.iter().map(|p| weight(p.0) * p.1).sum();
        let variance: f64 = points.iter().map(|p| (weight(p.0) * p.2).powi(2)).sum();
        Some(Self { value, std_err: variance.sqrt() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use globillum::integrator::{Estimator, Sampler, render};
    use globillum_testkit::accelerators::RENDERED;
    use globillum_testkit::scenes::{furnace, scene, stare};
    use globillum_testkit::stats::{Z_LIMIT, independent_pixels};

    /// The film of a furnace of albedo 0.5 with Russian roulette from the first bounce on: mean 2, variance 2.
    fn film(samples: u32, max_bounces: Option<u32>) -> Film {
        let mut settings = independent_pixels(64, 64, samples);
        (settings.sampler, settings.estimator) = (Sampler::Independent, Estimator::Bsdf);
        (settings.max_bounces, settings.roulette.start, settings.roulette.threshold) = (max_bounces, 0, 1.0);
        settings.seed = samples.into();
        let camera = stare(DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.35, -0.2, 1.0));
        let scene = scene(&furnace(0.5, 1.0, DVec3::ZERO), RENDERED[0].1);
        render(&scene, &camera, &settings).expect("the scene is good").film
    }

    fn truth() -> Truth {
        Truth::exact(vec![Rgb::splat(2.0); 64 * 64])
    }

    fn ladder(max_bounces: Option<u32>, truth: &Truth) -> Vec<(u32, Errors)> {
        [4, 16, 64].map(|n| (n, Errors::of(&film(n, max_bounces), truth))).to_vec()
    }

    #[test]
    fn errors_of_a_known_variance_are_found() {
        for (samples, errors) in ladder(None, &truth()) {
            // The variance 2 divided by the square of the mean.
            let expected = 0.5 / f64::from(samples);
            assert!((errors.mse - expected).abs() < 5.85 * errors.mse_std_err, "{samples}: {errors:?}");
            assert!(errors.mse_std_err < 0.1 * expected && errors.z.abs() < Z_LIMIT, "{samples}: {errors:?}");
            let [low, high] = errors.interval_95();
            assert!(low < errors.rmse() && errors.rmse() < high && high < 1.2 * low);
        }
    }

    #[test]
    fn the_error_of_the_truth_is_subtracted() {
        let (long, exact) = (Truth::of_film(&film(300, None)), truth());
        assert!((long.relative_std_err() / (0.5_f64 / 300.0).sqrt() - 1.0).abs() < 0.1);
        for samples in [50, 200] {
            let film = film(samples, None);
            let [by_long, by_exact] = [&long, &exact].map(|truth| Errors::of(&film, truth));
            let difference = (by_long.mse - by_exact.mse).abs();
            assert!(difference < 5.85 * by_long.mse_std_err, "{by_long:?} {by_exact:?}");
            assert!((by_long.truth_share - 1.0 / (1.0 + 300.0 / f64::from(samples))).abs() < 0.05);
        }
    }

    /// The film shows 2 everywhere. The truth is 2 for half of the pixels, and 9 for the others, which are
    /// excluded.
    #[test]
    fn only_counted_pixels_are_compared() {
        let counted: Vec<bool> = (0..64 * 64).map(|i| i % 2 == 0).collect();
        let means = counted.iter().map(|&counted| Rgb::splat(if counted { 2.0 } else { 9.0 })).collect();
        let (truth, film) = (Truth::exact(means).counting(counted), film(256, None));
        let errors = Errors::of(&film, &truth);
        assert!(truth.mean() == 2.0 && errors.z.abs() < Z_LIMIT, "{errors:?}");
        let estimated = truth.estimated_rmse(&film);
        assert!((estimated / errors.rmse() - 1.0).abs() < 0.08, "{estimated} {errors:?}");
    }

    #[test]
    fn a_slope_is_minus_one_half_unless_there_is_a_bias() {
        let slope = Slope::fit(&ladder(None, &truth())).unwrap();
        assert!((slope.value + 0.5).abs() < 5.85 * slope.std_err && slope.std_err < 0.02, "{slope:?}");
        // The radiance of more than two bounces, an eighth of the total, is missing.
        let biased = ladder(Some(2), &truth());
        assert!(biased[2].1.z < -10.0 * Z_LIMIT, "{biased:?}");
        let slope = Slope::fit(&biased).unwrap();
        assert!(slope.value > -0.5 + 5.85 * slope.std_err, "{slope:?}");
        assert_eq!(Slope::fit(&biased[..2]), None);
    }
}
