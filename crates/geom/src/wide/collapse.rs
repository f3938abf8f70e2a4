//! From a binary tree to a wide one: which of its cells become the up to eight cells of a node.

use super::blocks::Blocks;
use super::node::{Child, Node};
use super::simd::LANES;
use super::space::Space;
use crate::kdtree::{KdTree, Node as Binary};
use crate::{Aabb, Triangles};

/// Costs of a node and of a block to a ray that meets its box: a block takes between one and a half and
/// two times as long (docs/performance.md).
const NODE_COST: f32 = 1.0;
const BLOCK_COST: f32 = 1.5;

/// A subtree of the binary tree.
#[derive(Clone, Copy, Debug)]
struct Subtree {
    /// The box of what it holds.
    bounds: Aabb,
    /// The least expected cost of a ray, times the scene's surface, if it is given 1, 2, .. 8 lanes
    /// of a node (Ylitie, Karras and Laine, 2017, section 3).
    costs: [f32; LANES],
}

pub(super) struct Collapse<'a> {
    tree: &'a KdTree,
    space: Space,
    subtrees: Vec<Subtree>,
    pub(super) nodes: Vec<Node>,
    pub(super) blocks: Blocks,
}

/// A cell while a node is laid out.
#[derive(Clone, Copy)]
enum Cell<'a> {
    /// Holds nothing.
    Empty,
    /// A subtree, by its root.
    Tree(u32),
    /// Triangles of a leaf, and their box.
    List(&'a [u32], Aabb),
    /// Two cells in its place; the first is the lower one along the axis, if one parts them.
    Opened { axis: Option<u8>, parts: [usize; 2] },
}

