//! The one place that writes to standard output and standard error.

use anyhow::{Context, Error, Result};
use std::fmt::Display;
use std::io::{self, ErrorKind, Write};

/// Writes what people read to standard output. A reader who has gone away has seen enough: that is no error.
pub(crate) fn print(bytes: &[u8]) -> Result<()> {
    match write(bytes) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(error).context("standard output"),
        _ => Ok(()),
    }
}

/// Writes data to standard output: a picture, readings or figures. A reader who has gone away did not get all of it:
/// that is an error, with an exit code of its own ([`exit::CLOSED_PIPE`](crate::exit::CLOSED_PIPE)).
pub(crate) fn print_data(bytes: &[u8]) -> Result<()> {
    write(bytes).map_err(|error| match error.kind() {
        ErrorKind::BrokenPipe => {
            Error::new(error).context("standard output was closed before all data was written")
        }
        _ => Error::new(error).context("standard output"),
    })
}

fn write(bytes: &[u8]) -> io::Result<()> {
    let mut out = io::stdout().lock();
    out.write_all(bytes)?;
    out.flush()
}

/// Writes a table to standard output, or to standard error if standard output takes data.
pub(crate) fn print_table(table: &str, data_on_stdout: bool) -> Result<()> {
    if data_on_stdout {
        note(table.trim_end());
        return Ok(());
    }
    print(table.as_bytes())
}

/// Writes a line to standard error. If that fails, nobody is left to be told.
pub(crate) fn note(message: impl Display) {
    let _ = writeln!(io::stderr().lock(), "{message}");
}

/// Writes a warning to standard error, on one line: something that is no reason to stop.
pub fn warn(message: impl Display) {
    note(format_args!("warning: {message}"));
}
