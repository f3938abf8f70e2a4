//! What the program `globillum` is made of.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a program talks to people")]

mod checkpoint;
pub mod cornell;
mod flags;
mod load;
pub mod merge;
mod options;
pub mod render;
mod summary;
pub mod view;

pub use checkpoint::{Saver, Traced, read_checkpoint, write_checkpoint};
pub use flags::RenderFlags;
pub use load::{load, load_mesh};
pub use options::{Job, RenderOptions};
pub use summary::{Summary, print_error};

use globillum::geom::{
    Accel, BruteForce, GeomError, GridOptions, KdOptions, KdTree, Triangles, UniformGrid, WideKdTree,
};
use globillum::integrator::Progress;
use std::fmt::Display;
use std::process::ExitCode;
use std::time::Duration;

/// An accelerator by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum AccelKind {
    /// A k-d tree by the surface area heuristic, for many rays at a time
    Wide,
    /// The same, for one ray at a time
    Kd,
    /// A uniform grid
    Grid,
    /// Every triangle for every ray
    Brute,
}

impl AccelKind {
    /// Builds the accelerator with its default options.
    pub fn build(self, triangles: &Triangles) -> Result<Box<dyn Accel>, GeomError> {
        Ok(match self {
            Self::Wide => Box::new(WideKdTree::build(triangles)?),
            Self::Kd => Box::new(KdTree::build(triangles, &KdOptions::default())?),
            Self::Grid => Box::new(UniformGrid::build(triangles, &GridOptions::default())?),
            Self::Brute => Box::new(BruteForce::build(triangles)),
        })
    }
}

/// A progress bar on a terminal, nothing elsewhere.
pub struct ProgressBar(indicatif::ProgressBar);

impl ProgressBar {
    /// A bar that has not moved yet.
    pub fn new() -> Self {
        let template = "{wide_bar} {percent}% of {human_len} samples, {elapsed} elapsed, {msg}";
        let style = indicatif::ProgressStyle::with_template(template);
        let bar = indicatif::ProgressBar::new(0);
        Self(style.map_or_else(|_| bar.clone(), |style| bar.clone().with_style(style)))
    }

    /// Moves the bar.
    pub fn show(&self, progress: &Progress) {
        if self.0.is_hidden() {
            return;
        }
        self.0.set_length(progress.samples_total);
        self.0.set_position(progress.samples_done);
        let left = indicatif::HumanDuration(Duration::from_secs_f64(progress.seconds_left.min(1e9)));
        let error = match progress.relative_rmse {
            error if error.is_finite() => format!(", error {:.2} %", 100.0 * error),
            _ => String::new(),
        };
        self.0.set_message(format!("{left:#} left{error}"));
    }

    /// Takes the bar off the terminal.
    pub fn finish(&self) {
        self.0.finish_and_clear();
    }
}

/// Says something that is no reason to stop, on one line.
pub fn warn(message: impl Display) {
    eprintln!("warning: {message}");
}

/// Runs a program: help goes to standard output; what goes wrong goes to standard error as one
/// line, with exit code 1.
pub fn report_and_exit<O>(
    options: clap::error::Result<O>,
    run: impl FnOnce(&O) -> anyhow::Result<()>,
) -> ExitCode {
    let result = match options {
        Ok(options) => run(&options),
        Err(error) if !error.use_stderr() => {
            // A reader who has seen enough is no reason to complain.
            let _ = error.print();
            return ExitCode::SUCCESS;
        }
        Err(error) => Err(anyhow::anyhow!(first_paragraph(&error.to_string()))),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {}", in_one_line(&error));
            ExitCode::FAILURE
        }
    }
}

/// What went wrong and why; most errors of the library say why themselves.
fn in_one_line(error: &anyhow::Error) -> String {
    let mut line = error.to_string();
    for cause in error.chain().skip(1).map(ToString::to_string) {
        if !line.ends_with(&cause) {
            line = format!("{line}: {cause}");
        }
    }
    line
}

/// What went wrong, on one line, without the usage that follows it.
fn first_paragraph(message: &str) -> String {
    let lines = message.lines().map(str::trim).take_while(|line| !line.is_empty());
    lines.collect::<Vec<_>>().join(" ").trim_start_matches("error: ").to_owned()
}
