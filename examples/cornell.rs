//! Renders the Cornell box to `cornell.png`: `cargo run --example cornell`.

use globillum::geom::WideKdTree;
use globillum::integrator::{Monitor, Progress, Render, Scene, Settings};
use globillum::io::PictureFile;
use globillum::scenes::cornell;
use indicatif::ProgressBar;
use std::error::Error;
use std::time::Instant;

/// Shows how much of the picture is done.
struct Bar(ProgressBar);

impl Monitor for Bar {
    fn progress(&self, progress: Progress) {
        self.0.set_length(progress.samples_total);
        self.0.set_position(progress.samples_done);
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let file = PictureFile::create("cornell.png".as_ref())?;
    let scene = Scene::build(cornell::with_blocks(false)?, WideKdTree::build)?;
    let camera = cornell::camera()?;
    let settings = Settings::new(512, 512, 64);

    let (bar, start) = (Bar(ProgressBar::no_length()), Instant::now());
    let picture = Render::new(&scene, &camera, &settings).run(&bar)?;
    bar.0.finish_and_clear();
    file.write(&picture.film)?;

    let error = 100.0 * picture.film.error().relative_rmse;
    println!(
        "cornell.png: {} samples per pixel in {:.1?}, error {error:.2} %",
        picture.samples,
        start.elapsed()
    );
    Ok(())
}
