use crate::param::Param;
use crate::{Film, RenderError};

/// Conditions that end a render before all samples are taken.
///
/// The first limit that is reached ends it; goals end it when all of them are met. Both act between passes,
/// so the picture holds whole passes.
///
/// Stopping at a goal biases the mean, since the error is estimated from the same samples. The bias falls
/// with the number of observations and of pixels that are judged together, so it matters for [`PixelGoal`]
/// more than for [`Stop::relative_rmse`]; docs/estimators.md has figures. [`Stop::pilot`] avoids it.
///
/// ```
/// use globillum_integrator::Stop;
///
/// let mut stop = Stop::default(); // not before all samples are taken
/// stop.relative_rmse = Some(0.01); // when the error is at most one percent with 97.5 % confidence,
/// stop.seconds = Some(60.0); // but after a minute at the latest
/// stop.validate()?;
/// # Ok::<(), globillum_integrator::RenderError>(())
/// ```
///
/// Made by `default` and then changed, since fields may be added.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Stop {
    /// Limit, above 0 and finite: seconds from the start of this run. No pass begins that is expected to end later, judged
    /// by the passes of this run, and one that does is dropped.
    ///
    /// The first pass that this run adds is always finished, so a run adds at least one pass,
    /// [resumed](crate::Render::resume) or not, unless the picture holds all passes, the goals are met before,
    /// or the monitor cancels. So a run takes at most the longer of two times: the limit, and that of what precedes
    /// its first pass (the [training of a guide](crate::Guiding), probes, photons) and of that pass. With a
    /// [pilot](Stop::pilot), whose first pass is finished too, the second is the time of two passes.
    pub seconds: Option<f64>,
    /// Goal, above 0 and finite: the upper end of the 95 % interval of the picture's relative error
    /// ([`ErrorEstimate`](crate::ErrorEstimate)) is at most this. A picture in which no pixel has varied meets it only from
    /// 64 observations on, as does one whose variances are so small that they underflow, at a radiance below 1e-154. The
    /// error is relative to the mean over all pixels: a small bright object on a black background takes many more samples
    /// than one that fills the picture.
    pub relative_rmse: Option<f64>,
    /// Goal for single pixels.
    pub pixels: Option<PixelGoal>,
    /// Two stages (Stein 1945): this many passes, at least 2 and fewer than all, are rendered to estimate how many the goals
    /// need, and dropped; then that number is rendered. The mean is unbiased, since the number of passes does
    /// not depend on them. In return the goals are met only approximately, and the pilot's time is lost.
    ///
    /// Few passes tell little about their error. A pilot is therefore doubled as long as it asks for more than sixteen
    /// times its own passes, and more than that number of passes, and the time for them, is left.
    ///
    /// A [resumed](crate::Render::resume) picture keeps all of its passes. The pilot has the same passes as without a
    /// break, so that a run that was broken off ends with the same bits. If the picture holds some of them, as one that
    /// was rendered without a pilot does, they are rendered again and stay in the mean, on which the number of passes
    /// then depends: it has a stopping bias.
    pub pilot: Option<u32>,
}

/// A goal for the errors of single pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelGoal {
    /// The largest standard error of a component, above 0 and finite, relative to the mean radiance of the picture. A pixel
    /// whose samples have all missed its light has standard error 0 and meets the goal.
    pub error: f64,
    /// The share of all pixels that must meet it, in `(0, 1]`.
    pub share: f64,
}

impl PixelGoal {
    /// The goal is not judged by fewer independent observations, where the relative standard deviation of a
    /// pixel's error is above a quarter.
    pub const MIN_OBSERVATIONS: u64 = 8;

    /// The squared error over that of the goal.
    fn excess(&self, film: &Film) -> f64 {
        if film.observations() < Self::MIN_OBSERVATIONS {
            return f64::INFINITY;
        }
        let mut variances: Vec<f64> = film.variances_of_mean().map(|v| v.max_component()).collect();
        let rank = (self.share * variances.len() as f64).ceil() as usize;
        let last = rank.clamp(1, variances.len()) - 1;
        let (_, &mut variance, _) = variances.select_nth_unstable_by(last, f64::total_cmp);
        ratio(variance, (self.error * film.image_mean().mean()).powi(2))
    }
}

/// `reached / wanted`; 0 if nothing is left to reach.
fn ratio(reached: f64, wanted: f64) -> f64 {
    if reached == 0.0 { 0.0 } else { reached / wanted }
}

impl Stop {
    /// Checks each condition against its range.
    ///
    /// # Errors
    /// [`RenderError::Param`] for the first one outside.
    pub fn validate(&self) -> Result<(), RenderError> {
        let share = |share| Param::new(share > 0.0 && share <= 1.0, "share of pixels", share, "(0, 1]");
        let params = [
            self.seconds.map(|seconds| Param::positive("seconds", seconds)),
            self.relative_rmse.map(|error| Param::positive("relative_rmse", error)),
            self.pixels.map(|goal| Param::positive("pixel error", goal.error)),
            self.pixels.map(|goal| share(goal.share)),
            self.pilot.map(|passes| Param::new(passes >= 2, "pilot passes", passes, "[2, inf)")),
        ];
        Param::check(params.into_iter().flatten())
    }

    /// The number of passes that the goals need, estimated from those of a film that is then dropped, as
    /// [`Stop::pilot`] does; at least 2, infinite if the film does not say. `None` without a goal. If none of the film's
    /// pixels varied, it is the number of its passes for [`Stop::pixels`], and for [`Stop::relative_rmse`] from 64
    /// observations on; before, it is infinite.
    ///
    /// For a picture whose passes are rendered elsewhere: these many, none of them the film's, are averaged
    /// without a stopping bias.
    pub fn passes_after(&self, pilot: &Film) -> Option<f64> {
        // Not zero: without passes, the excess is infinite.
        let rendered = pilot.passes().iter().map(|range| range.len() as f64).sum::<f64>().max(1.0);
        // Fewer than two passes do not tell their error.
        let needed = |excess: f64| if excess == 0.0 { rendered } else { (excess * rendered).ceil() };
        self.excess(pilot).map(|excess| needed(excess).max(2.0))
    }

    /// The estimated number of samples that the goals need, as a multiple of those that `film` holds; at most
    /// 1 if they are met. `None` without a goal.
    pub(crate) fn excess(&self, film: &Film) -> Option<f64> {
        let picture = self.relative_rmse.map(|goal| (film.error().interval_95[1] / goal).powi(2));
        let pixels = self.pixels.map(|goal| goal.excess(film));
        picture.into_iter().chain(pixels).reduce(f64::max)
    }
}
