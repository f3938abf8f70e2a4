use super::branch::Branch;
use super::cost::CostModel;
use super::events::{Events, Move};
use super::options::{KdOptions, SplitRule};
use super::plane::{Place, Split};
use super::rules::choose_plane;
use super::sweep::cheapest_split;
use super::tree::KdTree;
use crate::accel::prim_ref::PrimRef;
use crate::{Aabb, GeomError, Triangles};

/// Keeps the indices of references and nodes within `u32`.
const MAX_REFERENCES: usize = 1 << 31;

/// The budget of a cell and all cells below it.
#[derive(Clone, Copy)]
struct Budget {
    /// The room for leaves: 1 per reference, and 1 per empty leaf, so that the number of nodes is bounded
    /// too. Collapsing a subtree frees its room.
    room: usize,
    /// The total room that the halves of cells on trial may take. Collapsing does not return it.
    trials: usize,
}

impl Budget {
    /// The budget of a tree over `count` triangles.
    fn of_tree(count: usize) -> Self {
        let room = (8 * count).clamp(1, MAX_REFERENCES);
        Self { room, trials: room.saturating_mul(KdTree::MAX_DEPTH as usize) }
    }

    /// The budgets of the halves of a cell, in proportion to the room that they need as leaves.
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

/// The slack of clipping: far below the resolution of `f32` coordinates, far above the rounding of `f64`.
fn slack_for(bounds: &Aabb) -> f64 {
    let largest = bounds.min.abs().max(bounds.max.abs()).max_element();
    // Zero for the empty box, whose coordinates are infinite.
    if largest.is_finite() { f64::from(largest) * 2.0_f64.powi(-40) } else { 0.0 }
}

impl KdTree {
    /// [`KdTree::build_with`] default options: by the surface area heuristic.
    ///
    /// # Errors
    /// None; the result has the type that all builders share.
    pub fn build(triangles: &Triangles) -> Result<Self, GeomError> {
        Self::build_with(triangles, &KdOptions::default())
    }

    /// Builds the tree.
    ///
    /// The surface area heuristic takes time `O(N log N)` for `N` references in the leaves. Large cells are
    /// built in parallel on the current rayon thread pool; the tree is the same for any number of threads.
    ///
    /// Memory and work are bounded for all options. Over `n` live triangles, the leaves hold at most `b = 8
    /// n` references, and never more than `2^31`. There are fewer than `2 b` nodes (one node for an empty
    /// scene), and the depth is at most [`KdTree::MAX_DEPTH`]. Splits that do not pay
    /// ([`KdOptions::lookahead`]), and all splits below them, are tried until their halves have held `60 b`
    /// references in total.
    ///
    /// Building takes at most `200 n + 240 b + 1024` bytes beside the triangles, on any number of threads: 76
    /// bytes for each triangle of the split cell and for each of `b`, for a box and its six events; and 52
    /// bytes for each of `b`, for a box and two nodes, in vectors that hold up to three times their content
    /// while they grow. Measured on one thread, closed meshes take 170 to 300 `n` bytes by the surface area
    /// heuristic and up to 410 `n` by other rules; long triangles take up to 800 `n`.
    ///
    /// # Errors
    /// [`GeomError::Param`] for an option out of its range.
    pub fn build_with(triangles: &Triangles, options: &KdOptions) -> Result<Self, GeomError> {
        Ok(Self::build_with_refs(triangles, options)?.0)
    }

