//! What the samples add up to.

mod checkpoint;
mod dispersion;
mod error;
mod estimates;
#[cfg(any(test, feature = "fuzz"))]
mod fuzz;
mod margin;
mod moments;
mod pass_node;
mod picture;
mod pixels;
pub(crate) mod student;

pub use checkpoint::{CheckpointHeader, CheckpointReader, CheckpointStrip, CheckpointWriter, Merge};
pub(crate) use dispersion::Blocks;
pub use error::{ErrorEstimate, PixelSums};
pub use estimates::Estimates;
#[cfg(any(test, feature = "fuzz"))]
pub use fuzz::check_checkpoint;
pub(crate) use moments::{Moments, Tally, mean};
pub(crate) use pass_node::PassNode;
pub use picture::{Ending, Picture};

use crate::pixel_rect::{PixelRect, SQUARE_SIDE};
use crate::{CheckpointError, PathReuse};
use globillum_material::Rgb;
use pass_node::{insert, passes_of};
use std::ops::Range;

/// A picture's pixels, row 0 at the top: mean radiance, and how well it is known. Of a sensor that measures irradiance,
/// such as [`IrradiancePoints`](crate::IrradiancePoints), every radiance of the film is an irradiance, and rows are not in
/// the order of the list: [`IrradiancePoints::readings`](crate::IrradiancePoints::readings) is.
///
/// A film holds a picture, a crop of it, or a strip of either ([`Film::rows`]). Its methods treat what it holds as a
/// picture of its own: row 0 is the first row of the strip.
///
/// All pixels hold the same passes. Equal passes give equal bits, wherever and in whatever order
/// they were rendered and put together.
///
/// Passes are kept as nodes of `2^k` passes that start at a multiple of `2^k`. Passes from 0 on without gaps make one
/// node for each digit 1 of their number in binary; other passes may make more. A node takes 48 bytes a pixel, and 24
/// bytes for each block of 4 x 4 pixels and each row of tiles.
///
/// The standard error comes from the spread of independent observations: of samples where those
/// are independent, of the means of passes where the samples of a pass are stratified. Errors of
/// different pixels are independent, unless they share paths and points ([`Film::path_reuse`]): then those of different
/// tiles of 16 x 16 are.
///
/// ```
/// use globillum_integrator::Film;
///
/// /// The middle of the picture, red, with its margin: the truth is within it 19 times of 20.
/// fn middle(film: &Film) -> String {
///     let (x, y) = (film.width() / 2, film.height() / 2);
///     format!("{} +- {}", film.mean(x, y).r, film.margin_95(x, y).r)
/// }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    /// Width and height of the whole picture.
    full_size: [u32; 2],
    /// Column and row in it of the upper left pixel of the picture or crop, of which the film may hold a strip.
    crop_origin: [u32; 2],
    width: u32,
    /// The rows of the picture or crop that are held; whole rows of tiles.
    rows: Range<u32>,
    path_reuse: PathReuse,
    /// In the order of their passes; no two that could be joined.
    nodes: Vec<PassNode>,
}

impl Film {
    /// Rows of pixels in a row of tiles. A strip begins at a multiple of it, and ends at one or with the picture.
    pub const TILE_ROWS: u32 = SQUARE_SIDE;

    /// A film without passes of these rows of a picture that ends with them.
    pub(crate) fn new(width: u32, rows: Range<u32>, path_reuse: PathReuse) -> Self {
        Self { full_size: [width, rows.end], crop_origin: [0; 2], width, rows, path_reuse, nodes: Vec::new() }
    }

    /// The same film of a crop that begins at `crop_origin` of a picture of `full_size`, or of a strip of the crop.
    pub(crate) fn within(self, full_size: [u32; 2], crop_origin: [u32; 2]) -> Self {
        Self { full_size, crop_origin, ..self }
    }