/// Two cells in the place of one, each with the lanes it gets.
struct Opening<'a> {
    /// The axis of the plane that parts them, the lower one first.
    axis: Option<u8>,
    parts: [(Cell<'a>, usize); 2],
}

impl<'a> Collapse<'a> {
    pub(super) fn run(tree: &'a KdTree, space: Space) -> Self {
        let unknown = Subtree { bounds: Aabb::EMPTY, costs: [0.0; LANES] };
        let subtrees = vec![unknown; tree.nodes.len()];
        let mut this = Self { tree, space, subtrees, nodes: Vec::new(), blocks: Blocks::default() };
        this.assess(0, tree.triangles().bounds());
        this.add_node(Cell::Tree(0));
        this.blocks.finish();
        this.nodes.shrink_to_fit();
        this
    }

    /// Finds boxes and costs of a subtree, whose cell is `cell`, and of all below it.
    fn assess(&mut self, binary: u32, cell: Aabb) {
        self.subtrees[binary as usize] = match self.tree.nodes[binary as usize] {
            Binary::Leaf { .. } => {
                let listed = self.listed(binary);
                let bounds = bounds_within(self.tree.triangles(), listed, &cell);
                let blocks = listed.len().div_ceil(LANES);
                let area = if blocks == 0 { 0.0 } else { bounds.half_area() as f32 };
                let all = area * BLOCK_COST * blocks as f32;
                let costs =
                    std::array::from_fn(|i| if blocks <= i + 1 { all } else { all + area * NODE_COST });
                Subtree { bounds, costs }
            }
            Binary::Split { axis, position, upper } => {
                let (mut low, mut high) = (cell, cell);
                low.max[usize::from(axis)] = position;
                high.min[usize::from(axis)] = position;
                self.assess(binary + 1, low);
                self.assess(upper, high);
                let [lower, upper] = [binary + 1, upper].map(|part| self.subtrees[part as usize].bounds);
                let bounds = lower.union(&upper);
                let mut costs = [0.0; LANES];
                costs[0] = bounds.half_area() as f32 * NODE_COST + self.share(binary, LANES).1;
                for lanes in 2..=LANES {
                    costs[lanes - 1] = self.share(binary, lanes).1.min(costs[lanes - 2]);
                }
                Subtree { bounds, costs }
            }
        }
    }

    /// How many lanes the lower part of a subtree gets, if it is opened into `lanes` of them, at
    /// least 2, and what that costs.
    fn share(&self, binary: u32, lanes: usize) -> (usize, f32) {
        let Binary::Split { upper, .. } = self.tree.nodes[binary as usize] else { return (0, 0.0) };
        let [low, high] = [binary + 1, upper].map(|part| &self.subtrees[part as usize]);
        if low.bounds.is_empty() {
            return (0, high.costs[lanes - 1]);
        }
        if high.bounds.is_empty() {
            return (lanes, low.costs[lanes - 1]);
        }
        let cost = |first: usize| (first, low.costs[first - 1] + high.costs[lanes - first - 1]);
        (2..lanes).map(cost).fold(cost(1), |best, next| if next.1 < best.1 { next } else { best })
    }

    /// The triangles of a leaf.
    fn listed(&self, leaf: u32) -> &'a [u32] {
        match self.tree.nodes[leaf as usize] {
            Binary::Leaf { first, count } => &self.tree.references[first as usize..][..count as usize],
            Binary::Split { .. } => &[],
        }
    }

    /// Adds a node that `root` is opened into, and returns its index.
    fn add_node(&mut self, root: Cell<'a>) -> u32 {
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

    /// Gives a cell up to `lanes` lanes: itself, or all that it is opened into. Appends them to
    /// `cells`, and returns where the cell is.
    fn lay_out(&self, cell: Cell<'a>, lanes: usize, must_open: bool, cells: &mut Vec<Cell<'a>>) -> usize {
        let at = cells.len();
        cells.push(cell);
        if let Some(Opening { axis, parts: [first, second] }) = self.opening(cell, lanes, must_open) {
            let first = self.lay_out(first.0, first.1, false, cells);
            let second = self.lay_out(second.0, second.1, false, cells);
            cells[at] = Cell::Opened { axis, parts: [first, second] };
        }
        at
    }

    /// How a cell that gets `lanes` lanes is opened, if it is.
    fn opening(&self, cell: Cell<'a>, lanes: usize, must_open: bool) -> Option<Opening<'a>> {
        match cell {
            Cell::Tree(binary) => match self.tree.nodes[binary as usize] {
                Binary::Leaf { .. } => {
                    let bounds = self.subtrees[binary as usize].bounds;
                    self.opening_of_list(self.listed(binary), &bounds, lanes, must_open)
                }
                Binary::Split { axis, upper, .. } if lanes > 1 => {
                    let (first, cost) = self.share(binary, lanes);
                    let part =
                        |root, lanes| if lanes == 0 { (Cell::Empty, 0) } else { (Cell::Tree(root), lanes) };
                    let parts = [part(binary + 1, first), part(upper, lanes - first)];
                    let pays = cost < self.subtrees[binary as usize].costs[0];
                    (must_open || pays).then_some(Opening { axis: Some(axis), parts })
                }
                Binary::Split { .. } => None,
            },
            Cell::List(triangles, bounds) => self.opening_of_list(triangles, &bounds, lanes, must_open),
            Cell::Empty | Cell::Opened { .. } => None,
        }
    }

    /// Halves what is too much for a block, if there are lanes for all of its blocks.
    fn opening_of_list(
        &self,
        triangles: &'a [u32],
        bounds: &Aabb,
        lanes: usize,
        must_open: bool,
    ) -> Option<Opening<'a>> {
        let fits = triangles.len().div_ceil(LANES) <= lanes;
        if triangles.len() <= LANES || lanes < 2 || !(fits || must_open) {
            return None;
        }
        let half = triangles.len().div_ceil(2).next_multiple_of(LANES);
        let (first, second) = triangles.split_at(half);
        let part = |part| Cell::List(part, bounds_within(self.tree.triangles(), part, bounds));
        let share = lanes.div_ceil(2);
        Some(Opening { axis: None, parts: [(part(first), share), (part(second), lanes - share)] })
    }

    /// What a cell's lane holds, and the box of that.
    fn child(&mut self, cell: &Cell<'a>) -> Option<(Aabb, Child)> {
        let (triangles, bounds) = match *cell {
            Cell::Tree(binary) => (self.listed(binary), self.subtrees[binary as usize].bounds),
            Cell::List(triangles, bounds) => (triangles, bounds),
            Cell::Empty | Cell::Opened { .. } => return None,
        };
        if bounds.is_empty() {
            return None;
        }
        if triangles.is_empty() || triangles.len() > LANES {
            return Some((bounds, Child::Node(self.add_node(*cell))));
        }
        let first = self.blocks.push(self.tree.triangles(), &self.space, triangles);
        Some((bounds, Child::Block { first, count: triangles.len() as u32 }))
    }
}

/// The box of triangles' boxes, cut at `cell`.
fn bounds_within(triangles: &Triangles, listed: &[u32], cell: &Aabb) -> Aabb {
    listed.iter().fold(Aabb::EMPTY, |all, &index| {
        let bounds = triangles.get(index).bounds();
        let (min, max) = (bounds.min.clamp(cell.min, cell.max), bounds.max.clamp(cell.min, cell.max));
        all.union(&Aabb { min, max })
    })
}

/// The lanes of a node as rays toward some octant meet them, first those that hold a cell.
struct Order {
    lanes: [usize; LANES],
    met: usize,
}

impl Order {
    /// Appends the lanes of the cells below `at`.
    fn meet(&mut self, cells: &[Cell<'_>], lanes: &[Option<usize>], at: usize, octant: usize) {
        match cells[at] {
            Cell::Opened { axis, parts: [lower, upper] } => {
                let down = axis.is_some_and(|axis| octant >> axis & 1 == 1);
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
    use crate::{KdOptions, Triangle};
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
        let tree = KdTree::build(&triangles, options).unwrap();
        let Collapse { nodes, .. } = Collapse::run(&tree, Space::new(&triangles.bounds()));
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
        // Planes cost nothing, so that no leaf is too large for a block: nothing parts its blocks.
        let options = KdOptions { leaf_size: 8, traversal_cost: 0.0, ..KdOptions::default() };
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
                assert!(!cells.is_empty());
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
