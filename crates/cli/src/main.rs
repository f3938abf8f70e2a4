//! The program `globillum`.

use std::process::ExitCode;

fn main() -> ExitCode {
    globillum_cli::run()
}
