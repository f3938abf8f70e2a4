//! Checkpoints as files, and when they are written.

use anyhow::{Context, Result, anyhow};
use globillum::integrator::Picture;
use globillum::io::{AtomicFile, IoError};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// A first checkpoint is written after this time at the latest.
const FIRST: Duration = Duration::from_secs(5);

/// Reads a picture with its bookkeeping. A message names the file.
pub(crate) fn read(path: &Path) -> Result<Picture> {
    let name = || path.display().to_string();
    let bytes = std::fs::read(path).map_err(|error| anyhow!("{}: cannot be read: {error}", name()))?;
    Picture::from_bytes(&bytes).with_context(name)
}

/// Replaces the file at `path` by the picture in one step.
pub(crate) fn write(path: &Path, picture: &Picture) -> Result<(), IoError> {
    AtomicFile::create(path)?.commit(|writer| writer.write_all(&picture.to_bytes()))
}

/// A checkpoint that is saved again and again while its picture is rendered.
#[derive(Debug)]
pub(crate) struct Checkpoint {
    path: PathBuf,
    every: Duration,
    next: Instant,
    failed: Option<IoError>,
}

impl Checkpoint {
    /// A checkpoint at `path`, which is known to be writable from now on, saved each `seconds`.
    pub(crate) fn new(path: &Path, seconds: f64) -> Result<Self> {
        drop(AtomicFile::create(path)?);
        let every = Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX);
        Ok(Self { path: path.into(), every, next: Instant::now() + FIRST.min(every), failed: None })
    }

    /// Whether the last save failed: there is no point in rendering on.
    pub(crate) fn has_failed(&self) -> bool {
        self.failed.is_some()
    }

    /// Saves if it is time to. [`Checkpoint::finish`] returns the error.
    pub(crate) fn save_if_due(&mut self, picture: &Picture) {
        if Instant::now() < self.next {
            return;
        }
        self.failed = write(&self.path, picture).err();
        // A time that no clock shows never comes.
        self.next = Instant::now().checked_add(self.every).unwrap_or(self.next + NEVER);
    }

    /// Saves the last time.
    pub(crate) fn finish(self, picture: &Picture) -> Result<(), IoError> {
        self.failed.map_or_else(|| write(&self.path, picture), Err)
    }
}

/// Longer than any render.
const NEVER: Duration = Duration::from_secs(1 << 40);
