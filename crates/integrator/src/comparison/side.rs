use crate::Estimates;
use crate::pixel_rect::{BLOCK_SIDE, PixelRect};
use globillum_material::Rgb;

/// A mean with its variance: of a pixel, or of a block.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    pub(super) mean: Rgb,
    /// Variance of the mean; infinite if unknown.
    pub(super) variance: Rgb,
    /// Degrees of freedom of the variance.
    pub(super) dof: f64,
}

/// One side of a comparison: a picture, or several seeds of one.
#[derive(Debug)]
pub(super) struct Side {
    pub(super) pixels: Vec<Cell>,
    pub(super) blocks: Vec<Cell>,
}

/// Blocks of 4 x 4 pixels, row by row.
fn blocks(width: u32, height: u32) -> impl Iterator<Item = PixelRect> {
    PixelRect::grid([width, height], [BLOCK_SIDE; 2])
}

impl Side {
    /// The side of a picture with its own errors, or of several pictures, whose errors are their spread. All have
    /// the size of the first.
    pub(super) fn of(pictures: &[Estimates]) -> Option<Self> {
        match pictures {
            [] => None,
            [picture] => Some(Self::of_one(picture)),
            seeds => Some(Self::of_seeds(seeds)),
        }
    }

    fn of_one(picture: &Estimates) -> Self {
        let pixel = |at: usize| {
            let (mean, error) = (picture.means[at], picture.standard_errors[at]);
            let dof = f64::from(picture.observations[at]) - 1.0;
            Cell { mean, variance: error * error + rounding(mean), dof: dof.max(1.0) }
        };
        let pixels: Vec<Cell> = (0..picture.means.len()).map(pixel).collect();
        let dependence = dependence(picture, &pixels);
        let block = |(block, dependence): (PixelRect, f64)| {
            let (mut mean, mut variance, mut uncertain, mut count) = (Rgb::BLACK, Rgb::BLACK, 0.0, 0.0);
            let mut least = f64::INFINITY;
            for pixel in block.places(picture.width).map(|at| pixels[at]) {
                mean += pixel.mean;
                variance += pixel.variance;
                uncertain += pixel.variance.mean().powi(2) / pixel.dof;
                least = least.min(pixel.dof);
                count += 1.0;
            }
            // Satterthwaite 1946; at least those of one pixel, also where squares underflow.
            let dependent = dependent_pixels(picture, block);
            let dof = f64::max(variance.mean().powi(2) / (uncertain * dependent), least);
            Cell { mean: mean / count, variance: variance * (dependence / (count * count)), dof }
        };
        let blocks = blocks(picture.width, picture.height).zip(dependence).map(block).collect();
        Self { pixels, blocks }
    }

    fn of_seeds(seeds: &[Estimates]) -> Self {
        let (width, height) = (seeds[0].width, seeds[0].height);
        let pixel = |at: usize| spread(seeds.iter().map(|seed| seed.means[at]));
        let block = |block: PixelRect| {
            let mean = |seed: &Estimates| {
                let mut sum = Rgb::BLACK;
                block.places(width).for_each(|at| sum += seed.means[at]);
                sum / block.pixel_count() as f64
            };
            spread(seeds.iter().map(mean))
        };
        Self {
            pixels: (0..seeds[0].means.len()).map(pixel).collect(),
            blocks: blocks(width, height).map(block).collect(),
        }
    }
}

/// For each block the variance of its mean over what it were if its pixels were independent, by the 3 x 3 blocks around
/// it: a block's own error rests on a few observations only. The most that it can be where errors of blocks are unknown
/// (Cauchy and Schwarz).
fn dependence(picture: &Estimates, pixels: &[Cell]) -> Vec<f64> {
    let independent = |block: PixelRect| {
        let variance: f64 = block.places(picture.width).map(|at| pixels[at].variance.mean()).sum();
        variance / (block.pixel_count() as f64).powi(2)
    };
    let independent: Vec<f64> = blocks(picture.width, picture.height).map(independent).collect();
    let told = |at: usize| picture.block_errors[at].map(|error| error * error).mean();
    let whole = PixelRect::whole([picture.width, picture.height]);
    let all = whole.blocks_in(&whole);
    let of_block = |(block, place)| {
        let around = PixelRect::pixels_near(place, [all.width, all.height]).map(|(x, y)| all.index(x, y));
        let (mut joint, mut alone) = (0.0, 0.0);
        around.for_each(|at| (joint, alone) = (joint + told(at), alone + independent[at]));
        let ratio = joint / alone;
        if ratio.is_finite() { ratio } else { dependent_pixels(picture, block) }
    };
    blocks(picture.width, picture.height).zip(all.pixels()).map(of_block).collect()
}

/// How many times the variance of a block's mean may be what it were if its pixels were independent.
fn dependent_pixels(picture: &Estimates, block: PixelRect) -> f64 {
    let pixels = block.pixel_count() as f64;
    pixels.min(picture.path_reuse.dependent_pixels().into())
}

/// The variance of what programs that sum in `f32` round: a millionth of the mean.
fn rounding(mean: Rgb) -> Rgb {
    mean * mean * 1e-12
}

/// The mean of equally good values, and its variance by their spread.
fn spread(values: impl Iterator<Item = Rgb> + Clone) -> Cell {
    let (mut sum, mut count) = (Rgb::BLACK, 0.0);
    for value in values.clone() {
        sum += value;
        count += 1.0;
    }
    let mean = sum / count;
    let mut squares = Rgb::BLACK;
    for value in values {
        let apart = value - mean;
        squares += apart * apart;
    }
    Cell { mean, variance: squares / ((count - 1.0) * count) + rounding(mean), dof: count - 1.0 }
}
