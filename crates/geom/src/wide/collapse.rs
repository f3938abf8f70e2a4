//! From a binary tree to a wide one: which of its subtrees become the up to eight cells of a node.

use super::blocks::Blocks;
use super::node::{Child, Node};
use super::simd::LANES;
use super::space::Space;
use super::subtrees::{Block, Parts, Subtree, Subtrees};
use crate::kdtree::Member;
use crate::{Aabb, Triangles};

pub(super) struct Collapse<'a> {
    triangles: &'a Triangles,
    subtrees: &'a Subtrees,
    members: &'a [Member],
    space: Space,
    pub(super) nodes: Vec<Node>,
    pub(super) blocks: Blocks,
}

/// A cell while a node is laid out.
#[derive(Clone, Copy)]
enum Cell {
    /// A subtree.
    Whole(u32),
    /// Two cells in its place; the first is the lower one along the axis.
    Opened { axis: u8, parts: [usize; 2] },
}

impl<'a> Collapse<'a> {
    /// `members` are what is in the subtrees.
    pub(super) fn run(
        triangles: &'a Triangles,
        subtrees: &'a Subtrees,
        members: &'a [Member],
        space: Space,
    ) -> Self {
        let (nodes, blocks) = (Vec::new(), Blocks::default());
        let mut this = Self { triangles, subtrees, members, space, nodes, blocks };
        this.add_node(0);
        this.blocks.finish();
        this.nodes.shrink_to_fit();
        this
    }

    /// Adds a node that subtree `root` is opened into, and returns its index.
    fn add_node(&mut self, root: u32) -> u32 {
        let index = self.nodes.len();
        self.nodes.push(Node::empty());
        let mut cells = Vec::with_capacity(2 * LANES);
        self.lay_out(root, LANES, true, &mut cells);
        let mut node = Node::empty();
        let mut lanes = vec![None; cells.len()];
        let mut used = 0;
        for (cell, lane) in cells.iter().zip(&mut lanes) {
            if let Some((bounds, child)) = self.child(cell) {
                node.set(used, &self.space.map(&bounds), child);
                *lane = Some(used);
                used += 1;
            }
        }
        for octant in 0..4 {
            let mut order = Order { lanes: std::array::from_fn(|i| i), met: 0 };
            order.meet(&cells, &lanes, 0, octant);
            node.orders[octant] = order.pack();
            // The other way, all is met in reverse.
            order.lanes[..used].reverse();
            node.orders[7 - octant] = order.pack();
        }
        self.nodes[index] = node;
        index as u32
    }

    /// Gives a subtree up to `lanes` lanes: one, or one for each that it is opened into. Appends them
    /// to `cells`, and returns where the subtree is.
    fn lay_out(&self, root: u32, lanes: usize, must_open: bool, cells: &mut Vec<Cell>) -> usize {
        let at = cells.len();
        cells.push(Cell::Whole(root));
        if let Some((Parts { axis, upper }, first)) = self.subtrees.opening(root, lanes, must_open) {
            let lower = self.lay_out(root + 1, first, false, cells);
            let upper = self.lay_out(upper, lanes - first, false, cells);
            cells[at] = Cell::Opened { axis, parts: [lower, upper] };
        }
        at
    }

    /// What a cell's lane holds, and the box of that; `None` for one that has no lane of its own, or that has
    /// nothing in it.
    fn child(&mut self, cell: &Cell) -> Option<(Aabb, Child)> {
        let Cell::Whole(at) = *cell else { return None };
        let Subtree { bounds, content, .. } = *self.subtrees.get(at);
        if bounds.is_empty() {
            return None;
        }
        let child = match content.block() {
            None => Child::Node(self.add_node(at)),
            Some(Block { first, count }) => {
                let members = &self.members[first as usize..][..count as usize];
                let listed = members.iter().map(|m| m.index);
                Child::Block { first: self.blocks.push(self.triangles, &self.space, listed), count }
            }
        };
        Some((bounds, child))
    }
}

/// The lanes of a node as rays toward some octant meet them, first those that hold a cell.
struct Order {
    lanes: [usize; LANES],
    met: usize,
}

