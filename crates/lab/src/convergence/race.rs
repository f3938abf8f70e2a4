//! One combination rendered for a given time.

use super::combination::Combination;
use super::errors::{Errors, Truth};
use super::plan::Plan;
use super::reference::Reference;
use super::subject::Subject;
use anyhow::Result;
use globillum::geom::Accel;
use globillum::integrator::{Film, Render, Scene};
use globillum_cli::AccelKind;
use std::time::Instant;

/// A picture rendered for at most the given time; the first pass is always completed.
pub(crate) struct Race {
    pub(crate) accel: AccelKind,
    pub(crate) combination: Combination,
    pub(crate) samples: u32,
    pub(crate) seconds: f64,
    /// The errors against the truth.
    pub(crate) errors: Errors,
    /// The film's own estimate of its relative RMSE; infinite after a single pass of Sobol' points.
    pub(crate) estimated_rmse: f64,
    pub(crate) film: Film,
    /// The RMSE of each pixel over its components, relative to the truth's mean.
    pub(crate) error_map: Vec<f64>,
}

impl Race {
    /// Renders with a time limit, in passes of the default length.
    pub(crate) fn run(
        subject: &Subject,
        accel: AccelKind,
        scene: &Scene<Box<dyn Accel>>,
        combination: Combination,
        reference: &Reference,
        plan: &Plan,
    ) -> Result<Self> {
        let mut settings = plan.settings(u32::MAX);
        combination.apply(&mut settings);
        let start = Instant::now();
        let picture = Render::new(scene, &subject.camera, &settings).until(plan.stop()).run()?;
        let seconds = start.elapsed().as_secs_f64();
        let truth = reference.truth(combination);
        Ok(Self {
            accel,
            combination,
            samples: picture.samples,
            seconds,
            errors: Errors::of(&picture.film, truth),
            estimated_rmse: truth.estimated_rmse(&picture.film),
            error_map: error_map(&picture.film, truth),
            film: picture.film,
        })
    }
}

fn error_map(film: &Film, truth: &Truth) -> Vec<f64> {
    let mean = truth.mean();
    let error = |x: [f64; 3], r: [f64; 3]| {
        let squares: f64 = x.iter().zip(r).map(|(x, r)| (x - r) * (x - r)).sum();
        (squares / 3.0).sqrt() / mean
    };
    film.means().zip(truth.means()).map(|(x, r)| error(x.to_array(), r.to_array())).collect()
}
