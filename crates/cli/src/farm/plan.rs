use super::Division;
use crate::checkpoint_coverage::format_range;
use anyhow::{Context, Result, anyhow, ensure};
use globillum::integrator::PinholeCamera;
use globillum::io::PictureData;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// What a job file says: a picture, and how it is divided into tasks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Plan {
    /// Of the program that wrote it.
    version: String,
    /// The picture's key, in hexadecimal digits.
    key: String,
    /// The command line that renders the picture, without the program.
    pub(crate) picture: Vec<String>,
    /// Samples of a pixel, of all passes up to the last.
    pub(crate) samples: u32,
    /// The camera as picture files have it, if it is a pinhole ([`PictureData::camera`]).
    ///
    /// [`PictureData::camera`]: globillum::io::PictureData::camera
    pub(crate) camera: Option<([f32; 16], f32)>,
    /// How many tasks there are, for programs that read this file.
    tasks: u32,
    pub(crate) division: Division,
}

/// What one task does.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Task {
    pub(crate) index: u32,
    pub(crate) passes: Range<u32>,
    pub(crate) rows: Range<u32>,
}

impl fmt::Display for Task {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { index, passes, rows } = self;
        write!(f, "task {index}: passes {} of rows {}", format_range(passes), format_range(rows))
    }
}

impl Plan {
    pub(crate) fn new(
        key: u64,
        picture: Vec<String>,
        camera: Option<&PinholeCamera>,
        samples: u32,
        division: Division,
    ) -> Self {
        let version = env!("CARGO_PKG_VERSION").into();
        let (key, camera, tasks) = (format!("{key:016x}"), camera.map(PictureData::frame), division.tasks());
        Self { version, key, picture, camera, samples, tasks, division }
    }

    /// Reads a job file.
    pub(crate) fn read(path: &Path) -> Result<Self> {
        let name = || path.display().to_string();
        let text = std::fs::read_to_string(path).with_context(|| format!("{}: cannot be read", name()))?;
        let plan: Self =
            serde_json::from_str(&text).map_err(|error| anyhow!("{}: is no job file: {error}", name()))?;
        let Self { division, tasks, key, .. } = &plan;
        let possible =
            division.is_possible() && division.tasks() == *tasks && u64::from_str_radix(key, 16).is_ok();
        ensure!(possible, "{}: is no plan: its key or its tasks are impossible", name());
        Ok(plan)
    }

    /// The picture's key.
    pub(crate) fn key(&self) -> u64 {
        u64::from_str_radix(&self.key, 16).unwrap_or_default()
    }

    /// The task of this index.
    pub(crate) fn task(&self, index: u32) -> Option<Task> {
        let (passes, rows) = (index < self.division.tasks()).then(|| self.division.task(index))?;
        Some(Task { index, passes, rows })
    }

    /// All tasks.
    pub(crate) fn tasks(&self) -> impl Iterator<Item = Task> {
        (0..).map_while(|index| self.task(index))
    }
}

/// The folder in which the tasks of a job file save their parts: beside it, with the extension `parts`.
pub(crate) fn parts_folder(job: &Path) -> PathBuf {
    job.with_extension("parts")
}

/// The file in which a task saves its part.
pub(crate) fn part_file(job: &Path, index: u32) -> PathBuf {
    parts_folder(job).join(format!("task-{index:06}.part"))
}
