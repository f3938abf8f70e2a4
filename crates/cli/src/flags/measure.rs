use super::checkpoints::CheckpointFlags;
use super::output::ReportFlags;
use super::sampling::SamplingFlags;
use super::speed::SpeedFlags;
use super::stop::StopFlags;
use anyhow::Result;
use globillum::geom::Accel;
use globillum::integrator::{IrradiancePoints, Picture, Render, Scene, Settings, Stop};
use serde::Serialize;

/// How a list of points is measured.
#[derive(clap::Args, Clone, Debug, Serialize)]
pub(crate) struct MeasureFlags {
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
    pub(crate) report: ReportFlags,
    #[command(flatten)]
    #[serde(flatten)]
    pub(crate) speed: SpeedFlags,
}

impl MeasureFlags {
    /// The same flags with what they leave open decided: samples and threads.
    pub(crate) fn resolved(&self) -> Result<Self> {
        let mut flags = self.clone();
        flags.sampling.spp = self.sampling.limit(&self.stop, &self.checkpoints);
        flags.speed.threads = self.speed.resolved_threads();
        flags.sampling.leave_neighbours();
        let settings = flags.apply_to(Settings::new(1, 1, 1));
        flags.checkpoints.check(settings.passes(), settings.samples)?;
        flags.stop.check(flags.checkpoints.rendered(settings.passes()))?;
        Ok(flags)
    }

    /// The settings of the library for these points.
    pub(crate) fn settings(&self, points: &IrradiancePoints) -> Settings {
        self.apply_to(points.settings(1))
    }

    fn apply_to(&self, mut settings: Settings) -> Settings {
        settings.samples = self.sampling.spp.unwrap_or(u32::MAX);
        settings.threads = self.speed.threads;
        self.sampling.apply_to(&mut settings);
        settings
    }

    /// What may end the measurement before all samples are taken.
    pub(crate) fn stop(&self) -> Stop {
        self.stop.conditions()
    }

    /// The render that these flags ask for, resumed from what the checkpoint holds.
    pub(crate) fn render<'a>(
        &self,
        scene: &'a Scene<dyn Accel + 'a>,
        points: &'a IrradiancePoints,
        settings: &'a Settings,
        held: Option<Picture>,
    ) -> Render<'a> {
        self.checkpoints.apply_to(Render::new(scene, points, settings).until(self.stop()), held)
    }
}
