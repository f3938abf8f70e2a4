use super::member::Member;
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

/// Far below what an `f32` coordinate can tell, far above what rounding does in `f64`.
fn slack_for(bounds: &Aabb) -> f64 {
    let largest = bounds.min.abs().max(bounds.max.abs()).max_element();
    // Zero for the empty box, whose coordinates are infinite.
    if largest.is_finite() { f64::from(largest) * 2.0_f64.powi(-40) } else { 0.0 }
}

impl KdTree {
    /// Builds the tree.
    ///
    /// Memory is bounded beforehand. Over `n` live triangles the leaves hold at most
    /// `b = 8 n + 1024` references (never more than `2^31`), there are fewer than `2 b` nodes, and
    /// the tree is at most [`KdTree::MAX_DEPTH`] deep. Building takes at most `44 n + 112 b` bytes
    /// beside the triangles: while a cell is halved, a box and two events for each triangle in it,
    /// 44 bytes; and for each of `b`, a box not yet in a leaf, a reference and two nodes, vectors
    /// holding up to three times their content while they grow. A closed mesh takes about `300 n`.
    ///
    /// # Errors
    /// [`GeomError::Param`] for an option out of its range.
    pub fn build(triangles: &Triangles, options: &KdOptions) -> Result<Self, GeomError> {
        options.validate()?;
        let live = triangles.live();
        let mut builder = Builder {
            triangles,
            options,
            slack: slack_for(&triangles.bounds()),
            nodes: Vec::new(),
            references: Vec::new(),
        };
        let everything = Cell {
            bounds: triangles.bounds(),
            members: live.iter().map(|&i| Member::new(triangles, i)).collect(),
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
    /// What touches it, ascending by index.
    members: Vec<Member>,
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
    triangles: &'a Triangles,
    options: &'a KdOptions,
    /// By how much a cut errs on the safe side.
    slack: f64,
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

    fn add_leaf(&mut self, members: &[Member]) {
        let first = self.references.len() as u32;
        self.references.extend(members.iter().map(|m| m.index));
        self.nodes.push(Node::Leaf { first, count: members.len() as u32 });
    }

    /// The best plane and the two cells it makes; `None` where a leaf is better.
    fn halve(&self, cell: &Cell) -> Option<(Plane, [Cell; 2])> {
        if cell.depth_left == 0 || cell.members.len() <= self.options.leaf_size as usize {
            return None;
        }
        let costs = Costs { traversal: self.options.traversal_cost, empty_factor: self.options.empty_factor };
        let Split { plane, counts } = best_split(&cell.bounds, &cell.members, costs)?;
        let needed = counts.map(room_of_leaf);
        let spare = cell.room.checked_sub(needed[0] + needed[1])?;
        // Shared in proportion; what the lower cell leaves goes to the upper one later.
        let share = (spare as f64 * needed[0] as f64 / (needed[0] + needed[1]) as f64) as usize;
        let rooms = [needed[0] + share, needed[1] + (spare - share)];
        let mut boxes = [cell.bounds; 2];
        boxes[0].max[plane.axis] = plane.position;
        boxes[1].min[plane.axis] = plane.position;
        let [lower, upper] = self.distribute(&cell.members, plane, counts, &boxes);
        let child = |bounds, members, room| Cell { bounds, members, depth_left: cell.depth_left - 1, room };
        Some((plane, [child(boxes[0], lower, rooms[0]), child(boxes[1], upper, rooms[1])]))
    }

    /// What is in each half, at most as many as `counts` says: of those whose box straddles the
    /// plane, the parts in both halves.
    fn distribute(
        &self,
        members: &[Member],
        plane: Plane,
        counts: [usize; 2],
        boxes: &[Aabb; 2],
    ) -> [Vec<Member>; 2] {
        let [mut lower, mut upper] = counts.map(Vec::with_capacity);
        for member in members {
            let (min, max) = (member.bounds.min[plane.axis], member.bounds.max[plane.axis]);
            if min < plane.position && plane.position < max {
                lower.extend(member.within(&boxes[0], self.triangles, self.slack));
                upper.extend(member.within(&boxes[1], self.triangles, self.slack));
            } else if min < plane.position || (max == plane.position && plane.within == Side::Lower) {
                lower.push(*member);
            } else {
                upper.push(*member);
            }
        }
        [lower, upper]
    }
}
