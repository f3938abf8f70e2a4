use globillum::integrator::Progress;
use std::fmt;
use std::time::Duration;

/// Steps of a whole bar.
const STEPS: f64 = 1000.0;

/// A progress bar on a terminal, nothing elsewhere.
pub(crate) struct ProgressBar(indicatif::ProgressBar);

impl ProgressBar {
    /// A bar that has not moved yet.
    pub(crate) fn new() -> Self {
        let bar = indicatif::ProgressBar::new(STEPS as u64);
        let style = indicatif::ProgressStyle::with_template("{wide_bar} {percent}% {msg}");
        Self(style.map_or_else(|_| bar.clone(), |style| bar.clone().with_style(style)))
    }

    /// Moves the bar: it shows time, of which samples, error and limit each may decide.
    pub(crate) fn show(&self, progress: &Progress) {
        if self.0.is_hidden() {
            return;
        }
        let share = progress.seconds / (progress.seconds + progress.seconds_left);
        self.0.set_position((STEPS * share) as u64);
        self.0.set_message(Message(progress).to_string());
    }

    /// Takes the bar off the terminal.
    pub(crate) fn finish(&self) {
        self.0.finish_and_clear();
    }
}

struct Message<'a>(&'a Progress);

impl fmt::Display for Message<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Progress { samples_done, seconds, seconds_left, relative_rmse, .. } = *self.0;
        let [elapsed, left] = [seconds, seconds_left]
            .map(|seconds| indicatif::HumanDuration(Duration::from_secs_f64(seconds.min(1e9))));
        write!(f, "{:.1} million samples, {elapsed:#}, {left:#} left", samples_done as f64 / 1e6)?;
        if relative_rmse.is_finite() {
            write!(f, ", error {:.2} %", 100.0 * relative_rmse)?;
        }
        Ok(())
    }
}
