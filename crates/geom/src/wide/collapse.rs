//! From a binary tree to a wide one: three levels become one node.

use super::blocks::Blocks;
use super::node::{Child, FIRST_CELL, Node};
use super::simd::LANES;
use super::space::Space;
use crate::kdtree::{KdTree, Node as Binary};

pub(super) struct Collapse<'a> {
    tree: &'a KdTree,
    space: Space,
    pub(super) nodes: Vec<Node>,
    pub(super) blocks: Blocks,
}

impl<'a> Collapse<'a> {
    pub(super) fn run(tree: &'a KdTree, space: Space) -> Self {
        let mut this = Self { tree, space, nodes: Vec::new(), blocks: Blocks::default() };
        this.add_node(|this, node| this.place(node, 0, 0));
        this.blocks.finish();
        this.nodes.shrink_to_fit();
        this
    }

    fn add_node(&mut self, fill: impl FnOnce(&mut Self, &mut Node)) -> u32 {
        let index = self.nodes.len();
        self.nodes.push(Node::empty());
        let mut node = Node::empty();
        fill(self, &mut node);
        self.nodes[index] = node;
        index as u32
    }

    /// Puts the subtree below `binary` at `place` of `node`.
    fn place(&mut self, node: &mut Node, place: usize, binary: u32) {
        match self.tree.nodes[binary as usize] {
            Binary::Leaf { first, count } => {
                let tree = self.tree;
                self.share(node, place, &tree.references[first as usize..][..count as usize]);
            }
            Binary::Split { .. } if place >= FIRST_CELL => {
                let index = self.add_node(|this, node| this.place(node, 0, binary));
                node.children[place - FIRST_CELL] = Child::Node(index).pack();
            }
            Binary::Split { axis, position, upper } => {
                node.set_plane(place, axis, self.space.coordinate(usize::from(axis), position));
                self.place(node, 2 * place + 1, binary + 1);
                self.place(node, 2 * place + 2, upper);
            }
        }
    }

    /// Shares the triangles of a leaf among the cells at or below `place`; no plane parts them.
    fn share(&mut self, node: &mut Node, place: usize, triangles: &[u32]) {
        if place < FIRST_CELL {
            let half = triangles.len().div_ceil(2).next_multiple_of(LANES).min(triangles.len());
            let (lower, upper) = triangles.split_at(half);
            self.share(node, 2 * place + 1, lower);
            self.share(node, 2 * place + 2, upper);
        } else if !triangles.is_empty() {
            node.children[place - FIRST_CELL] = self.block(triangles).pack();
        }
    }

    fn block(&mut self, triangles: &[u32]) -> Child {
        if triangles.len() > LANES {
            return Child::Node(self.add_node(|this, node| this.share(node, 0, triangles)));
        }
        let first = self.blocks.push(self.tree.triangles(), &self.space, triangles);
        Child::Block { first, count: triangles.len() as u32 }
    }
}
