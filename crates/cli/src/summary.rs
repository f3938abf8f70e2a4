//! What came of a render, as a table for people and as JSON for programs.

use crate::flags::{MeasureFlags, RenderFlags};
use crate::interrupt::Interrupt;
use crate::monitor::Traced;
use crate::view::{AnyCamera, CameraBy, CameraType, format_camera, format_vector};
use anyhow::Result;
use globillum::geom::{Accel, SimdLevel};
use globillum::glam::DVec3;
use globillum::integrator::{
    CheckpointHeader, CheckpointStrip, Ending, ImageError, Picture, Scene, Settings, Stop,
};
use serde::Serialize;
use std::fmt::{self, Display};
use std::ops::Range;
use std::path::PathBuf;

/// Settings and figures of a render. The keys of its JSON are described in the README of this crate.
#[derive(Debug, Serialize)]
pub(crate) struct Summary<'a> {
    version: &'static str,
    arguments: Vec<String>,
    scene: &'a str,
    simd: String,
    #[serde(flatten)]
    flags: &'a RenderFlags,
    roulette_start: u32,
    roulette_threshold: f64,

    triangles: usize,
    degenerate_triangles: usize,
    lights: usize,
    delta_lights: usize,
    environment: [f64; 3],
    bounds: [[f32; 3]; 2],
    camera: String,
    camera_type: CameraType,
    camera_by: CameraBy,
    accelerator_bytes: usize,
    build_seconds: f64,
    render_seconds: f64,
    samples_per_pixel: u32,
    passes_held: Vec<[u32; 2]>,
    samples: u64,
    camera_rays: u64,
    bounce_rays: u64,
    shadow_rays: u64,
    roulette_ends: u64,
    limit_ends: u64,
    samples_per_second: f64,
    rays_per_second: f64,
    image_mean: [f64; 3],
    #[serde(flatten)]
    error: PictureError,
    ended_by: &'static str,
}

/// How long a run took, what it traced in this time, and why it ended.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Timing {
    pub(crate) build_seconds: f64,
    pub(crate) render_seconds: f64,
    pub(crate) traced: Traced,
    pub(crate) ended_by: &'static str,
}

impl<'a> Summary<'a> {
    /// Gathers the figures; counts are those of the whole picture, rates those of this run.
    pub(crate) fn new<A: Accel>(
        name: &'a str,
        flags: &'a RenderFlags,
        settings: &Settings,
        scene: &Scene<A>,
        (camera, camera_by): (AnyCamera, CameraBy),
        picture: &Picture,
        timing: Timing,
    ) -> Self {
        let Timing { build_seconds, render_seconds, traced, ended_by } = timing;
        let counters = picture.counters;
        let pixels = u64::from(picture.film.width()) * u64::from(picture.film.height());
        let bounds = scene.triangles().bounds();
        let middle = bounds.center();
        Self {
            version: env!("CARGO_PKG_VERSION"),
            arguments: arguments(),
            scene: name,
            simd: format!("{:?}", SimdLevel::best()).to_lowercase(),
            flags,
            roulette_start: settings.roulette.start,
            roulette_threshold: settings.roulette.threshold,
            triangles: scene.triangles().len(),
            degenerate_triangles: scene.triangles().degenerate_count(),
            lights: scene.lights().triangles().count(),
            delta_lights: scene.lights().delta_lights().count(),
            environment: scene.environment().to_array(),
            bounds: [bounds.min, bounds.max].map(|corner| corner.to_array()),
            camera: format_camera(&camera, middle),
            camera_type: camera.camera_type(),
            camera_by,
            accelerator_bytes: scene.accel().bytes(),
            build_seconds,
            render_seconds,
            samples_per_pixel: picture.samples,
            passes_held: picture.film.passes().into_iter().map(|range| [range.start, range.end]).collect(),
            samples: u64::from(picture.samples) * pixels,
            camera_rays: counters.camera_rays,
            bounce_rays: counters.bounce_rays,
            shadow_rays: counters.shadow_rays,
            roulette_ends: counters.roulette_ends,
            limit_ends: counters.limit_ends,
            samples_per_second: traced.samples as f64 / render_seconds,
            rays_per_second: traced.rays as f64 / render_seconds,
            image_mean: picture.film.image_mean().to_array(),
            error: picture.film.error().into(),
            ended_by,
        }
    }

    /// The figures as JSON.
    pub(crate) fn to_json(&self) -> Result<String> {
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }

