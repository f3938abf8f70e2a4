//! Renders the Cornell box: `cargo run --example cornell`.
//!
//! Composes the crates and nothing more: a model from `globillum-testkit` or an OBJ file, an
//! accelerator, a camera, a render, a picture.

#[allow(dead_code, unused_imports, reason = "this example needs only a part")]
mod common;

use anyhow::{Result, ensure};
use clap::Parser;
use common::{AccelKind, RenderFlags, Summary, report_and_exit};
use globillum::integrator::{Model, Scene};
use globillum::io::{AtomicFile, PictureFile, load_obj};
use globillum_testkit::cornell;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

/// Renders the Cornell box.
#[derive(Parser)]
#[command(version, about)]
struct Options {
    /// Which scene: 0 is the box with two blocks
    #[arg(long, default_value_t = 0)]
    scene: u32,
    /// Stand this mesh in the box instead of the blocks
    #[arg(long, value_name = "FILE.obj")]
    mesh: Option<PathBuf>,
    /// Make the tall block, or the mesh, an ideal mirror
    #[arg(long)]
    specular: bool,
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
    /// Where the picture goes
    #[arg(long, value_name = "FILE.png|FILE.exr", default_value = "cornell.png")]
    out: PathBuf,
    /// Also write the figures of the summary there
    #[arg(long, value_name = "FILE.json")]
    stats: Option<PathBuf>,
}

fn main() -> ExitCode {
    report_and_exit(Options::try_parse(), run)
}

fn run(options: &Options) -> Result<()> {
    let settings = options.render.settings(options.width, options.height)?;
    let model = options.model()?;
    // Opened before the work, so that an unwritable place is known at once.
    let picture_file = PictureFile::create(&options.out)?;
    let stats_file = options.stats.as_deref().map(AtomicFile::create).transpose()?;

    let start = Instant::now();
    let scene = Scene::build(&model, |triangles| options.accel.build(triangles))?;
    let build_seconds = start.elapsed().as_secs_f64();

    let start = Instant::now();
    let picture = options.render.render(&scene, &cornell::camera()?, &settings)?;
    let render_seconds = start.elapsed().as_secs_f64();

    picture_file.write(&picture.film)?;
    let summary = Summary::new(&scene, &picture, build_seconds, render_seconds);
    if let Some(file) = stats_file {
        let json = summary.to_json()?;
        file.commit(|writer| writer.write_all(json.as_bytes()))?;
    }
    summary.print(&options.out)
}

impl Options {
    fn model(&self) -> Result<Model> {
        ensure!(self.scene == 0, "--scene {}: there is only scene 0", self.scene);
        let Some(path) = &self.mesh else {
            return Ok(cornell::with_blocks(self.specular)?);
        };
        let loaded = load_obj(path)?;
        for warning in &loaded.warnings {
            common::warn(warning);
        }
        let mesh = loaded.model.triangles();
        ensure!(cornell::has_extent(mesh), "{}: all vertices are the same point", path.display());
        Ok(cornell::with_mesh(mesh, self.specular)?)
    }
}
