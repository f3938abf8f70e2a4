//! Checkpoints as files, merged with little memory.

use crate::checkpoint_coverage;
use anyhow::{Context, Error, Result, anyhow};
use globillum::integrator::{
    CheckpointHeader, CheckpointReader, CheckpointWriter, ErrorEstimate, Estimates, Film, Merge, MergeError,
};
use globillum::io::AtomicFile;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

/// The result of a merge.
pub(crate) struct Merged {
    pub(crate) header: CheckpointHeader,
    pub(crate) error: ErrorEstimate,
    /// The pixels, if they were asked for; unknown in rows that no checkpoint holds.
    pub(crate) estimates: Option<Estimates>,
}

/// Merges the files at `paths` into the one at `checkpoint`, unless `check` refuses what they hold together, or
/// it is `cancelled`. A message names the file.
pub(crate) fn merge(
    paths: &[PathBuf],
    checkpoint: Option<&Path>,
    want_picture: bool,
    check: impl FnOnce(&CheckpointHeader) -> Result<()>,
    cancelled: impl Fn() -> bool,
) -> Result<Merged> {
    allow_open(paths.len() as u64);
    let readers = paths.iter().map(|path| open(path)).collect::<Result<Vec<_>>>()?;
    let headers: Vec<CheckpointHeader> = readers.iter().map(|reader| reader.header().clone()).collect();
    let merge = Merge::new(readers).map_err(|error| match error {
        MergeError::Overlap { indices, .. } => {
            overlap(indices.map(|index| (&*paths[index], &headers[index])))
        }
        error => named(error, paths),
    })?;
    let header = merge.header().clone();
    check(&header)?;
    let mut estimates = want_picture.then(|| {
        let mut unknown = Estimates::unknown(header.width, header.height);
        (unknown.full_size, unknown.origin) = (header.full_size, header.crop_origin);
        unknown
    });
    let collect = |rows: &Film| {
        estimates.iter_mut().for_each(|estimates| estimates.paste(&Estimates::of(rows)));
        if cancelled() { Err(io::ErrorKind::Interrupted.into()) } else { Ok(()) }
    };
    let error = match checkpoint {
        None => merge.run(collect).map_err(|error| named(error, paths))?,
        Some(path) => save(path, merge, collect, paths)?,
    };
    Ok(Merged { header, error, estimates })
}

/// Writes the merged checkpoint to `path`, and hands its rows to `collect`.
fn save(
    path: &Path,
    merge: Merge<File>,
    mut collect: impl FnMut(&Film) -> io::Result<()>,
    paths: &[PathBuf],
) -> Result<ErrorEstimate> {
    let header = merge.header().clone();
    let mut merged: Option<Result<ErrorEstimate, MergeError>> = None;
    let written = AtomicFile::create(path)?.commit(|target| {
        let mut writer = CheckpointWriter::new(target, &header)?;
        let run = merge.run(|rows| {
            writer.write(rows)?;
            collect(rows)
        });
        // The error of a file that is read is told apart from that of the file that is written.
        if let Err(MergeError::Write(kind)) = run {
            return Err(kind.into());
        }
        if merged.insert(run).is_err() {
            return Err(io::ErrorKind::Other.into());
        }
        writer.finish().map(|_| ())
    });
    if let Some(Err(error)) = merged {
        return Err(named(error, paths));
    }
    written?;
    merged.and_then(Result::ok).context("nothing was merged")
}

/// Asks the operating system for these many open files, and some more. If it refuses, opening the first file beyond
/// its limit fails.
fn allow_open(files: u64) {
    rlimit::increase_nofile_limit(files + 64).ok();
}

fn open(path: &Path) -> Result<CheckpointReader<File>> {
    let name = || path.display().to_string();
    let file = File::open(path).with_context(|| format!("{}: cannot be read", name()))?;
    CheckpointReader::new(file).with_context(name)
}

/// Two parts hold the same pass of a row, and not all the same: which of them to leave out.
fn overlap(parts: [(&Path, &CheckpointHeader); 2]) -> Error {
    let [(a, has_a), (b, has_b)] = parts.map(|(path, header)| (path.display(), header));
    let [holds_a, holds_b] = [has_a, has_b].map(checkpoint_coverage::describe);
    let leave_out = if checkpoint_coverage::is_all_of(has_a, has_b) {
        format!("the first holds all of the second: leave {b} out")
    } else if checkpoint_coverage::is_all_of(has_b, has_a) {
        format!("the second holds all of the first: leave {a} out")
    } else {
        "these overlap: leave one of the two out".into()
    };
    anyhow!("{a} holds {holds_a}, and {b} {holds_b}; {leave_out}")
}

/// The error with the names of the files. Two that overlap hold all the same passes here.
fn named(error: MergeError, paths: &[PathBuf]) -> Error {
    match error {
        MergeError::Input { index, error } => Error::new(error).context(paths[index].display().to_string()),
        MergeError::Overlap { indices: [a, b], pass, row } => {
            let [a, b] = [a, b].map(|index| paths[index].display());
            anyhow!("{a} and {b} differ, and both hold pass {pass} of row {row}")
        }
        MergeError::Write(kind) => io::Error::from(kind).into(),
        other => other.into(),
    }
}
