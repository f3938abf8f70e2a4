//! The binary tree of a k-d tree: the planes above, and below each leaf the parts of triangles in it, split down to leaf
//! blocks.

use super::binary_tree::BinaryTree;
use crate::Accel;
use crate::accel::kdtree::{KdTree, Node as KdNode};
use crate::accel::prim_ref::PrimRef;
use crate::accel::wide::tree::MAX_LEVELS;
use rayon::prelude::*;

impl BinaryTree {
    /// The binary tree of a k-d tree, in which a cell with an empty half has no node: its other half has. `refs`, the
    /// parts of triangles in the leaves, one for each reference, are reordered within each leaf, so that those of a leaf
    /// block are adjacent.
    ///
    /// Leaves are split in parallel on the current rayon pool.
    pub(super) fn by_kd_tree(tree: &KdTree, refs: &mut [PrimRef]) -> Self {
        let empty = Self::empty(&tree.bounds());
        let (mut leaves, mut rest) = (Vec::new(), refs);
        for node in &tree.nodes {
            if let KdNode::Leaf { first, count: count @ 1.. } = *node {
                let (leaf, others) = rest.split_at_mut(count as usize);
                leaves.push((first, leaf));
                rest = others;
            }
        }
        let subdivide = |(first, leaf): (u32, &mut [PrimRef])| {
            let mut below = empty.without_nodes();
            below.add_refs(first, leaf, MAX_LEVELS);
            below
        };
        let leaves: Vec<Self> = leaves.into_par_iter().map(subdivide).collect();
        // Each plane that is kept has something on both sides.
        let planes = leaves.len().saturating_sub(1);
        let count = planes + leaves.iter().map(|leaf| leaf.nodes.len()).sum::<usize>();
        let mut this = empty.without_nodes();
        this.nodes.reserve_exact(count);
        if leaves.is_empty() {
            this.add_refs(0, &mut [], MAX_LEVELS);
        } else {
            this.add_cell(tree, 0, &mut leaves.iter());
        }
        this
    }

    /// Adds a cell of the k-d tree that is not empty, and all below; the next of `leaves` are those
    /// in it that are not empty.
    fn add_cell(&mut self, tree: &KdTree, cell: u32, leaves: &mut std::slice::Iter<'_, Self>) {
        match tree.nodes[cell as usize] {
            KdNode::Leaf { .. } => {
                if let Some(leaf) = leaves.next() {
                    self.append(leaf);
                }
            }
            KdNode::Split { upper, .. } if is_empty(tree, upper) => self.add_cell(tree, cell + 1, leaves),
            KdNode::Split { upper, .. } if is_empty(tree, cell + 1) => self.add_cell(tree, upper, leaves),
            KdNode::Split { axis, upper, .. } => {
                self.add_inner(axis, [cell + 1, upper], |this, half| this.add_cell(tree, half, leaves));
            }
        }
    }
}

/// Whether a cell of the k-d tree holds nothing.
fn is_empty(tree: &KdTree, cell: u32) -> bool {
    match tree.nodes[cell as usize] {
        KdNode::Leaf { count, .. } => count == 0,
        KdNode::Split { upper, .. } => is_empty(tree, cell + 1) && is_empty(tree, upper),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::wide::build::binary_tree::{Content, RefRange, Split};
    use crate::{Aabb, Triangles};
    use glam::Vec3;

    fn contents(nodes: Vec<KdNode>, refs: &mut [PrimRef]) -> Vec<Content> {
        let triangles = Triangles::new(Vec::new()).unwrap();
        let mut tree = KdTree::build(&triangles).unwrap();
        tree.nodes = nodes;
        BinaryTree::by_kd_tree(&tree, refs).nodes.iter().map(|node| node.content).collect()
    }

    #[test]
    fn an_empty_half_has_no_node() {
        let split = |axis, upper| KdNode::Split { axis, position: 0.0, upper };
        let leaf = |first, count| KdNode::Leaf { first, count };
        let block = |first, count| Content::Leaf(RefRange { first, count });
        let nodes = vec![
            split(0, 4),
            split(1, 3),
            leaf(0, 0),
            leaf(0, 0),
            split(2, 8),
            split(0, 7),
            leaf(0, 0),
            leaf(0, 2),
            split(1, 10),
            leaf(2, 3),
            leaf(5, 0),
        ];
        let inner = Content::Inner(Split { axis: 2, upper: 2 });
        let unit = PrimRef { index: 0, bounds: Aabb { min: Vec3::ZERO, max: Vec3::ONE } };
        let five = &mut [unit; 5];
        assert_eq!(contents(nodes, five), [inner, block(0, 2), block(2, 3)]);
        for nodes in [vec![leaf(0, 0)], vec![split(1, 2), leaf(0, 0), leaf(0, 0)]] {
            assert_eq!(contents(nodes, &mut []), [block(0, 0)]);
        }
    }
}
