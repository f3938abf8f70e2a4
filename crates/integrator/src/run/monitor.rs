use crate::Picture;

/// How far a render has come.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Progress {
    /// Samples taken so far in this run, all pixels together.
    pub samples_done: u64,
    /// Samples that this run will have taken, all pixels together; an estimate where an error is
    /// the goal.
    pub samples_total: u64,
    /// Rays of all kinds traced so far in this run.
    pub rays: u64,
    /// The picture's error as of the last whole pass ([`ImageError`](crate::ImageError)); infinite
    /// while it is not known.
    pub relative_rmse: f64,
    /// Seconds since the run began.
    pub seconds: f64,
    /// Seconds that are probably left, going by those gone.
    pub seconds_left: f64,
}

/// Watches a render, and may stop it. Methods but for [`Monitor::pass_done`] are called from worker
/// threads, often: they should return at once.
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
pub trait Monitor: Sync {
    /// Called after each tile.
    fn progress(&self, _progress: Progress) {}

    /// Asked before each bounce of each tile; `true` ends the render with what is whole so far.
    fn cancelled(&self) -> bool {
        false
    }

    /// Called after each pass, from one thread, with all that is whole so far: the place to save a
    /// checkpoint, now and then. The next pass waits until it returns.
    fn pass_done(&self, _picture: &Picture) {}
}

/// Watches nothing.
impl Monitor for () {}
