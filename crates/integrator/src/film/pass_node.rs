use super::dispersion::{Blocks, Halves};
use super::moments::{Moments, Tally};
use globillum_material::Rgb;
use std::fmt;
use std::ops::Range;

/// Which passes a [`PassNode`] sums, and what it rests on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PassNodeHeader {
    pub(crate) first: u32,
    pub(crate) passes: u32,
    pub(crate) tally: Tally,
}

impl PassNodeHeader {
    pub(crate) fn range(&self) -> Range<u64> {
        let first = u64::from(self.first);
        first..first + u64::from(self.passes)
    }

    /// Whether a node may have this place.
    pub(crate) fn is_node(&self) -> bool {
        let Self { first, passes, .. } = *self;
        passes.is_power_of_two() && first.is_multiple_of(passes) && first.checked_add(passes).is_some()
    }

    /// Whether `self` and then `next` are the halves of a larger node.
    pub(crate) fn is_sibling(&self, next: &Self) -> bool {
        self.passes == next.passes
            && self.range().end == next.range().start
            && self.range().start.is_multiple_of(2 * u64::from(self.passes))
    }

    /// The samples that passes of `pass_samples` lack, fewer than a pass; `None` if they cannot be those of a
    /// render.
    pub(crate) fn lacks(&self, pass_samples: u32) -> Option<u64> {
        let full = u64::from(self.passes) * u64::from(pass_samples);
        full.checked_sub(self.tally.samples).filter(|&lacking| lacking < u64::from(pass_samples))
    }

    /// With the other half.
    pub(crate) fn joined(self, next: Self) -> Self {
        Self { passes: 2 * self.passes, tally: self.tally.joined(next.tally), ..self }
    }
}

/// The sums of `2^k` consecutive passes for every pixel of some rows.
///
/// A node of `n` passes starts at a multiple of `n`, and two halves of a larger node are joined at once.
/// Nodes are thus those of a fixed binary tree over all passes: the sum has the same bits in whatever order
/// the passes are added, and its rounding error grows with the logarithm of their number.
#[derive(Clone, PartialEq)]
pub(crate) struct PassNode {
    pub(crate) header: PassNodeHeader,
    pub(crate) pixels: Vec<Moments>,
    /// Squared deviations of the observations of each block of 4 x 4 pixels, which are means over its pixels.
    pub(crate) blocks: Vec<Rgb>,
    /// How its halves differ, for each row of tiles.
    pub(crate) halves: Vec<Halves>,
}

impl PassNode {
    /// A node of one pass, of pixels in rows of this width, the means of whose blocks have no spread.
    pub(crate) fn of_pass(first: u32, tally: Tally, pixels: Vec<Moments>, width: u32) -> Self {
        let blocks = vec![Rgb::BLACK; Blocks::of_means(width).count(pixels.len())];
        let halves = vec![Halves::default(); Blocks::of_means(width).tile_rows(&pixels).len()];
        Self { header: PassNodeHeader { first, passes: 1, tally }, pixels, blocks, halves }
    }

    /// Takes in the other half. The errors of `independent` blocks do not depend on each other's.
    pub(crate) fn join(&mut self, next: &Self, independent: &Blocks) {
        let tallies = [self.header.tally, next.header.tally];
        let rows = independent.tile_rows(&self.pixels).zip(independent.tile_rows(&next.pixels));
        self.halves = rows.map(|(a, b)| Halves::between([a, b], tallies, independent)).collect();
        let samples = tallies.map(|tally| tally.samples);
        let blocks = Blocks::of_means(independent.width).all(self.pixels.len());
        for (block, (own, &other)) in blocks.zip(self.blocks.iter_mut().zip(&next.blocks)) {
            let sums = block_sums([&self.pixels, &next.pixels], block);
            let [a, b] = [(sums[0], *own), (sums[1], other)].map(|(sum, spread)| Moments { sum, spread });
            *own = a.joined(samples[0], &b, samples[1]).spread;
        }
        let [n, m] = samples;
        for (own, other) in self.pixels.iter_mut().zip(&next.pixels) {
            *own = own.joined(n, other, m);
        }
        self.header = self.header.joined(next.header);
    }
}

/// The mean over a block's pixels of the sums of their samples, in each of two sets.
fn block_sums(sets: [&[Moments]; 2], block: impl Iterator<Item = usize>) -> [Rgb; 2] {
    let (mut sums, mut count) = ([Rgb::BLACK; 2], 0.0);
    for at in block {
        for (sum, pixels) in sums.iter_mut().zip(sets) {
            *sum += pixels[at].sum;
        }
        count += 1.0;
    }
    sums.map(|sum| sum / count)
}

impl AsRef<PassNodeHeader> for PassNode {
    fn as_ref(&self) -> &PassNodeHeader {
        &self.header
    }
}

impl AsRef<PassNodeHeader> for PassNodeHeader {
    fn as_ref(&self) -> &Self {
        self
    }
}

/// The passes of `nodes`, as ranges in ascending order that neither meet nor overlap.
pub(crate) fn passes_of<N: AsRef<PassNodeHeader>>(nodes: &[N]) -> Vec<Range<u32>> {
    let mut ranges: Vec<Range<u32>> = Vec::new();
    for node in nodes {
        let &PassNodeHeader { first, passes, .. } = node.as_ref();
        match ranges.last_mut() {
            Some(last) if last.end == first => last.end += passes,
            _ => ranges.push(first..first + passes),
        }
    }
    ranges
}

/// Adds a node of passes that are not in `nodes` yet, and joins what makes up a larger node.
pub(crate) fn insert<N: AsRef<PassNodeHeader>>(
    nodes: &mut Vec<N>,
    node: N,
    mut join: impl FnMut(&mut N, &N),
) {
    let mut at = nodes.partition_point(|other| other.as_ref().first < node.as_ref().first);
    nodes.insert(at, node);
    loop {
        let pairs_with =
            |i: usize| nodes.get(i + 1).is_some_and(|next| nodes[i].as_ref().is_sibling(next.as_ref()));
        at = match at {
            _ if pairs_with(at) => at,
            1.. if pairs_with(at - 1) => at - 1,
            _ => break,
        };
        let next = nodes.remove(at + 1);
        join(&mut nodes[at], &next);
    }
}

impl fmt::Debug for PassNode {
    /// Without the pixels, of which there may be millions.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("PassNode")
            .field("passes", &self.header.range())
            .field("tally", &self.header.tally)
            .finish_non_exhaustive()
    }
}
