use super::branch::Branch;
use super::cost::CostModel;
use super::events::{Events, Move};
use super::member::Member;
use super::options::{KdOptions, SplitRule};
use super::plane::{Place, Split};
use super::rules::choose_plane;
use super::sweep::cheapest_split;
use super::tree::KdTree;
use crate::{Aabb, GeomError, Triangles};

/// Leaves references and nodes countable in `u32`.
const MAX_REFERENCES: usize = 1 << 31;

/// What may yet be spent on a cell and all below it.
#[derive(Clone, Copy)]
struct Budget {
    /// Room that the leaves may take: one for each reference, and one for an empty leaf, so that nodes
    /// are bounded too. What is taken out again gives its room back.
    room: usize,
    /// Room that the halves of cells on trial may take, in all; what is taken out again has spent it.
    trials: usize,
}

impl Budget {
    /// That of a tree over `count` triangles.
    fn of_tree(count: usize) -> Self {
        let room = (8 * count).clamp(1, MAX_REFERENCES);
        Self { room, trials: room.saturating_mul(KdTree::MAX_DEPTH as usize) }
    }

    /// What is left for each half of a cell, shared in proportion to what the halves need at once. What the
    /// lower one leaves goes to the upper one later.
    fn share(self, needed: [usize; 2], on_trial: bool) -> [Self; 2] {
        let both = needed[0] + needed[1];
        let lower = |spare: usize| (spare as f64 * needed[0] as f64 / both as f64) as usize;
        let (room, trials) = (self.room - both, self.trials - if on_trial { both } else { 0 });
        let (lower_room, lower_trials) = (lower(room), lower(trials));
        [
            Self { room: needed[0] + lower_room, trials: lower_trials },
            Self { room: needed[1] + (room - lower_room), trials: trials - lower_trials },
        ]
    }
}

impl std::ops::Add for Budget {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { room: self.room + other.room, trials: self.trials + other.trials }
    }
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
    /// Memory and work are bounded beforehand, whatever the options. Over `n` live triangles the leaves hold
    /// at most `b = 8 n` references (never more than `2^31`), there are fewer than `2 b` nodes (one over
    /// nothing), and the tree is at most [`KdTree::MAX_DEPTH`] deep. Planes that do not pay by themselves
    /// ([`KdOptions::lookahead`]), and all planes below them, are tried as long as their halves hold `60 b`
    /// references in all. Building takes at most `200 n + 240 b + 1024`
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
            on_trial: false,
            budget: Budget::of_tree(live.len()),
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
    /// Whether some plane above did not pay by itself, and may be taken out again.
    on_trial: bool,
    /// Enough to make this cell a leaf.
    budget: Budget,
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
    /// Whether this plane or one above does not pay by itself.
    on_trial: bool,
}

/// What became of a cell.
struct Built {
    /// Of the cell's budget.
    left: Budget,
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
/// do not pass on what is left to each other.
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
        let (area, count, budget) = (cell.bounds.half_area(), cell.members.len(), cell.budget);
        let left = Budget { room: budget.room - room_of_leaf(count), ..budget };
        let as_leaf = Built { left, cost: area * count as f64 };
        let start = branch.len();
        let Some(choice) = self.choose_split(&cell) else {
            branch.add_leaf(cell.members);
            return as_leaf;
        };
        let halves = self.halve(cell, &choice, moves);
        branch.add_split(&choice.split.plane);
        let Built { left, cost } = if count < SIDE_BY_SIDE {
            self.one_by_one(halves, branch, moves)
        } else {
            // Freed for those below, who have their own.
            *moves = Vec::new();
            self.side_by_side(halves, branch)
        };
        let cost = area * self.costs.traversal + cost;
        if choice.unpaid > 0 && cost >= as_leaf.cost {
            branch.collapse(start);
            let left = Budget { room: as_leaf.left.room, ..left };
            return Built { left, ..as_leaf };
        }
        Built { left, cost }
    }

    /// Adds the nodes of both halves of a cell whose own node comes last in `branch`.
    fn one_by_one(&self, [lower, mut upper]: [Cell; 2], branch: &mut Branch, moves: &mut Vec<Move>) -> Built {
        let parent = branch.nodes.len() - 1;
        let lower = self.subdivide(lower, branch, moves);
        branch.point_to_upper(parent);
        upper.budget = upper.budget + lower.left;
        let upper = self.subdivide(upper, branch, moves);
        Built { left: upper.left, cost: lower.cost + upper.cost }
    }

    /// The same on two threads, where there are two.
    fn side_by_side(&self, [lower, upper]: [Cell; 2], branch: &mut Branch) -> Built {
        let parent = branch.nodes.len() - 1;
        let ((lower_branch, lower), (upper_branch, upper)) =
            rayon::join(|| self.grow(lower), || self.grow(upper));
        branch.append(&lower_branch);
        branch.point_to_upper(parent);
        branch.append(&upper_branch);
        Built { left: lower.left + upper.left, cost: lower.cost + upper.cost }
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
            None => {
                Split::count(choose_plane(self.options, bounds, members)?, members.iter().map(|m| &m.bounds))
            }
        };
        let pays = self.costs.of_split(bounds, &split) < members.len() as f64;
        let unpaid = if pays { 0 } else { cell.unpaid + 1 };
        let on_trial = cell.on_trial || !pays;
        let needed: usize = split.counts.map(room_of_leaf).into_iter().sum();
        let fits = needed <= cell.budget.room && (!on_trial || needed <= cell.budget.trials);
        (fits && unpaid <= self.options.lookahead).then_some(Choice { split, unpaid, on_trial })
    }

    fn halve(&self, cell: Cell, choice: &Choice, moves: &mut Vec<Move>) -> [Cell; 2] {
        let &Choice { ref split, unpaid, on_trial } = choice;
        let budgets = cell.budget.share(split.counts.map(room_of_leaf), on_trial);
        let halves = split.plane.halves(&cell.bounds);
        let ([lower, upper], parts) = self.distribute(&cell, split, moves);
        let [lower_events, upper_events] = match &cell.events {
            Some(events) => events.divide(moves, [&lower, &upper], parts).map(Some),
            None => [None, None],
        };
        let child = |bounds, members, events, budget| Cell {
            bounds,
            members,
            events,
            depth_left: cell.depth_left - 1,
            unpaid,
            on_trial,
            budget,
        };
        [child(halves[0], lower, lower_events, budgets[0]), child(halves[1], upper, upper_events, budgets[1])]
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
            let place = split.plane.place(&member.bounds);
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
        for member in cell.members.iter().filter(|member| split.plane.place(&member.bounds) == Place::Both) {
            let halves = member.halves(&cell.bounds, &split.plane, self.triangles, self.slack);
            for (list, part) in sides.iter_mut().zip(halves) {
                list.extend(part);
            }
        }
        (sides, parts)
    }
}
