use crate::checkpoint::{Checkpoint, Saved};
use crate::failures::Failures;
use crate::interrupt::Interrupt;
use crate::preview::Preview;
use crate::progress::ProgressBar;
use anyhow::Result;
use globillum::integrator::{Ending, Monitor, Progress};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;

/// Shows progress, saves checkpoints and previews between passes, and ends the render at a signal.
pub(crate) struct RenderMonitor<'a> {
    bar: ProgressBar,
    interrupt: &'a Interrupt,
    checkpoint: Mutex<Option<Checkpoint>>,
    preview: Mutex<Option<Preview<'a>>>,
    rays: AtomicU64,
    samples: AtomicU64,
}

/// What a run traced itself: not what its picture held before, but with a pilot's passes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Traced {
    pub(crate) rays: u64,
    pub(crate) samples: u64,
}

impl<'a> RenderMonitor<'a> {
    pub(crate) fn new(checkpoint: Option<Checkpoint>, interrupt: &'a Interrupt) -> Self {
        Self {
            bar: ProgressBar::new(),
            interrupt,
            checkpoint: Mutex::new(checkpoint),
            preview: Mutex::new(None),
            rays: AtomicU64::new(0),
            samples: AtomicU64::new(0),
        }
    }

    /// Shows pictures between passes too.
    pub(crate) fn with_preview(self, preview: Option<Preview<'a>>) -> Self {
        Self { preview: Mutex::new(preview), ..self }
    }

    /// Computes a result, and returns it with the seconds that it took and what was traced. Fails if a signal came before
    /// the first pass was complete. A checkpoint that cannot be saved is among the `failures`.
    pub(crate) fn run<R: Saved, E>(
        self,
        compute: impl FnOnce(&dyn Monitor<R>) -> Result<R, E>,
        failures: &mut Failures,
    ) -> Result<(R, f64, Traced)>
    where
        anyhow::Error: From<E>,
    {
        let (interrupt, start) = (self.interrupt, Instant::now());
        let result = compute(&self)?;
        let seconds = start.elapsed().as_secs_f64();
        let traced = self.finish(&result, failures);
        if result.is_empty() {
            interrupt.check()?;
        }
        Ok((result, seconds, traced))
    }

    /// Takes the bar off the terminal, and saves the checkpoint the last time if the result has any pass. An error is
    /// among the `failures`, so that the result is still written.
    fn finish(self, result: &impl Saved, failures: &mut Failures) -> Traced {
        self.bar.finish();
        let checkpoint = self.checkpoint.into_inner().unwrap_or_else(PoisonError::into_inner);
        if let Some(checkpoint) = checkpoint.filter(|_| !result.is_empty()) {
            let ended_by_save = result.ending() == Ending::Cancelled && !self.interrupt.is_asked();
            failures.keep(checkpoint.finish(result, ended_by_save));
        }
        let [rays, samples] = [self.rays, self.samples].map(AtomicU64::into_inner);
        Traced { rays, samples }
    }

    fn checkpoint(&self) -> MutexGuard<'_, Option<Checkpoint>> {
        self.checkpoint.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<R: Saved> Monitor<R> for RenderMonitor<'_> {
    fn progress(&self, progress: Progress) {
        self.rays.fetch_max(progress.rays, Ordering::Relaxed);
        self.samples.fetch_max(progress.samples_done, Ordering::Relaxed);
        self.bar.show(&progress);
    }

    fn cancelled(&self) -> bool {
        self.interrupt.is_asked() || self.checkpoint().as_ref().is_some_and(Checkpoint::has_failed)
    }

    fn pass_done(&self, result: &R) {
        if let Some(checkpoint) = self.checkpoint().as_mut() {
            checkpoint.save_if_due(result);
        }
        let mut preview = self.preview.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((preview, picture)) = preview.as_mut().zip(result.picture()) {
            preview.show_if_due(picture);
        }
    }
}
