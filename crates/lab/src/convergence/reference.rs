//! The reference that pictures are compared with.

use super::combination::Combination;
use super::errors::Truth;
use super::plan::Plan;
use super::subject::Subject;
use anyhow::{Result, ensure};
use globillum::integrator::{Estimator, PathReuse, Sampler, render};
use globillum_cli::AccelKind;

/// The reference picture.
pub(crate) enum Reference {
    /// A closed form.
    ClosedForm(Truth),
    /// Two long runs. Each combination is compared with the run of another estimator. Pixels that show a
    /// light are excluded; `without_lights` is the share of the others.
    Runs { by_light: Truth, by_mis: Truth, without_lights: f64 },
}

/// Samples of a long run that are stratified together.
const PASS: u32 = 64;

/// Samples per pixel that detect a light; enough for one that covers a thousandth of a pixel.
const LIGHT_SAMPLES: u32 = 1024;

/// Differs from the seeds of pictures.
const SEED: u64 = 0x0072_6566_6572_656e;

impl Reference {
    /// The number of long runs.
    pub(crate) const RUNS: usize = 2;

    /// The reference of `subject`: its closed form, else two long runs rendered with `accel`. `done` is called
    /// [`Reference::RUNS`] times.
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
            let picture = render(&scene, &subject.camera, &settings)?;
            done();
            Ok(Truth::of_film(&picture.film).counting(counted.clone()))
        };
        let (by_light, by_mis) = (run(Estimator::Light, 1 << 63)?, run(Estimator::Mis, 0)?);
        ensure!(by_mis.mean() > 0.0, "the picture is black: no radiance reaches the camera");
        let share = counted.iter().filter(|&&counted| counted).count() as f64 / counted.len() as f64;
        Ok(Self::Runs { by_light, by_mis, without_lights: share })
    }

    /// The picture that `combination` is compared with.
    pub(crate) fn truth(&self, combination: Combination) -> &Truth {
        match self {
            Self::ClosedForm(truth) => truth,
            Self::Runs { by_light, .. } if combination.estimator == Estimator::Mis => by_light,
            Self::Runs { by_mis, .. } => by_mis,
        }
    }

    /// A description for the report.
    pub(crate) fn describe(&self, plan: &Plan) -> String {
        match self {
            Self::ClosedForm(_) => "Compared with a closed form, pixel by pixel.".to_owned(),
            Self::Runs { by_light, by_mis, without_lights } => {
                let [light, mis] = [by_light, by_mis].map(|truth| 100.0 * truth.relative_std_err());
                format!(
                    "Compared with two runs of {} samples per pixel, by Sobol' points of other seeds in passes of \
                     {PASS}: `Mis` with a run by `Light`, whose standard error is {light:.3} % of the mean radiance, \
                     the others with a run by `Mis` ({mis:.3} %). The squared errors of these runs are subtracted; \
                     intervals and z include them. The {:.1} % of the pixels that show a light are excluded, because \
                     the error at a light's edge is the same for all estimators and hides the differences.",
                    plan.reference_samples,
                    100.0 * (1.0 - without_lights)
                )
            }
        }
    }
}

/// The pixels that show no light; all pixels if every one shows a light.
fn without_lights(subject: &Subject, accel: AccelKind, plan: &Plan) -> Result<Vec<bool>> {
    let mut settings = plan.settings(LIGHT_SAMPLES);
    (settings.max_bounces, settings.pass_samples) = (Some(0), LIGHT_SAMPLES);
    let emitted = render(&subject.without_environment(accel)?, &subject.camera, &settings)?.film;
    let dark: Vec<bool> = emitted.means().map(|mean| mean.is_black()).collect();
    Ok(if dark.contains(&true) { dark } else { vec![true; dark.len()] })
}
