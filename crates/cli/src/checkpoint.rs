//! Checkpoints as files, and when they are written.

use crate::checkpoint_coverage::is_all_of;
use crate::console;
use anyhow::{Context, Error, Result, anyhow, bail};
use globillum::integrator::view_factors::ViewFactors;
use globillum::integrator::{CheckpointError, CheckpointReader, Ending, Picture};
use globillum::io::{AtomicFile, IoError};
use std::ffi::OsString;
use std::fs::File;
use std::iter;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// A first checkpoint is written after this time, if saving is quick.
const FIRST: Duration = Duration::from_secs(5);

/// What is saved while it is computed.
pub(crate) trait Saved: Sized {
    fn from_bytes(bytes: &[u8]) -> Result<Self, CheckpointError>;
    fn to_bytes(&self) -> Vec<u8>;
    /// What the file at `path` holds, compared with `bytes`.
    fn held(bytes: &[u8], path: &Path) -> Held;
    /// Whether it holds no pass.
    fn is_empty(&self) -> bool;
    /// Why its computation ended.
    fn ending(&self) -> Ending;
    /// About how many bytes a checkpoint takes.
    fn size(&self) -> f64;
    /// The picture, if it is one.
    fn picture(&self) -> Option<&Picture> {
        None
    }
}

/// What a file holds, compared with a result that is to replace it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Held {
    /// A part of the result or all of it; or the file is missing or damaged.
    Part,
    /// All of the result and more, as where another process went on.
    More,
    /// What the result does not hold, as where two processes save in one file.
    Other,
}

impl Saved for Picture {
    fn from_bytes(bytes: &[u8]) -> Result<Self, CheckpointError> {
        Self::from_bytes(bytes)
    }
    fn to_bytes(&self) -> Vec<u8> {
        self.to_bytes()
    }
    fn held(bytes: &[u8], path: &Path) -> Held {
        let Ok(file) = File::open(path) else { return Held::Part };
        let (Ok(own), Ok(other)) = (CheckpointReader::new(bytes), CheckpointReader::new(file)) else {
            return Held::Part;
        };
        let (own, other) = (own.header(), other.header());
        match own.key == other.key {
            true if is_all_of(own, other) => Held::Part,
            _ if read::<Self>(path).is_err() => Held::Part,
            true if is_all_of(other, own) => Held::More,
            _ => Held::Other,
        }
    }
    fn is_empty(&self) -> bool {
        self.samples == 0
    }
    fn ending(&self) -> Ending {
        self.ending
    }
    fn size(&self) -> f64 {
        most_bytes(u64::from(self.film.width()) * u64::from(self.film.height()), 2) as f64
    }
    fn picture(&self) -> Option<&Picture> {
        Some(self)
    }
}

impl Saved for ViewFactors {
    fn from_bytes(bytes: &[u8]) -> Result<Self, CheckpointError> {
        Self::from_bytes(bytes)
    }
    fn to_bytes(&self) -> Vec<u8> {
        self.to_bytes()
    }
    fn held(bytes: &[u8], path: &Path) -> Held {
        match (Self::from_bytes(bytes), read::<Self>(path)) {
            (Ok(own), Ok(other)) if own.key() != other.key() => Held::Other,
            (Ok(own), Ok(other)) if other.passes() > own.passes() => Held::More,
            _ => Held::Part,
        }
    }
    fn is_empty(&self) -> bool {
        self.passes() == 0
    }
    fn ending(&self) -> Ending {
        self.ending()
    }
    fn size(&self) -> f64 {
        self.bytes() as f64
    }
}

/// Reads a result with its bookkeeping. A message names the file.
pub(crate) fn read<R: Saved>(path: &Path) -> Result<R> {
    let name = || path.display().to_string();
    let bytes = std::fs::read(path).with_context(|| format!("{}: cannot be read", name()))?;
    R::from_bytes(&bytes).with_context(name)
}

/// Replaces the file at `path` by the result in one step if it holds a [part](Held::Part) of it. Returns what it held.
fn write<R: Saved>(path: &Path, result: &R) -> Result<Held, IoError> {
    let bytes = result.to_bytes();
    let held = R::held(&bytes, path);
    if held == Held::Part {
        AtomicFile::create(path)?.commit(|writer| writer.write_all(&bytes))?;
    }
    Ok(held)
}

/// The path with `extension` appended, and a number if there is such a file.
pub(crate) fn free_path(path: &Path, extension: &str) -> Result<PathBuf> {
    let numbered = (2..=u32::MAX).map(|number| format!(".{extension}{number}"));
    for appended in iter::once(format!(".{extension}")).chain(numbered) {
        let mut free = OsString::from(path);
        free.push(appended);
        if !exists(Path::new(&free))? {
            return Ok(free.into());
        }
    }
    bail!("{}: has no free name beside it", path.display())
}

