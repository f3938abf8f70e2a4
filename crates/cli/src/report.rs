use crate::failures::in_one_line;
use crate::interrupt::Interrupted;
use crate::{console, exit, usage};
use anyhow::{Context, anyhow};
use std::process::ExitCode;

/// Runs a program with its parsed `options`, and returns its exit code.
///
/// Help and version go to standard output, with code 0. An error goes to standard error as one line that begins with
/// `error: `. Its code is 75 if it is temporary, such as a full disk; 3 if something is incomplete; 4 if pictures differ;
/// 5 if that cannot be told; 141 if the reader of data on standard output has gone away; 128 plus the number of a signal
/// that ended the run; and 1 otherwise, also for arguments that cannot be parsed.
pub fn report_and_exit<O>(
    options: clap::error::Result<O>,
    run: impl FnOnce(&O) -> anyhow::Result<()>,
) -> ExitCode {
    let result = match options {
        Ok(options) => run(&options),
        Err(help) if !help.use_stderr() => print_help(&help),
        Err(error) => Err(anyhow!(usage::message(&error))),
    };
    let Err(error) = result else { return ExitCode::SUCCESS };
    if let Some(interrupted) = error.downcast_ref::<Interrupted>() {
        console::note(interrupted);
        return interrupted.exit_code();
    }
    console::note(format_args!("error: {}", in_one_line(&error)));
    ExitCode::from(exit::code_of(&error))
}

/// Prints help or version as clap does, in colour on a terminal.
fn print_help(help: &clap::Error) -> anyhow::Result<()> {
    match help.print() {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(error).context("standard output"),
        _ => Ok(()),
    }
}