    /// Builds the tree; also returns its references with their bounds, in the same order.
    pub(crate) fn build_with_refs(
        triangles: &Triangles,
        options: &KdOptions,
    ) -> Result<(Self, Vec<PrimRef>), GeomError> {
        options.validate()?;
        let live = triangles.live();
        let refs: Vec<PrimRef> = live.iter().map(|&i| PrimRef::new(triangles, i)).collect();
        let root = Cell {
            bounds: triangles.bounds(),
            events: (options.rule == SplitRule::SurfaceArea).then(|| Events::new(&refs)),
            refs,
            depth_left: options.max_depth.min(Self::MAX_DEPTH),
            unpaid: 0,
            on_trial: false,
            budget: Budget::of_tree(live.len()),
        };
        let builder =
            Builder { triangles, options, costs: options.costs(), slack: slack_for(&triangles.bounds()) };
        let (Branch { mut nodes, refs }, _) = builder.grow(root);
        nodes.shrink_to_fit();
        let references = refs.iter().map(|reference| reference.index).collect();
        Ok((Self { triangles: triangles.clone(), nodes, references }, refs))
    }
}

/// A cell to be split or made a leaf.
struct Cell {
    bounds: Aabb,
    refs: Vec<PrimRef>,
    /// The sorted faces of the references' boxes, for the surface area heuristic.
    events: Option<Events>,
    depth_left: u32,
    /// The number of consecutive planes directly above that do not pay.
    unpaid: u32,
    /// Whether any plane above does not pay, so that it may be removed again.
    on_trial: bool,
    /// At least the room of this cell as a leaf.
    budget: Budget,
}

/// The room of a leaf with `count` references.
fn room_of_leaf(count: usize) -> usize {
    count.max(1)
}

/// A chosen split of a cell.
struct Choice {
    split: Split,
    /// The number of consecutive planes that do not pay, this one the last.
    unpaid: u32,
    /// Whether this plane or one above does not pay.
    on_trial: bool,
}

/// The result of building a cell.
struct Built {
    /// The rest of the cell's budget.
    left: Budget,
    /// The expected cost of a ray that intersects the cell, times half the cell's area.
    cost: f64,
}

/// What all cells share.
struct Builder<'a> {
    triangles: &'a Triangles,
    options: &'a KdOptions,
    costs: CostModel,
    /// The margin of conservative clipping.
    slack: f64,
}

/// Cells with at least this many references build their halves in parallel. The tree depends on it: parallel
/// halves do not pass on the rest of their budgets to each other.
const PARALLEL_MIN: usize = 4096;

