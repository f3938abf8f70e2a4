use super::{cornell, render};
use crate::flags::RenderFlags;
use crate::interrupt::Interrupt;
use crate::job::{BuiltScene, BuiltSubject, Subject};
use crate::usage;
use crate::view::AnyCamera;
use anyhow::{Result, anyhow};
use clap::Parser;
use globillum::integrator::Settings;

/// A picture as the command line says it that renders it.
#[derive(Debug, Parser)]
#[command(no_binary_name = true)]
pub(crate) enum Picture {
    Render(render::Options),
    Cornell(cornell::Options),
}

/// A picture that can be rendered.
pub(crate) struct Staged {
    pub(crate) scene: BuiltScene,
    pub(crate) camera: AnyCamera,
    pub(crate) settings: Settings,
}

impl Picture {
    /// Parses the command line, without the program's name.
    pub(crate) fn parse(words: &[String]) -> Result<Self> {
        Self::try_parse_from(words).map_err(|error| anyhow!(usage::message(&error)))
    }

    pub(crate) fn flags(&self) -> &RenderFlags {
        match self {
            Self::Render(options) => &options.flags,
            Self::Cornell(options) => &options.flags,
        }
    }

    /// Loads the scene and builds its accelerator.
    pub(crate) fn stage(&self, interrupt: &Interrupt) -> Result<Staged> {
        let subject: Subject = match self {
            Self::Render(options) => options.subject(interrupt)?,
            Self::Cornell(options) => options.subject(interrupt)?,
        };
        let BuiltSubject { scene, camera, .. } = subject.build(self.flags(), interrupt)?;
        Ok(Staged { scene, camera, settings: self.flags().settings() })
    }
}
