use super::meter::Meter;
use super::monitor::Monitor;
use crate::caught::caught;
use crate::film::{Blocks, Moments, PassNode, Tally, mean};
use crate::path::{RenderContext, TileProbes, Wavefront};
use crate::pixel_rect::PixelRect;
use crate::{Counters, RenderError, Sampler};
use globillum_material::Rgb;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::OnceLock;

/// Samples per pixel in one wavefront.
const WAVEFRONT_SAMPLES: u32 = 4;

/// The most tiles that a thread takes at once. Tiles differ in cost, so threads that took many would wait for each other.
const TILES_AT_ONCE: usize = 4;

/// Renders single passes.
pub(crate) struct PassRenderer<'a> {
    pub(crate) context: RenderContext<'a>,
    pub(crate) monitor: &'a dyn Monitor,
    pub(crate) meter: &'a Meter,
    /// The pixels that are rendered: those of the film, in the sensor's grid.
    pub(crate) window: PixelRect,
    /// What probes find of each tile. The first pass that renders the tile traces them.
    pub(crate) probes: Vec<OnceLock<TileProbes>>,
}

/// What the samples of a tile add up to.
struct TileResult {
    tile: PixelRect,
    pixels: Vec<Moments>,
    /// The means of blocks, where single samples are observations.
    blocks: Vec<Moments>,
    counters: Counters,
}

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
    ) -> Result<Option<(PassNode, Counters)>, RenderError> {
        let tiles: Vec<PixelRect> = PixelRect::tiles(self.window).collect();
        let results: Result<Vec<Option<TileResult>>, RenderError> = tiles
            .into_par_iter()
            .with_max_len(TILES_AT_ONCE)
            .zip(&self.probes)
            .map_init(Wavefront::default, |wavefront, (tile, probes)| {
                // After a panic the pass has failed: what is left in the wavefront reaches no picture.
                let result = caught(|| {
                    if cancelled() {
                        return Ok(None);
                    }
                    let probes = probes.get_or_init(|| TileProbes::of(&self.context, tile));
                    self.render_tile(wavefront, probes, pass, &cancelled)
                });
                result.unwrap_or_else(|message| Err(RenderError::Worker { x: tile.x, y: tile.y, message }))
            })
            .collect();
        // A pass without one of its tiles is dropped.
        let tiles: Option<Vec<TileResult>> = results?.into_iter().collect();
        Ok(tiles.map(|tiles| self.node(pass, tiles)))
    }

    /// Renders one tile of a pass, a few samples of each pixel at a time.
    fn render_tile(
        &self,
        wavefront: &mut Wavefront,
        probes: &TileProbes,
        pass: u32,
        cancelled: &impl Fn() -> bool,
    ) -> Result<Option<TileResult>, RenderError> {
        let tile = probes.tile;
        let all = self.context.settings.samples_of(pass..pass + 1);
        let mut pixels = vec![Moments::default(); tile.pixel_count()];
        let of_blocks = Blocks::of_means(tile.width);
        let mut blocks = vec![Moments::default(); of_blocks.count(pixels.len())];
        let mut counters = Counters::default();
        for first in all.clone().step_by(WAVEFRONT_SAMPLES as usize) {
            let samples = first..all.end.min(first + WAVEFRONT_SAMPLES);
            let Some(counted) = wavefront.trace(&self.context, probes, samples.clone(), cancelled) else {
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
            if self.context.settings.sampler == Sampler::Independent {
                let add =
                    |(block, moments)| add_means(moments, block, wavefront.radiance(), &samples, all.start);
                of_blocks.all(pixels.len()).zip(&mut blocks).for_each(add);
            }
            counters += counted;
        }
        self.meter.add(pixels.len() as u64 * all.len() as u64, &counters);
        self.monitor.progress(self.meter.progress());
        Ok(Some(TileResult { tile, pixels, blocks, counters }))
    }

    /// Puts the tiles of a pass together as a node of the film.
    fn node(&self, pass: u32, tiles: Vec<TileResult>) -> (PassNode, Counters) {
        let settings = self.context.settings;
        let samples = settings.samples_of(pass..pass + 1).len() as u64;
        let observations = match settings.sampler {
            Sampler::Independent => samples,
            // The samples of a pass are dependent: only their mean is an observation.
            Sampler::Sobol => 1,
        };
        let pixels = vec![Moments::default(); self.window.pixel_count()];
        let mut node = PassNode::of_pass(pass, Tally { samples, observations }, pixels, self.window.width);
        let mut counters = Counters::default();
        for TileResult { tile, pixels, blocks, counters: counted } in tiles {
            for ((x, y), moments) in tile.pixels().zip(pixels) {
                let spread = if observations > 1 { moments.spread } else { Rgb::BLACK };
                node.pixels[self.window.index(x, y)] = Moments { spread, ..moments };
            }
            let [all, part] = [&self.window, &tile].map(|tile| tile.blocks_in(&self.window));
            for ((x, y), moments) in part.pixels().zip(blocks) {
                node.blocks[all.index(x, y)] = moments.spread;
            }
            counters += counted;
        }
        (node, counters)
    }
}

/// Adds the means of a block's `radiance`, of all samples of a tile, to the mean of those from `start` on.
fn add_means(
    moments: &mut Moments,
    block: impl Iterator<Item = usize>,
    radiance: &[Rgb],
    samples: &Range<u32>,
    start: u32,
) {
    let places: Vec<usize> = block.collect();
    for (i, sample) in samples.clone().enumerate() {
        let of_sample = places.iter().map(|place| radiance[place * samples.len() + i]);
        moments.add(mean(of_sample), u64::from(sample - start));
    }
}
