use super::Film;

/// How far a picture is from the truth, told by its own samples.
///
/// Relative to the picture's mean radiance, over all pixels and components alike.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ImageError {
    /// Root of the mean squared error: the standard errors of the pixels, averaged as squares, over
    /// the picture's mean radiance. Infinite before there are two observations, 0 for a black
    /// picture without spread.
    pub relative_rmse: f64,
    /// The interval that holds `relative_rmse` with a probability of 95 %, from the spread of the
    /// pixels' estimates. Since part of that spread is that some pixels are truly noisier, it is
    /// rather too wide. Where pixels share paths, it is twice as wide for that.
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
        let (mut count, mut mse, mut deviations) = (0.0, 0.0, 0.0);
        for variance in film.variances_of_mean().map(|variance| variance.mean()) {
            count += 1.0;
            let apart = variance - mse;
            mse += apart / count;
            deviations += apart * (variance - mse);
        }
        // Of one pixel's spread nothing is known.
        let independent = if count < 2.0 { f64::INFINITY } else { deviations / (count * (count - 1.0)) };
        let margin = 1.96 * (independent * f64::from(film.path_reuse().dependent_pixels())).sqrt();
        let mean = film.image_mean().mean();
        let relative = |mse: f64| if mse == 0.0 { 0.0 } else { mse.sqrt() / mean };
        Self {
            relative_rmse: relative(mse),
            interval_95: [relative((mse - margin).max(0.0)), relative(mse + margin)],
        }
    }
}