/// Whether there is a file or folder. It is an error if that cannot be told, as where a server does not answer.
pub(crate) fn exists(path: &Path) -> Result<bool> {
    path.try_exists().with_context(|| path.display().to_string())
}

/// When a checkpoint is saved while its result is computed.
#[derive(Clone, Copy, Debug)]
pub(crate) enum SaveEvery {
    /// After these many seconds.
    Seconds(f64),
    /// After a minute, or later: saving takes at most a hundredth of the time.
    Hundredth,
}

/// A checkpoint that is saved again and again while its result is computed.
#[derive(Debug)]
pub(crate) struct Checkpoint {
    path: PathBuf,
    every: SaveEvery,
    start: Instant,
    /// When it was saved last.
    saved: Option<Instant>,
    /// How long the last save took.
    took: Duration,
    failed: Option<Error>,
}

impl Checkpoint {
    /// A checkpoint at `path`, which is known to be writable from now on.
    pub(crate) fn new(path: &Path, every: SaveEvery) -> Result<Self> {
        drop(AtomicFile::create(path)?);
        Ok(Self {
            path: path.into(),
            every,
            start: Instant::now(),
            saved: None,
            took: Duration::ZERO,
            failed: None,
        })
    }

    /// Whether the last save failed: the computation is to end after this pass.
    pub(crate) fn has_failed(&self) -> bool {
        self.failed.is_some()
    }

    /// Saves if it is time to. After an error [`Checkpoint::finish`] tries again, and so it does if the file holds what
    /// another process saved.
    pub(crate) fn save_if_due(&mut self, result: &impl Saved) {
        let took = self.saved.map_or_else(|| estimate(result), |_| self.took);
        let wait = wait(self.every, self.saved.is_none(), took);
        let begun = Instant::now();
        if begun.duration_since(self.saved.unwrap_or(self.start)) < wait {
            return;
        }
        self.failed = match write(&self.path, result) {
            Ok(Held::Other) => Some(self.conflict()),
            Ok(_) => None,
            Err(error) => Some(error.into()),
        };
        (self.saved, self.took) = (Some(Instant::now()), begun.elapsed());
    }

    /// Saves the last time. Fails too if an earlier save failed and `ended` the computation before it was complete, and if
    /// the file holds what another process saved: then this result is saved beside it.
    pub(crate) fn finish(self, result: &impl Saved, ended: bool) -> Result<()> {
        match write(&self.path, result)? {
            Held::Part => {}
            Held::More => {
                let path = self.path.display();
                console::warn(format_args!(
                    "{path}: holds more passes, which another process saved; it is kept"
                ));
            }
            Held::Other => {
                let free = free_path(&self.path, "other")?;
                write(&free, result)?;
                bail!("{}, and this run is saved as {}", self.conflict(), free.display());
            }
        }
        let saved = || format!("{}: is saved, but a failed save ended the run early", self.path.display());
        self.failed.filter(|_| ended).map_or(Ok(()), |error| Err(error.context(saved())))
    }

    fn conflict(&self) -> Error {
        anyhow!("{}: holds passes that another process saved; they are kept", self.path.display())
    }
}

/// The time from one save, or from the start, to the next, which takes `took`.
fn wait(every: SaveEvery, is_first: bool, took: Duration) -> Duration {
    let first = if is_first { FIRST } else { Duration::MAX };
    match every {
        SaveEvery::Seconds(seconds) => {
            Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX).min(first)
        }
        SaveEvery::Hundredth => Duration::from_secs(60).min(first).max(99 * took),
    }
}

/// How long the first save takes, with a disk of 200 MB a second.
fn estimate(result: &impl Saved) -> Duration {
    Duration::from_secs_f64(result.size() / 200e6)
}

