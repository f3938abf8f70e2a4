use super::dispersion::Blocks;
use super::moments::mean;
use super::{Film, margin};
use crate::PathReuse;
use crate::pixel_rect::{BLOCK_SIDE, PixelRect};
use globillum_material::Rgb;
use std::ops::Range;

/// Mean radiance of a picture's pixels with its standard error, row by row from the top: what a picture file can
/// hold of a [`Film`], in memory. Of a sensor that measures irradiance, radiance means irradiance.
///
/// All lists but [`block_errors`](Estimates::block_errors) have one entry for each pixel.
///
/// ```
/// use globillum_integrator::{Estimates, Film};
///
/// /// How many pixels are known to one percent.
/// fn good(film: &Film) -> usize {
///     let estimates = Estimates::of(film);
///     let pixels = estimates.means.iter().zip(&estimates.standard_errors);
///     pixels.filter(|(mean, error)| error.max_component() <= 0.01 * mean.mean()).count()
/// }
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Estimates {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Column and row of the upper left pixel in the whole picture; not 0 in a crop or a strip of it.
    pub origin: [u32; 2],
    /// Mean radiance, component by component.
    pub means: Vec<Rgb>,
    /// Standard errors of the means ([`Film::variance_of_mean`]); infinite if unknown.
    pub standard_errors: Vec<Rgb>,
    /// Standard errors of the means over blocks of 4 x 4 pixels, row by row from the upper left corner
    /// ([`Film::block_variances_of_mean`]): one entry for each block. Infinite if unknown.
    pub block_errors: Vec<Rgb>,
    /// Samples; 0 if unknown.
    pub samples: Vec<u32>,
    /// Independent observations on which the standard error rests ([`Film::observations`]); 0 if unknown.
    pub observations: Vec<u32>,
    /// Whether errors of pixels within a tile of 16 x 16 depend on each other ([`Film::path_reuse`]).
    pub path_reuse: PathReuse,
}

impl Estimates {
    /// A picture of which nothing is known: black, with infinite errors.
    pub fn unknown(width: u32, height: u32) -> Self {
        let pixels = width as usize * height as usize;
        Self {
            width,
            height,
            origin: [0; 2],
            means: vec![Rgb::BLACK; pixels],
            standard_errors: vec![Rgb::splat(f64::INFINITY); pixels],
            block_errors: vec![Rgb::splat(f64::INFINITY); Blocks::of_means(width).count(pixels)],
            samples: vec![0; pixels],
            observations: vec![0; pixels],
            path_reuse: PathReuse::Off,
        }
    }

    /// The estimates that `film` holds. A strip begins at its first row ([`Film::rows`]). The film of a
    /// [crop](crate::Render::crop) does not know its place: set [`Estimates::origin`].
    pub fn of(film: &Film) -> Self {
        let mut estimates = Self::unknown(film.width(), film.height());
        estimates.origin[1] = film.rows().start;
        estimates.set_from(0, film);
        estimates
    }

    /// Sets the rows that `film`, a strip of the same picture, holds ([`Film::rows`]).
    ///
    /// # Panics
    /// If the film has another width, or rows below the picture.
    pub fn set_rows(&mut self, film: &Film) {
        self.set_from(film.rows().start, film);
    }

    fn set_from(&mut self, first_row: u32, film: &Film) {
        assert_eq!(self.width, film.width(), "the strip has the picture's width");
        let first = first_row as usize * self.width as usize;
        let pixels: Range<usize> = first..first + film.pixel_count();
        let saturated = |count: u64| u32::try_from(count).unwrap_or(u32::MAX);
        self.path_reuse = film.path_reuse();
        self.samples[pixels.clone()].fill(saturated(film.samples()));
        self.observations[pixels.clone()].fill(saturated(film.observations()));
        let errors = self.standard_errors[pixels.clone()].iter_mut();
        for (error, variance) in errors.zip(film.variances_of_mean()) {
            *error = variance.map(f64::sqrt);
        }
        let blocks = Blocks::of_means(self.width);
        let first = blocks.count(pixels.start);
        for (error, variance) in self.block_errors[first..].iter_mut().zip(film.block_variances_of_mean()) {
            *error = variance.map(f64::sqrt);
        }
        for (mean, known) in self.means[pixels].iter_mut().zip(film.means()) {
            *mean = known;
        }
    }

    /// The pixels of these columns and rows alone. Errors of blocks that are not blocks of the whole picture are unknown.
    ///
    /// # Panics
    /// If a range begins after its end, or they are not all within the picture.
    #[must_use]
    pub fn crop(&self, columns: Range<u32>, rows: Range<u32>) -> Self {
        assert_crop([&columns, &rows], [self.width, self.height]);
        let within = (self.width, columns.clone(), rows.clone());
        Self {
            width: columns.end - columns.start,
            height: rows.end - rows.start,
            origin: [self.origin[0] + columns.start, self.origin[1] + rows.start],
            means: crop(&self.means, &within),
            standard_errors: crop(&self.standard_errors, &within),
            samples: crop(&self.samples, &within),
            observations: crop(&self.observations, &within),
            path_reuse: self.path_reuse,
            ..Self::unknown(columns.end - columns.start, rows.end - rows.start)
        }
        .with_blocks_of(self, columns, rows)
    }

