use super::{cornell, render};
use crate::flags::RenderFlags;
use crate::interrupt::Interrupt;
use crate::subject::BuiltSubject;
use crate::usage;
use anyhow::{Result, anyhow};
use clap::Parser;
use clap::error::ErrorKind;

/// The command line that renders a picture, as a job file has it.
#[derive(Debug, Parser)]
#[command(no_binary_name = true)]
pub(crate) enum PictureCommand {
    Render(render::Options),
    Cornell(cornell::Options),
}

impl PictureCommand {
    /// Parses the command line, without the program's name.
    pub(crate) fn parse(words: &[String]) -> Result<Self> {
        Self::try_parse_from(words).map_err(|error| match error.kind() {
            ErrorKind::DisplayHelp => {
                anyhow!("--help: not allowed in `plan`; see `globillum render --help` and `globillum cornell --help`")
            }
            _ => anyhow!(usage::message(&error)),
        })
    }

    pub(crate) fn flags(&self) -> &RenderFlags {
        match self {
            Self::Render(options) => &options.flags,
            Self::Cornell(options) => &options.flags,
        }
    }

    /// Loads the scene and builds its accelerator.
    pub(crate) fn build(&self, interrupt: &Interrupt) -> Result<BuiltSubject> {
        let subject = match self {
            Self::Render(options) => options.subject(interrupt)?,
            Self::Cornell(options) => options.subject(interrupt)?,
        };
        subject.build(self.flags(), interrupt)
    }
}