impl Order {
    /// Appends the lanes of the cells below `at`.
    fn meet(&mut self, cells: &[Cell], lanes: &[Option<usize>], at: usize, octant: usize) {
        match cells[at] {
            Cell::Opened { axis, parts: [lower, upper] } => {
                let down = octant >> axis & 1 == 1;
                let (near, far) = if down { (upper, lower) } else { (lower, upper) };
                self.meet(cells, lanes, near, octant);
                self.meet(cells, lanes, far, octant);
            }
            _ => {
                if let Some(lane) = lanes[at] {
                    self.lanes[self.met] = lane;
                    self.met += 1;
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
    use glam::{DVec3, Vec3};

    /// A cloud of small triangles, some of them `long`, so that they straddle many cells.
    fn collapsed(options: &KdOptions, long: f64) -> (Vec<Node>, usize) {
        let mut drawn = 0.0;
        let mut point = |size: f64| {
            drawn += 1.0;
            // Evenly spread (Roberts' sequence).
            let unit = (drawn * DVec3::new(0.819_172_513, 0.671_043_607, 0.549_700_478)).fract();
            (size * (2.0 * unit - 1.0)).as_vec3()
        };
        let triangles = (0..3000).map(|i| {
            let (corner, size) = (point(1.0), if i % 50 == 0 { long } else { 0.02 });
            let edge = |v: Vec3| corner + v;
            Triangle::new(corner, edge(point(size)), edge(point(size)))
        });
        let triangles = Triangles::new(triangles.collect()).unwrap();
        let (tree, mut members) = KdTree::build_with_members(&triangles, options).unwrap();
        let subtrees = Subtrees::new(&tree, &mut members);
        let space = Space::new(&triangles.bounds());
        let Collapse { nodes, .. } = Collapse::run(&triangles, &subtrees, &members, space);
        (nodes, tree.references.len())
    }

    fn cells(node: &Node) -> Vec<usize> {
        (0..LANES).filter(|&lane| node.faces[0][lane] <= node.faces[1][lane]).collect()
    }

    fn order(node: &Node, octant: usize) -> Vec<usize> {
        (0..LANES).map(|i| (node.orders[octant] >> (3 * i)) as usize % LANES).collect()
    }

    /// If one cell comes before another, some plane across an axis has it on the nearer side.
    #[test]
    fn every_octant_meets_cells_from_near_to_far() {
        // Planes cost nothing, so that a leaf holds what no plane parts, and nothing else parts it.
        let options = KdOptions { leaf_size: 1, traversal_cost: 0.0, ..KdOptions::default() };
        let (nodes, _) = collapsed(&options, 0.02);
        let mut pairs = 0;
        for (node, octant) in nodes.iter().flat_map(|node| (0..8).map(move |octant| (node, octant))) {
            let order = order(node, octant);
            let count = cells(node).len();
            for (i, j) in (0..count).flat_map(|j| (0..j).map(move |i| (i, j))) {
                let (near, far) = (order[i], order[j]);
                let apart = (0..3).any(|axis| {
                    let [lower, upper] = [&node.faces[2 * axis], &node.faces[2 * axis + 1]];
                    if octant >> axis & 1 == 1 {
                        lower[near] >= upper[far]
                    } else {
                        upper[near] <= lower[far]
                    }
                });
                assert!(apart, "octant {octant}: cell {near} before {far}");
                pairs += 1;
            }
        }
        assert!(pairs > 10_000, "{pairs}");
    }

    #[test]
    fn orders_are_permutations_and_blocks_hold_every_reference() {
        for leaf_size in [1, 8, 40] {
            let options = KdOptions { leaf_size, max_depth: 9, ..KdOptions::default() };
            let (nodes, references) = collapsed(&options, 0.8);
            let mut listed = 0;
            for node in &nodes {
                let cells = cells(node);
                assert!(cells.len() > 1);
                for octant in 0..8 {
                    let order = order(node, octant);
                    let mut sorted = order.clone();
                    sorted.sort_unstable();
                    assert!(sorted.iter().copied().eq(0..LANES));
                    assert!(order[..cells.len()].iter().all(|lane| cells.contains(lane)), "{order:?}");
                }
                let blocks =
                    cells.iter().map(|&lane| node.children[lane]).filter(|&c| Child::is_block(c) == 1);
                listed += blocks.map(|child| Child::block(child).1).sum::<usize>();
            }
            assert_eq!(listed, references);
        }
    }
}
