use crate::{AccelKind, RenderFlags, Summary};
use anyhow::Result;
use clap::Args;
use globillum::integrator::{Camera, Model, Scene, Settings};
use globillum::io::{AtomicFile, PictureFile};
use globillum::material::Rgb;
use std::path::PathBuf;
use std::time::Instant;

/// How a picture is made, whatever it shows.
#[derive(Args, Debug)]
pub struct RenderOptions {
    /// What finds the triangles
    #[arg(long, value_enum, default_value_t = AccelKind::Wide)]
    accel: AccelKind,
    /// Width of the picture in pixels
    #[arg(long, default_value_t = 512, value_parser = clap::value_parser!(u32).range(1..))]
    width: u32,
    /// Height of the picture in pixels
    #[arg(long, default_value_t = 512, value_parser = clap::value_parser!(u32).range(1..))]
    height: u32,
    #[command(flatten)]
    render: RenderFlags,
    /// Where the picture goes, as often as wanted; by default to a PNG named after the example
    #[arg(long, value_name = "FILE.png|FILE.exr")]
    out: Vec<PathBuf>,
    /// Brighten PNGs by so many stops: each doubles the light
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    exposure: f64,
    /// Also write the figures of the summary there
    #[arg(long, value_name = "FILE.json")]
    stats: Option<PathBuf>,
}

impl RenderOptions {
    /// Width over height of the picture.
    pub fn aspect(&self) -> f64 {
        f64::from(self.width) / f64::from(self.height)
    }

    /// Checks the settings, and opens the files: what can not work is known before any work.
    pub fn prepare(&self, default_out: &str) -> Result<Job<'_>> {
        let settings = self.render.settings(self.width, self.height)?;
        anyhow::ensure!(self.exposure.is_finite(), "--exposure {}: is not finite", self.exposure);
        let default_out = [PathBuf::from(default_out)];
        let out = if self.out.is_empty() { &default_out[..] } else { &self.out };
        let open = |path: &PathBuf| Ok((path.clone(), PictureFile::create(path)?.exposed(self.exposure)));
        Ok(Job {
            accel: self.accel,
            render: &self.render,
            settings,
            pictures: out.iter().map(open).collect::<Result<_>>()?,
            stats: self.stats.as_deref().map(AtomicFile::create).transpose()?,
        })
    }
}

/// A picture to be made, its files open.
pub struct Job<'a> {
    accel: AccelKind,
    render: &'a RenderFlags,
    settings: Settings,
    pictures: Vec<(PathBuf, PictureFile)>,
    stats: Option<AtomicFile>,
}

impl Job<'_> {
    /// Renders, writes what was asked for and prints the figures.
    pub fn run(self, model: Model, camera: &Camera, environment: Rgb) -> Result<()> {
        let start = Instant::now();
        let scene = Scene::build(model, |triangles| self.accel.build(triangles))?;
        let scene = scene.with_environment(environment)?;
        let build_seconds = start.elapsed().as_secs_f64();

        let start = Instant::now();
        let (picture, traced) = self.render.render(&scene, camera, &self.settings)?;
        let render_seconds = start.elapsed().as_secs_f64();

        let mut written = Vec::new();
        for (path, file) in self.pictures {
            file.write(&picture.film)?;
            written.push(path);
        }
        let summary = Summary::new(&scene, &picture, traced, build_seconds, render_seconds);
        if let Some(file) = self.stats {
            let json = summary.to_json()?;
            file.commit(|writer| writer.write_all(json.as_bytes()))?;
        }
        summary.print(&written)
    }
}
