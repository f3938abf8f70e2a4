use super::output::path_as_text;
use crate::checkpoint::{self, Checkpoint, SaveEvery, Saved};
use crate::output::STDOUT;
use crate::parse;
use anyhow::{Error, Result, bail, ensure};
use globillum::integrator::{Picture, Render, RenderError};
use serde::{Serialize, Serializer};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Where a run is saved and continued from.
#[derive(clap::Args, Clone, Debug, Serialize)]
#[command(next_help_heading = "Checkpoints")]
pub(crate) struct SaveFlags {
    /// Save the passes done so far in FILE, while running and at the end
    #[arg(long, value_name = "FILE")]
    #[serde(serialize_with = "path_as_text")]
    checkpoint: Option<PathBuf>,
    /// Seconds between two checkpoints; 0 saves after each pass [default: 60, or 99 times what saving takes]
    ///
    /// Checkpoints are saved between passes, the first one after 5 seconds. By default at most a hundredth of the
    /// time goes to saving, also that of the first one.
    #[arg(long, value_name = "S", requires = "checkpoint")]
    #[arg(value_parser = parse::not_negative, allow_negative_numbers = true)]
    save_every: Option<f64>,
    /// Continue from the checkpoint if it exists
    ///
    /// Scene, camera or patches, and settings must be the same but for --spp, which must not be less than what the
    /// checkpoint holds, --threads, --accel and the stop conditions. If --spp was not a multiple of --pass-spp, the last
    /// pass is incomplete, and the picture cannot be continued with more samples. View factors may have another --rays, but
    /// below 65536 or above 2^32 it sets the length of passes, which must be the same. The result has the bits of one that
    /// was computed at once.
    #[arg(long, requires = "checkpoint")]
    resume: bool,
}

impl SaveFlags {
    /// The checkpoint to be saved, known to be writable.
    pub(crate) fn open(&self) -> Result<Option<Checkpoint>> {
        ensure!(self.path() != Some(Path::new(STDOUT)), "--checkpoint -: a checkpoint needs a file");
        let every = self.save_every.map_or(SaveEvery::Hundredth, SaveEvery::Seconds);
        self.checkpoint.as_deref().map(|path| Checkpoint::new(path, every)).transpose()
    }

    /// The checkpoint's file.
    pub(crate) fn path(&self) -> Option<&Path> {
        self.checkpoint.as_deref()
    }

    /// The checkpoint's file, for messages.
    pub(crate) fn name(&self) -> String {
        self.checkpoint.as_deref().map(|path| path.display().to_string()).unwrap_or_default()
    }

    /// The error with the checkpoint's file, if it is about that.
    pub(crate) fn explain(&self, error: Error) -> Error {
        match error.downcast_ref() {
            Some(&RenderError::Checkpoint(error)) => Error::from(error).context(self.name()),
            _ => error,
        }
    }

    /// What the checkpoint holds, if it is there and to be continued.
    pub(crate) fn read<R: Saved>(&self) -> Result<Option<R>> {
        let Some(path) = self.path() else { return Ok(None) };
        if !checkpoint::exists(path)? {
            return Ok(None);
        }
        ensure!(self.resume, "{}: exists already; --resume continues from it", path.display());
        checkpoint::read(path).map(Some)
    }
}

#[derive(clap::Args, Clone, Debug, Serialize)]
#[command(next_help_heading = "Checkpoints")]
pub(crate) struct CheckpointFlags {
    #[command(flatten)]
    #[serde(flatten)]
    pub(crate) save: SaveFlags,
    /// Render only passes A to B - 1, to be joined with others by `globillum merge`
    ///
    /// With --resume, other passes that the checkpoint holds stay in it and in the picture.
    #[arg(long, value_name = "A..B", value_parser = parse::passes, allow_hyphen_values = true)]
    #[serde(serialize_with = "as_text")]
    pub(crate) passes: Option<Range<u32>>,
}

impl CheckpointFlags {
    /// Whether any flag is given.
    pub(crate) fn is_given(&self) -> bool {
        self.save.checkpoint.is_some() || self.passes.is_some()
    }

    /// Refuses passes that are not among these, of `samples`.
    pub(super) fn check(&self, passes: u32, samples: u32) -> Result<()> {
        let beyond = self.passes.as_ref().filter(|asked| asked.end > passes);
        beyond.map_or(Ok(()), |Range { start, end }| {
            bail!("--passes {start}..{end}: --spp {samples} has only passes 0..{passes}")
        })
    }

    /// How many of `passes` are rendered.
    pub(super) fn rendered(&self, passes: u32) -> u32 {
        self.passes.as_ref().map_or(passes, |asked| asked.end - asked.start)
    }

    /// The same render, of the passes asked for, resumed from what the checkpoint holds.
    pub(crate) fn apply_to<'a>(&self, render: Render<'a>, held: Option<Picture>) -> Render<'a> {
        let render = match &self.passes {
            Some(passes) => render.passes(passes.clone()),
            None => render,
        };
        held.into_iter().fold(render, Render::resume)
    }
}

/// A range as it is written on the command line.
fn as_text<S: Serializer>(range: &Option<Range<u32>>, serializer: S) -> Result<S::Ok, S::Error> {
    range.as_ref().map(|range| format!("{}..{}", range.start, range.end)).serialize(serializer)
}
