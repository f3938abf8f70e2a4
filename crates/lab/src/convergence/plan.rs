//! The command-line options, and the plan of measurements that follows from them.

use super::combination::accel_name;
use super::subject::Subject;
use anyhow::{Result, ensure};
use clap::Parser;
use globillum::integrator::{PinholeCamera, Settings, Stop};
use globillum::material::Rgb;
use globillum_cli::{AccelKind, view};
use std::path::PathBuf;

/// Reports speed against error: every accelerator, estimator and sampler on a few scenes.
#[derive(Debug, Parser)]
#[command(version)]
pub struct Options {
    /// furnace, corner, kaleidoscope, cornell, cornell-mirror, cornell-statue, cornell-statues, cornell-million,
    /// cornell-hall, or a file (.obj, .gltf, .glb); corner and cornell by default
    #[arg(value_name = "SCENE")]
    scenes: Vec<String>,
    /// Seconds for each equal-time picture; 2 by default, 0.5 with --quick
    #[arg(long, value_name = "S")]
    time: Option<f64>,
    /// Pixels along each side of a picture; 96 by default, 64 with --quick
    #[arg(long, value_parser = clap::value_parser!(u32).range(8..=4096))]
    side: Option<u32>,
    /// Sample counts double from 1 up to this; 256 by default, 64 with --quick
    #[arg(long, value_parser = clap::value_parser!(u32).range(4..=65536))]
    spp: Option<u32>,
    /// Samples per pixel of the two reference runs of a scene without closed form; 16 times --spp by default, at least 128
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(128..))]
    reference_spp: Option<u32>,
    /// Rays for each figure of ray-triangle tests; 200,000 by default, 20,000 with --quick
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(100..))]
    rays: Option<u32>,
    /// Smaller defaults, for a report in about a minute
    #[arg(long)]
    quick: bool,
    /// The compared accelerators
    #[arg(long, value_enum, value_delimiter = ',', default_values_t = [AccelKind::Wide, AccelKind::Kd, AccelKind::Grid])]
    accel: Vec<AccelKind>,
    /// For files: camera position, target, up vector and vertical field of view in degrees; by default the
    /// file's first camera, else a view of the whole scene
    #[arg(long, value_name = "X,Y,Z/X,Y,Z[/X,Y,Z[/FOV]]", allow_hyphen_values = true, value_parser = |text: &str| view::parse_camera(text, view::Up::Y))]
    camera: Option<PinholeCamera>,
    /// For files: radiance of the environment in all directions
    #[arg(long, value_name = "R,G,B", allow_hyphen_values = true, default_value = "0", value_parser = view::parse_colour)]
    environment: Rgb,
    /// Seed of the random numbers
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Worker threads, 0 for all
    #[arg(long, default_value_t = 0)]
    threads: usize,
    /// The folder for report.md, its figures and CSV files
    #[arg(long, value_name = "DIR", default_value = "convergence")]
    pub(crate) out: PathBuf,
}

/// The parameters of the measurements.
pub(crate) struct Plan {
    pub(crate) accels: Vec<AccelKind>,
    /// Pixels along each side.
    pub(crate) side: u32,
    /// Ascending powers of two.
    pub(crate) samples: Vec<u32>,
    pub(crate) reference_samples: u32,
    /// Seconds for each equal-time picture.
    pub(crate) seconds: f64,
    /// Rays for each figure of ray-triangle tests.
    pub(crate) rays: u32,
    pub(crate) seed: u64,
    pub(crate) threads: usize,
}

impl Options {
    /// The validated parameters.
    pub(crate) fn plan(&self) -> Result<Plan> {
        let or = |given: Option<u32>, quick, usual| given.unwrap_or(if self.quick { quick } else { usual });
        let most = or(self.spp, 64, 256);
        ensure!(most.is_power_of_two(), "--spp {most}: is not a power of two");
        for (i, accel) in self.accel.iter().enumerate() {
            ensure!(!self.accel[..i].contains(accel), "--accel: {} is given twice", accel_name(*accel));
        }
        let plan = Plan {
            accels: self.accel.clone(),
            side: or(self.side, 64, 96),
            samples: (0..=most.ilog2()).map(|level| 1 << level).collect(),
            reference_samples: self.reference_spp.unwrap_or((16 * most).max(128)),
            seconds: self.time.unwrap_or(if self.quick { 0.5 } else { 2.0 }),
            rays: or(self.rays, 20_000, 200_000),
            seed: self.seed,
            threads: self.threads,
        };
        plan.stop().validate()?;
        plan.settings(1).validate()?;
        Ok(plan)
    }

    /// The scenes, loaded.
    pub(crate) fn subjects(&self) -> Result<Vec<Subject>> {
        let usual = ["corner", "cornell"].map(str::to_owned);
        let scenes = if self.scenes.is_empty() { &usual[..] } else { &self.scenes };
        let mut with_files = false;
        let mut subjects: Vec<Subject> = Vec::new();
        for scene in scenes {
            let subject = match Subject::built_in(scene)? {
                Some(subject) => subject,
                None => {
                    with_files = true;
                    Subject::load(scene.as_ref(), self.camera, self.environment)?
                }
            };
            let twice = subjects.iter().any(|other| other.name == subject.name);
            ensure!(!twice, "two scenes are named {}; their pictures would collide", subject.name);
            subjects.push(subject);
        }
        let is_for_files = self.camera.is_some() || !self.environment.is_black();
        ensure!(with_files || !is_for_files, "--camera and --environment: only files take them");
        Ok(subjects)
    }
}

impl Plan {
    /// The settings common to all combinations.
    pub(crate) fn settings(&self, samples: u32) -> Settings {
        let mut settings = Settings::new(self.side, self.side, samples);
        (settings.seed, settings.threads) = (self.seed, self.threads);
        settings
    }

    /// The stop condition of equal-time pictures.
    pub(crate) fn stop(&self) -> Stop {
        let mut stop = Stop::default();
        stop.seconds = Some(self.seconds);
        stop
    }
}
