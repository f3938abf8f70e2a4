//! Whether two pictures show the same, told by their errors.

mod deviates;
mod normal;
mod side;
mod verdict;

use crate::Estimates;
use crate::film::student::quantile_975;
use crate::pixel_rect::{BLOCK_SIDE, PixelRect};
use deviates::{CellVariance, deviates};
use globillum_material::Rgb;
use side::{Cell, Side};

pub use verdict::Verdict;

/// Two estimates of a picture beside each other: what tells chance from a difference.
///
/// A side is one picture with its standard errors, or several seeds of a picture, which are averaged and whose
/// spread is the error. Both sides must be independent: other seeds, or other programs. Errors may depend on each
/// other within the tiles of 16 x 16 pixels of the whole picture ([`Estimates::origin`]), but not between tiles, as those of
/// [`Film`](crate::Film), and within blocks of 4 x 4 where no picture [reuses paths](crate::PathReuse), as pictures of
/// other programs are taken to do; a filter that spreads a sample over several pixels makes them dependent.
///
/// Four tests decide ([`Comparison::verdict`]). Three of them do not assume that samples are normally distributed:
/// each is a sum of a term for each tile (or block, if none is larger), independent and of mean 0 if the pictures are
/// equal, over the root of the sum of its squares. With some hundred tiles that is a standard normal deviate. The
/// fourth, the largest difference of a block, finds what few blocks show.
///
/// ```
/// use globillum_integrator::{Comparison, Estimates, Film, Verdict};
///
/// /// Whether two seeds of a picture differ by more than chance, which one pair of a thousand seems to; `None` for
/// /// pictures of different sizes.
/// fn verdict(a: &Film, b: &Film) -> Option<Verdict> {
///     let [a, b] = [a, b].map(Estimates::of);
///     Comparison::between(&[a], &[b]).map(|comparison| comparison.verdict(0.001))
/// }
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Comparison {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// The first side's mean less the second's over the standard error of the difference, for every pixel and
    /// component, row by row from the top, as a standard normal deviate: Student's distribution is accounted for. Where
    /// sides know their errors differently well, the degrees of freedom are those that the errors of the pixels around
    /// suggest if these are fewer, so that deviates are rather too small. NaN if an error is unknown.
    pub pixels: Vec<Rgb>,
    /// The same for the blocks of 4 x 4 pixels. The error of a block of a side of several seeds is their spread.
    /// That of a single picture is computed from the errors of its pixels, times how much less or more the blocks around
    /// it vary than if pixels were independent ([`Estimates::block_errors`]); where that is unknown, times the most that
    /// it can be, the number of its pixels if they depend on each other, so that deviates are too small.
    pub blocks: Vec<Rgb>,
    /// The first side's mean radiance over the second's, all components together; NaN if the second is black.
    pub ratio: f64,
    /// The 95 % confidence interval of `ratio`, by the differences of tiles: too wide where tiles truly differ. It is
    /// Student's, with a degree of freedom less than there are tiles; `[-inf, inf]` of a single tile.
    pub ratio_95: [f64; 2],
    /// The ratio of each component.
    pub component_ratios: Rgb,
    /// Test of the means: the sum of the differences of tiles in units of their errors, of one side if those of the other are
    /// not known. A standard normal deviate if pictures are equal.
    pub mean: f64,
    /// Test of structure: the sum of the products of such differences of neighbouring tiles (Moran 1950), above 0
    /// where pictures differ alike in neighbouring tiles. A standard normal deviate if pictures are equal.
    pub neighbours: f64,
    /// Test of the errors; `None` if no errors are known.
    pub chi_square: Option<ChiSquare>,
    /// Test of the blocks: the largest absolute deviate of a block and component, as in [`Comparison::blocks`], but with a
    /// variance of at least the mean of those of the blocks around. Rare samples, which find much of the light, may have
    /// missed a block, which then states too small an error. `None` if no errors are known.
    pub largest_block: Option<f64>,
    /// The p-value that the mean of both sides would have beside black, with the same errors: what a difference as large as
    /// the picture itself would show. It is large where tiles are few, or errors not known well; 0 of black pictures.
    pub least_p_value: f64,
}

