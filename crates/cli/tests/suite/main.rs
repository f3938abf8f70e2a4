//! The program `globillum` as its users meet it.
#![allow(clippy::print_stderr, reason = "a test that is skipped says so")]

mod blender;
mod checkpoints;
mod cornell;
mod diff;
mod example;
mod farm;
mod help;
#[cfg(unix)]
mod interrupt;
mod irradiance;
mod output;
mod render;
#[cfg(unix)]
mod slurm;
mod stats;
mod view_factors;

use globillum_testkit::program::Program;

const PATH: &str = env!("CARGO_BIN_EXE_globillum");
const GLOBILLUM: Program = Program { path: PATH, first: &[] };
const CORNELL: Program = Program { path: PATH, first: &["cornell"] };
const RENDER: Program = Program { path: PATH, first: &["render"] };
const MERGE: Program = Program { path: PATH, first: &["merge"] };
