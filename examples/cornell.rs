//! Renders the Cornell box to `cornell.png`: `cargo run --example cornell`.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a program talks to people")]

use globillum::geom::WideBvh;
use globillum::integrator::{Progress, Render, Scene, Settings};
use globillum::io::PictureFile;
use globillum::scenes::cornell;
use indicatif::ProgressBar;
use lexopt::{Arg, Parser, ValueExt};
use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

const USAGE: &str = "\
Renders the Cornell box with two blocks.

Usage: cargo run --example cornell -- [OPTIONS]

  --width N    width in pixels [default: 512]
  --height N   height in pixels [default: 512]
  --spp N      samples per pixel [default: 64]
  --out FILE   picture, .png or .exr [default: cornell.png]

The program `globillum cornell` has more scenes and flags.";

/// What the command line says.
pub(crate) struct Options {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) spp: u32,
    pub(crate) out: PathBuf,
}

impl Options {
    /// Reads the command line; `None` if it asks for help.
    pub(crate) fn parse(mut parser: Parser) -> Result<Option<Self>, Box<dyn Error>> {
        let mut options = Self { width: 512, height: 512, spp: 64, out: "cornell.png".into() };
        while let Some(argument) = parser.next()? {
            match argument {
                Arg::Long("width") => options.width = parser.value()?.parse()?,
                Arg::Long("height") => options.height = parser.value()?.parse()?,
                Arg::Long("spp") => options.spp = parser.value()?.parse()?,
                Arg::Long("out") => options.out = parser.value()?.into(),
                Arg::Long("help") | Arg::Short('h') => return Ok(None),
                other => Err(format!("{}; `globillum cornell --help` has more flags", other.unexpected()))?,
            }
        }
        Ok(Some(options))
    }
}

/// Renders the picture, writes it, and prints one line about it.
pub(crate) fn render(options: &Options) -> Result<(), Box<dyn Error>> {
    let file = PictureFile::create(&options.out)?; // A mistyped name fails now, not after the render.
    let scene = Scene::build(cornell::with_blocks(false)?, WideBvh::build)?;
    let camera = cornell::camera()?;
    let settings = Settings::new(options.width, options.height, options.spp);

    let (bar, start) = (ProgressBar::no_length(), Instant::now());
    let show = |progress: Progress| {
        bar.set_length(progress.samples_total);
        bar.set_position(progress.samples_done);
    };
    let picture = Render::new(&scene, &camera, &settings).monitor(&show).run();
    bar.finish_and_clear();
    let (picture, seconds) = (picture?, start.elapsed().as_secs_f64());
    file.write(&picture.film)?;

    let samples = picture.samples;
    let error = match picture.film.error().relative_rmse {
        error if error.is_finite() => format!("error {:.2} % of the mean", 100.0 * error),
        _ => "error unknown: one pass is too few to tell".into(),
    };
    println!("{}: {samples} samples per pixel in {seconds:.1} s, {error}", options.out.display());
    Ok(())
}

fn main() -> ExitCode {
    let result = Options::parse(Parser::from_env()).and_then(|options| match options {
        Some(options) => render(&options),
        None => {
            println!("{USAGE}");
            Ok(())
        }
    });
    let Err(error) = result else { return ExitCode::SUCCESS };
    eprintln!("error: {error}");
    ExitCode::FAILURE
}
