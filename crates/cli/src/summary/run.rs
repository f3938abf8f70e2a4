use super::error::PictureError;
use crate::interrupt::Interrupt;
use crate::monitor::Traced;
use globillum::geom::{Accel, SimdLevel};
use globillum::integrator::{Ending, Picture, Scene, Stop};
use serde::Serialize;
use std::fmt;

/// How long a run took, what it traced in this time, and why it ended.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Timing {
    pub(crate) build_seconds: f64,
    pub(crate) render_seconds: f64,
    pub(crate) traced: Traced,
    pub(crate) ended_by: &'static str,
}

/// Figures of a run, whether it renders a picture or measures at points. Counts are those of the whole picture, rates those
/// of this run.
#[derive(Debug, Serialize)]
pub(super) struct RunFigures<'a> {
    version: &'static str,
    arguments: Vec<String>,
    scene: &'a str,
    simd: &'static str,
    triangles: usize,
    degenerate_triangles: usize,
    lights: usize,
    delta_lights: usize,
    environment: [f64; 3],
    pub(super) build_seconds: f64,
    pub(super) render_seconds: f64,
    pub(super) bounce_rays: u64,
    pub(super) shadow_rays: u64,
    limit_ends: u64,
    pub(super) rays_per_second: f64,
    #[serde(flatten)]
    error: PictureError,
    ended_by: &'static str,
}

impl<'a> RunFigures<'a> {
    pub(super) fn new<A: Accel>(name: &'a str, scene: &Scene<A>, picture: &Picture, timing: Timing) -> Self {
        let Timing { build_seconds, render_seconds, traced, ended_by } = timing;
        Self {
            version: env!("CARGO_PKG_VERSION"),
            arguments: std::env::args_os().skip(1).map(|word| word.to_string_lossy().into()).collect(),
            scene: name,
            simd: simd_name(SimdLevel::best()),
            triangles: scene.triangles().len(),
            degenerate_triangles: scene.triangles().degenerate_count(),
            lights: scene.lights().triangles().count(),
            delta_lights: scene.lights().delta_lights().count(),
            environment: scene.environment().to_array(),
            build_seconds,
            render_seconds,
            bounce_rays: picture.counters.bounce_rays,
            shadow_rays: picture.counters.shadow_rays,
            limit_ends: picture.counters.limit_ends,
            rays_per_second: traced.rays as f64 / render_seconds,
            error: picture.film.error().into(),
            ended_by,
        }
    }

    /// Writes the lines about triangles and lights.
    pub(super) fn write_scene(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let degenerate = match self.degenerate_triangles {
            0 => String::new(),
            count => format!(", {count} degenerate"),
        };
        writeln!(f, "triangles     {} ({} emit{degenerate})", self.triangles, self.lights)?;
        match self.delta_lights {
            0 => Ok(()),
            count => writeln!(f, "delta lights  {count}"),
        }
    }

    /// Writes the last lines: the paths that the bounce limit ended, the mean, why the run ended, and its error.
    pub(super) fn write_end(
        &self,
        f: &mut fmt::Formatter<'_>,
        what: &str,
        [r, g, b]: [f64; 3],
        stop: &Stop,
    ) -> fmt::Result {
        if self.limit_ends > 0 {
            let paths = self.limit_ends;
            writeln!(f, "bounce limit  ended {paths} paths: radiance of more bounces is missing")?;
        }
        writeln!(f, "{what:<14}({r:.6}, {g:.6}, {b:.6})")?;
        writeln!(f, "ended by      {}{}", self.ended_by, self.missed(stop))?;
        write!(f, "{}", self.error)
    }

    /// What is added in a table if all samples were taken before the error asked for was reached.
    fn missed(&self, stop: &Stop) -> &'static str {
        let is_missed =
            self.ended_by == ALL_SAMPLES && stop.relative_rmse.is_some_and(|goal| !self.error.reaches(goal));
        if is_missed { "; the error asked for was not reached" } else { "" }
    }
}

/// The name of an instruction set in the figures.
fn simd_name(level: SimdLevel) -> &'static str {
    match level {
        SimdLevel::Portable => "portable",
        SimdLevel::Avx2 => "avx2",
        SimdLevel::Avx512 => "avx512",
        _ => "unnamed",
    }
}

/// Why a render ended that took all samples.
const ALL_SAMPLES: &str = "all samples taken";

/// Why a render ended that `interrupt` can cancel.
pub(crate) fn reason(ending: Ending, stop: &Stop, interrupt: &Interrupt) -> &'static str {
    match ending {
        Ending::Samples => ALL_SAMPLES,
        Ending::Goals if stop.pilot.is_some() => "the samples that the pilot asked for",
        Ending::Goals => "the error reached",
        Ending::Seconds => "the time given",
        Ending::Cancelled => interrupt.canceller(),
        _ => "nothing",
    }
}
