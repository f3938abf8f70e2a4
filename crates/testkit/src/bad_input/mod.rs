//! Bad input, row by row: scene files, and what must become of them. One table for the loaders'
//! own tests and for those of the program that prints their messages.

mod gltf;
mod images;
mod text;

pub use gltf::glb;

use std::fs;
use std::io;
use std::path::Path;

/// One case of a row; a row may have several.
#[derive(Clone, Debug)]
pub struct Case {
    /// The row's number in docs/testing.md.
    pub row: u32,
    /// Files by name; the first is the scene.
    pub files: Vec<(String, Content)>,
    /// What must become of it.
    pub outcome: Outcome,
}

/// What a name stands for.
#[derive(Clone, Debug)]
pub enum Content {
    /// A file of these bytes.
    Bytes(Vec<u8>),
    /// A folder.
    Folder,
    /// A pipe, where there are pipes.
    Pipe,
    /// A symbolic link to there, where there are links.
    Link(&'static str),
}

/// What must become of a scene.
#[derive(Clone, Debug)]
pub enum Outcome {
    /// An error of that variant, with exactly this message.
    Refused {
        /// The variant's name.
        kind: &'static str,
        /// One line, file names as they are in [`Case::files`].
        message: String,
    },
    /// It is loaded, with these warnings, but for the one that nothing shines.
    Loaded {
        /// One line each.
        warnings: Vec<String>,
    },
}

impl Case {
    fn new(row: u32, name: &str, content: impl Into<Vec<u8>>, outcome: Outcome) -> Self {
        Self { row, files: vec![(name.into(), Content::Bytes(content.into()))], outcome }
    }

    fn beside(mut self, name: &str, content: Content) -> Self {
        self.files.push((name.into(), content));
        self
    }

    /// The scene's name.
    pub fn scene(&self) -> &str {
        &self.files[0].0
    }

    /// Writes the files into an empty folder; `false` where pipes or links cannot be made.
    ///
    /// # Errors
    /// What the system says.
    pub fn write(&self, folder: &Path) -> io::Result<bool> {
        for (name, content) in &self.files {
            let path = folder.join(name);
            let made = match content {
                Content::Bytes(bytes) => fs::write(path, bytes).map(|()| true),
                Content::Folder => fs::create_dir(path).map(|()| true),
                Content::Pipe => Ok(make_pipe(&path)),
                Content::Link(target) => make_link(target, &path),
            }?;
            if !made {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

fn make_pipe(path: &Path) -> bool {
    cfg!(unix) && std::process::Command::new("mkfifo").arg(path).status().is_ok_and(|status| status.success())
}

#[cfg(unix)]
fn make_link(target: &str, path: &Path) -> io::Result<bool> {
    std::os::unix::fs::symlink(target, path).map(|()| true)
}

#[cfg(not(unix))]
fn make_link(_target: &str, _path: &Path) -> io::Result<bool> {
    Ok(false)
}

/// The beginning of a file that stands for another in Git's large file storage.
const LFS_POINTER: &str = "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n";

/// The message for such a file.
const LFS_MESSAGE: &str = "cannot be read: is a Git LFS pointer; `git lfs pull` fetches the file";

fn refused(kind: &'static str, message: impl Into<String>) -> Outcome {
    Outcome::Refused { kind, message: message.into() }
}

fn loaded(warnings: &[&str]) -> Outcome {
    Outcome::Loaded { warnings: warnings.iter().map(|&warning| warning.into()).collect() }
}

/// All cases of rows 1 to 82 and 97 to 99.
pub fn cases() -> Vec<Case> {
    [text::cases(), gltf::cases(), images::cases(), gltf::lights(), gltf::ranges()].concat()
}

#[cfg(test)]
mod tests {
    #[test]
    fn no_row_is_missing() {
        let cases = super::cases();
        for row in (1..=82).chain(97..=99) {
            assert!(cases.iter().any(|case| case.row == row), "row {row}");
        }
    }
}
