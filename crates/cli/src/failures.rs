//! Errors that do not keep the rest from being done.

use anyhow::{Error, Result};
use std::fmt;

/// The errors of steps that do not depend on each other, such as writing several files.
#[derive(Debug, Default)]
pub(crate) struct Failures(Vec<Error>);

impl Failures {
    /// Keeps the error of a step; returns what came of it.
    pub(crate) fn keep<T, E: Into<Error>>(&mut self, result: Result<T, E>) -> Option<T> {
        result.map_err(|error| self.0.push(error.into())).ok()
    }

    /// Fails if there is an error: with it, or with all of them.
    pub(crate) fn into_result(mut self) -> Result<()> {
        match self.0.len() {
            0 => Ok(()),
            1 => Err(self.0.remove(0)),
            _ => Err(self.into()),
        }
    }

    /// The errors in the order in which they occurred.
    pub(crate) fn errors(&self) -> &[Error] {
        &self.0
    }
}

impl fmt::Display for Failures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lines: Vec<String> = self.0.iter().map(in_one_line).collect();
        f.write_str(&lines.join("; "))
    }
}

impl std::error::Error for Failures {}

/// What went wrong and why; most errors of the library say why themselves.
pub(crate) fn in_one_line(error: &Error) -> String {
    let mut line = error.to_string();
    for cause in error.chain().skip(1).map(ToString::to_string) {
        if !line.ends_with(&cause) {
            line = format!("{line}: {cause}");
        }
    }
    line
}
