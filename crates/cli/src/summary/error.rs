use globillum::integrator::ErrorEstimate;
use serde::Serialize;
use std::fmt::{self, Display};

/// How far a picture is from its expectation.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct PictureError {
    /// Root mean squared error of the pixels over the picture's mean; `None` while it is not known.
    relative_rmse: Option<f64>,
    /// Its 95 % confidence interval.
    relative_rmse_95: Option<[f64; 2]>,
}

impl PictureError {
    /// Whether the upper end of the interval is known and at most `goal`.
    pub(super) fn reaches(&self, goal: f64) -> bool {
        self.relative_rmse_95.is_some_and(|[_, high]| high <= goal)
    }
}

impl From<ErrorEstimate> for PictureError {
    fn from(error: ErrorEstimate) -> Self {
        // Equal observations tell nothing unless they are many.
        let known =
            error.relative_rmse.is_finite() && (error.relative_rmse > 0.0 || error.interval_95[1] == 0.0);
        Self {
            relative_rmse: known.then_some(error.relative_rmse),
            relative_rmse_95: known.then_some(error.interval_95).filter(|interval| interval[1].is_finite()),
        }
    }
}

impl Display for PictureError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(error) = self.relative_rmse.map(|share| 100.0 * share) else {
            return writeln!(f, "error         unknown: it takes two passes or more, of which some differ");
        };
        write!(f, "error         {error:.3} % of the mean")?;
        match self.relative_rmse_95.map(|interval| interval.map(|share| 100.0 * share)) {
            Some([low, high]) => writeln!(f, " (95 % confidence interval {low:.3} to {high:.3} %)"),
            None => writeln!(f),
        }
    }
}
