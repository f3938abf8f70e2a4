use crate::flags::PictureOutput;
use crate::interrupt::Interrupt;
use crate::output::Outputs;
use crate::{checkpoint, console, summary};
use anyhow::{Context, Result, ensure};
use std::path::PathBuf;

const LONG_ABOUT: &str = "\
Joins checkpoints of one picture whose passes were rendered in parts, with --passes, on one machine or on \
several. The picture has the bits of one that was rendered at once, whatever the order of the parts.

The parts must be of the same scene, camera and settings, and no pass may be in two of them.";

const EXAMPLES: &str = "\
Examples:
  Render a picture in two parts and join them:
      globillum render SCENE.glb --spp 256 --passes 0..8 --checkpoint a.part
      globillum render SCENE.glb --spp 256 --passes 8..16 --checkpoint b.part
      globillum merge a.part b.part --out picture.png
  Collect parts in a checkpoint, from which `render --resume` can continue:
      globillum merge a.part b.part --checkpoint all.part";

/// Joins checkpoints of one picture that was rendered in parts
#[derive(clap::Args, Debug)]
#[command(long_about = LONG_ABOUT, after_long_help = EXAMPLES)]
pub(crate) struct Options {
    /// The parts, in any order
    #[arg(required = true, value_name = "CHECKPOINT")]
    parts: Vec<PathBuf>,
    #[command(flatten)]
    output: PictureOutput,
    /// Save the joined checkpoint in FILE
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    checkpoint: Option<PathBuf>,
}

pub(crate) fn run(options: &Options) -> Result<()> {
    let nothing = options.output.out.is_empty() && options.checkpoint.is_none();
    ensure!(!nothing, "neither --out nor --checkpoint is given");
    let interrupt = Interrupt::catch()?;
    let outputs = Outputs::open(&options.output, None)?;
    let (first, others) = options.parts.split_first().context("no checkpoint is given")?;
    let mut picture = checkpoint::read(first)?;
    for path in others {
        interrupt.check()?;
        picture.merge(checkpoint::read(path)?).with_context(|| path.display().to_string())?;
    }
    if let Some(path) = &options.checkpoint {
        checkpoint::write(path, &picture)?;
    }
    let data_on_stdout = outputs.fill_stdout();
    outputs.write(&picture.film, || Ok(String::new()))?;
    console::print_table(&summary::of_merged(&picture), data_on_stdout)
}