/// Squared differences of pixels beside their variances.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ChiSquare {
    /// Squared differences over variances: about 1 if pictures are equal and errors are right, above if pictures
    /// differ or errors are too small. Pixels are weighted by the inverse variance of the tiles around their own.
    pub reduced: f64,
    /// By how much squared differences exceed variances, tile by tile, each by at most four times the variance around. A
    /// standard normal deviate, or rather less, if pictures are equal and errors are right; below -4, errors are too large or
    /// the pictures are not independent.
    pub z: f64,
}

impl Comparison {
    /// Compares two sides of one or several pictures each; `None` if a side has none, sizes differ, or there are no pixels.
    ///
    /// # Panics
    /// If a list of a picture has another length than [`Estimates`] says.
    pub fn between(a: &[Estimates], b: &[Estimates]) -> Option<Self> {
        let (width, height) = a.first().map(|first| (first.width, first.height))?;
        let are_whole = a.iter().chain(b).all(Estimates::are_whole);
        assert!(are_whole, "every list has one entry for each pixel or block");
        let differs = |picture: &Estimates| (picture.width, picture.height) != (width, height);
        if width == 0 || height == 0 || a.iter().chain(b).any(differs) {
            return None;
        }
        // Of pictures with equal tiles, one that knows its place.
        let tiles = |picture: &&Estimates| (picture.path_reuse.tile_side(), picture.origin != [0; 2]);
        let largest = a.iter().chain(b).max_by_key(tiles)?;
        let tile_side = largest.path_reuse.tile_side().max(BLOCK_SIDE);
        let offset = largest.origin.map(|at| at % tile_side);
        let pair = Pair { width, height, tile_side, offset, a: Side::of(a)?, b: Side::of(b)? };
        let comparison = Self::of(&pair);
        let beside_black = pair.beside_black();
        let least_p_value = if beside_black.is_black() { 0.0 } else { Self::of(&beside_black).p_value() };
        Some(Self { least_p_value, ..comparison })
    }

    /// The comparison of a pair, but for [`Comparison::least_p_value`].
    fn of(pair: &Pair) -> Self {
        let Pair { width, height, .. } = *pair;
        let variances = [&pair.a, &pair.b].map(|side| pair.tile_variances(side));
        let differences = pair.differences(&variances);
        let of_blocks = |of| deviates([&pair.a.blocks, &pair.b.blocks], width.div_ceil(BLOCK_SIDE), of);
        let components = of_blocks(CellVariance::AtLeastAround).into_iter().flat_map(|z| z.to_array());
        let largest_block = components.filter(|z| !z.is_nan()).map(f64::abs).reduce(f64::max);
        let ratio = pair.ratio(Rgb::mean);
        let [r, g, b] = [0, 1, 2].map(|c| pair.ratio(|rgb| rgb.to_array()[c]).value);
        Self {
            width,
            height,
            pixels: deviates([&pair.a.pixels, &pair.b.pixels], width, CellVariance::Own),
            blocks: of_blocks(CellVariance::Own),
            ratio: ratio.value,
            ratio_95: ratio.interval_95,
            component_ratios: Rgb::new(r, g, b),
            mean: normal::of_sum(differences.iter().copied()),
            neighbours: pair.neighbours(&differences),
            chi_square: pair.chi_square(&variances),
            largest_block,
            least_p_value: 0.0,
        }
    }

    /// The probability that equal pictures differ as much as these, by the test of the least probability; at most 1, and
    /// corrected for the number of tests (Bonferroni).
    ///
    /// Of few tiles it is never small, however much the pictures differ ([`Comparison::least_p_value`]): 0.63 for one pass of
    /// 16 x 16 pixels. More seeds of each side, or passes, give errors.
    ///
    /// The means are tested on both sides, structure and chi-square on the upper one, the largest of all blocks and
    /// components as one of as many (Bonferroni again).
    pub fn p_value(&self) -> f64 {
        let mean = 2.0 * normal::above(self.mean.abs());
        let neighbours = normal::above(self.neighbours);
        let chi_square = self.chi_square.map(|chi_square| normal::above(chi_square.z));
        let components = 3.0 * self.blocks.len() as f64;
        let largest = self.largest_block.map(|z| components * 2.0 * normal::above(z));
        let tests = [Some(mean), Some(neighbours), chi_square, largest];
        let count = tests.iter().flatten().count() as f64;
        tests.into_iter().flatten().fold(1.0, |least, p| f64::min(least, count * p))
    }

