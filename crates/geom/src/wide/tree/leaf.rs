//! Leaf blocks: up to eight triangles each, as rows of coordinates.

use super::normalize::NormalizedSpace;
use crate::wide::simd::{LANES, Rows};
use crate::{Triangle, Triangles};
use arrayvec::ArrayVec;

/// What a vector read at the last row may see beyond the end.
const PADDING: usize = Rows::COUNT * LANES + LANES;

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
        self.words.resize(start + Rows::COUNT * count, 0.0);
        let rows = &mut self.words[start..];
        // All are read at once, so that the reads wait for memory together.
        let block: ArrayVec<Triangle, LANES> = indices.iter().map(|&index| *triangles.get(index)).collect();
        for (lane, triangle) in block.iter().enumerate() {
            for (vertex, &position) in triangle.vertices.iter().enumerate() {
                for (axis, x) in space.position(position).to_array().into_iter().enumerate() {
                    rows[(3 * axis + vertex) * count + lane] = x;
                }
            }
            rows[(Rows::COUNT - 1) * count + lane] = Rows::word_of(indices[lane]);
        }
        (start / Rows::COUNT) as u32
    }

    /// Pads the end, so that vectors loaded from the last row stay within bounds, and frees what is not used.
    pub(crate) fn finish(&mut self) {
        self.words.extend([0.0; PADDING]);
        self.words.shrink_to_fit();
    }

    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&*self.words)
    }

    /// The words of all blocks: [`Rows::COUNT`] for each reference.
    #[inline(always)]
    pub(crate) fn words(&self) -> &[f32] {
        &self.words
    }

    /// The block's rows.
    #[inline(always)]
    pub(crate) fn rows(&self, first: usize, count: usize) -> Rows<'_> {
        Rows::new(&self.words[Rows::COUNT * first..], count)
    }
}
