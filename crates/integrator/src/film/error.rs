use super::dispersion::Dispersion;
use super::{Film, student};

/// How far pictures of these samples are from the truth, told by the samples.
///
/// Relative to the picture's mean radiance, over all pixels and components alike.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ImageError {
    /// Root of the mean squared error: the standard errors of the pixels, averaged as squares, over
    /// the picture's mean radiance. Infinite before there are two observations, 0 if no pixel varied.
    pub relative_rmse: f64,
    /// The interval that holds with a probability of 95 % what `relative_rmse` is on average over all seeds.
    ///
    /// With four observations or more it comes from the difference between two halves of the passes, of
    /// which only chance is the reason, summed over squares of pixels that are independent of each other.
    /// With fewer it comes from the differences between the squares, of which some are truly noisier, and is
    /// too wide; `[0, inf]` if nothing is known. How often it holds, and where less: docs/estimators.md.
    pub interval_95: [f64; 2],
}

impl Film {
    /// How far the whole picture is from the truth.
    pub fn error(&self) -> ImageError {
        ImageError::of(self)
    }
}

impl ImageError {
    /// What is known before there are two observations: nothing.
    const UNKNOWN: Self = Self { relative_rmse: f64::INFINITY, interval_95: [0.0, f64::INFINITY] };

    fn of(film: &Film) -> Self {
        if film.observations() < 2 {
            return Self::UNKNOWN;
        }
        let mse = film.mean_variance().mean();
        if mse == 0.0 {
            return Self { relative_rmse: 0.0, interval_95: [0.0; 2] };
        }
        let relative_rmse = mse.sqrt() / film.image_mean().mean();
        let Dispersion { variance, dof } = film.dispersion();
        if dof == 0.0 {
            return Self { relative_rmse, interval_95: [0.0, f64::INFINITY] };
        }
        // Of the logarithm, which is less skewed than the variance; half of it for the root.
        let std_err = (variance / (film.observations() - 1) as f64).sqrt() / 2.0;
        let factor = (student::quantile_975(dof as u64) * std_err).exp();
        Self { relative_rmse, interval_95: [relative_rmse / factor, relative_rmse * factor] }
    }
}
