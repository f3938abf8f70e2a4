use super::branch::Branch;
use super::cost::CostModel;
use super::events::{Events, Move};
use super::member::Member;
use super::plane::{Place, Split};
use super::rules::choose_plane;
use super::sweep::cheapest_split;
use super::{KdOptions, KdTree, SplitRule};
use crate::{Aabb, GeomError, Triangles};

/// Leaves references and nodes countable in `u32`.
const MAX_REFERENCES: usize = 1 << 31;

/// The room that the leaves of a tree over `count` triangles may take; see [`Cell::room`].
fn room_for(count: usize) -> usize {
    (8 * count).clamp(1, MAX_REFERENCES)
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
    /// Large cells are built side by side on the threads of the current rayon pool; the tree is the
    /// same for any number of them.
    ///
    /// Memory is bounded beforehand. Over `n` live triangles the leaves hold at most `b = 8 n`
    /// references (never more than `2^31`), there are fewer than `2 b` nodes (one over nothing), and
    /// the tree is at most [`KdTree::MAX_DEPTH`] deep. Building takes at most `200 n + 240 b + 1024`
    /// bytes beside the triangles: for each triangle in the cell that is being halved, and for each of
    /// `b`, a box and its six events, 76 bytes; and for each of `b` a box and two nodes, 52 bytes, in
    /// vectors that hold up to three times their content while they grow; this on any number of threads,
    /// since what is being halved, its halves and what is finished never take a reference's room at once.
    /// Closed meshes take 170 to 300 `n` on one thread by the surface area heuristic, and up to 410 `n` by
    /// other rules; long triangles up to 800 `n` (measured).
    ///
    /// # Errors
    /// [`GeomError::Param`] for an option out of its range.
    pub fn build(triangles: &Triangles, options: &KdOptions) -> Result<Self, GeomError> {
        Ok(Self::build_with_members(triangles, options)?.0)
    }

    /// Builds the tree; also returns what of the triangles is in the leaves, one for each reference.
    pub(crate) fn build_with_members(
        triangles: &Triangles,
        options: &KdOptions,
    ) -> Result<(Self, Vec<Member>), GeomError> {
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
        let builder =
            Builder { triangles, options, costs: options.costs(), slack: slack_for(&triangles.bounds()) };
        let (Branch { mut nodes, members }, _) = builder.grow(everything);
        nodes.shrink_to_fit();
        let references = members.iter().map(|m| m.index).collect();
        Ok((Self { triangles: triangles.clone(), nodes, references }, members))
    }
}

/// A cell that may yet be halved.
struct Cell {
    bounds: Aabb,
    /// What touches it.
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

/// What all cells share.
struct Builder<'a> {
    triangles: &'a Triangles,
    options: &'a KdOptions,
    costs: CostModel,
    /// By how much a cut errs on the safe side.
    slack: f64,
}

/// The halves of a cell with so many members are built side by side. Part of what a tree is: they
/// do not pass on room to each other.
const SIDE_BY_SIDE: usize = 4096;

impl Builder<'_> {
    /// Builds a branch of its own out of `cell`.
    fn grow(&self, cell: Cell) -> (Branch, Built) {
        let mut branch = Branch::default();
        let built = self.subdivide(cell, &mut branch, &mut Vec::new());
        (branch, built)
    }

    /// Adds the nodes of `cell` to `branch`.
    fn subdivide(&self, cell: Cell, branch: &mut Branch, moves: &mut Vec<Move>) -> Built {
        let (area, count, room) = (cell.bounds.half_area(), cell.members.len(), cell.room);
        let as_leaf = Built { room_left: room - room_of_leaf(count), cost: area * count as f64 };
        let start = branch.len();
        let Some(Choice { split, unpaid }) = self.choose_split(&cell) else {
            branch.add_leaf(cell.members);
            return as_leaf;
        };
        let halves = self.halve(cell, &split, unpaid, moves);
        branch.add_split(&split.plane);
        let Built { room_left, cost } = if count < SIDE_BY_SIDE {
            self.one_by_one(halves, branch, moves)
        } else {
            // Freed for those below, who have their own.
            *moves = Vec::new();
            self.side_by_side(halves, branch)
        };
        let cost = area * self.costs.traversal + cost;
        if unpaid > 0 && cost >= as_leaf.cost {
            branch.collapse(start);
            return as_leaf;
        }
        Built { room_left, cost }
    }

    /// Adds the nodes of both halves of a cell whose own node comes last in `branch`.
    fn one_by_one(&self, [lower, mut upper]: [Cell; 2], branch: &mut Branch, moves: &mut Vec<Move>) -> Built {
        let parent = branch.nodes.len() - 1;
        let lower = self.subdivide(lower, branch, moves);
        branch.point_to_upper(parent);
        upper.room += lower.room_left;
        let upper = self.subdivide(upper, branch, moves);
        Built { room_left: upper.room_left, cost: lower.cost + upper.cost }
    }

    /// The same on two threads, where there are two.
    fn side_by_side(&self, [lower, upper]: [Cell; 2], branch: &mut Branch) -> Built {
        let parent = branch.nodes.len() - 1;
        let ((lower_branch, lower), (upper_branch, upper)) =
            rayon::join(|| self.grow(lower), || self.grow(upper));
        branch.append(&lower_branch);
        branch.point_to_upper(parent);
        branch.append(&upper_branch);
        Built { room_left: lower.room_left + upper.room_left, cost: lower.cost + upper.cost }
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

    fn halve(&self, cell: Cell, split: &Split, unpaid: u32, moves: &mut Vec<Move>) -> [Cell; 2] {
        let needed = split.counts.map(room_of_leaf);
        let spare = cell.room - needed[0] - needed[1];
        // Shared in proportion; what the lower cell leaves goes to the upper one later.
        let share = (spare as f64 * needed[0] as f64 / (needed[0] + needed[1]) as f64) as usize;
        let [lower_room, upper_room] = [needed[0] + share, needed[1] + (spare - share)];
        let halves = split.plane.halves(&cell.bounds);
        let ([lower, upper], parts) = self.distribute(&cell, split, moves);
        let [lower_events, upper_events] = match &cell.events {
            Some(events) => events.divide(moves, [&lower, &upper], parts).map(Some),
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

    /// What is in each half, at most as many as the split counts: the members on its side of the
    /// plane, and, from the returned places on, the parts of those that straddle it. Notes in
    /// `moves` where they went.
    fn distribute(
        &self,
        cell: &Cell,
        split: &Split,
        moves: &mut Vec<Move>,
    ) -> ([Vec<Member>; 2], [usize; 2]) {
        moves.clear();
        let mut sides = split.counts.map(Vec::with_capacity);
        for member in &cell.members {
            let place = split.plane.place(member);
            let end = match place {
                Place::Both => 0,
                Place::Lower | Place::Upper => {
                    let side = &mut sides[place as usize];
                    side.push(*member);
                    side.len() - 1
                }
            };
            moves.push(Move::to(place, end));
        }
        let parts = sides.each_ref().map(Vec::len);
        for member in cell.members.iter().filter(|member| split.plane.place(member) == Place::Both) {
            let halves = member.halves(&cell.bounds, &split.plane, self.triangles, self.slack);
            for (list, part) in sides.iter_mut().zip(halves) {
                list.extend(part);
            }
        }
        (sides, parts)
    }
}
