use crate::ProgressBar;
use anyhow::{Context, Result};
use globillum::integrator::{Monitor, Picture, Progress};
use globillum::io::{AtomicFile, IoError};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// A first checkpoint is written after this time at the latest.
const FIRST: Duration = Duration::from_secs(5);

/// Shows progress, and saves checkpoints between passes.
pub struct Saver {
    bar: ProgressBar,
    path: Option<PathBuf>,
    every: Duration,
    state: Mutex<State>,
    rays: AtomicU64,
    samples: AtomicU64,
}

/// What a run traced itself: not what its picture held before, but with a pilot's passes.
#[derive(Clone, Copy)]
pub struct Traced {
    pub rays: u64,
    pub samples: u64,
}

struct State {
    next: Instant,
    failed: Option<IoError>,
}

impl Saver {
    /// Saves at `path`, if one is given, which is known to be writable from now on.
    ///
    /// # Errors
    /// [`IoError::Write`] if it is not.
    pub fn new(path: Option<&Path>, every: Duration) -> Result<Self> {
        path.map(AtomicFile::create).transpose()?;
        let state = State { next: Instant::now() + FIRST.min(every), failed: None };
        Ok(Self {
            bar: ProgressBar::new(),
            path: path.map(Into::into),
            every,
            state: Mutex::new(state),
            rays: AtomicU64::new(0),
            samples: AtomicU64::new(0),
        })
    }

    /// What was traced so far.
    pub fn traced(&self) -> Traced {
        let [rays, samples] = [&self.rays, &self.samples].map(|count| count.load(Ordering::Relaxed));
        Traced { rays, samples }
    }

    /// Saves the whole picture, and takes the bar off the terminal.
    ///
    /// # Errors
    /// [`IoError::Write`], also for a checkpoint that could not be written earlier.
    pub fn finish(self, picture: &Picture) -> Result<()> {
        self.bar.finish();
        let state = self.state.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner());
        match (state.failed, &self.path) {
            (Some(error), _) => Err(error.into()),
            (None, Some(path)) => Ok(write_checkpoint(path, picture)?),
            (None, None) => Ok(()),
        }
    }

    fn has_failed(&self) -> bool {
        self.state.lock().is_ok_and(|state| state.failed.is_some())
    }
}

impl Monitor for Saver {
    fn progress(&self, progress: Progress) {
        self.rays.fetch_max(progress.rays, Ordering::Relaxed);
        self.samples.fetch_max(progress.samples_done, Ordering::Relaxed);
        self.bar.show(&progress);
    }

    /// There is no point in rendering on what can not be saved.
    fn cancelled(&self) -> bool {
        self.path.is_some() && self.has_failed()
    }

    fn pass_done(&self, picture: &Picture) {
        let (Some(path), Ok(mut state)) = (&self.path, self.state.lock()) else { return };
        if Instant::now() >= state.next {
            state.failed = write_checkpoint(path, picture).err();
            state.next = Instant::now() + self.every;
        }
    }
}

/// Puts the picture in the place of what is there, in one step.
///
/// # Errors
/// [`IoError::Write`], with the old file still there.
pub fn write_checkpoint(path: &Path, picture: &Picture) -> Result<(), IoError> {
    AtomicFile::create(path)?.commit(|writer| writer.write_all(&picture.to_bytes()))
}

/// Reads a picture with its bookkeeping.
///
/// # Errors
/// If the file can not be read or is no whole checkpoint; the message names it.
pub fn read_checkpoint(path: &Path) -> Result<Picture> {
    let name = || path.display().to_string();
    let bytes =
        std::fs::read(path).map_err(|error| anyhow::anyhow!("{}: can not be read: {error}", name()))?;
    Picture::from_bytes(&bytes).with_context(name)
}
