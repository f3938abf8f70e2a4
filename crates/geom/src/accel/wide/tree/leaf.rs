//! Leaf blocks: up to eight triangles each, as rows of coordinates. The tree builder writes them, traversal reads them.

use super::normalize::NormalizedSpace;
use crate::accel::wide::simd::{LANES, Simd, SimdBase, SimdFloat};
use crate::{Triangle, Triangles};
use arrayvec::ArrayVec;
use fearless_simd::SimdMask;

/// What a vector read at the last row may see beyond the end.
const PADDING: usize = (LeafBlock::ROWS + 1) * LANES;

/// All blocks, one after another. A block of `n` triangles is ten rows of `n` words: each vertex's x, each one's y,
/// each one's z, and the indices. A vector read from a row holds what follows in its excess lanes.
#[derive(Clone, Debug, Default)]
pub(crate) struct LeafBlocks {
    words: Vec<f32>,
}

impl LeafBlocks {
    /// Adds a block and returns its place.
    pub(crate) fn push(
        &mut self,
        triangles: &Triangles,
        space: &NormalizedSpace,
        indices: impl Iterator<Item = u32>,
    ) -> u32 {
        let indices: ArrayVec<u32, LANES> = indices.collect();
        let (start, count) = (self.words.len(), indices.len());
        self.words.resize(start + LeafBlock::ROWS * count, 0.0);
        let rows = &mut self.words[start..];
        // All are read at once, so that the reads wait for memory together.
        let block: ArrayVec<Triangle, LANES> = indices.iter().map(|&index| *triangles.get(index)).collect();
        for (lane, triangle) in block.iter().enumerate() {
            for (vertex, &position) in triangle.vertices.iter().enumerate() {
                for (axis, x) in space.position(position).to_array().into_iter().enumerate() {
                    rows[(3 * axis + vertex) * count + lane] = x;
                }
            }
            rows[(LeafBlock::ROWS - 1) * count + lane] = f32::from_bits(indices[lane] | LeafBlock::NORMAL);
        }
        (start / LeafBlock::ROWS) as u32
    }

    /// Pads the end, so that vectors loaded from the last row stay within bounds, and frees what is not used.
    pub(crate) fn finish(&mut self) {
        self.words.extend([0.0; PADDING]);
        self.words.shrink_to_fit();
    }

    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&*self.words)
    }

    /// The words of all blocks: [`LeafBlock::ROWS`] for each reference.
    #[inline(always)]
    pub(crate) fn words(&self) -> &[f32] {
        &self.words
    }

    /// The block of `count` triangles whose first reference is `first`.
    #[inline(always)]
    pub(crate) fn get(&self, first: usize, count: usize) -> LeafBlock<'_> {
        assert!(count <= LANES);
        // `LeafBlocks::finish` adds as many words after the last block.
        let words =
            self.words[LeafBlock::ROWS * first..].first_chunk().expect("a vector follows the last row");
        LeafBlock { words, count }
    }
}

/// A block as traversal reads it. A vector may be loaded from the end of its last row.
#[derive(Clone, Copy)]
pub(crate) struct LeafBlock<'a> {
    words: &'a [f32; PADDING],
    count: usize,
}

impl<'a> LeafBlock<'a> {
    pub(crate) const ROWS: usize = 10;

    /// This bit makes an index, which has 30, the bits of an `f32` that is not denormal: the lanes beyond a row of
    /// coordinates may hold indices, and denormal numbers are slow to compute with. Those lanes are masked, so that infinities
    /// and NaNs, which the largest indices make, change no answer.
    const NORMAL: u32 = 1 << 30;

    /// The coordinates along `axis` of the three vertices.
    #[inline(always)]
    pub(crate) fn along(self, axis: usize) -> [&'a [f32; LANES]; 3] {
        assert!(axis < 3);
        let start = 3 * axis * self.count;
        [self.row(start), self.row(start + self.count), self.row(start + 2 * self.count)]
    }

    /// The index of the triangle in `lane`.
    #[inline(always)]
    pub(crate) fn index(self, lane: usize) -> u32 {
        assert!(lane < LANES);
        self.words[(Self::ROWS - 1) * self.count + lane].to_bits() & !Self::NORMAL
    }

    /// The indices of all triangles.
    #[inline(always)]
    pub(crate) fn indices(self) -> impl Iterator<Item = u32> + 'a {
        (0..self.count).map(
            #[inline(always)]
            move |lane| self.index(lane),
        )
    }

    /// The lanes that hold one of two triangles. Lanes beyond the block may be among them.
    ///
    /// Any index may be asked for: `index ^ NORMAL` is the word of the triangle of this index, and no triangle's word if
    /// there is none.
    #[inline(always)]
    pub(crate) fn lanes_of<S: Simd>(self, simd: S, [a, b]: [u32; 2]) -> u8 {
        let words = simd.load(self.row((Self::ROWS - 1) * self.count)).to_bits();
        (words.simd_eq(a ^ Self::NORMAL) | words.simd_eq(b ^ Self::NORMAL)).to_bitmask() as u8
    }

    #[inline(always)]
    fn row(self, start: usize) -> &'a [f32; LANES] {
        // At most 9 rows of 8 words precede a row, and `words` has 11.
        self.words[start..].first_chunk().expect("a vector follows the last row")
    }

    /// The lanes that hold a triangle.
    #[inline(always)]
    pub(crate) fn lanes(self) -> u8 {
        (0xff_u32 >> (LANES - self.count)) as u8
    }
}
