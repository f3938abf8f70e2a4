use crate::{Film, RenderError};

/// What may end a render before all samples are taken.
///
/// Limits end it when the first of them is reached; goals when all of them are. Both act between
/// passes, so what comes out is a picture of whole passes.
///
/// A render that stops when its error seems small is biased, since the mean and the error come from
/// the same samples: it stops earlier where these happen to be bright or alike. The bias falls with
/// the number of observations and of pixels that are judged together, so it matters for
/// [`PixelGoal`] more than for [`Stop::relative_rmse`]; docs/estimators.md has figures.
/// [`Stop::pilot`] avoids it.
///
/// ```
/// use globillum_integrator::Stop;
///
/// let mut stop = Stop::default(); // not before all samples are taken
/// stop.relative_rmse = Some(0.01); // at an error of one percent,
/// stop.seconds = Some(60.0); // but after a minute at the latest
/// stop.validate()?;
/// # Ok::<(), globillum_integrator::RenderError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Stop {
    /// A limit: seconds from the start of this run. No pass begins that would, going by those that
    /// this run has rendered, end later, and one that does is dropped.
    ///
    /// The first pass that this run adds to the picture is always finished, however small the limit
    /// is: a run, [resumed](crate::Render::resume) or not, adds at least one pass, unless the picture
    /// holds all of them, the goals are met before, or the monitor cancels. So it takes at most the limit
    /// or the time of one pass, and of one more where there is a [pilot](Stop::pilot), whose first
    /// pass is finished too.
    pub seconds: Option<f64>,
    /// A goal: the upper end of the 95 % interval of the picture's relative error
    /// ([`ImageError`](crate::ImageError)) is at most this.
    pub relative_rmse: Option<f64>,
    /// A goal for single pixels.
    pub pixels: Option<PixelGoal>,
    /// Two stages (Stein 1945): so many passes, at least 2, are rendered to learn how many more
    /// the goals need; then they are dropped, and that many are rendered whatever they turn out to
    /// be. What is averaged has no say in when to stop, so the mean is unbiased, as it is with no
    /// goal at all. In return the goals are met only nearly, and the pilot's time is lost.
    pub pilot: Option<u32>,
}

/// An error that single pixels are to reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelGoal {
    /// The largest standard error of a component, relative to the mean radiance of the picture. A pixel whose
    /// samples have all missed its light has one of 0, and counts as good.
    pub error: f64,
    /// The share of all pixels that must reach it, in `(0, 1]`.
    pub share: f64,
}

impl PixelGoal {
    /// With fewer independent observations a pixel's own error means little: its relative standard
    /// deviation is then above a quarter.
    pub const MIN_OBSERVATIONS: u64 = 8;

    /// The square of the error reached over that of the goal.
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

/// `reached` over `wanted`, where nothing is no error at all.
fn ratio(reached: f64, wanted: f64) -> f64 {
    if reached == 0.0 { 0.0 } else { reached / wanted }
}

impl Stop {
    /// Checks each condition against its range.
    ///
    /// # Errors
    /// [`RenderError::Param`] for the first one outside.
    pub fn validate(&self) -> Result<(), RenderError> {
        let positive = "(0, inf)";
        let checks = [
            ("seconds", self.seconds, positive),
            ("relative_rmse", self.relative_rmse, positive),
            ("pixel error", self.pixels.map(|goal| goal.error), positive),
            ("share of pixels", self.pixels.map(|goal| goal.share), "(0, 1]"),
            ("pilot passes", self.pilot.map(f64::from), "[2, inf)"),
        ];
        for (name, value, range) in checks {
            let Some(value) = value else { continue };
            let valid = match range {
                "(0, 1]" => value > 0.0 && value <= 1.0,
                "[2, inf)" => value >= 2.0,
                _ => value > 0.0 && value.is_finite(),
            };
            if !valid {
                return Err(RenderError::Param { name, value, range });
            }
        }
        Ok(())
    }

    /// How many times as many samples as `film` holds the goals need in all, by what it knows of
    /// its error; at most 1 if they are met. `None` without a goal.
    pub(crate) fn excess(&self, film: &Film) -> Option<f64> {
        let picture = self.relative_rmse.map(|goal| (film.error().interval_95[1] / goal).powi(2));
        let pixels = self.pixels.map(|goal| goal.excess(film));
        picture.into_iter().chain(pixels).reduce(f64::max)
    }
}
