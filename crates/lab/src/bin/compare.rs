//! Compares every accelerator and every split rule on a few meshes: `cargo run --release -p globillum-lab
//! --bin compare`.

use clap::Parser;
use globillum_cli::report_and_exit;
use globillum_lab::compare::{Options, run};
use std::process::ExitCode;

fn main() -> ExitCode {
    report_and_exit(Options::try_parse(), |options| run(options, &mut std::io::stdout().lock()))
}
