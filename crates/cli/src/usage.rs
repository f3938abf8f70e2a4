//! Usage errors on one line.

use clap::error::{ContextKind, ErrorKind};
use std::error::Error as _;

/// What is wrong with the arguments: which of them, and what it must be.
pub(crate) fn message(error: &clap::Error) -> String {
    let context = |kind| error.get(kind).map(ToString::to_string).unwrap_or_default();
    let argument = context(ContextKind::InvalidArg);
    let value = context(ContextKind::InvalidValue);
    // Clap names a flag together with its value: `--error <E>`.
    let flag = argument.split(" <").next().unwrap_or_default();
    match error.kind() {
        ErrorKind::ValueValidation => {
            let reason = error.source().map(ToString::to_string).unwrap_or_default();
            format!("{flag} {value}: {reason}")
        }
        ErrorKind::InvalidValue if value.is_empty() => format!("{flag}: a value is missing"),
        ErrorKind::InvalidValue => {
            let values = context(ContextKind::ValidValue);
            let similar = similar(error, "value", ContextKind::SuggestedValue);
            format!("{flag} {value}: must be one of {values}{similar}")
        }
        ErrorKind::UnknownArgument => {
            let similar = similar(error, "argument", ContextKind::SuggestedArg);
            format!("unexpected argument {argument}{similar}")
        }
        ErrorKind::InvalidSubcommand => {
            let command = context(ContextKind::InvalidSubcommand);
            let similar = similar(error, "command", ContextKind::SuggestedSubcommand);
            format!("unknown command {command}{similar}")
        }
        ErrorKind::MissingSubcommand => {
            let commands = context(ContextKind::ValidSubcommand);
            format!("a command is missing: {commands}; see `globillum --help`")
        }
        ErrorKind::MissingRequiredArgument => format!("{argument} is missing"),
        ErrorKind::ArgumentConflict if argument == context(ContextKind::PriorArg) => {
            format!("{flag}: can be given only once")
        }
        ErrorKind::TooManyValues => format!("{flag}: takes no value"),
        _ => first_paragraph(&error.to_string()),
    }
}

/// Clap's guess at what was meant.
fn similar(error: &clap::Error, what: &str, kind: ContextKind) -> String {
    match error.get(kind) {
        Some(similar) => format!(" (a similar {what} exists: {similar})"),
        None => String::new(),
    }
}

/// What clap says, without the usage that follows it.
fn first_paragraph(message: &str) -> String {
    let lines = message.lines().map(str::trim).take_while(|line| !line.is_empty());
    lines.collect::<Vec<_>>().join(" ").trim_start_matches("error: ").to_owned()
}
