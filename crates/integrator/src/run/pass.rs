use super::meter::Meter;
use super::monitor::Monitor;
use crate::caught::caught;
use crate::film::{Block, Moments, Tally};
use crate::path::{RenderContext, TILE_SIDE, Tile, Wavefront};
use crate::{Counters, RenderError, Sampler};
use globillum_material::Rgb;
use rayon::prelude::*;
use std::ops::Range;

/// Samples per pixel in one wavefront.
const WAVEFRONT_SAMPLES: u32 = 4;

/// Renders single passes.
pub(crate) struct PassRenderer<'a> {
    pub(crate) context: RenderContext<'a>,
    pub(crate) monitor: &'a dyn Monitor,
    pub(crate) meter: &'a Meter,
    /// The pixels that are rendered: those of the film, in the sensor's grid.
    pub(crate) window: Tile,
}

type TileResult = (Tile, Vec<Moments>, Counters);

impl PassRenderer<'_> {
    /// Samples in `passes`, all pixels together.
    pub(crate) fn samples_of(&self, passes: Range<u32>) -> u64 {
        self.context.settings.samples_of(passes).len() as u64 * self.window.pixel_count() as u64
    }

    /// Renders one pass on all threads; `None` if `cancelled` before its end.
    pub(crate) fn render_pass(
        &self,
        pass: u32,
        cancelled: impl Fn() -> bool + Sync,
    ) -> Result<Option<(Block, Counters)>, RenderError> {
        let tiles: Vec<Tile> = Tile::all(self.window).collect();
        let results: Result<Vec<Option<TileResult>>, RenderError> = tiles
            .into_par_iter()
            .map_init(Wavefront::default, |wavefront, tile| {
                // A tile clears what a panic in the one before left in the wavefront.
                let result = caught(|| self.render_tile(wavefront, tile, pass, &cancelled));
                result.unwrap_or_else(|message| Err(RenderError::Worker { x: tile.x, y: tile.y, message }))
            })
            .collect();
        // A pass without one of its tiles is dropped.
        let tiles: Option<Vec<TileResult>> = results?.into_iter().collect();
        Ok(tiles.map(|tiles| self.block(pass, tiles)))
    }

    /// Renders one tile of a pass, a few samples of each pixel at a time.
    fn render_tile(
        &self,
        wavefront: &mut Wavefront,
        tile: Tile,
        pass: u32,
        cancelled: &impl Fn() -> bool,
    ) -> Result<Option<TileResult>, RenderError> {
        let all = self.context.settings.samples_of(pass..pass + 1);
        let mut pixels = vec![Moments::default(); tile.pixel_count()];
        let mut counters = Counters::default();
        for first in all.clone().step_by(WAVEFRONT_SAMPLES as usize) {
            if cancelled() {
                return Ok(None);
            }
            let samples = first..all.end.min(first + WAVEFRONT_SAMPLES);
            let Some(counted) = wavefront.trace(&self.context, tile, &samples, cancelled) else {
                return Ok(None);
            };
            let radiance = wavefront.radiance().chunks_exact(samples.len());
            for (((x, y), pixel), radiance) in tile.pixels().zip(&mut pixels).zip(radiance) {
                for (sample, &radiance) in samples.clone().zip(radiance) {
                    if !radiance.is_finite() {
                        return Err(RenderError::NonFinite { x, y, sample });
                    }
                    pixel.add(radiance, u64::from(sample - all.start));
                }
            }
            counters += counted;
        }
        self.meter.add(pixels.len() as u64 * all.len() as u64, &counters);
        self.monitor.progress(self.meter.progress());
        Ok(Some((tile, pixels, counters)))
    }

    /// Puts the tiles of a pass together as a block of the film.
    fn block(&self, pass: u32, tiles: Vec<TileResult>) -> (Block, Counters) {
        let settings = self.context.settings;
        let samples = settings.samples_of(pass..pass + 1).len() as u64;
        let mut pixels = vec![Moments::default(); self.window.pixel_count()];
        let mut counters = Counters::default();
        for (tile, moments, counted) in tiles {
            for ((x, y), moments) in tile.pixels().zip(moments) {
                pixels[self.window.index(x, y)] = moments;
            }
            counters += counted;
        }
        let observations = match settings.sampler {
            Sampler::Independent => samples,
            // The samples of a pass are dependent: only their mean is an observation.
            Sampler::Sobol => {
                pixels.iter_mut().for_each(|pixel| pixel.spread = Rgb::BLACK);
                1
            }
        };
        let tally = Tally { samples, observations };
        let tile_rows = self.window.height.div_ceil(TILE_SIDE) as usize;
        (Block::of_pass(pass, tally, pixels, tile_rows), counters)
    }
}
