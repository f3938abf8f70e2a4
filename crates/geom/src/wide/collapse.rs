//! From a binary tree to a wide one: the largest cells are opened until a node has eight.

use super::blocks::Blocks;
use super::node::{Child, Node};
use super::simd::LANES;
use super::space::Space;
use crate::kdtree::{KdTree, Node as Binary};
use crate::{Aabb, Triangles};

pub(super) struct Collapse<'a> {
    tree: &'a KdTree,
    space: Space,
    /// The boxes of what the binary tree's cells hold.
    boxes: Vec<Aabb>,
    pub(super) nodes: Vec<Node>,
    pub(super) blocks: Blocks,
}

/// A cell that is to find its place in a node.
#[derive(Clone, Copy)]
enum Cell<'a> {
    /// A subtree, by its root.
    Tree(u32),
    /// Triangles of a leaf, and the box of it all.
    List(&'a [u32], Aabb),
    /// Two cells in its place; the first is the lower one along the axis, if one parts them.
    Opened { axis: Option<u8>, parts: [usize; 2] },
}

impl<'a> Collapse<'a> {
    pub(super) fn run(tree: &'a KdTree, space: Space) -> Self {
        let boxes = vec![Aabb::EMPTY; tree.nodes.len()];
        let mut this = Self { tree, space, boxes, nodes: Vec::new(), blocks: Blocks::default() };
        this.fit(0, tree.triangles().bounds());
        this.add_node(Cell::Tree(0));
        this.blocks.finish();
        this.nodes.shrink_to_fit();
        this
    }

    /// Finds the boxes of a cell and those below it.
    fn fit(&mut self, binary: u32, cell: Aabb) -> Aabb {
        let bounds = match self.tree.nodes[binary as usize] {
            Binary::Leaf { .. } => bounds_within(self.tree.triangles(), self.listed(binary), &cell),
            Binary::Split { axis, position, upper } => {
                let (mut low, mut high) = (cell, cell);
                low.max[usize::from(axis)] = position;
                high.min[usize::from(axis)] = position;
                self.fit(binary + 1, low).union(&self.fit(upper, high))
            }
        };
        self.boxes[binary as usize] = bounds;
        bounds
    }

    /// The triangles of a leaf.
    fn listed(&self, leaf: u32) -> &'a [u32] {
        match self.tree.nodes[leaf as usize] {
            Binary::Leaf { first, count } => &self.tree.references[first as usize..][..count as usize],
            Binary::Split { .. } => &[],
        }
    }

    fn bounds(&self, cell: &Cell<'_>) -> Aabb {
        match *cell {
            Cell::Tree(binary) => self.boxes[binary as usize],
            Cell::List(_, bounds) => bounds,
            Cell::Opened { .. } => Aabb::EMPTY,
        }
    }

    /// The two parts of a cell that can be opened.
    fn parts(&self, cell: &Cell<'a>) -> Option<(Option<u8>, [Cell<'a>; 2])> {
        match *cell {
            Cell::Tree(binary) => match self.tree.nodes[binary as usize] {
                Binary::Split { axis, upper, .. } => {
                    Some((Some(axis), [Cell::Tree(binary + 1), Cell::Tree(upper)]))
                }
                Binary::Leaf { .. } => {
                    self.parts(&Cell::List(self.listed(binary), self.boxes[binary as usize]))
                }
            },
            Cell::List(triangles, bounds) if triangles.len() > LANES => {
                let half = triangles.len().div_ceil(2).next_multiple_of(LANES);
                let (first, second) = triangles.split_at(half);
                let part = |part| Cell::List(part, bounds_within(self.tree.triangles(), part, &bounds));
                Some((None, [part(first), part(second)]))
            }
            _ => None,
        }
    }

    /// Adds a node with the cells that `root` is opened into, and returns its index.
    fn add_node(&mut self, root: Cell<'a>) -> u32 {
        let index = self.nodes.len();
        self.nodes.push(Node::empty());
        let cells = self.open(root);
        let mut node = Node::empty();
        let mut lanes = vec![None; cells.len()];
        let mut used = 0;
        for (cell, lane) in cells.iter().zip(&mut lanes) {
            let bounds = self.bounds(cell);
            if !bounds.is_empty() {
                let child = self.child(cell);
                node.set(used, &self.space.map(&bounds), child);
                *lane = Some(used);
                used += 1;
            }
        }
        for (octant, order) in node.orders.iter_mut().enumerate() {
            let mut met = Vec::with_capacity(LANES);
            list_met(&cells, &lanes, 0, octant, &mut met);
            *order =
                (0..).zip(met.into_iter().chain(used..LANES)).map(|(i, lane)| (lane as u32) << (3 * i)).sum();
        }
        self.nodes[index] = node;
        index as u32
    }

    /// Opens the largest of the cells until there are eight.
    fn open(&self, root: Cell<'a>) -> Vec<Cell<'a>> {
        let mut cells = vec![root];
        let mut count = 1;
        while count < LANES {
            let openable = cells.iter().enumerate().filter_map(|(i, cell)| {
                if self.bounds(cell).is_empty() {
                    return None;
                }
                let (axis, parts) = self.parts(cell)?;
                Some((self.bounds(cell).half_area(), i, axis, parts))
            });
            let Some((_, i, axis, parts)) = openable.max_by(|a, b| a.0.total_cmp(&b.0)) else { break };
            let next = cells.len();
            cells[i] = Cell::Opened { axis, parts: [next, next + 1] };
            cells.extend(parts);
            count = count - 1 + parts.iter().filter(|part| !self.bounds(part).is_empty()).count();
        }
        cells
    }

    fn child(&mut self, cell: &Cell<'a>) -> Child {
        let triangles = match *cell {
            Cell::Tree(binary) => self.listed(binary),
            Cell::List(triangles, _) => triangles,
            Cell::Opened { .. } => &[],
        };
        if triangles.is_empty() || triangles.len() > LANES {
            return Child::Node(self.add_node(*cell));
        }
        let first = self.blocks.push(self.tree.triangles(), &self.space, triangles);
        Child::Block { first, count: triangles.len() as u32 }
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

/// Lists the lanes of the cells below `at` in the order in which rays toward `octant` meet them.
fn list_met(cells: &[Cell<'_>], lanes: &[Option<usize>], at: usize, octant: usize, met: &mut Vec<usize>) {
    match cells[at] {
        Cell::Opened { axis, parts: [lower, upper] } => {
            let down = axis.is_some_and(|axis| octant >> axis & 1 == 1);
            let (near, far) = if down { (upper, lower) } else { (lower, upper) };
            list_met(cells, lanes, near, octant, met);
            list_met(cells, lanes, far, octant, met);
        }
        _ => met.extend(lanes[at]),
    }
}
