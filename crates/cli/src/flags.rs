use crate::{Saver, Traced};
use anyhow::{Context, Result, anyhow, ensure};
use globillum::geom::Accel;
use globillum::integrator::{
    Camera, Estimator, LightSampling, MirrorSampling, PathReuse, Picture, PixelFilter, Render, Sampler,
    Scene, Settings, Stop,
};
use std::ops::Range;
use std::path::PathBuf;
use std::time::Duration;

/// How a picture is rendered, and when that is enough: the flags of every example that renders.
#[derive(clap::Args, Debug)]
pub struct RenderFlags {
    /// Samples for each pixel, unless an error or a time ends the render before; 64 by default
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    spp: Option<u32>,
    /// Samples of each pixel in one pass, a power of two
    #[arg(long, default_value_t = 16)]
    pass_spp: u32,
    /// Which random numbers
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Where random numbers come from
    #[arg(long, value_enum, default_value_t = SamplerKind::Sobol)]
    sampler: SamplerKind,
    /// How a pixel weighs the light around its centre
    #[arg(long, value_enum, default_value_t = FilterKind::Box)]
    filter: FilterKind,
    /// How light is found
    #[arg(long, value_enum, default_value_t = EstimatorKind::Mis)]
    estimator: EstimatorKind,
    /// How points on lights are chosen
    #[arg(long, value_enum, default_value_t = LightSamplingKind::SolidAngle)]
    light_sampling: LightSamplingKind,
    /// Whether lights are looked for in plane mirrors
    #[arg(long, value_enum, default_value_t = MirrorSamplingKind::Planes)]
    mirror_sampling: MirrorSamplingKind,
    /// Whether neighbouring pixels share what their paths find
    #[arg(long, value_enum, default_value_t = PathReuseKind::Fours)]
    path_reuse: PathReuseKind,
    /// Most bounces of a path: 0 is emitted light only, 1 adds direct light; unlimited by default
    #[arg(long)]
    max_bounces: Option<u32>,
    /// Worker threads, 0 for all
    #[arg(long, default_value_t = 0)]
    threads: usize,
    /// End once the picture's error, relative to its mean, is surely below this, such as 0.01
    #[arg(long, value_name = "E")]
    error: Option<f64>,
    /// Learn from so many passes how many more --error needs, and drop them: no bias from stopping
    #[arg(long, value_name = "PASSES", requires = "error")]
    pilot: Option<u32>,
    /// End after so many seconds
    #[arg(long, value_name = "S")]
    seconds: Option<f64>,
    /// Render these passes only, the first included, the last not; to be joined by `merge`
    #[arg(long, value_name = "A..B", value_parser = parse_passes)]
    passes: Option<Range<u32>>,
    /// Save what is done there, now and then and at the end
    #[arg(long, value_name = "FILE")]
    checkpoint: Option<PathBuf>,
    /// Save that often while rendering, between passes, in seconds; 0 after each pass
    #[arg(long, value_name = "S", default_value_t = 60.0, requires = "checkpoint")]
    save_every: f64,
    /// Go on from the checkpoint, if it is there
    #[arg(long, requires = "checkpoint")]
    resume: bool,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum SamplerKind {
    /// Independent numbers
    Independent,
    /// Scrambled Sobol' points, stratified over each pass
    Sobol,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum FilterKind {
    /// The pixel's own square, evenly
    Box,
    /// A pyramid two pixels wide
    Tent,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum EstimatorKind {
    /// Paths that happen to meet a light
    Bsdf,
    /// Points chosen on lights
    Light,
    /// Both, weighted
    Mis,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum LightSamplingKind {
    /// Uniformly by area
    Area,
    /// Uniformly by solid angle
    SolidAngle,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum MirrorSamplingKind {
    /// No
    Off,
    /// In ideal mirrors of few planes
    Planes,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum PathReuseKind {
    /// No
    Off,
    /// Four pixels together
    Fours,
}

fn parse_passes(text: &str) -> Result<Range<u32>> {
    let (start, end) = text.split_once("..").context("expected A..B, such as 0..8")?;
    let number = |text: &str| text.parse().map_err(|error| anyhow!("`{text}`: {error}"));
    Ok(number(start)?..number(end)?)
}

impl RenderFlags {
    /// The settings for a picture of that size.
    ///
    /// # Errors
    /// For values out of range.
    pub fn settings(&self, width: u32, height: u32) -> Result<Settings> {
        let mut settings = Settings::new(width, height, self.samples());
        settings.pass_samples = self.pass_spp;
        settings.seed = self.seed;
        settings.threads = self.threads;
        settings.max_bounces = self.max_bounces;
        settings.sampler = match self.sampler {
            SamplerKind::Independent => Sampler::Independent,
            SamplerKind::Sobol => Sampler::Sobol,
        };
        settings.filter = match self.filter {
            FilterKind::Box => PixelFilter::Box,
            FilterKind::Tent => PixelFilter::Tent,
        };
        settings.estimator = match self.estimator {
            EstimatorKind::Bsdf => Estimator::Bsdf,
            EstimatorKind::Light => Estimator::Light,
            EstimatorKind::Mis => Estimator::Mis,
        };
        settings.light_sampling = match self.light_sampling {
            LightSamplingKind::Area => LightSampling::Area,
            LightSamplingKind::SolidAngle => LightSampling::SolidAngle,
        };
        settings.mirror_sampling = match self.mirror_sampling {
            MirrorSamplingKind::Off => MirrorSampling::Off,
            MirrorSamplingKind::Planes => MirrorSampling::Planes,
        };
        settings.path_reuse = match self.path_reuse {
            PathReuseKind::Off => PathReuse::Off,
            PathReuseKind::Fours => PathReuse::Fours,
        };
        settings.validate()?;
        self.stop().validate()?;
        Ok(settings)
    }

    /// As many samples as asked for; without that, as other flags need.
    fn samples(&self) -> u32 {
        let without = match &self.passes {
            Some(passes) => passes.end.saturating_mul(self.pass_spp),
            None if self.error.is_some() || self.seconds.is_some() => u32::MAX,
            None => 64,
        };
        self.spp.unwrap_or(without)
    }

    fn stop(&self) -> Stop {
        let mut stop = Stop::default();
        (stop.relative_rmse, stop.pilot, stop.seconds) = (self.error, self.pilot, self.seconds);
        stop
    }

    /// Renders, showing progress and saving checkpoints: the picture, and what this run did for it.
    ///
    /// # Errors
    /// Those of [`Render::run`], and for a checkpoint that can not be read, used or written.
    pub fn render<A: Accel>(
        &self,
        scene: &Scene<A>,
        camera: &Camera,
        settings: &Settings,
    ) -> Result<(Picture, Traced)> {
        let every = Duration::try_from_secs_f64(self.save_every);
        let every = every.map_err(|error| anyhow!("--save-every {}: {error}", self.save_every))?;
        let saver = Saver::new(self.checkpoint.as_deref(), every)?;
        let mut render = Render::new(scene, camera, settings).until(self.stop());
        if let Some(passes) = &self.passes {
            render = render.passes(passes.clone());
        }
        if let Some(path) = self.checkpoint.as_ref().filter(|path| path.exists()) {
            ensure!(self.resume, "{}: is there already; --resume goes on from it", path.display());
            render = render.resume(super::read_checkpoint(path)?);
        }
        let picture = render.run(&saver)?;
        let traced = saver.traced();
        saver.finish(&picture)?;
        Ok((picture, traced))
    }
}
