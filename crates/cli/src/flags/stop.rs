use crate::parse;
use anyhow::{Result, bail};
use globillum::integrator::Stop;
use serde::Serialize;

#[derive(clap::Args, Clone, Debug, Serialize)]
#[command(next_help_heading = "When to stop")]
pub(crate) struct StopFlags {
    /// Stop when the picture's relative RMSE is at most E, such as 0.01 for 1 %
    ///
    /// The error is the root mean squared error of the pixels over the picture's mean. What has to fall to E
    /// is the upper end of its 95 % confidence interval. If --spp or --seconds ends the render before, it is done all the
    /// same, with exit code 0: what ended it is in the table, and as `ended_by` in --stats.
    #[arg(long, value_name = "E", value_parser = parse::positive, allow_negative_numbers = true)]
    error: Option<f64>,
    /// Two stages: plan the samples for --error from this number of passes, which are then dropped
    ///
    /// Stopping as soon as the error is small biases the mean a little. With a pilot, the samples that are averaged do
    /// not influence when the render stops (Stein 1945). At least 2 passes, and fewer than --spp has. A pilot that asks
    /// for more than sixteen times its passes is doubled. Its passes are in no checkpoint: a run that is resumed renders
    /// them again.
    #[arg(long, value_name = "PASSES", requires = "error", value_parser = parse::integer(2..=u32::MAX))]
    #[arg(allow_negative_numbers = true)]
    pilot: Option<u32>,
    /// Stop after this time in seconds, at the end of a pass; at least one pass is rendered
    #[arg(long, value_name = "S", value_parser = parse::positive, allow_negative_numbers = true)]
    seconds: Option<f64>,
}

impl StopFlags {
    /// Whether an error or a time ends the render.
    pub(crate) fn is_given(&self) -> bool {
        self.error.is_some() || self.seconds.is_some()
    }

    /// Refuses a pilot that leaves none of `passes`.
    pub(super) fn check(&self, passes: u32) -> Result<()> {
        match self.pilot.filter(|&pilot| pilot >= passes) {
            Some(pilot) => bail!("--pilot {pilot}: leaves no pass of {passes} after those of the pilot"),
            None => Ok(()),
        }
    }

    pub(crate) fn conditions(&self) -> Stop {
        let mut stop = Stop::default();
        (stop.relative_rmse, stop.pilot, stop.seconds) = (self.error, self.pilot, self.seconds);
        stop
    }
}
