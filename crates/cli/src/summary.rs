use crate::Traced;
use anyhow::Result;
use globillum::geom::Accel;
use globillum::integrator::{Ending, Picture, Scene};
use serde::Serialize;
use std::path::PathBuf;

/// The figures of a render.
#[derive(Debug, Serialize)]
pub struct Summary {
    build_seconds: f64,
    render_seconds: f64,
    camera_rays: u64,
    bounce_rays: u64,
    shadow_rays: u64,
    rays_per_second: f64,
    samples_per_pixel: u32,
    samples: u64,
    samples_per_second: f64,
    roulette_ends: u64,
    limit_ends: u64,
    triangles: usize,
    degenerate_triangles: usize,
    lights: usize,
    accelerator_bytes: usize,
    image_mean: [f64; 3],
    /// Root mean squared error of the pixels over the picture's mean, and the interval that holds it
    /// with a probability of 95 %; none while it is not known.
    relative_rmse: Option<f64>,
    relative_rmse_95: Option<[f64; 2]>,
    ended_by: &'static str,
}

impl Summary {
    /// Gathers the figures; the counts are the whole picture's, the rates those of this run.
    pub fn new<A: Accel>(
        scene: &Scene<A>,
        picture: &Picture,
        traced: Traced,
        build_seconds: f64,
        render_seconds: f64,
    ) -> Self {
        let counters = picture.counters;
        let error = picture.film.error();
        let known = error.relative_rmse.is_finite();
        Self {
            build_seconds,
            render_seconds,
            camera_rays: counters.camera_rays,
            bounce_rays: counters.bounce_rays,
            shadow_rays: counters.shadow_rays,
            rays_per_second: traced.rays as f64 / render_seconds,
            samples_per_pixel: picture.samples,
            samples: counters.camera_rays,
            samples_per_second: traced.samples as f64 / render_seconds,
            roulette_ends: counters.roulette_ends,
            limit_ends: counters.limit_ends,
            triangles: scene.triangles().len(),
            degenerate_triangles: scene.triangles().degenerate_count(),
            lights: scene.lights().len(),
            accelerator_bytes: scene.accel().bytes(),
            image_mean: picture.film.image_mean().to_array(),
            relative_rmse: known.then_some(error.relative_rmse),
            relative_rmse_95: known.then_some(error.interval_95).filter(|interval| interval[1].is_finite()),
            ended_by: reason(picture.ending),
        }
    }

    /// The figures as JSON.
    pub fn to_json(&self) -> Result<String> {
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }

    /// Prints the figures as a table, and where the pictures went.
    pub fn print(&self, out: &[PathBuf]) -> Result<()> {
        let million = |n: u64| n as f64 / 1e6;
        let [r, g, b] = self.image_mean;
        println!(
            "triangles     {} ({} emit, {} degenerate)",
            self.triangles, self.lights, self.degenerate_triangles
        );
        println!(
            "accelerator   {:.1} kB, built in {:.3} s",
            self.accelerator_bytes as f64 / 1e3,
            self.build_seconds
        );
        println!(
            "samples       {} a pixel, {:.2} million in all",
            self.samples_per_pixel,
            million(self.samples)
        );
        println!(
            "rays          {:.2} million camera, {:.2} bounce, {:.2} shadow",
            million(self.camera_rays),
            million(self.bounce_rays),
            million(self.shadow_rays)
        );
        println!(
            "render        {:.2} s: {:.2} million samples and {:.2} million rays a second",
            self.render_seconds,
            self.samples_per_second / 1e6,
            self.rays_per_second / 1e6
        );
        if self.limit_ends > 0 {
            println!("bounce limit  ended {} paths: light of more bounces is missing", self.limit_ends);
        }
        println!("image mean    ({r:.6}, {g:.6}, {b:.6})");
        println!("ended by      {}", self.ended_by);
        if let Some((error, interval)) = self.relative_rmse.zip(self.relative_rmse_95) {
            print_error_line(error, interval);
        }
        for path in out {
            println!("picture       {}", path.display());
        }
        Ok(())
    }
}

/// Prints how many samples and passes a picture has, and how far it is from the truth.
pub fn print_error(picture: &Picture) {
    let passes = picture
        .film
        .passes()
        .iter()
        .map(|range| format!("{}..{}", range.start, range.end))
        .collect::<Vec<_>>();
    println!("samples       {} a pixel, passes {}", picture.samples, passes.join(", "));
    let error = picture.film.error();
    if error.relative_rmse.is_finite() {
        print_error_line(error.relative_rmse, error.interval_95);
    }
}

fn print_error_line(error: f64, interval: [f64; 2]) {
    let [error, low, high] = [error, interval[0], interval[1]].map(|x| 100.0 * x);
    println!("error         {error:.3} % of the mean (with 95 % confidence {low:.3} to {high:.3} %)");
}

fn reason(ending: Ending) -> &'static str {
    match ending {
        Ending::Samples => "all samples taken",
        Ending::Goals => "the error reached",
        Ending::Seconds => "the time given",
        Ending::Cancelled => "being cancelled",
        _ => "nothing",
    }
}
