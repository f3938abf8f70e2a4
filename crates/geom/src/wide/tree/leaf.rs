//! Leaf blocks: up to eight triangles each, as rows of coordinates.

use super::normalize::NormalizedSpace;
use crate::wide::simd::{LANES, Rows};
use crate::{Triangle, Triangles};
use arrayvec::ArrayVec;
use prefetch_index::prefetch_index;

/// What a vector read at the last row may see beyond the end.
const PADDING: usize = Rows::COUNT * LANES + LANES;

/// All blocks, one after another. A block of `n` triangles is nine rows of `n` coordinates: each
/// vertex's x, each one's y, each one's z. A vector read from a row holds what follows in its
/// excess lanes. Indices are stored apart, since as coordinates they would be denormal numbers, which are
/// slow to compute with.
#[derive(Clone, Debug, Default)]
pub(crate) struct LeafBlocks {
    coordinates: Vec<f32>,
    indices: Vec<u32>,
}

impl LeafBlocks {
    /// Adds a block and returns its place.
    pub(crate) fn push(
        &mut self,
        triangles: &Triangles,
        space: &NormalizedSpace,
        indices: impl Iterator<Item = u32>,
    ) -> u32 {
        let first = self.indices.len();
        self.indices.extend(indices);
        let (indices, start) = (&self.indices[first..], self.coordinates.len());
        let count = indices.len();
        self.coordinates.resize(start + Rows::COUNT * count, 0.0);
        let rows = &mut self.coordinates[start..];
        // All are read at once, so that the reads wait for memory together.
        let block: ArrayVec<Triangle, LANES> = indices.iter().map(|&index| *triangles.get(index)).collect();
        for (lane, triangle) in block.iter().enumerate() {
            for (vertex, &position) in triangle.vertices.iter().enumerate() {
                for (axis, x) in space.position(position).to_array().into_iter().enumerate() {
                    rows[(3 * axis + vertex) * count + lane] = x;
                }
            }
        }
        first as u32
    }

    /// Ends the last block.
    pub(crate) fn finish(&mut self) {
        self.coordinates.extend([0.0; PADDING]);
        self.coordinates.shrink_to_fit();
        self.indices.shrink_to_fit();
    }

    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&*self.coordinates) + size_of_val(&*self.indices)
    }

    /// The coordinates of all blocks: [`Rows::COUNT`] for each reference.
    #[inline(always)]
    pub(crate) fn coordinates(&self) -> &[f32] {
        &self.coordinates
    }

    /// The block's rows.
    #[inline(always)]
    pub(crate) fn rows(&self, first: usize, count: usize) -> Rows<'_> {
        Rows::new(&self.coordinates[Rows::COUNT * first..], count)
    }

    /// The triangles of the block.
    pub(crate) fn indices(&self, first: usize, count: usize) -> &[u32] {
        &self.indices[first..][..count]
    }

    /// Asks for the cache line of a block's first index.
    #[inline(always)]
    pub(crate) fn prefetch_indices(&self, first: usize) {
        prefetch_index(&self.indices, first);
    }

    /// The index of a triangle of the block.
    #[inline(always)]
    pub(crate) fn index(&self, first: usize, lane: usize) -> u32 {
        self.indices[first + lane]
    }
}
