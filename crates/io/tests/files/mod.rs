//! Scene files in a temporary folder for tests.
#![allow(dead_code, reason = "no test uses all items")]

use globillum_io::{IoError, Loaded, Loader};
use std::fs;
use std::path::PathBuf;
use tempfile::TempDir;

/// A temporary folder with files, removed on drop.
pub(crate) struct Files(TempDir);

impl Files {
    pub(crate) fn new(files: &[(&str, &[u8])]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        for (name, content) in files {
            fs::write(folder.path().join(name), content).unwrap();
        }
        Self(folder)
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn load(&self, name: &str) -> Result<Loaded, IoError> {
        Loader::new().load(self.path(name))
    }

    /// A message without the path of this folder.
    pub(crate) fn shortened(&self, message: &impl ToString) -> String {
        message.to_string().replace(&format!("{}/", self.0.path().display()), "")
    }
}

/// Little-endian bytes.
pub(crate) fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|x| x.to_le_bytes()).collect()
}