    /// Whether both hold the same pixels of pictures of one size.
    pub(crate) fn has_pixels_of(&self, other: &Self) -> bool {
        let pixels = |film: &Self| (film.full_size, film.crop_origin, film.width, film.rows.clone());
        pixels(self) == pixels(other)
    }

    /// One of the same kind, without passes.
    pub(crate) fn emptied(&self) -> Self {
        Self::new(self.width, self.rows.clone(), self.path_reuse).within(self.full_size, self.crop_origin)
    }

    /// Width in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels: that of the strip, if the film holds a strip.
    pub fn height(&self) -> u32 {
        self.rows.end - self.rows.start
    }

    /// Width and height of the whole picture, of which the film may hold a [crop](crate::Render::crop) or a
    /// [strip](Film::rows).
    pub fn full_size(&self) -> [u32; 2] {
        self.full_size
    }

    /// Column and row of the film's upper left pixel in the whole picture.
    pub fn origin(&self) -> [u32; 2] {
        let [x, y] = self.crop_origin;
        [x, y + self.rows.start]
    }

    /// The rows of the picture or crop that the film holds.
    pub fn rows(&self) -> Range<u32> {
        self.rows.clone()
    }

    /// Whether the errors of the pixels of a tile of 16 x 16 depend on each other. [`Film::block_variances_of_mean`]
    /// allows for that.
    pub fn path_reuse(&self) -> PathReuse {
        self.path_reuse
    }

    /// Mean radiance of a pixel, in the unit of the lights' radiance; black before the first sample.
    ///
    /// # Panics
    /// If the pixel lies outside the film.
    pub fn mean(&self, x: u32, y: u32) -> Rgb {
        let (moments, tally) = self.sums(self.index(x, y));
        moments.mean(tally)
    }

    /// Variance of [`Film::mean`], estimated from the spread of [`Film::observations`], component
    /// by component; infinite for fewer than two. Its square root is the standard error. It is the pixel's own:
    /// 0 where its observations are equal, which does not make it exact ([`Film::margin_95`]).
    ///
    /// # Panics
    /// If the pixel lies outside the film.
    pub fn variance_of_mean(&self, x: u32, y: u32) -> Rgb {
        let (moments, tally) = self.sums(self.index(x, y));
        moments.variance_of_mean(tally)
    }

    /// Half the width of the interval around [`Film::mean`] that holds the truth with a probability
    /// of 95 %, component by component. Infinite for fewer than two observations.
    ///
    /// It is Student's quantile times the standard error, but at least 1.4 standard errors by the mean
    /// variance of the 3 x 3 pixels around it: where samples are skewed, a pixel that missed the rare bright
    /// ones underestimates its error. Where none of the 3 x 3 varied, the mean variance of the whole
    /// picture replaces theirs. The margin is therefore 0 only if no pixel of the picture varied; a pixel that
    /// is exact, such as one of an empty background, has a margin above 0 in any other picture.
    ///
    /// Measured, by fifths of the pixels by skewness and from 4 passes on: 94 to 98 % in rooms and on a
    /// checkered floor. The limit is a pixel whose neighbours have missed the rare samples too: 87 to 96 %
    /// where small curved mirrors reflect light, 86 to 100 % where a sliver of light covers a
    /// thirtieth to a thousandth of each pixel. docs/estimators.md has the tables.
    ///
    /// Where nothing of the 3 x 3 varied, one call looks at all pixels: for many, use [`Film::margins_95`].
    ///
    /// # Panics
    /// If the pixel lies outside the film.
    pub fn margin_95(&self, x: u32, y: u32) -> Rgb {
        self.margin_of(x, y, || self.mean_variance())
    }

    /// How many samples each pixel holds.
    pub fn samples(&self) -> u64 {
        self.tally().samples
    }

    /// How many independent observations each pixel's error rests on: samples of the independent
    /// sampler, passes of the Sobol' sampler.
    pub fn observations(&self) -> u64 {
        self.tally().observations
    }

