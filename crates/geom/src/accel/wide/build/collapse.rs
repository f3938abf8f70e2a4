//! Collapses the binary tree into a wide one: which of its nodes become the up to eight children of a node.

use super::binary_tree::{BinaryNode, BinaryTree, RefRange, Split};
use crate::accel::prim_ref::PrimRef;
use crate::accel::wide::simd::LANES;
use crate::accel::wide::tree::leaf::LeafBlocks;
use crate::accel::wide::tree::node::{Child, Node};
use crate::accel::wide::tree::normalize::NormalizedSpace;
use crate::{Aabb, Triangles};

pub(super) struct Collapse<'a> {
    triangles: &'a Triangles,
    binary: &'a BinaryTree,
    refs: &'a [PrimRef],
    pub(super) space: NormalizedSpace,
    pub(super) nodes: Vec<Node>,
    pub(super) leaves: LeafBlocks,
}

/// The part of the binary tree that becomes one node: a child of it, or a binary node opened into two.
#[derive(Clone, Copy)]
enum Treelet {
    /// A child, by its place in the binary tree.
    Child(u32),
    /// Two treelets; the first is the lower one along the axis.
    Opened { axis: u8, halves: [usize; 2] },
}

impl<'a> Collapse<'a> {
    /// `refs` are the contents of the binary tree.
    pub(super) fn run(triangles: &'a Triangles, binary: &'a BinaryTree, refs: &'a [PrimRef]) -> Self {
        let space = NormalizedSpace::new(&triangles.bounds());
        let (nodes, leaves) = (Vec::new(), LeafBlocks::default());
        let mut this = Self { triangles, binary, refs, space, nodes, leaves };
        this.add_node(0);
        this.leaves.finish();
        this.nodes.shrink_to_fit();
        this
    }

    /// Adds the node that binary node `root` is opened into, and returns its index.
    fn add_node(&mut self, root: u32) -> u32 {
        let index = self.nodes.len();
        self.nodes.push(Node::empty());
        let mut treelets = Vec::with_capacity(2 * LANES);
        self.lay_out(root, LANES, true, &mut treelets);
        let mut node = Node::empty();
        let mut lanes = vec![None; treelets.len()];
        let mut used = 0;
        for (treelet, lane) in treelets.iter().zip(&mut lanes) {
            if let Some((bounds, child)) = self.child(treelet) {
                node.set(used, &self.space.map(&bounds), child);
                *lane = Some(used);
                used += 1;
            }
        }
        for octant in 0..4 {
            let mut order = Order { lanes: std::array::from_fn(|i| i), visited: 0 };
            order.visit(&treelets, &lanes, 0, octant);
            node.orders[octant] = order.pack();
            // In the opposite direction children are visited in reverse.
            order.lanes[..used].reverse();
            node.orders[7 - octant] = order.pack();
        }
        self.nodes[index] = node;
        index as u32
    }

    /// Gives a binary node up to `lanes` lanes: one, or one for each child that it is opened into. Appends its
    /// treelets, and returns where they start.
    fn lay_out(&self, root: u32, lanes: usize, must_open: bool, treelets: &mut Vec<Treelet>) -> usize {
        let at = treelets.len();
        treelets.push(Treelet::Child(root));
        if let Some((Split { axis, upper }, first)) = self.binary.opening(root, lanes, must_open) {
            let lower = self.lay_out(root + 1, first, false, treelets);
            let upper = self.lay_out(upper, lanes - first, false, treelets);
            treelets[at] = Treelet::Opened { axis, halves: [lower, upper] };
        }
        at
    }

    /// The child of a lane and its bounds; `None` for a treelet that is opened, or is empty.
    fn child(&mut self, treelet: &Treelet) -> Option<(Aabb, Child)> {
        let Treelet::Child(at) = *treelet else { return None };
        let BinaryNode { bounds, content, .. } = *self.binary.node(at);
        if bounds.is_empty() {
            return None;
        }
        let child = match content.leaf() {
            None => Child::Node(self.add_node(at)),
            Some(RefRange { first, count }) => {
                let refs = &self.refs[first as usize..][..count as usize];
                let listed = refs.iter().map(|reference| reference.index);
                Child::Block { first: self.leaves.push(self.triangles, &self.space, listed), count }
            }
        };
        Some((bounds, child))
    }
}

/// The lanes of a node in the order in which rays toward an octant visit them, first those that hold a child.
struct Order {
    lanes: [usize; LANES],
    visited: usize,
}

impl Order {
    /// Appends the lanes of treelet `at`.
    fn visit(&mut self, treelets: &[Treelet], lanes: &[Option<usize>], at: usize, octant: usize) {
        match treelets[at] {
            Treelet::Opened { axis, halves: [lower, upper] } => {
                let down = octant >> axis & 1 == 1;
                let (near, far) = if down { (upper, lower) } else { (lower, upper) };
                self.visit(treelets, lanes, near, octant);
                self.visit(treelets, lanes, far, octant);
            }
            _ => {
                if let Some(lane) = lanes[at] {
                    self.lanes[self.visited] = lane;
                    self.visited += 1;
                }
            }
        }
    }

    /// Three bits a lane.
    fn pack(&self) -> u32 {
        self.lanes.iter().rev().fold(0, |order, &lane| order << 3 | lane as u32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{KdOptions, KdTree, Triangle};
    use glam::DVec3;

    /// The nodes over a cloud of small triangles.
    fn nodes() -> Vec<Node> {
        let mut drawn = 0.0;
        let mut point = |size: f64| {
            drawn += 1.0;
            // Evenly spread (Roberts' sequence).
            let unit = (drawn * DVec3::new(0.819_172_513, 0.671_043_607, 0.549_700_478)).fract();
            (size * (2.0 * unit - 1.0)).as_vec3()
        };
        let triangles = (0..3000).map(|_| {
            let corner = point(1.0);
            Triangle::new(corner, corner + point(0.02), corner + point(0.02))
        });
        let triangles = Triangles::new(triangles.collect()).unwrap();
        // Planes cost nothing, so that a leaf holds what no plane separates, and nothing else does.
        let options = KdOptions { leaf_size: 1, traversal_cost: 0.0, ..KdOptions::default() };
        let (tree, mut refs) = KdTree::build_with_refs(&triangles, &options).unwrap();
        let binary = BinaryTree::by_kd_tree(&tree, &mut refs);
        Collapse::run(&triangles, &binary, &refs).nodes
    }

    /// If one child comes before another, some plane across an axis has it on the nearer side.
    #[test]
    fn every_octant_visits_children_from_near_to_far() {
        let nodes = nodes();
        let mut pairs = 0;
        for (node, octant) in nodes.iter().flat_map(|node| (0..8).map(move |octant| (node, octant))) {
            let lane = |place: usize| (node.orders[octant] >> (3 * place)) as usize % LANES;
            let count = (0..LANES).filter(|&lane| node.faces[0][lane] <= node.faces[1][lane]).count();
            for (near, far) in (0..count).flat_map(|j| (0..j).map(move |i| (lane(i), lane(j)))) {
                let apart = (0..3).any(|axis| {
                    let [lower, upper] = [&node.faces[2 * axis], &node.faces[2 * axis + 1]];
                    if octant >> axis & 1 == 1 {
                        lower[near] >= upper[far]
                    } else {
                        upper[near] <= lower[far]
                    }
                });
                assert!(apart, "octant {octant}: child {near} before {far}");
                pairs += 1;
            }
        }
        assert!(pairs > 10_000, "{pairs}");
    }
}
