//! A checkpoint that a merge replaces.

use crate::checkpoint_coverage;
use crate::farm::Part;
use anyhow::{Result, bail, ensure};
use globillum::integrator::CheckpointHeader;
use std::fs;
use std::path::{Path, PathBuf};

/// Refuses to replace the file at `path` if it holds what is not in the merge of `parts`, whose header is `merged`. Files
/// that are written through, such as devices, are not replaced.
pub(crate) fn check(path: &Path, parts: &[PathBuf], merged: &CheckpointHeader) -> Result<()> {
    let Some(file) = fs::canonicalize(path).ok().filter(|file| file.is_file()) else { return Ok(()) };
    if parts.iter().any(|part| fs::canonicalize(part).is_ok_and(|part| part == file)) {
        return Ok(());
    }
    let name = path.display();
    let header = match Part::read(path, merged.key)? {
        Part::Good(header, _) => header,
        Part::Damaged(error) | Part::Foreign(error) => {
            bail!("{name}: exists already and {error}; move it away, or give --checkpoint another name")
        }
    };
    ensure!(
        checkpoint_coverage::is_all_of(merged, &header),
        "{name}: exists already and holds {}, some of which the parts lack; \
         join it with them, move it away, or give --checkpoint another name",
        checkpoint_coverage::describe(&header)
    );
    Ok(())
}