/// About the most bytes of a checkpoint of these pixels, while `passes` passes are rendered, a power of two from 1 up: 48
/// for a pixel of each node of passes, of which there are as many as the number of passes has binary digits 1, and 2 for its
/// share of a block.
pub(crate) fn most_bytes(pixels: u64, passes: u32) -> u64 {
    50 * pixels * u64::from(passes.ilog2().max(1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use globillum::geom::KdTree;
    use globillum::integrator::{Render, Scene, Settings};
    use globillum::scenes::cornell;

    #[test]
    fn saving_takes_a_hundredth_of_the_time_at_most() {
        for milliseconds in [0, 50, 1000, 30_000] {
            let took = Duration::from_millis(milliseconds);
            for is_first in [true, false] {
                let wait = wait(SaveEvery::Hundredth, is_first, took);
                assert!(took * 100 <= wait + took && wait >= FIRST, "{took:?}: {wait:?}");
            }
        }
        let minute = Duration::from_secs(60);
        assert_eq!(wait(SaveEvery::Hundredth, false, Duration::from_millis(100)), minute);
        assert_eq!(wait(SaveEvery::Seconds(60.0), false, minute), minute, "what is asked for is done");
        assert_eq!(wait(SaveEvery::Seconds(60.0), true, minute), FIRST);
        assert_eq!(wait(SaveEvery::Seconds(1e300), false, minute), Duration::MAX);
    }

    /// As where a process that was thought dead goes on while another one has done its work.
    #[test]
    fn a_file_that_holds_more_is_kept() {
        let scene = Scene::build(cornell::with_blocks(false).expect("it is good"), KdTree::build)
            .expect("it is good");
        let camera = cornell::camera().expect("it is good");
        let passes = |passes| {
            let settings = Settings::new(8, 8, 48);
            Render::new(&scene, &camera, &settings).passes(passes).run().expect("the scene is good")
        };
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("a");
        for (held, expected, there) in [
            (0..1, Held::Part, 0..1),
            (0..2, Held::Part, 0..2),
            (1..2, Held::More, 0..2),
            (0..2, Held::Part, 0..2),
            (2..3, Held::Other, 0..2),
            (1..3, Held::Other, 0..2),
        ] {
            assert_eq!(write(&path, &passes(held.clone())).expect("it can be written"), expected, "{held:?}");
            let picture: Picture = read(&path).expect("it is whole");
            assert_eq!(picture.film.passes(), vec![there], "{held:?}");
        }
        // What the file does not hold is saved beside it.
        for (extension, held) in [("other", 2..3), ("other2", 1..3)] {
            let mut checkpoint = Checkpoint::new(&path, SaveEvery::Seconds(0.0)).expect("the folder is good");
            checkpoint.save_if_due(&passes(held.clone()));
            assert!(checkpoint.has_failed(), "it saves over {held:?}");
            let error = checkpoint.finish(&passes(held.clone()), true).expect_err("it is not saved there");
            let beside = folder.path().join(format!("a.{extension}"));
            let [kept, saved] = [&path, &beside].map(|path| path.display());
            let said = format!(
                "{kept}: holds passes that another process saved; they are kept, and this run is saved as {saved}"
            );
            assert_eq!(format!("{error:#}"), said);
            assert_eq!(read::<Picture>(&beside).expect("it is whole").film.passes(), vec![held]);
            assert_eq!(read::<Picture>(&path).expect("it is whole").film.passes(), vec![0..2]);
        }
        // A file that is damaged after its header holds nothing.
        let mut bytes = passes(0..3).to_bytes();
        *bytes.last_mut().expect("it is not empty") ^= 1;
        std::fs::write(&path, bytes).expect("it can be written");
        assert_eq!(write(&path, &passes(0..2)).expect("it can be written"), Held::Part);
        assert_eq!(read::<Picture>(&path).expect("it is whole").film.passes(), vec![0..2]);
    }

    /// Passes that are saved as nothing.
    struct Passes;

    impl Saved for Passes {
        fn from_bytes(_: &[u8]) -> Result<Self, CheckpointError> {
            Ok(Self)
        }
        fn to_bytes(&self) -> Vec<u8> {
            Vec::new()
        }
        fn held(_: &[u8], _: &Path) -> Held {
            Held::Part
        }
        fn is_empty(&self) -> bool {
            false
        }
        fn ending(&self) -> Ending {
            Ending::Cancelled
        }
        fn size(&self) -> f64 {
            0.0
        }
    }

    #[test]
    fn the_last_save_is_tried_after_one_that_failed() {
        for ended in [false, true] {
            let folder = tempfile::tempdir().expect("a temporary folder");
            let path = folder.path().join("a");
            let mut checkpoint = Checkpoint::new(&path, SaveEvery::Seconds(0.0)).expect("an empty folder");
            std::fs::create_dir(&path).expect("nothing is there");
            checkpoint.save_if_due(&Passes);
            assert!(checkpoint.has_failed(), "a folder was replaced");
            std::fs::remove_dir(&path).expect("it is empty");
            let saved = checkpoint.finish(&Passes, ended).map_err(|error| error.to_string());
            let said = format!("{}: is saved, but a failed save ended the run early", path.display());
            assert_eq!(saved, if ended { Err(said) } else { Ok(()) });
            assert!(path.is_file(), "it is not saved");
        }
    }
}
