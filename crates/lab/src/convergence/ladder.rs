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
use globillum::integrator::{Scene, render};
use globillum_cli::AccelKind;
use globillum_testkit::hash;

/// Seconds that all runs of a picture take, about.
const ENOUGH: f64 = 0.1;
const MOST_RUNS: f64 = 9.0;

/// A picture of so many samples.
pub(crate) struct Level {
    pub(crate) samples: u32,
    pub(crate) seconds: f64,
    pub(crate) errors: Errors,
    pub(crate) hash: u64,
}

/// Pictures of doubling numbers of samples, of a seed each.
pub(crate) struct Ladder {
    pub(crate) accel: AccelKind,
    pub(crate) combination: Combination,
    pub(crate) levels: Vec<Level>,
}

impl Ladder {
    /// Renders all levels; Sobol' points are stratified over all samples of a level.
    pub(crate) fn climb(
        subject: &Subject,
        (accel, scene): (AccelKind, &Scene<Box<dyn Accel>>),
        combination: Combination,
        reference: &Reference,
        plan: &Plan,
    ) -> Result<Self> {
        let truth = reference.truth(combination);
        let level = |&samples: &u32| -> Result<Level> {
            let mut settings = plan.settings(samples);
            combination.apply(&mut settings);
            settings.pass_samples = samples;
            // Levels share no random numbers, so that their errors are independent.
            settings.seed = settings.seed.wrapping_add(u64::from(samples) << 32);
            let (film, seconds) = median_time(|| Ok(render(scene, &subject.camera, &settings, &())?.film))?;
            Ok(Level { samples, seconds, errors: Errors::of(&film, truth), hash: hash::of_film(&film) })
        };
        Ok(Self { accel, combination, levels: plan.samples.iter().map(level).collect::<Result<_>>()? })
    }

    /// The level of most samples.
    pub(crate) fn top(&self) -> &Level {
        &self.levels[self.levels.len() - 1]
    }

    /// Of the error over the number of samples; `None` where the reference is not good enough.
    pub(crate) fn slope(&self) -> Option<Slope> {
        let errors: Vec<_> = self.levels.iter().map(|level| (level.samples, level.errors)).collect();
        Slope::fit(&errors)
    }

    /// Whether it is right on average, as far as can be seen.
    pub(crate) fn verdict(&self) -> Verdict {
        Verdict::of(self.combination.sampler, self.slope(), &self.top().errors)
    }

    /// Relative mean squared error times seconds, of the level of most samples.
    pub(crate) fn mse_seconds(&self) -> f64 {
        self.top().errors.mse * self.top().seconds
    }
}

/// What `work` returned last, and the median of the seconds that it took: the shorter a run, the more of
/// them, since a disturbance weighs more.
fn median_time<T>(work: impl Fn() -> Result<T>) -> Result<(T, f64)> {
    let (result, first) = timed(&work);
    let (mut result, mut times) = (result?, vec![first]);
    let runs = (ENOUGH / first).ceil().clamp(1.0, MOST_RUNS) as usize | 1;
    for _ in 1..runs {
        let (again, seconds) = timed(&work);
        result = again?;
        times.push(seconds);
    }
    Ok((result, median(times)))
}
