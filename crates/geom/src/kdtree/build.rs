use super::cost::CostModel;
use super::events::{Event, Events, Move};
use super::member::Member;
use super::plane::{Place, Plane, Side, Split};
use super::rules::choose_plane;
use super::sweep::cheapest_split;
use super::{KdOptions, KdTree, Node, SplitRule};
use crate::{Aabb, GeomError, Triangles};

/// Leaves references and nodes countable in `u32`.
const MAX_REFERENCES: usize = 1 << 31;

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
    /// Takes `O(N log N)` for the surface area heuristic, `N` being the references in the end.
    ///
    /// Memory is bounded beforehand. Over `n` live triangles the leaves hold at most
    /// `b = 8 n + 1024` references (never more than `2^31`), there are fewer than `2 b` nodes, and
    /// the tree is at most [`KdTree::MAX_DEPTH`] deep. Building takes at most `140 n + 190 b` bytes
    /// beside the triangles: for each triangle in the cell that is being halved, and for each of
    /// `b`, a box and its six events, 76 bytes; and for each of `b` a reference and two nodes, in
    /// vectors that hold up to three times their content while they grow. A closed mesh takes
    /// about `600 n`.
    ///
    /// # Errors
    /// [`GeomError::Param`] for an option out of its range.
    pub fn build(triangles: &Triangles, options: &KdOptions) -> Result<Self, GeomError> {
        options.validate()?;
        let live = triangles.live();
        let members: Vec<Member> = live.iter().map(|&i| Member::new(triangles, i)).collect();
        let everything = Cell {
            bounds: triangles.bounds(),
            events: (options.rule == SplitRule::SurfaceArea).then(|| Events::new(&members)),
            members,
            depth_left: options.max_depth.min(Self::MAX_DEPTH),
            unpaid: 0,
            room: room_for(live.len()),
        };
        let mut builder = Builder {
            triangles,
            options,
            costs: options.costs(),
            slack: slack_for(&triangles.bounds()),
            nodes: Vec::new(),
            references: Vec::new(),
            scratch: Scratch::default(),
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
    /// Where the members' boxes begin and end, for a rule that sweeps.
    events: Option<Events>,
    depth_left: u32,
    /// How many planes right above did not pay by themselves.
    unpaid: u32,
    /// How much room the leaves below may take: one for each reference, and one for an empty
    /// leaf, so that nodes are bounded too. Enough to make this cell a leaf.
    room: usize,
}

/// The room that a leaf with `count` references takes.
fn room_of_leaf(count: usize) -> usize {
    count.max(1)
}

/// Where a cell is halved.
struct Choice {
    split: Split,
    /// How many planes in a row, this one the last, do not pay by themselves.
    unpaid: u32,
}

/// What became of a cell.
struct Built {
    room_left: usize,
    /// Expected cost of a ray that meets the cell, times half the cell's area.
    cost: f64,
}

struct Builder<'a> {
    triangles: &'a Triangles,
    options: &'a KdOptions,
    costs: CostModel,
    /// By how much a cut errs on the safe side.
    slack: f64,
    nodes: Vec<Node>,
    references: Vec<u32>,
    scratch: Scratch,
}

/// Lists that each halving needs anew.
#[derive(Default)]
struct Scratch {
    moves: Vec<Move>,
    /// Places, among the members of each side, of parts of those that straddle the plane.
    parts: [Vec<u32>; 2],
    events: Vec<Event>,
}

