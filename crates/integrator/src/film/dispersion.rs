//! How certain a picture's variance is.

use super::moments::{Moments, Tally};
use crate::pixel_rect::{BLOCK_SIDE, PixelRect, SQUARE_SIDE};
use std::slice::Chunks;

/// The width of a film, and the side of blocks of pixels, by which it is divided from its upper left corner.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Blocks {
    pub(crate) width: u32,
    pub(crate) side: u32,
}

/// By how much estimates of a picture's variance differ: one picture's passes are divided in two halves, and
/// what they say is compared block by block.
///
/// Between the halves of one block there is no difference but chance, whatever its true variance, and blocks
/// are independent: the sum of the squared differences is that of the variances. Differences are relative
/// to the variance of the whole picture, so that the scale of its radiance plays no part.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Dispersion {
    /// Relative variance of an estimate of one degree of freedom.
    pub(crate) variance: f64,
    /// Degrees of freedom of `variance` (Satterthwaite 1946): by halves of the passes, 1 if one block decides, and about
    /// their number if all differ alike; among blocks, their number less one. 0 if nothing is known.
    pub(crate) dof: f64,
}

/// How the halves of a set of passes differ in a row of tiles. All 0 if a half has fewer than two
/// observations, or if no pixel varied.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Halves {
    /// The sum of squared deviations of both halves, all pixels together.
    pub(crate) spread: f64,
    /// The sum of squared differences of the blocks' variances, relative to the variance of the row.
    pub(crate) squared: f64,
    /// The sum of the squares of these.
    pub(crate) fourths: f64,
}

impl Halves {
    /// Of two sets of passes in one row of tiles.
    pub(crate) fn between([a, b]: [&[Moments]; 2], tallies: [Tally; 2], blocks: &Blocks) -> Self {
        if tallies.iter().any(|tally| tally.observations < 2) {
            return Self::default();
        }
        let [m, n] = tallies.map(|tally| (tally.observations - 1) as f64);
        let whole = a.iter().zip(b).map(|(a, b)| spread(a) + spread(b)).sum::<f64>();
        if whole == 0.0 {
            return Self::default();
        }
        let scale = whole / (m + n) * (1.0 / m + 1.0 / n).sqrt();
        let apart = |i: usize| spread(&a[i]) / m - spread(&b[i]) / n;
        let mut halves = Self { spread: whole, ..Self::default() };
        for block in blocks.all(a.len()) {
            let apart = block.map(apart).sum::<f64>() / scale;
            halves.squared += apart * apart;
            halves.fourths += apart.powi(4);
        }
        halves
    }

    /// Whether halves can differ like this.
    pub(crate) fn are_possible(&self) -> bool {
        [self.spread, self.squared, self.fourths].iter().all(|x| x.is_finite() && *x >= 0.0)
    }
}

impl Dispersion {
    /// Of all rows of tiles.
    pub(crate) fn between(rows: &[Halves]) -> Self {
        let whole = rows.iter().map(|row| row.spread).sum::<f64>();
        let (mut squared, mut fourths) = (0.0, 0.0);
        for row in rows {
            let share = row.spread / whole;
            squared += row.squared * share.powi(2);
            fourths += row.fourths * share.powi(4);
        }
        // Satterthwaite's `s^2 / q`, of the sums `s` of variances and `q` of their squares. Of normal differences, the
        // expected sum of fourth powers is `3 q`, and that of the squared sum of squares `s^2 + 2 q`.
        let dof = 3.0 * squared * squared / fourths - 2.0;
        if dof.is_finite() { Self { variance: squared, dof: dof.max(1.0) } } else { Self::default() }
    }

    /// Of one set of passes, by the spreads of the blocks themselves: too large, since some blocks are truly
    /// noisier. Unknown of one block.
    pub(crate) fn among(blocks: &[f64], observations: u64) -> Self {
        let (whole, count) = (blocks.iter().sum::<f64>(), blocks.len() as f64);
        if observations < 2 || count < 2.0 || whole == 0.0 {
            return Self::default();
        }
        let squared: f64 = blocks.iter().map(|block| (block / whole - 1.0 / count).powi(2)).sum();
        let variance = squared * count / (count - 1.0) * (observations - 1) as f64;
        Self { variance, dof: count - 1.0 }
    }
}

/// A pixel's squared deviations, the mean of the components.
fn spread(moments: &Moments) -> f64 {
    moments.spread.mean()
}

impl Blocks {
    /// The blocks whose means a film of this width knows.
    pub(crate) fn of_means(width: u32) -> Self {
        Self { width, side: BLOCK_SIDE }
    }

    /// How many there are of `pixels` pixels of whole rows.
    pub(crate) fn count(&self, pixels: usize) -> usize {
        let [width, side] = [self.width, self.side].map(|x| x as usize);
        if width == 0 { 0 } else { width.div_ceil(side) * (pixels / width).div_ceil(side) }
    }