    /// Width of the grid of [`Comparison::blocks`].
    pub fn blocks_width(&self) -> u32 {
        self.width.div_ceil(BLOCK_SIDE)
    }
}

/// The most by which a tile's squared difference counts as above its variance, over the variance around: few tiles that
/// differ much do not hide that others do. What is cut off makes the test rather too small.
const MAX_EXCESS: f64 = 4.0;

/// A ratio of sums over both sides.
struct Ratio {
    value: f64,
    /// Its 95 % confidence interval.
    interval_95: [f64; 2],
}

/// Both sides.
struct Pair {
    width: u32,
    height: u32,
    /// Pixels along each side of the tiles within which errors may depend on each other.
    tile_side: u32,
    /// Column and row of the upper left pixel in its tile.
    offset: [u32; 2],
    a: Side,
    b: Side,
}

impl Pair {
    /// The mean of both sides beside black, with the errors of the sides.
    fn beside_black(&self) -> Self {
        let mean = |a: &[Cell], b: &[Cell]| -> Vec<Cell> {
            a.iter().zip(b).map(|(a, b)| Cell { mean: 0.5 * (a.mean + b.mean), ..*a }).collect()
        };
        let black = |b: &[Cell]| -> Vec<Cell> { b.iter().map(|b| Cell { mean: Rgb::BLACK, ..*b }).collect() };
        let Self { a, b, .. } = self;
        let bright = Side { pixels: mean(&a.pixels, &b.pixels), blocks: mean(&a.blocks, &b.blocks) };
        let dark = Side { pixels: black(&b.pixels), blocks: black(&b.blocks) };
        Self { a: bright, b: dark, ..*self }
    }

    fn is_black(&self) -> bool {
        let mut pixels = self.a.pixels.iter().chain(&self.b.pixels);
        pixels.all(|pixel| pixel.mean.is_black())
    }

    /// What the picture has of each tile, row by row.
    fn tiles(&self) -> impl Iterator<Item = PixelRect> {
        let [left, top] = self.offset;
        PixelRect::grid([self.width + left, self.height + top], [self.tile_side; 2]).map(move |tile| {
            let (x, y) = (tile.x.max(left), tile.y.max(top));
            let (width, height) = (tile.x + tile.width - x, tile.y + tile.height - y);
            PixelRect { x: x - left, y: y - top, width, height }
        })
    }

    /// The number of tiles in a row.
    fn columns(&self) -> usize {
        (self.width + self.offset[0]).div_ceil(self.tile_side) as usize
    }

    /// What `of` takes of the means of both sides, summed over each tile.
    fn sums(&self, of: impl Fn(Rgb) -> f64) -> impl Iterator<Item = [f64; 2]> {
        self.tiles().map(move |tile| {
            tile.places(self.width)
                .fold([0.0; 2], |[a, b], at| [a + of(self.a.pixels[at].mean), b + of(self.b.pixels[at].mean)])
        })
    }

    /// The differences of the sums of tiles, the mean of the components, over the root of their pixels' variances, of the
    /// side whose are known; as they are if none are.
    ///
    /// The variances bring tiles to one scale, so that no few outweigh the others; no test needs them to be right.
    fn differences(&self, sides: &[Vec<f64>; 2]) -> Vec<f64> {
        let known = |variances: &&Vec<f64>| variances.iter().all(|variance| variance.is_finite());
        let zero = vec![0.0; sides[0].len()];
        let variances = sides.iter().filter(known).fold(zero, |sum, variances| added(&sum, variances));
        let floor = floor(&variances);
        let scale = |variance: f64| if floor > 0.0 { (variance + floor).sqrt() } else { 1.0 };
        self.sums(Rgb::mean).zip(variances).map(|([a, b], variance)| (a - b) / scale(variance)).collect()
    }