impl Builder<'_> {
    /// Adds the nodes of `cell`.
    fn subdivide(&mut self, cell: Cell) -> Built {
        let (area, count, room) = (cell.bounds.half_area(), cell.members.len(), cell.room);
        let as_leaf = Built { room_left: room - room_of_leaf(count), cost: area * count as f64 };
        let start = (self.nodes.len(), self.references.len());
        let Some(Choice { split, unpaid }) = self.choose_split(&cell) else {
            self.add_leaf(cell.members.iter().map(|m| m.index));
            return as_leaf;
        };
        let [lower, mut upper] = self.halve(cell, &split, unpaid);
        let Plane { axis, position, .. } = split.plane;
        // The upper child's index is known only after the lower one's nodes.
        self.nodes.push(Node::Split { axis: axis as u8, position, upper: 0 });
        let lower = self.subdivide(lower);
        let next = self.nodes.len() as u32;
        if let Node::Split { upper, .. } = &mut self.nodes[start.0] {
            *upper = next;
        }
        upper.room += lower.room_left;
        let upper = self.subdivide(upper);
        let cost = area * self.costs.traversal + lower.cost + upper.cost;
        if unpaid > 0 && cost >= as_leaf.cost {
            self.collapse(start);
            return as_leaf;
        }
        Built { room_left: upper.room_left, cost }
    }

    fn add_leaf(&mut self, triangles: impl Iterator<Item = u32>) {
        let first = self.references.len();
        self.references.extend(triangles);
        let count = self.references.len() - first;
        self.nodes.push(Node::Leaf { first: first as u32, count: count as u32 });
    }

    /// Makes one leaf of what has been added since there were so many nodes and references.
    fn collapse(&mut self, (nodes, references): (usize, usize)) {
        let mut listed = self.references.split_off(references);
        listed.sort_unstable();
        listed.dedup();
        self.nodes.truncate(nodes);
        self.add_leaf(listed.into_iter());
    }

    /// Where to halve `cell`; `None` where it is to be a leaf: by the same criteria, whichever rule
    /// proposes the plane.
    fn choose_split(&self, cell: &Cell) -> Option<Choice> {
        let Cell { bounds, members, .. } = cell;
        if cell.depth_left == 0 || members.len() <= self.options.leaf_size as usize || members.is_empty() {
            return None;
        }
        let split = match &cell.events {
            Some(events) => cheapest_split(bounds, members.len(), events, &self.costs)?,
            None => Split::count(choose_plane(self.options, bounds, members)?, members),
        };
        let pays = self.costs.of_split(bounds, &split) < members.len() as f64;
        let unpaid = if pays { 0 } else { cell.unpaid + 1 };
        let fits = split.counts.map(room_of_leaf).into_iter().sum::<usize>() <= cell.room;
        (fits && unpaid <= self.options.lookahead).then_some(Choice { split, unpaid })
    }

    fn halve(&mut self, cell: Cell, split: &Split, unpaid: u32) -> [Cell; 2] {
        let needed = split.counts.map(room_of_leaf);
        let spare = cell.room - needed[0] - needed[1];
        // Shared in proportion; what the lower cell leaves goes to the upper one later.
        let share = (spare as f64 * needed[0] as f64 / (needed[0] + needed[1]) as f64) as usize;
        let [lower_room, upper_room] = [needed[0] + share, needed[1] + (spare - share)];
        let halves = split.plane.halves(&cell.bounds);
        let [lower, upper] = self.distribute(&cell.members, split, &halves);
        let [lower_events, upper_events] = match &cell.events {
            Some(events) => {
                let Scratch { moves, parts, events: scratch } = &mut self.scratch;
                events.divide(moves, [&lower, &upper], parts, scratch).map(Some)
            }
            None => [None, None],
        };
        let child = |bounds, members, events, room| Cell {
            bounds,
            members,
            events,
            depth_left: cell.depth_left - 1,
            unpaid,
            room,
        };
        [child(halves[0], lower, lower_events, lower_room), child(halves[1], upper, upper_events, upper_room)]
    }

    /// What is in each half, at most as many as the split counts: of those whose box straddles
    /// the plane, the parts in both halves. Notes in `scratch` where they went.
    fn distribute(&mut self, members: &[Member], split: &Split, halves: &[Aabb; 2]) -> [Vec<Member>; 2] {
        let mut sides = split.counts.map(Vec::with_capacity);
        let Scratch { moves, parts, .. } = &mut self.scratch;
        moves.clear();
        parts.iter_mut().for_each(Vec::clear);
        for member in members {
            match split.plane.place(member) {
                Place::Only(side) => {
                    let list = &mut sides[side as usize];
                    moves.push(Move::to(side, list.len()));
                    list.push(*member);
                }
                Place::Both => {
                    moves.push(Move::STRADDLES);
                    for side in [Side::Lower, Side::Upper].map(|side| side as usize) {
                        if let Some(part) = member.within(&halves[side], self.triangles, self.slack) {
                            parts[side].push(sides[side].len() as u32);
                            sides[side].push(part);
                        }
                    }
                }
            }
        }
        sides
    }
}