    /// The figures as a table, with the names of the pictures.
    pub(crate) fn to_table(&self, pictures: &[PathBuf]) -> String {
        let names = pictures.iter().map(|path| format!("picture       {}\n", path.display()));
        format!("{self}{}", names.collect::<String>())
    }
}

impl Display for Summary<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let million = |count: u64| count as f64 / 1e6;
        let [triangles, emit, degenerate] = [self.triangles, self.lights, self.degenerate_triangles];
        let degenerate = if degenerate > 0 { format!(", {degenerate} degenerate") } else { String::new() };
        writeln!(f, "triangles     {triangles} ({emit} emit{degenerate})")?;
        if self.delta_lights > 0 {
            writeln!(f, "delta lights  {}", self.delta_lights)?;
        }
        let bounds = self.bounds.map(|corner| DVec3::from(corner.map(f64::from)));
        let [min, max] = bounds.map(|corner| format_vector(corner, bounds[0].distance(bounds[1])));
        writeln!(f, "bounds        {min} to {max}")?;
        let by = match self.camera_by {
            CameraBy::Flag => "as given",
            CameraBy::Scene => "the scene's",
            CameraBy::Outside => "automatic",
            CameraBy::Inside => "automatic, inside",
        };
        writeln!(f, "camera        {} ({by})", self.camera)?;
        let kilobytes = self.accelerator_bytes as f64 / 1e3;
        writeln!(f, "accelerator   {kilobytes:.1} kB, built in {:.3} s", self.build_seconds)?;
        let samples = million(self.samples);
        writeln!(f, "samples       {} per pixel, {samples:.2} million in all", self.samples_per_pixel)?;
        let [camera, bounce, shadow] = [self.camera_rays, self.bounce_rays, self.shadow_rays].map(million);
        writeln!(f, "rays          {camera:.2} million camera, {bounce:.2} bounce, {shadow:.2} shadow")?;
        let [samples, rays] = [self.samples_per_second, self.rays_per_second].map(|rate| rate / 1e6);
        let seconds = self.render_seconds;
        writeln!(
            f,
            "render        {seconds:.2} s: {samples:.2} million samples and {rays:.2} million rays a second"
        )?;
        if self.limit_ends > 0 {
            let paths = self.limit_ends;
            writeln!(f, "bounce limit  ended {paths} paths: radiance of more bounces is missing")?;
        }
        let [r, g, b] = self.image_mean;
        writeln!(f, "image mean    ({r:.6}, {g:.6}, {b:.6})")?;
        writeln!(
            f,
            "ended by      {}{}",
            self.ended_by,
            missed(self.ended_by, &self.flags.stop(), &self.error)
        )?;
        self.error.fmt(f)
    }
}

/// How far a picture is from its expectation.
#[derive(Clone, Copy, Debug, Serialize)]
struct PictureError {
    /// Root mean squared error of the pixels over the picture's mean; `None` while it is not known.
    relative_rmse: Option<f64>,
    /// Its 95 % confidence interval.
    relative_rmse_95: Option<[f64; 2]>,
}

impl From<ImageError> for PictureError {
    fn from(error: ImageError) -> Self {
        // Equal observations tell nothing unless they are many.
        let known =
            error.relative_rmse.is_finite() && (error.relative_rmse > 0.0 || error.interval_95[1] == 0.0);
        Self {
            relative_rmse: known.then_some(error.relative_rmse),
            relative_rmse_95: known.then_some(error.interval_95).filter(|interval| interval[1].is_finite()),
        }
    }
}

impl Display for PictureError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(error) = self.relative_rmse.map(|share| 100.0 * share) else {
            return writeln!(f, "error         unknown");
        };
        write!(f, "error         {error:.3} % of the mean")?;
        match self.relative_rmse_95.map(|interval| interval.map(|share| 100.0 * share)) {
            Some([low, high]) => writeln!(f, " (95 % confidence interval {low:.3} to {high:.3} %)"),
            None => writeln!(f),
        }
    }
}

/// Figures of a measurement at points.
#[derive(Debug, Serialize)]
pub(crate) struct PointsSummary<'a> {
    version: &'static str,
    arguments: Vec<String>,
    scene: &'a str,
    simd: String,
    #[serde(flatten)]
    flags: &'a MeasureFlags,
    triangles: usize,
    lights: usize,
    delta_lights: usize,
    environment: [f64; 3],
    build_seconds: f64,
    render_seconds: f64,
    points: u32,
    samples_per_point: u32,
    bounce_rays: u64,
    shadow_rays: u64,
    limit_ends: u64,
    rays_per_second: f64,
    irradiance_mean: [f64; 3],
    #[serde(flatten)]
    error: PictureError,
    ended_by: &'static str,
}