    /// With the errors of blocks of `whole`, whose columns and rows these are, if they have the same blocks.
    fn with_blocks_of(mut self, whole: &Self, columns: Range<u32>, rows: Range<u32>) -> Self {
        let is_end = |at: u32, size: u32| at.is_multiple_of(BLOCK_SIDE) || at == size;
        let are_blocks =
            |range: &Range<u32>, size: u32| range.start.is_multiple_of(BLOCK_SIDE) && is_end(range.end, size);
        if are_blocks(&columns, whole.width) && are_blocks(&rows, whole.height) {
            let blocks = |range: Range<u32>| range.start / BLOCK_SIDE..range.end.div_ceil(BLOCK_SIDE);
            let within = (whole.width.div_ceil(BLOCK_SIDE), blocks(columns), blocks(rows));
            self.block_errors = crop(&whole.block_errors, &within);
        }
        self
    }

    /// Whether every list has the length that it says it has.
    pub(crate) fn are_whole(&self) -> bool {
        let pixels = self.width as usize * self.height as usize;
        let lengths =
            [self.means.len(), self.standard_errors.len(), self.samples.len(), self.observations.len()];
        lengths == [pixels; 4] && self.block_errors.len() == Blocks::of_means(self.width).count(pixels)
    }

    /// Whether any pixel's standard error is known.
    pub fn has_errors(&self) -> bool {
        self.standard_errors.iter().any(|error| error.is_finite())
    }

    /// Half the width of the 95 % confidence interval of every pixel, as [`Film::margin_95`] has it; infinite if
    /// unknown.
    ///
    /// # Panics
    /// If a list has another length than [`Estimates`] says.
    pub fn margins_95(&self) -> Vec<Rgb> {
        assert!(self.are_whole(), "every list has one entry for each pixel or block");
        let variances: Vec<Rgb> = self.standard_errors.iter().map(|&error| error * error).collect();
        let picture = mean(variances.iter().copied());
        let whole = PixelRect { x: 0, y: 0, width: self.width, height: self.height };
        let margin = |(at, pixel): (usize, (u32, u32))| {
            let around = PixelRect::pixels_near(pixel, self.width, self.height);
            let around = around.map(|(x, y)| variances[whole.index(x, y)]);
            margin::margin_95(self.observations[at].into(), variances[at], around, || picture)
        };
        whole.pixels().enumerate().map(margin).collect()
    }
}

/// Panics unless these columns and rows lie within a picture of this size.
pub(crate) fn assert_crop(ranges: [&Range<u32>; 2], size: [u32; 2]) {
    let are_within = ranges.iter().zip(size).all(|(range, end)| range.start <= range.end && range.end <= end);
    assert!(are_within, "a crop lies within the picture");
}

/// The pixels of these columns and rows, of a picture of this width.
pub(crate) fn crop<T: Copy>(pixels: &[T], (width, columns, rows): &(u32, Range<u32>, Range<u32>)) -> Vec<T> {
    let line = |y: u32| {
        let [left, right] = [columns.start, columns.end].map(|x| y as usize * *width as usize + x as usize);
        &pixels[left..right]
    };
    rows.clone().flat_map(line).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::super::{Moments, PassNode, Tally};
    use super::*;
    use approx::assert_relative_eq;

    /// A strip whose pixels have sums of 0, 1, 2, ... and so large spreads too.
    fn strip(rows: Range<u32>) -> Film {
        let mut film = Film::new(3, rows, PathReuse::Tiles);
        let pixel = |i: usize| Moments { sum: Rgb::splat(i as f64), spread: Rgb::splat(i as f64) };
        let pixels = (0..film.pixel_count()).map(pixel).collect();
        film.insert(PassNode::of_pass(0, Tally { samples: 8, observations: 4 }, pixels, 3));
        film
    }

    #[test]
    fn estimates_are_those_of_the_film() {
        let film = strip(0..2);
        let estimates = Estimates::of(&film);
        assert!(film.means().eq(estimates.means.iter().copied()));
        assert_eq!((estimates.samples[5], estimates.observations[0]), (8, 4));
        assert_eq!(estimates.path_reuse, PathReuse::Tiles);
        let margins = estimates.margins_95();
        assert_eq!(margins.len(), 6);
        for (margin, expected) in margins.iter().zip(film.margins_95()) {
            assert_relative_eq!(margin.g, expected.g, max_relative = 1e-14);
        }
    }

    #[test]
    fn a_strip_knows_its_place() {
        let estimates = Estimates::of(&strip(16..48));
        assert_eq!((estimates.origin, estimates.height), ([0, 16], 32));
        assert_eq!(estimates.crop(1..2, 4..8).origin, [1, 20]);
    }

    #[test]
    fn strips_fill_their_rows_and_nothing_is_known_of_others() {
        let mut estimates = Estimates::unknown(3, 48);
        assert!(!estimates.has_errors());
        estimates.set_rows(&strip(16..32));
        assert!(estimates.has_errors());
        assert_eq!(estimates.means[16 * 3 + 2], Rgb::splat(2.0 / 8.0));
        for at in [0, 16 * 3 - 1, 32 * 3] {
            assert_eq!((estimates.means[at], estimates.samples[at]), (Rgb::BLACK, 0));
            assert_eq!(estimates.standard_errors[at].r, f64::INFINITY);
        }
    }
}
