use super::dispersion::{Dispersion, Squares};
use super::moments::{Moments, Tally};
use std::fmt;
use std::ops::Range;

/// The sums of `2^k` consecutive passes for every pixel.
///
/// A block of `n` passes starts at a multiple of `n`, and two halves of a larger block are joined at once.
/// Blocks are thus nodes of a fixed binary tree over all passes: the sum has the same bits in whatever order
/// the passes are added, and its rounding error grows with the logarithm of their number.
#[derive(Clone, PartialEq)]
pub(crate) struct Block {
    pub(crate) first: u32,
    pub(crate) passes: u32,
    pub(crate) tally: Tally,
    pub(crate) pixels: Vec<Moments>,
    /// Between its halves; unknown of a single pass.
    pub(crate) dispersion: Dispersion,
}

impl Block {
    pub(crate) fn of_pass(first: u32, tally: Tally, pixels: Vec<Moments>) -> Self {
        Self { first, passes: 1, tally, pixels, dispersion: Dispersion::default() }
    }

    pub(crate) fn range(&self) -> Range<u64> {
        let first = u64::from(self.first);
        first..first + u64::from(self.passes)
    }

    /// Whether a block may have this place.
    pub(crate) fn is_node(first: u32, passes: u32) -> bool {
        passes.is_power_of_two() && first.is_multiple_of(passes) && first.checked_add(passes).is_some()
    }

    /// Whether `self` and then `next` are the halves of a larger block.
    pub(crate) fn is_sibling(&self, next: &Self) -> bool {
        self.passes == next.passes
            && self.range().end == next.range().start
            && self.range().start.is_multiple_of(2 * u64::from(self.passes))
    }

    /// Takes in the other half.
    pub(crate) fn join(&mut self, next: &Self, squares: Squares) {
        self.dispersion =
            Dispersion::between([&self.pixels, &next.pixels], [self.tally, next.tally], squares);
        let (n, m) = (self.tally.samples, next.tally.samples);
        for (own, other) in self.pixels.iter_mut().zip(&next.pixels) {
            *own = own.joined(n, other, m);
        }
        self.tally = self.tally.joined(next.tally);
        self.passes *= 2;
    }
}

impl fmt::Debug for Block {
    /// Without the pixels, of which there may be millions.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Block")
            .field("passes", &self.range())
            .field("tally", &self.tally)
            .finish_non_exhaustive()
    }
}
