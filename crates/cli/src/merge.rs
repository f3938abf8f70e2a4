//! Joins checkpoints of one picture, rendered in parts: `cargo run --example merge -- a b --out all.png`.
//!
//! What comes out has the bits of one run.

use crate::{read_checkpoint, write_checkpoint};
use anyhow::{Context, Result, ensure};
use globillum::io::PictureFile;
use std::path::PathBuf;

/// Joins checkpoints of one picture, rendered in parts.
#[derive(clap::Args, Debug)]
pub struct Options {
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

/// Does what `options` ask for.
///
/// # Errors
/// What a user has to know, with the file it concerns.
pub fn run(options: &Options) -> Result<()> {
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
    crate::print_error(&picture);
    Ok(())
}
