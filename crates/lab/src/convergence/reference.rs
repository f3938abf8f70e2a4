//! What pictures are compared with.

use super::combination::Combination;
use super::errors::Truth;
use super::plan::Plan;
use super::subject::Subject;
use anyhow::{Result, ensure};
use globillum::integrator::{Estimator, PathReuse, Sampler, render};
use globillum_cli::AccelKind;

/// The picture as it should be.
pub(crate) enum Reference {
    /// By a formula.
    ClosedForm(Truth),
    /// By two long runs: each combination is compared with the one of another estimator. Pixels in
    /// which a light is seen do not count; the others are this share of all.
    Runs { by_light: Truth, by_mis: Truth, without_lights: f64 },
}

/// Samples of a long run that are stratified together.
const PASS: u32 = 64;

/// Samples by which a light that covers a thousandth of a pixel is found.
const LIGHT_SAMPLES: u32 = 1024;

/// Far from the seeds of pictures.
const SEED: u64 = 0x0072_6566_6572_656e;

impl Reference {
    /// How many long runs there may be.
    pub(crate) const RUNS: usize = 2;

    /// Of `subject`, rendered with `accel` where no formula is known; `done` is called after each run.
    pub(crate) fn of(
        subject: &Subject,
        accel: AccelKind,
        plan: &Plan,
        mut done: impl FnMut(),
    ) -> Result<Self> {
        if let Some(truth) = subject.closed_form(plan.side) {
            (0..Self::RUNS).for_each(|_| done());
            return Ok(Self::ClosedForm(truth));
        }
        let counted = without_lights(subject, accel, plan)?;
        let scene = subject.scene(accel)?;
        let mut run = |estimator, seed: u64| -> Result<Truth> {
            let mut settings = plan.settings(plan.reference_samples);
            (settings.estimator, settings.sampler) = (estimator, Sampler::Sobol);
            (settings.pass_samples, settings.seed) = (PASS, SEED ^ plan.seed ^ seed);
            settings.path_reuse = PathReuse::Off;
            let picture = render(&scene, &subject.camera, &settings, &())?;
            done();
            Ok(Truth::of_film(&picture.film).counting(counted.clone()))
        };
        let (by_light, by_mis) = (run(Estimator::Light, 1 << 63)?, run(Estimator::Mis, 0)?);
        ensure!(by_mis.mean() > 0.0, "no light reaches the camera");
        let share = counted.iter().filter(|&&counted| counted).count() as f64 / counted.len() as f64;
        Ok(Self::Runs { by_light, by_mis, without_lights: share })
    }

    /// What `combination` is compared with.
    pub(crate) fn truth(&self, combination: Combination) -> &Truth {
        match self {
            Self::ClosedForm(truth) => truth,
            Self::Runs { by_light, .. } if combination.estimator == Estimator::Mis => by_light,
            Self::Runs { by_mis, .. } => by_mis,
        }
    }

    /// In a sentence.
    pub(crate) fn describe(&self, plan: &Plan) -> String {
        match self {
            Self::ClosedForm(_) => "Compared with a closed form, pixel by pixel.".to_owned(),
            Self::Runs { by_light, by_mis, without_lights } => {
                let [light, mis] = [by_light, by_mis].map(|truth| 100.0 * truth.relative_std_err());
                format!(
                    "Compared with two runs of {} samples a pixel, by Sobol' points of other seeds in passes of \
                     {PASS}: `Mis` with one by `Light`, whose standard error is {light:.3} % of the mean radiance, \
                     the others with one by `Mis` ({mis:.3} %). What these errors add is subtracted; it is within \
                     all intervals and z. The {:.1} % of the pixels in which a light is seen are left out: a light's \
                     edge is the same to all, and hides what differs.",
                    plan.reference_samples,
                    100.0 * (1.0 - without_lights)
                )
            }
        }
    }
}

/// Which pixels see no light; all, if there is no such pixel.
fn without_lights(subject: &Subject, accel: AccelKind, plan: &Plan) -> Result<Vec<bool>> {
    let mut settings = plan.settings(LIGHT_SAMPLES);
    (settings.max_bounces, settings.pass_samples) = (Some(0), LIGHT_SAMPLES);
    let emitted = render(&subject.without_environment(accel)?, &subject.camera, &settings, &())?.film;
    let dark: Vec<bool> = emitted.means().map(|mean| mean.is_black()).collect();
    Ok(if dark.contains(&true) { dark } else { vec![true; dark.len()] })
}
