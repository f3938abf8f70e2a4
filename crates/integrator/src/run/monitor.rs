use crate::Picture;

/// The progress of a render.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Progress {
    /// Samples taken so far in this run, all pixels together.
    pub samples_done: u64,
    /// Samples that this run will take, all pixels together; an estimate if an error is the goal or the time is limited.
    pub samples_total: u64,
    /// Rays traced so far in this run, as counted by [`Counters::rays`](crate::Counters::rays).
    pub rays: u64,
    /// The picture's error after the last whole pass ([`ErrorEstimate`](crate::ErrorEstimate)), also of a picture that this
    /// run has resumed; infinite while unknown. [`Stop::relative_rmse`](crate::Stop::relative_rmse) is compared with the
    /// upper end of its interval, so this may be below the goal before the render ends.
    pub relative_rmse: f64,
    /// Seconds since the run began.
    pub seconds: f64,
    /// Estimate of the seconds left.
    pub seconds_left: f64,
}

/// Observes a run whose result is `R`, by default a render, and may stop it. Methods except [`Monitor::pass_done`]
/// are called often, from worker threads, and should return at once.
///
/// ```
/// use globillum_integrator::{Monitor, Progress};
/// use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
///
/// /// Stops when its button is pressed.
/// struct Button(AtomicBool);
///
/// impl Monitor for Button {
///     fn progress(&self, progress: Progress) {
///         eprintln!("{} of {} samples", progress.samples_done, progress.samples_total);
///     }
///
///     fn cancelled(&self) -> bool {
///         self.0.load(Relaxed)
///     }
/// }
/// ```
pub trait Monitor<R = Picture>: Sync {
    /// Called after each tile, and by a render after each pass, with the error that it leaves.
    fn progress(&self, _progress: Progress) {}

    /// Called before each bounce of each tile; `true` ends the render with the whole passes so far. Called as often while a
    /// guide is trained and while photons are traced. Before the first tile, some ten thousand probes are traced without
    /// calling it.
    fn cancelled(&self) -> bool {
        false
    }

    /// Called after each pass, from one thread, with all whole passes so far, for example to save a
    /// checkpoint. The next pass waits until it returns.
    fn pass_done(&self, _result: &R) {}
}

/// Observes nothing.
impl<R> Monitor<R> for () {}

/// A function or a closure observes the progress.
///
/// ```
/// use globillum_integrator::{Monitor, Progress};
///
/// let monitor: &dyn Monitor = &|progress: Progress| eprintln!("{:.0} s left", progress.seconds_left);
/// ```
impl<R, F: Fn(Progress) + Sync> Monitor<R> for F {
    fn progress(&self, progress: Progress) {
        self(progress);
    }
}
