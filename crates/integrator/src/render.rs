use crate::film::PixelSum;
use crate::path::{PassSamples, View, Wave};
use crate::tile::Tile;
use crate::{Camera, Counters, Film, Monitor, Progress, RenderError, Scene, Settings};
use globillum_geom::Accel;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};

/// Samples of a pixel in one pass. Part of a picture's definition: sums are made pass by pass.
const PASS_SAMPLES: u32 = 4;

/// What [`render`] made.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Picture {
    /// The picture: every pixel holds the same number of samples.
    pub film: Film,
    /// What was done for it.
    pub counters: Counters,
    /// Samples of each pixel; fewer than asked for if the render was cancelled.
    pub samples: u32,
}

/// Renders `scene` as `camera` sees it.
///
/// The work goes over the picture in passes of a few samples a pixel, tile by tile on all
/// threads. Each tile is one task and each pixel belongs to one tile, so sums are made in one
/// fixed order, whatever the number of threads. If `monitor` cancels, the pass under way is
/// dropped and the picture is that of the passes before it.
///
/// # Errors
/// [`RenderError::Param`] for settings out of range, [`RenderError::Threads`] if no threads can be
/// had, [`RenderError::NonFinite`] for a sample that is NaN or infinite.
pub fn render<A: Accel>(
    scene: &Scene<A>,
    camera: &Camera,
    settings: &Settings,
    monitor: &impl Monitor,
) -> Result<Picture, RenderError> {
    settings.validate()?;
    let threads = rayon::ThreadPoolBuilder::new()
        .num_threads(settings.threads)
        .build()
        .map_err(|error| RenderError::Threads(error.to_string()))?;
    let job = Job { scene, camera, settings, monitor, samples_done: AtomicU64::new(0) };
    threads.install(|| job.run())
}

struct Job<'a, A, M> {
    scene: &'a Scene<A>,
    camera: &'a Camera,
    settings: &'a Settings,
    monitor: &'a M,
    samples_done: AtomicU64,
}

type TileResult = (Tile, Vec<PixelSum>, Counters);

impl<A: Accel, M: Monitor> Job<'_, A, M> {
    fn run(&self) -> Result<Picture, RenderError> {
        let Settings { width, height, samples, .. } = *self.settings;
        let mut picture =
            Picture { film: Film::new(width, height), counters: Counters::default(), samples: 0 };
        for first in (0..samples).step_by(PASS_SAMPLES as usize) {
            let pass = PassSamples { first, count: PASS_SAMPLES.min(samples - first) };
            let Some(tiles) = self.pass(pass)? else { break };
            for (tile, sums, counters) in tiles {
                picture.film.merge_tile(&tile, &sums);
                picture.counters += counters;
            }
            picture.samples += pass.count;
        }
        Ok(picture)
    }

    /// All tiles of one pass, in order; `None` if cancelled before the last.
    fn pass(&self, pass: PassSamples) -> Result<Option<Vec<TileResult>>, RenderError> {
        let tiles: Vec<Tile> = Tile::all(self.settings.width, self.settings.height).collect();
        let results: Result<Vec<Option<TileResult>>, RenderError> = tiles
            .into_par_iter()
            .map_init(Wave::default, |wave, tile| {
                let view = View { scene: self.scene, camera: self.camera, settings: self.settings };
                let Some(counters) = wave.trace(&view, tile, pass, || self.monitor.cancelled()) else {
                    return Ok(None);
                };
                self.report(counters.camera_rays);
                Ok(Some((tile, wave.sum_pixels(tile, pass)?, counters)))
            })
            .collect();
        // A pass with a tile missing is no pass.
        Ok(results?.into_iter().collect())
    }

    fn report(&self, samples: u64) {
        let Settings { width, height, samples: per_pixel, .. } = *self.settings;
        let samples_done = self.samples_done.fetch_add(samples, Ordering::Relaxed) + samples;
        let samples_total = u64::from(width) * u64::from(height) * u64::from(per_pixel);
        self.monitor.progress(Progress { samples_done, samples_total });
    }
}