    /// The ratio of the sums of what `of` takes of a pixel.
    fn ratio(&self, of: impl Fn(Rgb) -> f64) -> Ratio {
        let sums: Vec<[f64; 2]> = self.sums(of).collect();
        let (a, b) = sums.iter().fold((0.0, 0.0), |(a, b), sums| (a + sums[0], b + sums[1]));
        let ratio = a / b;
        let squares: f64 = sums.iter().map(|sums| (sums[0] - ratio * sums[1]).powi(2)).sum();
        let [tiles, others] = [sums.len(), sums.len() - 1].map(|count| count as f64);
        // Cochran 1977, 6.4.
        let std_err = if others > 0.0 { (squares * tiles / others).sqrt() / b } else { f64::INFINITY };
        let margin = quantile_975(others as u64) * std_err;
        Ratio { value: ratio, interval_95: [ratio - margin, ratio + margin] }
    }

    /// [`Comparison::neighbours`], given the differences of tiles.
    fn neighbours(&self, apart: &[f64]) -> f64 {
        let columns = self.columns();
        let right = |at: usize| (!(at + 1).is_multiple_of(columns)).then_some(at + 1);
        let below = |at: usize| Some(at + columns).filter(|&at| at < apart.len());
        let pairs = (0..apart.len())
            .flat_map(|at| [right(at), below(at)].into_iter().flatten().map(move |n| (at, n)));
        normal::of_sum(pairs.map(|(a, b)| apart[a] * apart[b]))
    }

    /// [`Comparison::chi_square`].
    fn chi_square(&self, sides: &[Vec<f64>; 2]) -> Option<ChiSquare> {
        let variances = added(&sides[0], &sides[1]);
        if !variances.iter().all(|variance| variance.is_finite()) {
            return None;
        }
        let around = self.around(&variances);
        let (mut squares, mut expected, mut excesses) = (0.0, 0.0, Vec::new());
        for ((tile, variance), around) in self.tiles().zip(&variances).zip(around) {
            let weight = if around > 0.0 { 1.0 / around } else { 1.0 };
            let square = tile.places(self.width).map(|at| {
                let apart = self.a.pixels[at].mean - self.b.pixels[at].mean;
                (apart * apart).mean()
            });
            let square: f64 = square.sum();
            squares += weight * square;
            expected += weight * variance;
            excesses.push((weight * (square - variance)).min(MAX_EXCESS));
        }
        let reduced = if squares == expected { 1.0 } else { squares / expected };
        Some(ChiSquare { reduced, z: normal::of_sum(excesses.into_iter()) })
    }

    /// The variances of a side's pixels, summed over each tile; infinite if unknown.
    fn tile_variances(&self, side: &Side) -> Vec<f64> {
        let variance = |at: usize| side.pixels[at].variance.mean();
        self.tiles().map(|tile| tile.places(self.width).map(variance).sum()).collect()
    }

    /// The mean of the values of the tiles around each, of which chance in the tile itself is independent, and a little more
    /// than nothing.
    fn around(&self, values: &[f64]) -> Vec<f64> {
        let columns = self.columns();
        let size = [columns, values.len() / columns].map(|count| count as u32);
        let tiles = PixelRect::whole(size);
        let floor = floor(values);
        let around = |tile: (u32, u32)| {
            let around = PixelRect::pixels_near(tile, size).filter(|&other| other != tile);
            let around: Vec<f64> = around.map(|(x, y)| values[tiles.index(x, y)]).collect();
            mean_of(&around) + floor
        };
        tiles.pixels().map(around).collect()
    }
}

/// A value that is small beside most: a sixteenth of the median, or of the mean if that is 0.
fn floor(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    let middle = sorted.len() / 2;
    let (_, &mut median, _) = sorted.select_nth_unstable_by(middle, f64::total_cmp);
    (if median > 0.0 { median } else { mean_of(values) }) / 16.0
}

fn added(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}

/// 0 for none.
fn mean_of(values: &[f64]) -> f64 {
    if values.is_empty() { 0.0 } else { values.iter().sum::<f64>() / values.len() as f64 }
}
