//! The flags of the commands that render, grouped as `--help` shows them. They serialize under their own
//! names: that is how `--stats` records them.

mod checkpoints;
mod crop;
mod kinds;
mod measure;
mod output;
mod picture;
mod sampling;
mod scene;
mod speed;
mod stop;

pub(crate) use checkpoints::{CheckpointFlags, SaveFlags};
pub(crate) use crop::Shown;
pub(crate) use measure::MeasureFlags;
pub(crate) use output::PictureOutput;
pub(crate) use scene::{LoadedScene, SceneFlags};
pub(crate) use speed::SpeedFlags;

use crate::file_conflicts::Uses;
use crate::load::Warnings;
use crate::output::has_format;
use anyhow::{Result, ensure};
use globillum::geom::Accel;
use globillum::integrator::{Picture, Render, Scene, Sensor, Settings, Stop};
use globillum::io::PictureFormat;
use output::ReportFlags;
use picture::PictureFlags;
use sampling::SamplingFlags;
use serde::Serialize;
use std::path::PathBuf;
use stop::StopFlags;

/// How a picture is rendered, whatever it shows.
#[derive(clap::Args, Clone, Debug, Serialize)]
pub(crate) struct RenderFlags {
    #[command(flatten)]
    #[serde(flatten)]
    pub(crate) picture: PictureFlags,
    #[command(flatten)]
    #[serde(flatten)]
    sampling: SamplingFlags,
    #[command(flatten)]
    #[serde(flatten)]
    stop: StopFlags,
    #[command(flatten)]
    #[serde(flatten)]
    pub(crate) checkpoints: CheckpointFlags,
    #[command(flatten)]
    #[serde(flatten)]
    pub(crate) output: PictureOutput,
    #[command(flatten)]
    #[serde(flatten)]
    pub(crate) report: ReportFlags,
    #[command(flatten)]
    #[serde(flatten)]
    pub(crate) speed: SpeedFlags,
}

impl RenderFlags {
    /// The same flags with what they leave open decided: samples, threads and pictures' files.
    pub(crate) fn resolved(&self, default_out: &str) -> Result<Self> {
        let mut flags = self.clone();
        flags.sampling.spp = self.limit();
        flags.speed.threads = self.speed.resolved_threads();
        if flags.output.out.is_empty() {
            flags.output.out.push(default_out.into());
        }
        flags.check()?;
        Ok(flags)
    }

    /// Adds the files that are written.
    pub(crate) fn add_to<'a>(&'a self, uses: Uses<'a>) -> Uses<'a> {
        uses.written("--out", &self.output.out)
            .written("--stats", &self.report.stats)
            .written("--checkpoint", self.checkpoints.save.path())
    }

    /// Samples of a pixel at which the render ends; `None` if only the error or the time ends it.
    fn limit(&self) -> Option<u32> {
        self.sampling.limit(&self.stop, &self.checkpoints)
    }

    /// Checks flags against each other.
    fn check(&self) -> Result<()> {
        let (width, height) = (self.picture.width, self.picture.height);
        let pixels = u64::from(width) * u64::from(height);
        ensure!(
            pixels <= Settings::MAX_PIXELS,
            "--width {width} --height {height}: must be at most {} pixels together",
            Settings::MAX_PIXELS
        );
        if let Some(crop) = self.picture.crop.filter(|crop| !crop.is_within(width, height)) {
            anyhow::bail!("--crop {crop}: must lie within the picture of {width} x {height} pixels");
        }
        let is_exr = |path: &PathBuf| has_format(path, PictureFormat::Exr);
        ensure!(
            !self.picture.buffers || self.output.out.iter().any(is_exr),
            "--buffers: only OpenEXR pictures hold them; --out names none"
        );
        let passes = self.settings().passes();
        self.checkpoints.check(passes, self.settings().samples)?;
        self.stop.check(self.checkpoints.rendered(passes))
    }

    /// Samples of a pixel, if a flag says how many.
    pub(crate) fn samples_asked_for(&self) -> Option<u32> {
        self.sampling.spp
    }

    /// Refuses flags that `plan` does not allow, since they have no meaning for a part of a picture that a farm renders.
    pub(crate) fn check_for_farm(&self) -> Result<()> {
        let Self { picture, stop, checkpoints, output, report, .. } = self;
        let given = [
            ("--crop", picture.crop.is_some()),
            ("--error and --seconds", stop.is_given()),
            ("--checkpoint and --passes", checkpoints.is_given()),
            ("--out", !output.out.is_empty()),
            ("--exposure", output.exposure != 0.0),
            ("--stats", report.stats.is_some()),
            ("--preview", picture.preview),
            ("--buffers", picture.buffers),
        ];
        match given.into_iter().find(|(_, is_given)| *is_given) {
            Some((flags, _)) => anyhow::bail!("{flags}: not allowed in `plan`"),
            None => self.check(),
        }
    }

    /// The settings of the library for these flags.
    pub(crate) fn settings(&self) -> Settings {
        let samples = self.limit().unwrap_or(u32::MAX);
        let mut settings = Settings::new(self.picture.width, self.picture.height, samples);
        settings.filter = self.picture.filter.into();
        settings.threads = self.speed.threads;
        self.sampling.apply_to(&mut settings);
        settings
    }

    /// Which warnings about scene files are shown.
    pub(crate) fn warnings(&self) -> Warnings {
        self.report.warnings()
    }

    /// What may end the render before all samples are taken.
    pub(crate) fn stop(&self) -> Stop {
        self.stop.conditions()
    }

    /// The render that these flags ask for, resumed from what the checkpoint holds.
    pub(crate) fn render<'a>(
        &self,
        scene: &'a Scene<dyn Accel + 'a>,
        sensor: &'a dyn Sensor,
        settings: &'a Settings,
        held: Option<Picture>,
    ) -> Render<'a> {
        let render = Render::new(scene, sensor, settings).until(self.stop());
        let render = match self.picture.rendered(settings.path_reuse) {
            Some([columns, rows]) => render.crop(columns, rows),
            None => render,
        };
        self.checkpoints.apply_to(render, held)
    }
}
