use super::plan::{Plan, Task, part_file, parts_folder};
use crate::checkpoint_coverage;
use anyhow::{Context, Result};
use globillum::integrator::{CheckpointError, CheckpointHeader, CheckpointReader, PixelSums};
use std::fs::File;
use std::io::ErrorKind;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// A file among the parts of a picture, by its header.
#[derive(Debug)]
pub(crate) enum Part {
    /// Of this picture.
    Good(CheckpointHeader, PixelSums),
    /// Damaged, cut off, or no checkpoint.
    Damaged(CheckpointError),
    /// Of another picture, or of another version of the format.
    Foreign(CheckpointError),
}

/// All parts of a picture that there are, by their names.
#[derive(Debug)]
pub(crate) struct Parts(pub(crate) Vec<(PathBuf, Part)>);

impl Part {
    /// Reads the header and the end of a file; damage between them is not found.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub(crate) fn read(path: &Path, key: u64) -> Result<Self> {
        let read = || -> Result<_, CheckpointError> {
            let file = File::open(path).map_err(|error| CheckpointError::Read(error.kind()))?;
            let reader = CheckpointReader::new(file)?;
            let header = reader.header().clone();
            Ok((header, reader.into_sums()?))
        };
        match read() {
            Ok((header, sums)) if header.key == key => Ok(Self::Good(header, sums)),
            Ok(_) => Ok(Self::Foreign(CheckpointError::Mismatch("scene, camera, settings or build"))),
            Err(CheckpointError::Read(kind)) => {
                Err(std::io::Error::from(kind)).with_context(|| format!("{}: cannot be read", path.display()))
            }
            Err(error @ CheckpointError::Version(_)) => Ok(Self::Foreign(error)),
            Err(error) => Ok(Self::Damaged(error)),
        }
    }

    /// Whether the file holds passes of the task's rows, and nothing else.
    pub(crate) fn is_of(&self, task: &Task) -> bool {
        let Self::Good(header, _) = self else { return false };
        let within = |passes: &Range<u32>| task.passes.start <= passes.start && passes.end <= task.passes.end;
        header.strips.iter().all(|strip| strip.rows() == task.rows && strip.passes().iter().all(within))
    }

    /// How much of a task the file holds, from 0 to 1.
    pub(crate) fn share_of(&self, task: &Task) -> f64 {
        let Self::Good(header, _) = self else { return 0.0 };
        checkpoint_coverage::share(header, &task.passes, &task.rows)
    }
}

impl Parts {
    /// Those in the folder of a job file.
    pub(crate) fn of(job: &Path, plan: &Plan) -> Result<Self> {
        let folder = parts_folder(job);
        let name = || format!("{}: cannot be read", folder.display());
        let entries = match std::fs::read_dir(&folder) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Self(Vec::new())),
            entries => entries.with_context(name)?,
        };
        let mut paths = Vec::new();
        for entry in entries {
            let path = entry.with_context(name)?.path();
            if path.extension().is_some_and(|extension| extension == "part") {
                paths.push(path);
            }
        }
        paths.sort();
        let parts = paths.into_iter().map(|path| Part::read(&path, plan.key()).map(|part| (path, part)));
        Ok(Self(parts.collect::<Result<_>>()?))
    }

    /// The files that hold all of a task.
    pub(crate) fn complete<'a>(&'a self, task: &'a Task) -> impl Iterator<Item = &'a Path> {
        let complete = self.0.iter().filter(|(_, part)| part.share_of(task) == 1.0);
        complete.map(|(path, _)| path.as_path())
    }

    /// The largest share of a task that a file holds.
    pub(crate) fn share_of(&self, task: &Task) -> f64 {
        self.0.iter().map(|(_, part)| part.share_of(task)).fold(0.0, f64::max)
    }

    /// The task whose file this is by its name.
    pub(crate) fn task_of(job: &Path, plan: &Plan, path: &Path) -> Option<Task> {
        plan.tasks().find(|task| part_file(job, task.index) == path)
    }
}
