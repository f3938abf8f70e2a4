//! Joins checkpoints of one picture, rendered in parts: `cargo run --example merge -- a b --out all.png`.
//!
//! What comes out has the bits of one run.

#[allow(dead_code, unused_imports, reason = "this example needs only a part")]
mod common;

use anyhow::{Context, Result, ensure};
use clap::Parser;
use common::{read_checkpoint, report_and_exit, write_checkpoint};
use globillum::io::PictureFile;
use std::path::PathBuf;
use std::process::ExitCode;

/// Joins checkpoints of one picture, rendered in parts.
#[derive(Parser)]
#[command(version, about)]
struct Options {
    /// The parts, in any order
    #[arg(required = true, value_name = "CHECKPOINT")]
    parts: Vec<PathBuf>,
    /// Where the picture goes
    #[arg(long, value_name = "FILE.png|FILE.exr")]
    out: Option<PathBuf>,
    /// Where the joined checkpoint goes
    #[arg(long, value_name = "FILE")]
    checkpoint: Option<PathBuf>,
}

fn main() -> ExitCode {
    report_and_exit(Options::try_parse(), run)
}

fn run(options: &Options) -> Result<()> {
    ensure!(options.out.is_some() || options.checkpoint.is_some(), "neither --out nor --checkpoint is given");
    let out = options.out.as_deref().map(PictureFile::create).transpose()?;
    let (first, others) = options.parts.split_first().context("no checkpoint is given")?;
    let mut picture = read_checkpoint(first)?;
    for path in others {
        picture.merge(read_checkpoint(path)?).with_context(|| path.display().to_string())?;
    }
    if let Some(path) = &options.checkpoint {
        write_checkpoint(path, &picture)?;
    }
    if let Some(out) = out {
        out.write(&picture.film)?;
    }
    common::print_error(&picture);
    Ok(())
}
