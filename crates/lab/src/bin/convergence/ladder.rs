//! One combination at doubling numbers of samples.

use crate::combination::Combination;
use crate::plan::Plan;
use crate::reference::Reference;
use crate::subject::Subject;
use anyhow::Result;
use globillum::geom::Accel;
use globillum::integrator::{Scene, render};
use globillum_cli::AccelKind;
use globillum_testkit::convergence::{Errors, Slope};
use globillum_testkit::hash;
use globillum_testkit::lab::median;
use globillum_testkit::verdict::Verdict;
use std::time::Instant;

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
            let (picture, seconds) =
                timed(plan.repeats(samples), || Ok(render(scene, &subject.camera, &settings, &())?))?;
            let film = picture.film;
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

/// What `work` returned last, and the median of the seconds that it took, in so many runs.
fn timed<T>(repeats: u32, work: impl Fn() -> Result<T>) -> Result<(T, f64)> {
    let run = || -> Result<(T, f64)> {
        let start = Instant::now();
        Ok((work()?, start.elapsed().as_secs_f64()))
    };
    let (mut result, first) = run()?;
    let mut times = vec![first];
    for _ in 1..repeats {
        let (again, seconds) = run()?;
        result = again;
        times.push(seconds);
    }
    Ok((result, median(times)))
}
