//! All measurements of one scene.

use super::combination::{Combination, accel_name};
use super::ladder::Ladder;
use super::plan::Plan;
use super::race::Race;
use super::reference::Reference;
use super::subject::Subject;
use anyhow::{Result, ensure};
use globillum::geom::Accel;
use globillum::integrator::Scene;
use globillum_cli::AccelKind;
use indicatif::ProgressBar;

/// The measurements of a scene.
pub(crate) struct Study {
    pub(crate) name: String,
    pub(crate) triangles: usize,
    /// A description of the reference.
    pub(crate) reference: String,
    /// The largest of the reference's own relative standard errors; 0 for a closed form.
    pub(crate) reference_error: f64,
    /// For each combination, all accelerators; [`Combination::TRUNCATED`] comes last.
    pub(crate) ladders: Vec<Ladder>,
    pub(crate) races: Vec<Race>,
    /// Mean radiance.
    pub(crate) mean: f64,
}

impl Study {
    /// The number of steps by which a study advances the progress bar.
    pub(crate) fn steps(plan: &Plan) -> usize {
        Reference::RUNS + 2 * Combination::UNBIASED * plan.accels.len() + 1
    }

    /// Measures `subject`.
    pub(crate) fn of(subject: &Subject, plan: &Plan, bar: &ProgressBar) -> Result<Self> {
        let built = |&accel: &AccelKind| Ok((accel, subject.scene(accel)?));
        let scenes: Vec<(AccelKind, Scene<Box<dyn Accel>>)> =
            plan.accels.iter().map(built).collect::<Result<_>>()?;
        let (first, scene) = &scenes[0];
        bar.set_message(format!("{}: reference", subject.name));
        let reference = Reference::of(subject, *first, plan, || bar.inc(1))?;

        let (mut ladders, mut races): (Vec<Ladder>, Vec<Race>) = (Vec::new(), Vec::new());
        for combination in Combination::unbiased() {
            let (estimator, sampler) = (combination.estimator_name(), combination.sampler_name());
            bar.set_message(format!("{}: {estimator}, {sampler}", subject.name));
            for (accel, scene) in &scenes {
                ladders.push(Ladder::measure(subject, *accel, scene, combination, &reference, plan)?);
                bar.inc(1);
                races.push(Race::run(subject, *accel, scene, combination, &reference, plan)?);
                bar.inc(1);
            }
        }
        ladders.push(Ladder::measure(subject, *first, scene, Combination::TRUNCATED, &reference, plan)?);
        bar.inc(1);

        let truth = |combination| reference.truth(combination);
        let errors = Combination::unbiased().map(|combination| truth(combination).relative_std_err());
        let study = Self {
            name: subject.name.clone(),
            triangles: subject.model.triangles().len(),
            reference: reference.describe(plan),
            reference_error: errors.fold(0.0, f64::max),
            mean: truth(Combination::TRUNCATED).mean(),
            ladders,
            races,
        };
        study.assert_same_pictures()?;
        Ok(study)
    }

    /// Fails unless all accelerators render the same pictures, to the bit.
    fn assert_same_pictures(&self) -> Result<()> {
        for ladder in &self.ladders {
            let first = self.ladders.iter().find(|other| other.combination == ladder.combination);
            let levels = first.map_or(&[][..], |first| &first.levels);
            for (level, other) in ladder.levels.iter().zip(levels) {
                ensure!(
                    level.hash == other.hash,
                    "the {} renders a different picture: hash {:016x} instead of {:016x}",
                    accel_name(ladder.accel),
                    level.hash,
                    other.hash
                );
            }
        }
        Ok(())
    }

    /// The ladders of the first accelerator. The errors are the same for all accelerators.
    pub(crate) fn ladders_of_first(&self) -> impl Iterator<Item = &Ladder> {
        self.ladders.iter().filter(|ladder| ladder.accel == self.ladders[0].accel)
    }

    /// The ladders of each accelerator.
    pub(crate) fn ladders_by_accel(&self) -> Vec<Vec<&Ladder>> {
        let mut groups: Vec<Vec<&Ladder>> = Vec::new();
        for ladder in &self.ladders {
            match groups.iter_mut().find(|group| group[0].accel == ladder.accel) {
                Some(group) => group.push(ladder),
                None => groups.push(vec![ladder]),
            }
        }
        groups
    }

    /// The equal-time pictures of the first accelerator.
    pub(crate) fn races_of_first(&self) -> impl Iterator<Item = &Race> {
        self.races.iter().filter(|race| race.accel == self.ladders[0].accel)
    }
}
