use super::monitor::Progress;
use crate::Counters;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::Instant;

/// Measures a running render; shared by all workers.
#[derive(Debug)]
pub(crate) struct Meter {
    start: Instant,
    seconds_limit: Option<f64>,
    samples_done: AtomicU64,
    samples_total: AtomicU64,
    rays: AtomicU64,
    /// The bits of an `f64`.
    relative_rmse: AtomicU64,
}

impl Meter {
    /// Starts the clock.
    pub(crate) fn new(seconds_limit: Option<f64>) -> Self {
        Self {
            start: Instant::now(),
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

    /// Estimate of the seconds that `samples` take.
    pub(crate) fn seconds_for(&self, samples: u64) -> f64 {
        self.seconds() * samples as f64 / self.samples_done().max(1) as f64
    }

    fn samples_done(&self) -> u64 {
        self.samples_done.load(Relaxed)
    }

    pub(crate) fn progress(&self) -> Progress {
        let samples_done = self.samples_done();
        let samples_total = self.samples_total.load(Relaxed).max(samples_done);
        let seconds = self.seconds();
        let left = self.seconds_for(samples_total - samples_done);
        let limit = self.seconds_limit.unwrap_or(f64::INFINITY);
        Progress {
            samples_done,
            samples_total,
            rays: self.rays.load(Relaxed),
            relative_rmse: f64::from_bits(self.relative_rmse.load(Relaxed)),
            seconds,
            seconds_left: left.min((limit - seconds).max(0.0)),
        }
    }
}
