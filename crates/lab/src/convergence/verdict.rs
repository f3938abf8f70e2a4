//! The tests for bias.

use super::errors::{Errors, Slope};
use globillum::integrator::Sampler;
use globillum_testkit::stats::Z_LIMIT;
use std::fmt;

/// The result of the tests for bias of a combination.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// No test finds a bias.
    Unbiased,
    /// The mean is wrong.
    BiasedMean,
    /// The error falls too slowly: a part of it does not vanish.
    ResidualError,
    /// The error of independent samples falls too fast: they are not independent.
    TooSteep,
    /// One pixel has too large a share of the squared errors for a conclusion.
    HeavyTail,
    /// The error of the reference is too large for a slope.
    ReferenceTooNoisy,
    /// All pixels depend on each other.
    OneTile,
}

impl Verdict {
    /// If one pixel has a larger share of all squared errors, neither test is reliable.
    const HEAVY: f64 = 0.05;

    /// The verdict by `errors`, those of the level with most samples, and `slope`, that over all levels.
    pub(crate) fn of(sampler: Sampler, slope: Option<Slope>, errors: &Errors) -> Self {
        if errors.z.is_nan() {
            return Self::OneTile;
        }
        if errors.z.abs() > Z_LIMIT {
            return Self::BiasedMean;
        }
        if errors.largest_share > Self::HEAVY {
            return Self::HeavyTail;
        }
        let Some(Slope { value, std_err }) = slope else { return Self::ReferenceTooNoisy };
        let margin = Z_LIMIT * std_err;
        if value + 0.5 > margin {
            Self::ResidualError
        } else if sampler == Sampler::Independent && value + 0.5 < -margin {
            Self::TooSteep
        } else {
            Self::Unbiased
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Unbiased => "no bias found",
            Self::BiasedMean => "**biased**: the mean",
            Self::ResidualError => "**biased**: residual error",
            Self::TooSteep => "**not independent**",
            Self::HeavyTail => "none: heavy tail",
            Self::ReferenceTooNoisy => "none: reference too noisy",
            Self::OneTile => "none: a single tile",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_flaw_has_its_verdict() {
        let errors = |z, largest_share| Errors {
            mse: 1e-4,
            block_mse: 1e-5,
            mse_std_err: 1e-6,
            z,
            largest_share,
            truth_share: 0.0,
        };
        let slope = |value| Some(Slope { value, std_err: 0.01 });
        let fine = errors(3.0, 0.001);
        for (sampler, slope, errors, verdict) in [
            (Sampler::Independent, slope(-0.52), fine, Verdict::Unbiased),
            (Sampler::Sobol, slope(-1.2), fine, Verdict::Unbiased),
            (Sampler::Independent, slope(-0.6), fine, Verdict::TooSteep),
            (Sampler::Sobol, slope(-0.4), fine, Verdict::ResidualError),
            (Sampler::Sobol, slope(-1.2), errors(-6.0, 0.001), Verdict::BiasedMean),
            (Sampler::Sobol, slope(-1.2), errors(0.0, 0.3), Verdict::HeavyTail),
            (Sampler::Sobol, None, fine, Verdict::ReferenceTooNoisy),
        ] {
            assert_eq!(Verdict::of(sampler, slope, &errors), verdict, "{sampler:?} {slope:?} {errors:?}");
        }
    }
}
