//! What the files of a command line are used for: none is written that has another use.

use crate::output::STDOUT;
use anyhow::{Result, bail, ensure};
use globillum::io::AtomicFile;
use std::collections::HashMap;
use std::fmt;
use std::path::{Path, PathBuf};

/// What a file is that a scene is read from. Which files these are is known when it is loaded.
pub(crate) const SCENE_FILE: &str = "the scene's file";

/// The files that a command reads and writes.
#[derive(Debug, Default)]
pub(crate) struct Uses<'a>(Vec<Use<'a>>);

/// A file, and the flag or the words for what it is.
#[derive(Clone, Copy, Debug)]
struct Use<'a> {
    name: &'static str,
    path: &'a Path,
    is_written: bool,
}

impl<'a> Uses<'a> {
    /// Adds files that are read; `-` is standard input.
    pub(crate) fn read<P>(self, name: &'static str, paths: impl IntoIterator<Item = &'a P>) -> Self
    where
        P: AsRef<Path> + ?Sized + 'a,
    {
        self.add(name, paths, false)
    }

    /// Adds files that are written; `-` is standard output.
    pub(crate) fn written<P>(self, name: &'static str, paths: impl IntoIterator<Item = &'a P>) -> Self
    where
        P: AsRef<Path> + ?Sized + 'a,
    {
        self.add(name, paths, true)
    }

    fn add<P>(mut self, name: &'static str, paths: impl IntoIterator<Item = &'a P>, is_written: bool) -> Self
    where
        P: AsRef<Path> + ?Sized + 'a,
    {
        self.0.extend(paths.into_iter().map(|path| Use { name, path: path.as_ref(), is_written }));
        self
    }

    /// Refuses a file that is written and has another use, whatever its names. Files that are written through, such
    /// as devices and FIFOs, may have several.
    pub(crate) fn check(&self) -> Result<()> {
        let streams = self.0.iter().filter(|one| one.is_written && one.path == Path::new(STDOUT));
        ensure!(streams.count() <= 1, "-: standard output can be given only once");
        let mut seen: HashMap<PathBuf, Use<'_>> = HashMap::new();
        for &one in self.0.iter().filter(|one| one.path != Path::new(STDOUT)) {
            let Some(file) = AtomicFile::target(one.path) else { continue };
            match seen.insert(file, one) {
                Some(other) if one.is_written || other.is_written => {
                    bail!("{other} and {one} are the same file")
                }
                _ => {}
            }
        }
        Ok(())
    }
}

impl fmt::Display for Use<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.name, self.path.display())
    }
}
