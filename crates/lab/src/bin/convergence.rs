//! Reports speed against error, for pictures and for ray-triangle tests:
//! `cargo run --release -p globillum-lab --bin convergence`.

use clap::Parser;
use globillum_cli::report_and_exit;
use globillum_lab::convergence::{Options, run};
use std::process::ExitCode;

fn main() -> ExitCode {
    report_and_exit(Options::try_parse(), |options| run(options, &mut std::io::stdout().lock()))
}
