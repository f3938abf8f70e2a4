use super::run::{RunFigures, Timing};
use crate::flags::RenderFlags;
use crate::subject::BuiltSubject;
use crate::view::{CameraBy, CameraType, format_camera, format_vector};
use globillum::glam::DVec3;
use globillum::integrator::{Picture, Settings};
use serde::Serialize;
use std::fmt::{self, Display};
use std::path::PathBuf;

/// Settings and figures of a picture. The keys of its JSON are described in the README of this crate.
#[derive(Debug, Serialize)]
pub(crate) struct PictureSummary<'a> {
    #[serde(flatten)]
    run: RunFigures<'a>,
    #[serde(flatten)]
    flags: &'a RenderFlags,
    roulette_start: u32,
    roulette_threshold: f64,

    bounds: [[f32; 3]; 2],
    camera: String,
    camera_type: CameraType,
    camera_by: CameraBy,
    accelerator_bytes: usize,
    samples_per_pixel: u32,
    passes_held: Vec<[u32; 2]>,
    samples: u64,
    camera_rays: u64,
    roulette_ends: u64,
    samples_per_second: f64,
    image_mean: [f64; 3],
}

impl<'a> PictureSummary<'a> {
    /// Gathers the figures.
    pub(crate) fn new(
        subject: &'a BuiltSubject,
        flags: &'a RenderFlags,
        settings: &Settings,
        picture: &Picture,
        timing: Timing,
    ) -> Self {
        let pixels = u64::from(picture.film.width()) * u64::from(picture.film.height());
        let BuiltSubject { name, scene, camera, camera_by, .. } = subject;
        let bounds = scene.triangles().bounds();
        Self {
            run: RunFigures::new(name, scene, picture, timing),
            flags,
            roulette_start: settings.roulette.start,
            roulette_threshold: settings.roulette.threshold,
            bounds: [bounds.min, bounds.max].map(|corner| corner.to_array()),
            camera: format_camera(camera, bounds.center()),
            camera_type: camera.camera_type(),
            camera_by: *camera_by,
            accelerator_bytes: scene.accel().bytes(),
            samples_per_pixel: picture.samples,
            passes_held: picture.film.passes().into_iter().map(|range| [range.start, range.end]).collect(),
            samples: u64::from(picture.samples) * pixels,
            camera_rays: picture.counters.camera_rays,
            roulette_ends: picture.counters.roulette_ends,
            samples_per_second: timing.traced.samples as f64 / timing.render_seconds,
            image_mean: picture.film.image_mean().to_array(),
        }
    }

    /// The figures as a table, with the names of the pictures.
    pub(crate) fn to_table(&self, pictures: &[PathBuf]) -> String {
        let names = pictures.iter().map(|path| format!("picture       {}\n", path.display()));
        format!("{self}{}", names.collect::<String>())
    }
}

impl Display for PictureSummary<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let run = &self.run;
        let million = |count: u64| count as f64 / 1e6;
        run.write_scene(f)?;
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
        writeln!(f, "accelerator   {kilobytes:.1} kB, built in {:.3} s", run.build_seconds)?;
        let samples = million(self.samples);
        writeln!(f, "samples       {} per pixel, {samples:.2} million in all", self.samples_per_pixel)?;
        let [camera, bounce, shadow] = [self.camera_rays, run.bounce_rays, run.shadow_rays].map(million);
        writeln!(f, "rays          {camera:.2} million camera, {bounce:.2} bounce, {shadow:.2} shadow")?;
        let [samples, rays] = [self.samples_per_second, run.rays_per_second].map(|rate| rate / 1e6);
        let seconds = run.render_seconds;
        writeln!(
            f,
            "render        {seconds:.2} s: {samples:.2} million samples and {rays:.2} million rays a second"
        )?;
        run.write_end(f, "image mean", self.image_mean, &self.flags.stop())
    }
}
