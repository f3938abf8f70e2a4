use super::sah::{Costs, Plane, Side, Split, best_split};
use super::{KdTree, Node};
use crate::{Aabb, GeomError, Triangles};

/// How a [`KdTree`] is built.
///
/// ```
/// let mut options = globillum_geom::KdOptions::default();
/// options.leaf_size = 4;
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct KdOptions {
    /// Most planes above a leaf; `None` for `8 + 1.3 log2 n`. Never more than
    /// [`KdTree::MAX_DEPTH`] are built.
    pub max_depth: Option<u32>,
    /// A cell with at most this many triangles is not halved.
    pub leaf_size: u32,
    /// Cost of visiting an inner node, in units of deciding one triangle; finite and `>= 0`.
    pub traversal_cost: f64,
    /// Factor on the cost of a split that cuts off an empty cell, in `(0, 1]`.
    pub empty_factor: f64,
}

/// Leaves references and nodes countable in `u32`.
const MAX_REFERENCES: usize = 1 << 31;

impl Default for KdOptions {
    fn default() -> Self {
        Self { max_depth: None, leaf_size: 1, traversal_cost: 0.7, empty_factor: 0.8 }
    }
}

impl KdOptions {
    fn validate(&self) -> Result<(), GeomError> {
        let param = |name, value, range| Err(GeomError::Param { name, value, range });
        if !(self.traversal_cost.is_finite() && self.traversal_cost >= 0.0) {
            return param("traversal_cost", self.traversal_cost, "[0, inf)");
        }
        if !(self.empty_factor > 0.0 && self.empty_factor <= 1.0) {
            return param("empty_factor", self.empty_factor, "(0, 1]");
        }
        Ok(())
    }

    fn depth_for(&self, count: usize) -> u32 {
        let usual = 8.0 + 1.3 * (count.max(1) as f64).log2();
        self.max_depth.unwrap_or(usual as u32).min(KdTree::MAX_DEPTH)
    }
}

/// The room that the leaves of a tree over `count` triangles may take; see [`Cell::room`].
fn room_for(count: usize) -> usize {
    (8 * count + 1024).min(MAX_REFERENCES)
}

impl KdTree {
    /// Builds the tree.
    ///
    /// Memory is bounded beforehand. Over `n` live triangles the leaves hold at most
    /// `b = 8 n + 1024` references (never more than `2^31`), there are fewer than `2 b` nodes, and
    /// the tree is at most [`KdTree::MAX_DEPTH`] deep. Building takes at most `44 n + 88 b` bytes
    /// beside the triangles: while a cell is halved, a box, a position and two events a triangle,
    /// 44 bytes; and for each of `b`, a position not yet in a leaf, a reference and two nodes,
    /// vectors holding up to three times their content while they grow. A closed mesh takes about
    /// `230 n`.
    ///
    /// # Errors
    /// [`GeomError::Param`] for an option out of its range.
    pub fn build(triangles: &Triangles, options: &KdOptions) -> Result<Self, GeomError> {
        options.validate()?;
        let live = triangles.live();
        let mut builder = Builder {
            bounds: live.iter().map(|&i| triangles.get(i).bounds()).collect(),
            live,
            options,
            nodes: Vec::new(),
            references: Vec::new(),
        };
        let everything = Cell {
            bounds: triangles.bounds(),
            members: (0..live.len() as u32).collect(),
            depth_left: options.depth_for(live.len()),
            room: room_for(live.len()),
        };
        builder.subdivide(everything);
        let Builder { mut nodes, mut references, .. } = builder;
        nodes.shrink_to_fit();
        references.shrink_to_fit();
        Ok(Self { triangles: triangles.clone(), nodes, references })
    }
}

/// A cell that may yet be halved.
struct Cell {
    bounds: Aabb,
    /// Which triangles touch it, as positions in `live`, ascending.
    members: Vec<u32>,
    depth_left: u32,
    /// How much room the leaves below may take: one for each reference, and one for an empty
    /// leaf, so that nodes are bounded too. Enough to make this cell a leaf.
    room: usize,
}

/// The room that a leaf with `count` references takes.
fn room_of_leaf(count: usize) -> usize {
    count.max(1)
}

struct Builder<'a> {
    live: &'a [u32],
    bounds: Vec<Aabb>,
    options: &'a KdOptions,
    nodes: Vec<Node>,
    references: Vec<u32>,
}

impl Builder<'_> {
    /// Adds the nodes of `cell` and returns the room that they left.
    fn subdivide(&mut self, cell: Cell) -> usize {
        let Some((plane, [lower, mut upper])) = self.halve(&cell) else {
            self.add_leaf(&cell.members);
            return cell.room - room_of_leaf(cell.members.len());
        };
        drop(cell);
        let node = self.nodes.len();
        // The upper child's index is known only after the lower one's nodes.
        self.nodes.push(Node::Split { axis: plane.axis as u8, position: plane.position, upper: 0 });
        upper.room += self.subdivide(lower);
        let next = self.nodes.len() as u32;
        if let Node::Split { upper, .. } = &mut self.nodes[node] {
            *upper = next;
        }
        self.subdivide(upper)
    }

    fn add_leaf(&mut self, members: &[u32]) {
        let first = self.references.len() as u32;
        self.references.extend(members.iter().map(|&m| self.live[m as usize]));
        self.nodes.push(Node::Leaf { first, count: members.len() as u32 });
    }

    /// The best plane and the two cells it makes; `None` where a leaf is better.
    fn halve(&self, cell: &Cell) -> Option<(Plane, [Cell; 2])> {
        if cell.depth_left == 0 || cell.members.len() <= self.options.leaf_size as usize {
            return None;
        }
        let costs = Costs { traversal: self.options.traversal_cost, empty_factor: self.options.empty_factor };
        let Split { plane, counts } = best_split(&cell.bounds, &cell.members, &self.bounds, costs)?;
        let needed = counts.map(room_of_leaf);
        let spare = cell.room.checked_sub(needed[0] + needed[1])?;
        // Shared in proportion; what the lower cell leaves goes to the upper one later.
        let share = (spare as f64 * needed[0] as f64 / (needed[0] + needed[1]) as f64) as usize;
        let rooms = [needed[0] + share, needed[1] + (spare - share)];
        let [lower, upper] = self.distribute(&cell.members, plane, counts);
        let [mut low_box, mut high_box] = [cell.bounds; 2];
        low_box.max[plane.axis] = plane.position;
        high_box.min[plane.axis] = plane.position;
        let child = |bounds, members, room| Cell { bounds, members, depth_left: cell.depth_left - 1, room };
        Some((plane, [child(low_box, lower, rooms[0]), child(high_box, upper, rooms[1])]))
    }

    /// Lists the members on each side, as many as `counts` says; those that straddle the plane on
    /// both.
    fn distribute(&self, members: &[u32], plane: Plane, counts: [usize; 2]) -> [Vec<u32>; 2] {
        let mut sides = counts.map(Vec::with_capacity);
        for &member in members {
            let bounds = &self.bounds[member as usize];
            let (min, max) = (bounds.min[plane.axis], bounds.max[plane.axis]);
            let within = min == plane.position && max == plane.position;
            if min < plane.position || (within && plane.within == Side::Lower) {
                sides[0].push(member);
            }
            if max > plane.position || (within && plane.within == Side::Upper) {
                sides[1].push(member);
            }
        }
        debug_assert_eq!(sides.each_ref().map(Vec::len), counts);
        sides
    }
}
