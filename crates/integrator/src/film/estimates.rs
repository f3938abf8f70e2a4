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
    /// Width and height of the whole picture. They differ from `width` and `height` in a crop or a strip.
    pub full_size: [u32; 2],
    /// Column and row of the upper left pixel in the whole picture.
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
    /// Pixels along each side of the blocks of [`Estimates::block_errors`]: 4.
    pub const BLOCK_SIDE: u32 = BLOCK_SIDE;

    /// A picture of which nothing is known: black, with infinite errors.
    pub fn unknown(width: u32, height: u32) -> Self {
        let pixels = width as usize * height as usize;
        Self {
            width,
            height,
            full_size: [width, height],
            origin: [0; 2],
            means: vec![Rgb::BLACK; pixels],
            standard_errors: vec![Rgb::splat(f64::INFINITY); pixels],
            block_errors: vec![Rgb::splat(f64::INFINITY); Blocks::of_means(width).count(pixels)],
            samples: vec![0; pixels],
            observations: vec![0; pixels],
            path_reuse: PathReuse::Off,
        }
    }

    /// The estimates that `film` holds.
    pub fn of(film: &Film) -> Self {
        let saturated = |count: u64| u32::try_from(count).unwrap_or(u32::MAX);
        let errors = |variance: Rgb| variance.map(f64::sqrt);
        let pixels = film.pixel_count();
        Self {
            width: film.width(),
            height: film.height(),
            full_size: film.full_size(),
            origin: film.origin(),
            means: film.means().collect(),
            standard_errors: film.variances_of_mean().map(errors).collect(),
            block_errors: film.block_variances_of_mean().map(errors).collect(),
            samples: vec![saturated(film.samples()); pixels],
            observations: vec![saturated(film.observations()); pixels],
            path_reuse: film.path_reuse(),
        }
    }

    /// Whether these are of a part of the picture only.
    pub fn is_crop(&self) -> bool {
        [self.width, self.height] != self.full_size
    }

    /// Replaces the pixels that `part`, a crop or a strip of the same picture, holds. Unless it begins and ends with blocks
    /// of this picture, the errors of all blocks that it touches are unknown from then on.
    ///
    /// ```
    /// use globillum_integrator::{Estimates, Render};
    /// # use globillum_integrator::{Model, PinholeCamera, RenderError, Scene, Settings, render};
    /// # use glam::DVec3;
    /// # use globillum_geom::KdTree;
    /// # let scene = Scene::build(Model::default(), KdTree::build)?;
    /// # let camera = PinholeCamera::look_at(DVec3::ZERO, -DVec3::Z, DVec3::Y, 0.7)?;
    /// # let settings = Settings::new(48, 32, 16);
    /// let mut whole = Estimates::unknown(48, 32);
    /// for columns in [0..16, 16..48] {
    ///     let part = Render::new(&scene, &camera, &settings).crop(columns, 0..32).run()?;
    ///     whole.paste(&Estimates::of(&part.film));
    /// }
    /// assert_eq!(whole, Estimates::of(&render(&scene, &camera, &settings)?.film));
    /// # Ok::<(), RenderError>(())
    /// ```
    ///
    /// # Panics
    /// If `part` is of a picture of another size or holds pixels that these estimates do not have, or if a list has another
    /// length than [`Estimates`] says.
    pub fn paste(&mut self, part: &Self) {
        assert_eq!(self.full_size, part.full_size, "parts are of pictures of one size");
        assert!(self.are_whole() && part.are_whole(), "every list has one entry for each pixel or block");
        let [columns, rows] = [(0, part.width), (1, part.height)].map(|(axis, length)| {
            let start = part.origin[axis].checked_sub(self.origin[axis]).unwrap_or(u32::MAX);
            start..start.saturating_add(length)
        });
        let rect = PixelRect::of_ranges(columns, rows, [self.width, self.height]);
        rect.paste(&part.means, &mut self.means, self.width);
        rect.paste(&part.standard_errors, &mut self.standard_errors, self.width);
        rect.paste(&part.samples, &mut self.samples, self.width);
        rect.paste(&part.observations, &mut self.observations, self.width);
        let (blocks, columns) = (rect.touched_blocks(), self.width.div_ceil(BLOCK_SIDE));
        if self.has_blocks_of(&rect) {
            blocks.paste(&part.block_errors, &mut self.block_errors, columns);
        } else {
            let unknown = vec![Rgb::splat(f64::INFINITY); blocks.pixel_count()];
            blocks.paste(&unknown, &mut self.block_errors, columns);
        }
        if part.path_reuse != PathReuse::Off {
            self.path_reuse = part.path_reuse;
        }
    }

    /// The pixels of these columns and rows alone. Errors of blocks that are not blocks of the whole picture are unknown.
    ///
    /// # Panics
    /// If a range begins after its end, or they are not all within the picture.
    #[must_use]
    pub fn crop(&self, columns: Range<u32>, rows: Range<u32>) -> Self {
        let rect = PixelRect::of_ranges(columns, rows, [self.width, self.height]);
        let mut crop = Self {
            full_size: self.full_size,
            origin: [self.origin[0] + rect.x, self.origin[1] + rect.y],
            means: rect.cut(&self.means, self.width),
            standard_errors: rect.cut(&self.standard_errors, self.width),
            samples: rect.cut(&self.samples, self.width),
            observations: rect.cut(&self.observations, self.width),
            path_reuse: self.path_reuse,
            ..Self::unknown(rect.width, rect.height)
        };
        if self.has_blocks_of(&rect) {
            let columns = self.width.div_ceil(BLOCK_SIDE);
            crop.block_errors = rect.touched_blocks().cut(&self.block_errors, columns);
        }
        crop
    }

    /// Whether the blocks of a crop are blocks of this picture.
    fn has_blocks_of(&self, crop: &PixelRect) -> bool {
        let is_end = |at: u32, size: u32| at.is_multiple_of(BLOCK_SIDE) || at == size;
        let are_blocks = |start: u32, length: u32, size: u32| {
            start.is_multiple_of(BLOCK_SIDE) && is_end(start + length, size)
        };
        are_blocks(crop.x, crop.width, self.width) && are_blocks(crop.y, crop.height, self.height)
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
        let whole = PixelRect::whole([self.width, self.height]);
        let margin = |(at, pixel): (usize, (u32, u32))| {
            let around = PixelRect::pixels_near(pixel, [self.width, self.height]);
            let around = around.map(|(x, y)| variances[whole.index(x, y)]);
            margin::margin_95(self.observations[at].into(), variances[at], around, || picture)
        };
        whole.pixels().enumerate().map(margin).collect()
    }
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
    fn parts_know_their_place() {
        let estimates = Estimates::of(&strip(16..48).within([9, 80], [5, 30]));
        assert_eq!((estimates.full_size, estimates.origin, estimates.height), ([9, 80], [5, 46], 32));
        let crop = estimates.crop(1..2, 4..8);
        assert_eq!((crop.full_size, crop.origin), ([9, 80], [6, 50]));
        assert!(estimates.is_crop() && crop.is_crop() && !Estimates::of(&strip(0..16)).is_crop());
    }

    #[test]
    fn parts_replace_their_pixels_and_nothing_is_known_of_others() {
        let mut estimates = Estimates::unknown(3, 48);
        assert!(!estimates.has_errors());
        estimates.paste(&Estimates::of(&strip(16..32).within([3, 48], [0; 2])));
        assert!(estimates.has_errors());
        assert_eq!(estimates.means[16 * 3 + 2], Rgb::splat(2.0 / 8.0));
        for at in [0, 16 * 3 - 1, 32 * 3] {
            assert_eq!((estimates.means[at], estimates.samples[at]), (Rgb::BLACK, 0));
            assert_eq!(estimates.standard_errors[at].r, f64::INFINITY);
        }
    }

    /// Crops of a crop, put together again in another order.
    #[test]
    fn what_is_cut_apart_is_put_together() {
        let whole = Estimates::of(&strip(16..48).within([9, 80], [5, 30]));
        let mut pasted = Estimates { path_reuse: whole.path_reuse, ..whole.clone() };
        pasted.means.fill(Rgb::BLACK);
        pasted.standard_errors.fill(Rgb::BLACK);
        pasted.block_errors.fill(Rgb::BLACK);
        pasted.samples.fill(0);
        pasted.observations.fill(0);
        for rows in [24..32, 0..4, 4..24] {
            pasted.paste(&whole.crop(0..3, rows));
        }
        assert_eq!(pasted, whole);
        pasted.paste(&whole.crop(1..1, 5..8));
        assert_eq!(pasted, whole, "nothing is pasted");
        // A block and part of the next.
        pasted.paste(&whole.crop(0..3, 4..10));
        assert_eq!(pasted.means, whole.means);
        let unknown: Vec<usize> = (0..8).filter(|&at| pasted.block_errors[at].r.is_infinite()).collect();
        assert_eq!(unknown, [1, 2]);
    }

    #[test]
    fn parts_of_other_pictures_are_refused() {
        let whole = Estimates::of(&strip(0..32));
        let refuses = |part: Estimates| {
            let paste = std::panic::AssertUnwindSafe(|| whole.clone().paste(&part));
            std::panic::catch_unwind(paste).is_err()
        };
        assert!(!refuses(whole.clone()));
        assert!(refuses(Estimates { full_size: [3, 33], ..whole.clone() }));
        assert!(refuses(Estimates { origin: [0, 1], ..whole.clone() }));
        assert!(refuses(Estimates { origin: [u32::MAX, 0], ..whole.clone() }));
        assert!(refuses(Estimates { means: Vec::new(), ..whole.clone() }));
        let mut picture = Estimates { path_reuse: PathReuse::Tiles, ..Estimates::unknown(3, 32) };
        picture.paste(&Estimates { path_reuse: PathReuse::Off, ..whole.crop(0..3, 0..16) });
        assert_eq!(picture.path_reuse, PathReuse::Tiles, "errors of some pixels still depend on each other");
    }
}
