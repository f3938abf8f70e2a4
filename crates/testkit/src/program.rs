//! Runs a program as a person does.

use std::path::Path;
use std::process::{Command, Output};

/// A program: its executable, and what comes first among its arguments.
#[derive(Clone, Copy, Debug)]
pub struct Program {
    /// Where it lies: `env!("CARGO_BIN_EXE_name")`.
    pub path: &'static str,
    /// The subcommand, if it has some.
    pub first: &'static [&'static str],
}

impl Program {
    /// The program in `folder`, to be started.
    pub fn command(&self, folder: &Path, arguments: &[&str]) -> Command {
        let mut command = Command::new(self.path);
        command.current_dir(folder).args(self.first).args(arguments);
        command
    }

    /// Runs the program in `folder`.
    pub fn run(&self, folder: &Path, arguments: &[&str]) -> Output {
        self.command(folder, arguments).output().expect("the program starts")
    }

    /// Runs the program in `folder`, where it must succeed; returns what it writes to standard output.
    pub fn succeed(&self, folder: &Path, arguments: &[&str]) -> String {
        let output = self.run(folder, arguments);
        assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8_lossy(&output.stdout).into_owned()
    }

    /// Fails unless, in a folder filled by `fill`, the program ends with exit code 1 and one line on
    /// standard error that holds each of `words`, and leaves the folder as it was.
    pub fn assert_refused(&self, fill: impl Fn(&Path), arguments: &[&str], words: &[&str]) {
        let folder = tempfile::tempdir().expect("a temporary folder");
        fill(folder.path());
        let before = contents(folder.path());
        let output = self.run(folder.path(), arguments);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {message}");
        assert_eq!(message.lines().count(), 1, "{arguments:?}: {message}");
        let parts: Vec<_> = message.trim_end().split(": ").collect();
        assert!(parts.windows(2).all(|pair| pair[0] != pair[1]), "said twice: {message}");
        for word in words {
            assert!(message.contains(word), "{arguments:?}: {message}");
        }
        assert!(contents(folder.path()) == before, "{arguments:?} changed something or left it behind");
    }
}

/// The names of all that is in `folder`, sorted, each with its bytes if it is a file.
fn contents(folder: &Path) -> Vec<(std::ffi::OsString, Option<Vec<u8>>)> {
    let bytes = |name: &std::ffi::OsString| {
        let path = folder.join(name);
        let is_file = std::fs::symlink_metadata(&path).is_ok_and(|found| found.is_file());
        is_file.then(|| std::fs::read(path).expect("a file can be read"))
    };
    names(folder).into_iter().map(|name| (name.clone(), bytes(&name))).collect()
}

/// The names of all that is in `folder`, sorted.
pub fn names(folder: &Path) -> Vec<std::ffi::OsString> {
    let entries = std::fs::read_dir(folder).expect("the folder is there");
    let mut names: Vec<_> = entries.map(|e| e.expect("an entry").file_name()).collect();
    names.sort();
    names
}
