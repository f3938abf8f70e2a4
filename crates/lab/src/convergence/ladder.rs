//! One combination at doubling numbers of samples.

use super::combination::Combination;
use super::errors::{Errors, Slope};
use super::plan::Plan;
use super::reference::Reference;
use super::subject::Subject;
use super::verdict::Verdict;
use crate::timing::{median, timed};
use anyhow::Result;
use globillum::geom::Accel;
use globillum::integrator::{Film, Scene, render};
use globillum_cli::AccelKind;
use globillum_testkit::hash;

/// Target for the total seconds of all runs of a picture.
const TARGET_SECONDS: f64 = 0.2;
/// Largest number of runs; odd, for the median.
const MAX_RUNS: usize = 9;

/// The error and time of a picture with `samples` samples per pixel.
pub(crate) struct Level {
    pub(crate) samples: u32,
    pub(crate) seconds: f64,
    pub(crate) errors: Errors,
    pub(crate) hash: u64,
}

/// Pictures with doubling numbers of samples, each with its own seed.
pub(crate) struct Ladder {
    pub(crate) accel: AccelKind,
    pub(crate) combination: Combination,
    pub(crate) levels: Vec<Level>,
}

impl Ladder {
    /// Renders all levels. Sobol' points are stratified over all samples of a level.
    pub(crate) fn measure(
        subject: &Subject,
        accel: AccelKind,
        scene: &Scene<Box<dyn Accel>>,
        combination: Combination,
        reference: &Reference,
        plan: &Plan,
    ) -> Result<Self> {
        let settings = |samples: u32| {
            let mut settings = plan.settings(samples);
            combination.apply(&mut settings);
            settings.pass_samples = samples;
            // Levels share no random numbers, so that their errors are independent.
            settings.seed = settings.seed.wrapping_add(u64::from(samples) << 32);
            settings
        };
        let run = |samples: u32| -> Result<(Film, f64)> {
            let (picture, seconds) = timed(|| render(scene, &subject.camera, &settings(samples)));
            Ok((picture?.film, seconds))
        };
        let first: Vec<(Film, f64)> = plan.samples.iter().map(|&n| run(n)).collect::<Result<_>>()?;
        let mut times: Vec<Vec<f64>> = first.iter().map(|&(_, seconds)| vec![seconds]).collect();
        // The levels take turns, so that other load on the machine affects all equally.
        for turn in 1..MAX_RUNS {
            for (&samples, times) in plan.samples.iter().zip(&mut times) {
                if turn < runs(times[0]) {
                    times.push(run(samples)?.1);
                }
            }
        }
        let truth = reference.truth(combination);
        let level = |((&samples, (film, _)), times): ((&u32, (Film, f64)), Vec<f64>)| Level {
            samples,
            seconds: median(times),
            errors: Errors::of(&film, truth),
            hash: hash::of_film(&film),
        };
        let levels = plan.samples.iter().zip(first).zip(times).map(level).collect();
        Ok(Self { accel, combination, levels })
    }

    /// The level with most samples.
    pub(crate) fn top(&self) -> &Level {
        &self.levels[self.levels.len() - 1]
    }

    /// The slope of the error over the number of samples; `None` if the reference is not precise enough.
    pub(crate) fn slope(&self) -> Option<Slope> {
        let errors: Vec<_> = self.levels.iter().map(|level| (level.samples, level.errors)).collect();
        Slope::fit(&errors)
    }

    /// The result of the tests for bias.
    pub(crate) fn verdict(&self) -> Verdict {
        Verdict::of(self.combination.sampler, self.slope(), &self.top().errors)
    }

    /// Relative mean squared error times seconds, of the level with most samples.
    pub(crate) fn mse_seconds(&self) -> f64 {
        self.top().errors.mse * self.top().seconds
    }
}

/// The number of runs of a picture that takes `seconds`. Short times need more, as other load affects them
/// more.
fn runs(seconds: f64) -> usize {
    ((TARGET_SECONDS / seconds).ceil() as usize | 1).min(MAX_RUNS)
}
