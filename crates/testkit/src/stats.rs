//! Statistics with a stated risk of false alarm.
//!
//! All tests of a single mean together may raise a false alarm with probability 1e-6. Over 200 tests that leaves
//! 5e-9 each (Sidak), which a normal variate exceeds at 5.85 standard deviations. A test of a
//! mean must also be precise: with too few samples any mean would pass.

use globillum_integrator::{Film, PathReuse, Settings};
use globillum_material::Rgb;
use std::collections::BTreeMap;

/// The limit of a mean's error in standard errors, by the suite's risk of false alarm.
pub const Z_LIMIT: f64 = 5.85;

/// The largest accepted half width of an interval, relative to the truth.
pub const PRECISION: f64 = 0.005;

/// [`Settings::new`] without path reuse: pixels are independent, which gives a mean its smallest error.
pub fn independent_pixels(width: u32, height: u32, samples: u32) -> Settings {
    let mut settings = Settings::new(width, height, samples);
    settings.path_reuse = PathReuse::Off;
    settings
}

/// For each tile of [`PathReuse::tile_side`] pixels, by column and row, the largest possible standard deviation of the sum of its pixels: the
/// sum of those of its blocks of 4 x 4.
fn tile_std_devs(film: &Film, component: impl Fn(Rgb) -> f64) -> BTreeMap<(u32, u32), f64> {
    let starts = |size: u32| (0..size).step_by(4);
    let blocks = starts(film.height()).flat_map(|y| starts(film.width()).map(move |x| (x, y)));
    let side = film.path_reuse().tile_side();
    let mut std_devs = BTreeMap::new();
    for ((x, y), variance) in blocks.zip(film.block_variances_of_mean()) {
        let pixels = f64::from((film.width() - x).min(4) * (film.height() - y).min(4));
        *std_devs.entry((x / side, y / side)).or_default() += pixels * component(variance).sqrt();
    }
    std_devs
}

/// A mean and its standard error.
#[derive(Clone, Copy, Debug)]
pub struct Estimate {
    /// The mean.
    pub mean: f64,
    /// Its standard error.
    pub std_err: f64,
    /// The number of samples.
    pub count: f64,
}

impl Estimate {
    /// The mean of one colour component over all pixels of `film`, which must have the same expectation. `std_err` follows
    /// from the variances of independent pixels. With path reuse it is an upper bound, which holds however the blocks of a
    /// tile depend on each other.
    pub fn of_film(film: &Film, component: impl Fn(Rgb) -> f64) -> Self {
        let pixels = || (0..film.height()).flat_map(|y| (0..film.width()).map(move |x| (x, y)));
        let n = pixels().count() as f64;
        let mean = pixels().map(|(x, y)| component(film.mean(x, y))).sum::<f64>() / n;
        // The variances of independent terms add up to that of the sum.
        let within: f64 = match film.path_reuse() {
            PathReuse::Off => film.variances_of_mean().map(&component).sum(),
            _ => tile_std_devs(film, &component).into_values().map(|std_dev| std_dev * std_dev).sum(),
        };
        let count = n * film.samples() as f64;
        Self { mean, std_err: within.sqrt() / n, count }
    }

    /// The variance of a single sample; requires independent samples and pixels.
    pub fn sample_variance(&self) -> f64 {
        self.std_err * self.std_err * self.count
    }

    /// Distance to `truth` in standard errors.
    pub fn z(&self, truth: f64) -> f64 {
        (self.mean - truth) / self.std_err
    }

    /// Asserts that this and an independent `other` are of the same mean, within [`Z_LIMIT`] and a margin of at most
    /// `precision` of the mean.
    ///
    /// # Panics
    /// If they are not, naming `what`.
    pub fn assert_agrees(&self, other: &Self, precision: f64, what: &str) {
        let margin = Z_LIMIT * self.std_err.hypot(other.std_err);
        assert!(margin <= precision * self.mean, "{what} is too wide: {self:?}, {other:?}");
        let apart = (self.mean - other.mean).abs();
        assert!(apart <= margin + 1e-12 * self.mean, "{what}: {self:?}, {other:?}");
    }

    /// Asserts that the mean is `truth`, within [`Z_LIMIT`] and with [`PRECISION`].
    ///
    /// # Panics
    /// If it is not, naming `what`.
    pub fn assert_is(&self, truth: f64, what: &str) {
        let margin = Z_LIMIT * self.std_err;
        assert!(margin <= PRECISION * truth, "{what}: {self:?} is too wide for {truth}");
        let error = (self.mean - truth).abs();
        assert!(error <= margin + 1e-12 * truth, "{what}: {self:?} is not {truth}, z = {}", self.z(truth));
    }
}
