//! The program `globillum`.

use clap::{Parser, Subcommand};
use globillum_cli::{cornell, merge, render, report_and_exit};
use std::process::ExitCode;

/// Renders pictures with global illumination, and says how far they are from the truth.
#[derive(Parser)]
#[command(name = "globillum", version, about)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Renders a scene file
    Render(render::Options),
    /// Renders a built-in scene
    Cornell(cornell::Options),
    /// Joins checkpoints of one picture, rendered in parts
    Merge(merge::Options),
}

fn main() -> ExitCode {
    report_and_exit(Cli::try_parse(), |cli| match &cli.command {
        Command::Render(options) => render::run(options),
        Command::Cornell(options) => cornell::run(options),
        Command::Merge(options) => merge::run(options),
    })
}
