//! Runs an example as a person does.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// An example, by name.
pub(crate) struct Program(pub(crate) &'static str);

impl Program {
    /// The example's executable, which cargo builds beside the tests.
    pub(crate) fn path(&self) -> PathBuf {
        let test = std::env::current_exe().expect("a test knows its own path");
        let profile = test.ancestors().nth(2).expect("tests lie in a profile's folder");
        let path = profile.join("examples").join(format!("{}{}", self.0, std::env::consts::EXE_SUFFIX));
        assert!(
            path.exists(),
            "{} is not built; run `cargo test` or `cargo build --examples`",
            path.display()
        );
        path
    }

    /// Runs the example in `folder`.
    pub(crate) fn run(&self, folder: &Path, arguments: &[&str]) -> Output {
        Command::new(self.path()).current_dir(folder).args(arguments).output().expect("the example starts")
    }

    /// Fails unless, in a folder filled by `fill`, the example ends with exit code 1 and one line on
    /// standard error that holds each of `words`, and leaves the folder as it was.
    pub(crate) fn assert_refused(&self, fill: impl Fn(&Path), arguments: &[&str], words: &[&str]) {
        let folder = tempfile::tempdir().expect("a temporary folder");
        fill(folder.path());
        let before = names(folder.path());
        let output = self.run(folder.path(), arguments);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {message}");
        assert_eq!(message.lines().count(), 1, "{arguments:?}: {message}");
        let parts: Vec<_> = message.trim_end().split(": ").collect();
        assert!(parts.windows(2).all(|pair| pair[0] != pair[1]), "said twice: {message}");
        for word in words {
            assert!(message.contains(word), "{arguments:?}: {message}");
        }
        assert_eq!(names(folder.path()), before, "{arguments:?} left something behind");
    }
}

fn names(folder: &Path) -> Vec<std::ffi::OsString> {
    let entries = std::fs::read_dir(folder).expect("the folder is there");
    let mut names: Vec<_> = entries.map(|e| e.expect("an entry").file_name()).collect();
    names.sort();
    names
}
