use super::monitor::Progress;
use crate::Counters;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::Instant;

/// Measures a running render; shared by all workers.
#[derive(Debug)]
pub(crate) struct Meter {
    /// When the run began, from which its limit counts.
    start: Instant,
    /// When the first pass could begin, after what is done once, such as the training of a guide.
    passes_start: Instant,
    seconds_limit: Option<f64>,
    samples_done: AtomicU64,
    samples_total: AtomicU64,
    rays: AtomicU64,
    /// The bits of an `f64`.
    relative_rmse: AtomicU64,
}

impl Meter {
    /// Of a run that began at `start` and is now ready for its first pass.
    pub(crate) fn new(start: Instant, seconds_limit: Option<f64>) -> Self {
        Self {
            start,
            passes_start: Instant::now(),
            seconds_limit,
            samples_done: AtomicU64::new(0),
            samples_total: AtomicU64::new(0),
            rays: AtomicU64::new(0),
            relative_rmse: AtomicU64::new(f64::INFINITY.to_bits()),
        }
    }

    fn seconds(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    /// Whether the limit will be over in `seconds` more.
    pub(crate) fn is_over_in(&self, seconds: f64) -> bool {
        self.seconds_limit.is_some_and(|limit| self.seconds() + seconds > limit)
    }

    pub(crate) fn add(&self, samples: u64, counters: &Counters) {
        self.samples_done.fetch_add(samples, Relaxed);
        self.rays.fetch_add(counters.rays(), Relaxed);
    }

    pub(crate) fn set_error(&self, relative_rmse: f64) {
        self.relative_rmse.store(relative_rmse.to_bits(), Relaxed);
    }

    /// Sets the number of samples that the run is expected to take from now on.
    pub(crate) fn expect(&self, samples: u64) {
        self.samples_total.store(self.samples_done() + samples, Relaxed);
    }

    /// Estimate of the seconds that `samples` take, by those done since the first pass began.
    pub(crate) fn seconds_for(&self, samples: u64) -> f64 {
        self.passes_start.elapsed().as_secs_f64() * samples as f64 / self.samples_done().max(1) as f64
    }

    fn samples_done(&self) -> u64 {
        self.samples_done.load(Relaxed)
    }

    pub(crate) fn progress(&self) -> Progress {
        let samples_done = self.samples_done();
        let samples_left = self.samples_total.load(Relaxed).saturating_sub(samples_done);
        let seconds = self.seconds();
        let needed = self.seconds_for(samples_left);
        let limit = self.seconds_limit.unwrap_or(f64::INFINITY);
        let seconds_left = needed.min((limit - seconds).max(0.0));
        let share = if needed > seconds_left { seconds_left / needed } else { 1.0 };
        Progress {
            samples_done,
            samples_total: samples_done + (share * samples_left as f64) as u64,
            rays: self.rays.load(Relaxed),
            relative_rmse: f64::from_bits(self.relative_rmse.load(Relaxed)),
            seconds,
            seconds_left,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    /// What precedes the passes counts for the limit, not for the time of a pass.
    #[test]
    fn passes_are_expected_to_take_as_long_as_passes_have_taken() {
        const MINUTE: f64 = 60.0;
        let start = Instant::now().checked_sub(Duration::from_secs(60)).expect("the clock is older");
        let meter = Meter::new(start, Some(1.5 * MINUTE));
        meter.add(10, &Counters::default());
        assert!(meter.progress().seconds >= MINUTE);
        assert!(!meter.is_over_in(meter.seconds_for(10)));
        assert!(meter.is_over_in(0.5 * MINUTE));
    }

    /// Ten samples took a minute; in the minute left there are ten more.
    #[test]
    fn no_more_samples_are_expected_than_there_is_time_for() {
        let minute_ago = Instant::now().checked_sub(Duration::from_secs(60)).expect("the clock is older");
        let total = |seconds_limit| {
            let mut meter = Meter::new(minute_ago, seconds_limit);
            meter.passes_start = minute_ago;
            meter.add(10, &Counters::default());
            meter.expect(1000);
            meter.progress().samples_total
        };
        assert_eq!(total(None), 1010);
        assert!((15..=20).contains(&total(Some(120.0))));
        assert_eq!(total(Some(60.0)), 10);
        assert_eq!(total(Some(1e9)), 1010);
    }
}