/// Gathers the figures of a measurement; counts are those of the whole picture, rates those of this run.
pub(crate) fn of_points<'a, A: Accel>(
    name: &'a str,
    flags: &'a MeasureFlags,
    scene: &Scene<A>,
    picture: &Picture,
    timing: Timing,
) -> PointsSummary<'a> {
    let Timing { build_seconds, render_seconds, traced, ended_by } = timing;
    PointsSummary {
        version: env!("CARGO_PKG_VERSION"),
        arguments: arguments(),
        scene: name,
        simd: format!("{:?}", SimdLevel::best()).to_lowercase(),
        flags,
        triangles: scene.triangles().len(),
        lights: scene.lights().triangles().count(),
        delta_lights: scene.lights().delta_lights().count(),
        environment: scene.environment().to_array(),
        build_seconds,
        render_seconds,
        points: picture.film.height(),
        samples_per_point: picture.samples,
        bounce_rays: picture.counters.bounce_rays,
        shadow_rays: picture.counters.shadow_rays,
        limit_ends: picture.counters.limit_ends,
        rays_per_second: traced.rays as f64 / render_seconds,
        irradiance_mean: picture.film.image_mean().to_array(),
        error: picture.film.error().into(),
        ended_by,
    }
}

impl PointsSummary<'_> {
    /// The figures as JSON.
    pub(crate) fn to_json(&self) -> Result<String> {
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }
}

impl Display for PointsSummary<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "triangles     {} ({} emit)", self.triangles, self.lights)?;
        if self.delta_lights > 0 {
            writeln!(f, "delta lights  {}", self.delta_lights)?;
        }
        writeln!(f, "points        {}, {} samples each", self.points, self.samples_per_point)?;
        let [bounce, shadow] = [self.bounce_rays, self.shadow_rays].map(|count| count as f64 / 1e6);
        writeln!(f, "rays          {bounce:.2} million bounce, {shadow:.2} shadow")?;
        let (seconds, rays) = (self.render_seconds, self.rays_per_second / 1e6);
        writeln!(f, "measured in   {seconds:.2} s: {rays:.2} million rays a second")?;
        if self.limit_ends > 0 {
            let paths = self.limit_ends;
            writeln!(f, "bounce limit  ended {paths} paths: radiance of more bounces is missing")?;
        }
        let [r, g, b] = self.irradiance_mean;
        writeln!(f, "mean          ({r:.6}, {g:.6}, {b:.6})")?;
        writeln!(
            f,
            "ended by      {}{}",
            self.ended_by,
            missed(self.ended_by, &self.flags.stop(), &self.error)
        )?;
        self.error.fmt(f)
    }
}

/// The arguments of the program.
fn arguments() -> Vec<String> {
    std::env::args_os().skip(1).map(|word| word.to_string_lossy().into()).collect()
}

/// Samples, passes and error of a merged picture, as lines of the table; rows only if they differ.
pub(crate) fn of_merged(header: &CheckpointHeader, error: ImageError) -> String {
    let strip = |strip: &CheckpointStrip| {
        let passes: Vec<_> = strip.passes().iter().map(format_range).collect();
        let rows = if strip.rows() == (0..header.height) {
            String::new()
        } else {
            format!(" of rows {}", format_range(&strip.rows()))
        };
        format!("samples       {} per pixel, passes {}{rows}\n", strip.samples(), passes.join(", "))
    };
    header.strips.iter().map(strip).collect::<String>() + &PictureError::from(error).to_string()
}

/// `A..B`.
pub(crate) fn format_range(range: &Range<u32>) -> String {
    format!("{}..{}", range.start, range.end)
}

/// Why a render ended that took all samples.
const ALL_SAMPLES: &str = "all samples taken";

/// What is added in a table if all samples were taken before the error asked for was reached.
fn missed(ended_by: &str, stop: &Stop, error: &PictureError) -> &'static str {
    let reached = |goal| error.relative_rmse_95.is_some_and(|[_, high]| high <= goal);
    let is_missed = ended_by == ALL_SAMPLES && stop.relative_rmse.is_some_and(|goal| !reached(goal));
    if is_missed { "; the error asked for was not reached" } else { "" }
}

/// Why a render ended that `interrupt` can cancel.
pub(crate) fn reason(ending: Ending, interrupt: &Interrupt) -> &'static str {
    match ending {
        Ending::Samples => ALL_SAMPLES,
        Ending::Goals => "the error reached",
        Ending::Seconds => "the time given",
        Ending::Cancelled => interrupt.canceller(),
        _ => "nothing",
    }
}