    /// The passes held, as ranges in ascending order that neither meet nor overlap.
    pub fn passes(&self) -> Vec<Range<u32>> {
        passes_of(&self.nodes)
    }

    /// Mean radiance of every pixel, row by row from the top.
    pub fn means(&self) -> impl Iterator<Item = Rgb> + '_ {
        self.all_sums().map(|(moments, tally)| moments.mean(tally))
    }

    /// [`Film::variance_of_mean`] of every pixel, row by row from the top.
    pub fn variances_of_mean(&self) -> impl Iterator<Item = Rgb> + '_ {
        self.all_sums().map(|(moments, tally)| moments.variance_of_mean(tally))
    }

    /// Variance of the mean over each block of 4 x 4 pixels, row by row from the upper left corner, where blocks at the
    /// right and lower border may be smaller. Estimated, as [`Film::variance_of_mean`], from the spread of
    /// [`Film::observations`], here of such means: it allows for errors that the pixels of a block have in common or
    /// that cancel. Infinite for fewer than two observations.
    pub fn block_variances_of_mean(&self) -> impl Iterator<Item = Rgb> + '_ {
        let blocks = Blocks::of_means(self.width).all(self.pixel_count());
        blocks.enumerate().map(|(at, block)| {
            let places: Vec<usize> = block.collect();
            let (moments, tally) = self.joined(|node| Moments {
                sum: mean(places.iter().map(|&place| node.pixels[place].sum)),
                spread: node.blocks[at],
            });
            moments.variance_of_mean(tally)
        })
    }

    /// [`Film::margin_95`] of every pixel, row by row from the top.
    pub fn margins_95(&self) -> impl Iterator<Item = Rgb> + '_ {
        let picture = self.mean_variance();
        let pixels = (0..self.height()).flat_map(|y| (0..self.width).map(move |x| (x, y)));
        pixels.map(move |(x, y)| self.margin_of(x, y, || picture))
    }

    /// Mean radiance of the whole picture.
    pub fn image_mean(&self) -> Rgb {
        mean(self.means())
    }

    /// Takes in the passes of `other`, a film of the same picture.
    ///
    /// # Errors
    /// [`CheckpointError::Overlap`] for a pass that both hold, [`CheckpointError::Mismatch`] for
    /// other pixels. Neither film is changed.
    pub(crate) fn merge(&mut self, other: Self) -> Result<(), CheckpointError> {
        if !self.has_pixels_of(&other) {
            return Err(CheckpointError::Mismatch("size"));
        }
        if let Some(shared) = other.passes().iter().find_map(|range| self.held_of(range).next()) {
            return Err(CheckpointError::Overlap { pass: shared.start });
        }
        for node in other.nodes {
            self.insert(node);
        }
        Ok(())
    }

    /// Whether the film holds this pass.
    pub(crate) fn holds(&self, pass: u32) -> bool {
        self.nodes.iter().any(|node| node.header.range().contains(&u64::from(pass)))
    }

    /// The parts of `passes` that the film holds, in ascending order.
    pub(crate) fn held_of(&self, passes: &Range<u32>) -> impl Iterator<Item = Range<u32>> + use<> {
        let Range { start, end } = *passes;
        let parts = self.passes().into_iter().map(move |held| held.start.max(start)..held.end.min(end));
        parts.filter(|part| !part.is_empty())
    }

    /// Adds a node of passes that are not there yet, and joins what makes up a larger node.
    pub(crate) fn insert(&mut self, node: PassNode) {
        let blocks = self.independent_blocks();
        insert(&mut self.nodes, node, |node, next| node.join(next, &blocks));
    }

    /// Appends the rows below, of the same passes.
    pub(crate) fn append(&mut self, below: Self) {
        debug_assert_eq!(self.rows.end, below.rows.start);
        self.rows.end = below.rows.end;
        for (node, more) in self.nodes.iter_mut().zip(below.nodes) {
            debug_assert_eq!(node.header, more.header);
            node.pixels.extend(more.pixels);
            node.blocks.extend(more.blocks);
            node.halves.extend(more.halves);
        }
    }

    /// [`Film::margin_95`], by the mean variance of the `picture`.
    fn margin_of(&self, x: u32, y: u32, picture: impl FnOnce() -> Rgb) -> Rgb {
        let around = PixelRect::pixels_near((x, y), [self.width, self.height()]);
        let around = around.map(|(x, y)| self.variance_of_mean(x, y));
        margin::margin_95(self.observations(), self.variance_of_mean(x, y), around, picture)
    }

    /// How many standard errors of a mean its 95 % interval is wide on either side, if observations are normally
    /// distributed (Student); infinite for fewer than two observations.
    pub(crate) fn student_quantile(&self) -> f64 {
        student::quantile_975(self.observations().saturating_sub(1))
    }

    /// The mean of [`Film::variance_of_mean`] over all pixels.
    fn mean_variance(&self) -> Rgb {
        mean(self.variances_of_mean())
    }

    pub(crate) fn nodes(&self) -> &[PassNode] {
        &self.nodes
    }

    pub(crate) fn pixel_count(&self) -> usize {
        self.width as usize * self.height() as usize
    }

    pub(crate) fn tally(&self) -> Tally {
        self.nodes.iter().fold(Tally::default(), |sum, node| sum.joined(node.header.tally))
    }

    /// The blocks of pixels whose errors are independent of each other's.
    pub(crate) fn independent_blocks(&self) -> Blocks {
        Blocks { width: self.width, side: self.path_reuse.tile_side() }
    }

    pub(crate) fn all_sums(&self) -> impl Iterator<Item = (Moments, Tally)> + '_ {
        (0..self.pixel_count()).map(|index| self.sums(index))
    }

    /// All of a pixel's nodes as one set.
    fn sums(&self, index: usize) -> (Moments, Tally) {
        self.joined(|node| node.pixels[index])
    }

    /// What all nodes hold of something as one set, in the order of their passes.
    fn joined(&self, of: impl Fn(&PassNode) -> Moments) -> (Moments, Tally) {
        let mut nodes = self.nodes.iter().map(|node| (of(node), node.header.tally));
        let first = nodes.next().unwrap_or_default();
        nodes.fold(first, |(a, n), (b, m)| (a.joined(n.samples, &b, m.samples), n.joined(m)))
    }

    fn index(&self, x: u32, y: u32) -> usize {
        assert!(x < self.width && y < self.height(), "pixel ({x}, {y}) is outside the film");
        y as usize * self.width as usize + x as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// A pass of a film of one pixel, of one sample that no other pass has.
    fn pass(first: u32) -> PassNode {
        let sum = Rgb::splat(1.0 / f64::from(3 + first));
        let tally = Tally { samples: 1, observations: 1 };
        PassNode::of_pass(first, tally, vec![Moments { sum, spread: Rgb::BLACK }], 1)
    }

    fn film(passes: impl IntoIterator<Item = u32>) -> Film {
        let mut film = Film::new(1, 0..1, PathReuse::Off);
        passes.into_iter().for_each(|first| film.insert(pass(first)));
        film
    }

    #[test]
    fn nodes_hold_what_a_plain_sum_does() {
        let film = film(0..37);
        let values: Vec<f64> = (0..37).map(|i| 1.0 / f64::from(3 + i)).collect();
        let mean = values.iter().sum::<f64>() / 37.0;
        let spread: f64 = values.iter().map(|x| (x - mean) * (x - mean)).sum();
        assert_relative_eq!(film.mean(0, 0).g, mean, max_relative = 1e-14);
        assert_relative_eq!(film.variance_of_mean(0, 0).g, spread / (36.0 * 37.0), max_relative = 1e-13);
    }

    /// The errors of two pixels of a block cancel in each of 37 passes, and those of a pixel alone are its block's.
    #[test]
    fn errors_of_a_block_are_those_of_its_mean() {
        let sum = |value: f64| Moments { sum: Rgb::splat(value), spread: Rgb::BLACK };
        let values: Vec<f64> = (0..37).map(|i| 1.0 / f64::from(3 + i)).collect();
        let mut film = Film::new(6, 0..1, PathReuse::Tiles);
        for (first, &x) in (0..).zip(&values) {
            let pixels = [x, 1.0 - x, 0.5, 0.5, x, x].map(sum).to_vec();
            film.insert(PassNode::of_pass(first, Tally { samples: 1, observations: 1 }, pixels, 6));
        }
        let variances: Vec<f64> = film.block_variances_of_mean().map(|variance| variance.g).collect();
        assert_eq!(variances.len(), 2);
        assert!(variances[0] < 1e-30, "{variances:?}");
        assert_relative_eq!(variances[1], film.variance_of_mean(4, 0).g, max_relative = 1e-13);
    }

    /// A last pass cut short is joined with the one before it, and weighs by its samples.
    #[test]
    fn a_short_last_pass_weighs_less() {
        let node = |first, samples: u32, mean: f64| {
            let tally = Tally { samples: samples.into(), observations: 1 };
            let sum = Rgb::splat(mean * f64::from(samples));
            PassNode::of_pass(first, tally, vec![Moments { sum, spread: Rgb::BLACK }], 1)
        };
        let mut film = Film::new(1, 0..1, PathReuse::Off);
        film.insert(node(0, 16, 1.0));
        film.insert(node(1, 4, 2.0));
        assert_eq!((film.nodes.len(), film.samples()), (1, 20));
        assert_relative_eq!(film.mean(0, 0).g, 1.2, max_relative = 1e-15);
        // Squared deviations 16 x 0.2^2 and 4 x 0.8^2, over one degree of freedom and 20 samples.
        assert_relative_eq!(film.variance_of_mean(0, 0).g, 0.16, max_relative = 1e-14);
    }

    /// A row of pixels of which the second alone varied: a variance of the mean of 1 is a spread of 240.
    #[test]
    fn a_pixel_that_never_varied_is_not_taken_for_exact() {
        let mut film = Film::new(5, 0..1, PathReuse::Off);
        let pixel = |spread| Moments { sum: Rgb::WHITE, spread: Rgb::splat(spread) };
        let pixels = [0.0, 240.0, 0.0, 0.0, 0.0].map(pixel).to_vec();
        film.insert(PassNode::of_pass(0, Tally { samples: 16, observations: 16 }, pixels, 5));
        let margins: Vec<Rgb> = film.margins_95().collect();
        let expected = [0.5, 0.0, 1.0 / 3.0, 0.2, 0.2].map(|variance: f64| 1.4 * variance.sqrt());
        for x in [0, 2, 3, 4] {
            assert_relative_eq!(margins[x].b, expected[x], max_relative = 1e-12);
        }
        assert!((0..5).map(|x| film.margin_95(x, 0)).eq(margins), "one at a time");
    }

    #[test]
    fn an_empty_film_is_black_and_knows_nothing() {
        let film = Film::new(2, 0..1, PathReuse::Off);
        assert_eq!((film.mean(1, 0), film.samples()), (Rgb::BLACK, 0));
        assert_eq!(film.variance_of_mean(0, 0).r, f64::INFINITY);
        assert_eq!(film.margin_95(0, 0).r, f64::INFINITY);
    }

    #[test]
    fn what_does_not_fit_is_refused_and_nothing_changes() {
        let (mut a, before) = (film(0..6), film(0..6));
        assert_eq!(a.merge(film(5..8)), Err(CheckpointError::Overlap { pass: 5 }));
        assert_eq!(a.merge(Film::new(1, 0..2, PathReuse::Off)), Err(CheckpointError::Mismatch("size")));
        assert_eq!(a, before);
        a.merge(film(9..11)).unwrap();
        assert_eq!(a.passes(), [0..6, 9..11]);
    }
}
