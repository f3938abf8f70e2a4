//! What is concluded from the errors of a way to render.

use super::errors::{Errors, Slope};
use globillum::integrator::Sampler;
use globillum_testkit::stats::Z_LIMIT;
use std::fmt;

/// Whether a way to render is right on average.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// Nothing speaks against it.
    Unbiased,
    /// The mean is wrong.
    BiasedMean,
    /// The error falls too slowly: some of it stays.
    ErrorStays,
    /// The error of independent samples falls too fast: they are not independent.
    TooSteep,
    /// A few pixels make up most of the error, and nothing can be concluded.
    HeavyTail,
    /// The reference is no better than what it is to judge.
    ReferenceTooPoor,
}

impl Verdict {
    /// A pixel with a larger share of all squared errors makes both tests worthless.
    const HEAVY: f64 = 0.05;

    /// By the errors of the level of most samples, and the slope over all levels.
    pub(crate) fn of(sampler: Sampler, slope: Option<Slope>, errors: &Errors) -> Self {
        if errors.z.abs() > Z_LIMIT {
            return Self::BiasedMean;
        }
        if errors.largest_share > Self::HEAVY {
            return Self::HeavyTail;
        }
        let Some(Slope { value, std_err }) = slope else { return Self::ReferenceTooPoor };
        let margin = Z_LIMIT * std_err;
        if value + 0.5 > margin {
            Self::ErrorStays
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
            Self::ErrorStays => "**biased**: error that stays",
            Self::TooSteep => "**not independent**",
            Self::HeavyTail => "heavy tail: none",
            Self::ReferenceTooPoor => "reference too poor: none",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_flaw_has_its_verdict() {
        let errors =
            |z, largest_share| Errors { mse: 1e-4, mse_std_err: 1e-6, z, largest_share, truth_share: 0.0 };
        let slope = |value| Some(Slope { value, std_err: 0.01 });
        let fine = errors(3.0, 0.001);
        for (sampler, slope, errors, verdict) in [
            (Sampler::Independent, slope(-0.52), fine, Verdict::Unbiased),
            (Sampler::Sobol, slope(-1.2), fine, Verdict::Unbiased),
            (Sampler::Independent, slope(-0.6), fine, Verdict::TooSteep),
            (Sampler::Sobol, slope(-0.4), fine, Verdict::ErrorStays),
            (Sampler::Sobol, slope(-1.2), errors(-6.0, 0.001), Verdict::BiasedMean),
            (Sampler::Sobol, slope(-1.2), errors(0.0, 0.3), Verdict::HeavyTail),
            (Sampler::Sobol, None, fine, Verdict::ReferenceTooPoor),
        ] {
            assert_eq!(Verdict::of(sampler, slope, &errors), verdict, "{sampler:?} {slope:?} {errors:?}");
        }
    }
}
