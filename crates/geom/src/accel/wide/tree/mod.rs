//! The tree as traversal reads it: [nodes](node), [leaf blocks](leaf), of small trees [projected
//! triangles](projected_triangle), and the [space](normalize) that their coordinates are in.

pub(super) mod leaf;
pub(super) mod node;
pub(super) mod normalize;
pub(super) mod projected_triangle;

use crate::{Aabb, Triangles};
use leaf::{LeafBlock, LeafBlocks};
use node::{Child, Node};
use normalize::NormalizedSpace;
use prefetch_index::prefetch_index;
use projected_triangle::ProjectedTriangles;
use std::hint::select_unpredictable;

/// How many `f32` a cache line holds.
const WORDS_OF_A_LINE: usize = 16;

/// Most levels of nodes below a leaf of the k-d tree, or below the root of a tree that is built without one. Half of them
/// are enough to halve any number of triangles.
pub(super) const MAX_LEVELS: u32 = 60;

/// A tree of nodes with up to eight children; the first node is the root.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    /// All triangles of the scene.
    pub(super) triangles: Triangles,
    /// The bounds of those in this tree.
    pub(super) bounds: Aabb,
    pub(super) space: NormalizedSpace,
    pub(super) nodes: Vec<Node>,
    pub(super) leaves: LeafBlocks,
    pub(super) projected: ProjectedTriangles,
}

impl Tree {
    /// Bytes of memory held, without the triangles.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.nodes) + self.leaves.bytes() + self.projected.bytes()
    }

    /// Whether it has so few triangles that batches test all of them instead of its nodes.
    #[inline(always)]
    pub(super) fn tests_exhaustively(&self) -> bool {
        !self.projected.is_empty()
    }

    /// Makes traversals visit nodes whatever the number of triangles.
    #[cfg(feature = "conformance")]
    pub(super) fn always_visit_nodes(&mut self) {
        self.projected = ProjectedTriangles::default();
    }

    /// The leaf block that is this child.
    #[inline(always)]
    pub(super) fn leaf_block(&self, child: u32) -> LeafBlock<'_> {
        let (first, count) = Child::block(child);
        self.leaves.get(first, count)
    }

    /// Asks for the first cache lines of a child, without a branch, which would be mispredicted.
    #[inline(always)]
    pub(super) fn prefetch<const LINES: usize>(&self, child: u32) {
        let (place, is_block) = ((child & Child::PLACE) as usize, Child::is_block(child));
        let (nodes, blocks) = (self.nodes[0].faces.as_flattened(), self.leaves.words());
        let start = select_unpredictable(is_block, blocks, nodes);
        let words = select_unpredictable(is_block, LeafBlock::ROWS, size_of::<Node>() / size_of::<f32>());
        for line in 0..LINES {
            prefetch_index(start, place * words + line * WORDS_OF_A_LINE);
        }
    }
}
