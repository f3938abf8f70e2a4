//! The tree as traversal reads it: [nodes](node), [leaf blocks](leaf), and the [space](normalize) that
//! their coordinates are in.

pub(super) mod leaf;
pub(super) mod node;
pub(super) mod normalize;

use crate::Triangles;
use leaf::LeafBlocks;
use node::{Child, Node};
use normalize::NormalizedSpace;

/// Most levels of nodes below a leaf of the k-d tree. Half of them are enough to halve any number of
/// triangles.
pub(super) const MAX_LEVELS: u32 = 60;

/// A tree of nodes with up to eight children; the first node is the root.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    pub(super) triangles: Triangles,
    pub(super) space: NormalizedSpace,
    pub(super) nodes: Vec<Node>,
    pub(super) leaves: LeafBlocks,
}

impl Tree {
    /// Bytes of memory held, the triangles included.
    pub(super) fn bytes(&self) -> usize {
        self.triangles.bytes() + size_of_val(&*self.nodes) + self.leaves.bytes()
    }

    /// The triangles of a leaf block.
    pub(super) fn listed(&self, child: u32) -> &[u32] {
        let (first, count) = Child::block(child);
        self.leaves.indices(first, count)
    }

    /// Where a child is, found without a branch, which would be mispredicted.
    #[inline(always)]
    pub(super) fn address(&self, child: u32) -> *const u8 {
        let (nodes, leaves) = (self.nodes.as_ptr().cast::<u8>(), self.leaves.as_ptr());
        let (place, is_block) = ((child & Child::PLACE) as usize, Child::is_block(child) as usize);
        let (starts, sizes) = ([nodes, leaves], [size_of::<Node>(), LeafBlocks::STRIDE]);
        starts[is_block & 1].wrapping_add(place * sizes[is_block & 1])
    }
}