impl Builder<'_> {
    /// Builds a separate branch from `cell`.
    fn grow(&self, cell: Cell) -> (Branch, Built) {
        let mut branch = Branch::default();
        let built = self.subdivide(cell, &mut branch, &mut Vec::new());
        (branch, built)
    }

    /// Appends the nodes of `cell` to `branch`.
    fn subdivide(&self, cell: Cell, branch: &mut Branch, moves: &mut Vec<Move>) -> Built {
        let (area, count, budget) = (cell.bounds.half_area(), cell.refs.len(), cell.budget);
        let left = Budget { room: budget.room - room_of_leaf(count), ..budget };
        let as_leaf = Built { left, cost: area * count as f64 };
        let start = branch.len();
        let Some(choice) = self.choose_split(&cell) else {
            branch.add_leaf(cell.refs);
            return as_leaf;
        };
        let halves = self.halve(cell, &choice, moves);
        branch.add_split(&choice.split.plane);
        let Built { left, cost } = if count < PARALLEL_MIN {
            self.build_sequentially(halves, branch, moves)
        } else {
            // Free the buffer: the branches below have their own.
            *moves = Vec::new();
            self.build_in_parallel(halves, branch)
        };
        let cost = area * self.costs.traversal + cost;
        if choice.unpaid > 0 && cost >= as_leaf.cost {
            branch.collapse(start);
            let left = Budget { room: as_leaf.left.room, ..left };
            return Built { left, ..as_leaf };
        }
        Built { left, cost }
    }

    /// Appends the nodes of both halves of a cell, whose own node is the last of `branch`. The upper half
    /// also gets the rest of the lower half's budget.
    fn build_sequentially(
        &self,
        [lower, mut upper]: [Cell; 2],
        branch: &mut Branch,
        moves: &mut Vec<Move>,
    ) -> Built {
        let parent = branch.nodes.len() - 1;
        let lower = self.subdivide(lower, branch, moves);
        branch.point_to_upper(parent);
        upper.budget = upper.budget + lower.left;
        let upper = self.subdivide(upper, branch, moves);
        Built { left: upper.left, cost: lower.cost + upper.cost }
    }

    /// Appends the nodes of both halves, built in parallel with separate budgets.
    fn build_in_parallel(&self, [lower, upper]: [Cell; 2], branch: &mut Branch) -> Built {
        let parent = branch.nodes.len() - 1;
        let ((lower_branch, lower), (upper_branch, upper)) =
            rayon::join(|| self.grow(lower), || self.grow(upper));
        branch.append(&lower_branch);
        branch.point_to_upper(parent);
        branch.append(&upper_branch);
        Built { left: lower.left + upper.left, cost: lower.cost + upper.cost }
    }

    /// The split of `cell`; `None` if it becomes a leaf. The leaf criteria are the same for all rules.
    fn choose_split(&self, cell: &Cell) -> Option<Choice> {
        let Cell { bounds, refs, .. } = cell;
        if cell.depth_left == 0 || refs.len() <= self.options.leaf_size as usize || refs.is_empty() {
            return None;
        }
        let split = match &cell.events {
            Some(events) => cheapest_split(bounds, refs.len(), events, &self.costs)?,
            None => Split::count(
                choose_plane(self.options, bounds, refs)?,
                refs.iter().map(|reference| &reference.bounds),
            ),
        };
        let pays = self.costs.of_split(bounds, &split) < refs.len() as f64;
        let unpaid = if pays { 0 } else { cell.unpaid + 1 };
        let on_trial = cell.on_trial || !pays;
        let needed: usize = split.counts.map(room_of_leaf).into_iter().sum();
        let fits = needed <= cell.budget.room && (!on_trial || needed <= cell.budget.trials);
        (fits && unpaid <= self.options.lookahead).then_some(Choice { split, unpaid, on_trial })
    }

    /// The two halves of `cell`, with their references, events and budgets.
    fn halve(&self, cell: Cell, choice: &Choice, moves: &mut Vec<Move>) -> [Cell; 2] {
        let &Choice { ref split, unpaid, on_trial } = choice;
        let budgets = cell.budget.share(split.counts.map(room_of_leaf), on_trial);
        let halves = split.plane.halves(&cell.bounds);
        let ([lower, upper], parts) = self.distribute(&cell, split, moves);
        let [lower_events, upper_events] = match &cell.events {
            Some(events) => events.divide(moves, [&lower, &upper], parts).map(Some),
            None => [None, None],
        };
        let child = |bounds, refs, events, budget| Cell {
            bounds,
            refs,
            events,
            depth_left: cell.depth_left - 1,
            unpaid,
            on_trial,
            budget,
        };
        [child(halves[0], lower, lower_events, budgets[0]), child(halves[1], upper, upper_events, budgets[1])]
    }

    /// The references of each half, at most as many as the split counts: first the references on its side of the
    /// plane, then, from the returned indices on, the parts of those that straddle it. Stores in `moves`
    /// where each reference went.
    fn distribute(
        &self,
        cell: &Cell,
        split: &Split,
        moves: &mut Vec<Move>,
    ) -> ([Vec<PrimRef>; 2], [usize; 2]) {
        moves.clear();
        let mut sides = split.counts.map(Vec::with_capacity);
        for reference in &cell.refs {
            let place = split.plane.place(&reference.bounds);
            let end = match place {
                Place::Both => 0,
                Place::Lower | Place::Upper => {
                    let side = &mut sides[place as usize];
                    side.push(*reference);
                    side.len() - 1
                }
            };
            moves.push(Move::to(place, end));
        }
        let parts = sides.each_ref().map(Vec::len);
        for reference in
            cell.refs.iter().filter(|reference| split.plane.place(&reference.bounds) == Place::Both)
        {
            let halves = reference.halves(&cell.bounds, &split.plane, self.triangles, self.slack);
            for (list, part) in sides.iter_mut().zip(halves) {
                list.extend(part);
            }
        }
        (sides, parts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conformance::shapes::statue;

    #[test]
    fn any_number_of_threads_builds_the_same_tree() {
        let triangles = Triangles::new(statue(60_000).triangles()).expect("a valid mesh");
        let tree = |threads: usize, rule| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            let options = KdOptions { lookahead: 1, ..KdOptions::by_rule(rule) };
            let tree =
                pool.install(|| KdTree::build_with(&triangles, &options)).expect("the tree can be built");
            format!("{:?}, {:?}", tree.nodes, tree.references)
        };
        for rule in [SplitRule::SurfaceArea, SplitRule::SlidingMidpoint] {
            let one = tree(1, rule);
            assert!(one.len() > 1_000_000);
            for threads in [2, 5] {
                assert!(one == tree(threads, rule), "{rule:?}, {threads} threads");
            }
        }
    }
}