    /// `pixels`, a row of tiles at a time.
    pub(crate) fn tile_rows<'a, T>(&self, pixels: &'a [T]) -> Chunks<'a, T> {
        pixels.chunks(self.width as usize * SQUARE_SIDE as usize)
    }

    /// Those of `blocks`, one for each block of a film, that are in a row of tiles.
    pub(crate) fn of_tile_row<'a, T>(&self, blocks: &'a [T], index: usize) -> &'a [T] {
        let count = self.width.div_ceil(self.side) as usize * (SQUARE_SIDE / self.side) as usize;
        &blocks[count * index..blocks.len().min(count * (index + 1))]
    }

    /// The spread of every block.
    pub(crate) fn spreads(&self, moments: &[Moments]) -> impl Iterator<Item = f64> {
        self.all(moments.len()).map(|block| block.map(|i| spread(&moments[i])).sum())
    }

    /// The pixels of every block, as places among `pixels` pixels of whole rows.
    pub(crate) fn all(self, pixels: usize) -> impl Iterator<Item = impl Iterator<Item = usize>> {
        let height = (pixels / self.width as usize) as u32;
        PixelRect::grid([self.width, height], [self.side; 2]).map(move |block| block.places(self.width))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use globillum_material::Rgb;

    const ROW: Blocks = Blocks { width: 4, side: 2 };

    type Half = (Vec<Moments>, Tally);

    /// A row of four pixels with `observations` observations each and these sums of squared deviations.
    fn half(observations: u64, spreads: [f64; 4]) -> Half {
        let pixels = spreads.map(|spread| Moments { sum: Rgb::WHITE, spread: Rgb::splat(spread) });
        (pixels.to_vec(), Tally { samples: observations, observations })
    }

    fn between(a: &Half, b: &Half) -> Dispersion {
        Dispersion::between(&[Halves::between([&a.0, &b.0], [a.1, b.1], &ROW)])
    }

    #[test]
    fn halves_are_compared_block_by_block() {
        let (a, b) = (half(3, [1.0, 3.0, 2.0, 2.0]), half(5, [4.0, 8.0, 1.0, 3.0]));
        let Dispersion { variance, dof } = between(&a, &b);
        // Variances of the blocks 2 and 2 beside 3 and 1; of all together 24 by 6 degrees of freedom.
        let unit = 1.0 / (16.0 * (0.5 + 0.25));
        assert_relative_eq!(variance, (1.0 + 1.0) * unit, max_relative = 1e-14);
        assert_relative_eq!(dof, 4.0, max_relative = 1e-14);
    }

    #[test]
    fn one_block_has_one_degree_of_freedom() {
        for spreads in [[4.0, 8.0, 1.0, 1.0], [4.0, 8.0, 1.1, 1.2]] {
            let Dispersion { dof, .. } = between(&half(3, [1.0, 3.0, 1.0, 1.0]), &half(3, spreads));
            assert!((1.0..1.2).contains(&dof), "{dof}");
        }
    }

    #[test]
    fn nothing_is_known_of_what_does_not_vary_or_was_observed_once() {
        let (once, still, good) = (half(1, [0.0; 4]), half(4, [0.0; 4]), half(4, [1.0, 2.0, 3.0, 4.0]));
        for (a, b) in [(&once, &good), (&good, &once), (&still, &still)] {
            assert_eq!(between(a, b), Dispersion::default());
        }
        assert_eq!(Dispersion::among(&[1.0], 4), Dispersion::default());
    }

    #[test]
    fn blocks_by_themselves_disperse_by_their_variances() {
        let (pixels, tally) = half(4, [1.0, 2.0, 2.0, 3.0]);
        // Shares of 3/8 and 5/8: a variance of 1/32, and of their sum twice that, for 3 degrees of freedom.
        let spreads: Vec<f64> = ROW.spreads(&pixels).collect();
        let Dispersion { variance, dof } = Dispersion::among(&spreads, tally.observations);
        assert_relative_eq!(variance, 3.0 * 2.0 / 32.0, max_relative = 1e-14);
        assert_relative_eq!(dof, 1.0);
    }

    /// What rows of tiles say together is what they say as one.
    #[test]
    fn rows_of_tiles_add_up() {
        let (a, b) = (half(3, [1.0, 3.0, 2.0, 2.0]), half(5, [4.0, 8.0, 1.0, 3.0]));
        let pair = Blocks { width: 2, side: 2 };
        let rows =
            [0..2, 2..4].map(|part| Halves::between([&a.0[part.clone()], &b.0[part]], [a.1, b.1], &pair));
        let (whole, parts) = (between(&a, &b), Dispersion::between(&rows));
        assert_relative_eq!(parts.variance, whole.variance, max_relative = 1e-14);
        assert_relative_eq!(parts.dof, whole.dof, max_relative = 1e-14);
    }
}
