//! The binary tree that is made a wide one: the cells of a k-d tree, and below its leaves parts of
//! what they hold, down to what fits into a block.

use super::halve::halve;
use super::simd::LANES;
use super::space::{power_of_two_below, power_of_two_inverse};
use crate::kdtree::{KdTree, Member, Node as Binary};
use crate::{Aabb, Accel};
use rayon::prelude::*;

/// Most levels below a leaf of the k-d tree. Half of them are enough to halve any number of triangles.
pub(super) const MAX_LEVELS: u32 = 60;

/// A subtree.
#[derive(Clone, Copy, Debug)]
pub(super) struct Subtree {
    /// The box of what it holds.
    pub(super) bounds: Aabb,
    pub(super) content: Content,
    /// The least expected number of nodes that a ray visits, in proportion, if the subtree is given
    /// 1, 2, .. 8 lanes of a node (Ylitie, Karras and Laine, 2017, section 3).
    costs: [f32; LANES],
}

/// What is in a subtree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Content {
    /// Triangles for one block; none only where the whole tree has none.
    Block { first: u32, count: u32 },
    /// Two parts: the next subtree, which is lower along the axis, and subtree `upper`.
    Parts { axis: u8, upper: u32 },
}

/// Subtrees, depth first. Where a cell of the tree has nothing in one half, its other half alone is here.
#[derive(Debug)]
pub(super) struct Subtrees {
    all: Vec<Subtree>,
    /// What makes the scene's surface, times it, a number for which `f32` has range enough: a power of
    /// two, so that costs do not depend on the unit of length.
    area_scale: f64,
}

impl Subtrees {
    /// Those of a tree. `members`, what is in its leaves, one for each reference, are reordered
    /// within each leaf, so that those of a block come one after another.
    ///
    /// Leaves are parted side by side on the threads of the current rayon pool.
    pub(super) fn new(tree: &KdTree, members: &mut [Member]) -> Self {
        let area = tree.bounds().half_area();
        let area_scale = if area > 0.0 { power_of_two_inverse(power_of_two_below(area)) } else { 1.0 };
        let (mut leaves, mut rest) = (Vec::new(), members);
        for node in &tree.nodes {
            if let Binary::Leaf { first, count: count @ 1.. } = *node {
                let (leaf, others) = rest.split_at_mut(count as usize);
                leaves.push((first, leaf));
                rest = others;
            }
        }
        let part = |(first, leaf): (u32, &mut [Member])| {
            let mut parts = Self { all: Vec::new(), area_scale };
            parts.add_members(first, leaf, MAX_LEVELS);
            parts
        };
        let leaves: Vec<Self> = leaves.into_par_iter().map(part).collect();
        // Each plane has something on both sides.
        let planes = leaves.len().saturating_sub(1);
        let count = planes + leaves.iter().map(|leaf| leaf.all.len()).sum::<usize>();
        let mut this = Self { all: Vec::with_capacity(count), area_scale };
        if leaves.is_empty() {
            this.add_members(0, &mut [], MAX_LEVELS);
        } else {
            this.add_cell(tree, 0, &mut leaves.iter());
        }
        this
    }

    pub(super) fn get(&self, at: u32) -> &Subtree {
        &self.all[at as usize]
    }

    /// How many lanes the lower part of a subtree gets, if it is opened into `lanes` of them, at
    /// least 2, and what that costs.
    fn share(&self, at: u32, lanes: usize) -> (usize, f32) {
        let Content::Parts { upper, .. } = self.get(at).content else { return (0, 0.0) };
        let (low, high) = (self.get(at + 1), self.get(upper));
        let cost = |first: usize| (first, low.costs[first - 1] + high.costs[lanes - first - 1]);
        (2..lanes).map(cost).fold(cost(1), |best, next| if next.1 < best.1 { next } else { best })
    }

    /// How many lanes the lower part of a subtree of two gets, if opening it into up to `lanes` of them is
    /// better than to give it one; the upper part gets the others. Either gets one at least.
    pub(super) fn opening(&self, at: u32, lanes: usize, must_open: bool) -> Option<usize> {
        if lanes < 2 {
            return None;
        }
        let (lower, cost) = self.share(at, lanes);
        (must_open || cost < self.get(at).costs[0]).then_some(lower)
    }

    /// Adds a cell of the tree, one with something in it, and all below; the next of `leaves` are those
    /// in it that have something in them.
    fn add_cell(&mut self, tree: &KdTree, cell: u32, leaves: &mut std::slice::Iter<'_, Self>) {
        match tree.nodes[cell as usize] {
            Binary::Leaf { .. } => {
                if let Some(leaf) = leaves.next() {
                    self.append(leaf);
                }
            }
            Binary::Split { upper, .. } if is_empty(tree, upper) => self.add_cell(tree, cell + 1, leaves),
            Binary::Split { upper, .. } if is_empty(tree, cell + 1) => self.add_cell(tree, upper, leaves),
            Binary::Split { axis, upper, .. } => {
                let at = self.begin(axis);
                self.add_cell(tree, cell + 1, leaves);
                self.point_to_upper(at);
                self.add_cell(tree, upper, leaves);
                self.finish(at);
            }
        }
    }

    /// Adds all of `other`.
    fn append(&mut self, other: &Self) {
        let start = self.all.len() as u32;
        self.all.extend(other.all.iter().map(|subtree| match subtree.content {
            Content::Block { .. } => *subtree,
            Content::Parts { axis, upper } => {
                Subtree { content: Content::Parts { axis, upper: upper + start }, ..*subtree }
            }
        }));
    }

    /// Adds members, of which the first is number `first` of all, parted into blocks.
    fn add_members(&mut self, first: u32, members: &mut [Member], levels_left: u32) {
        if members.len() <= LANES {
            let bounds = members.iter().fold(Aabb::EMPTY, |all, m| all.union(&m.bounds));
            let content = Content::Block { first, count: members.len() as u32 };
            self.all.push(Subtree { bounds, content, costs: [0.0; LANES] });
            return;
        }
        let (axis, lower) = halve(members, levels_left <= MAX_LEVELS / 2);
        let (low, high) = members.split_at_mut(lower);
        let at = self.begin(axis);
        self.add_members(first, low, levels_left - 1);
        self.point_to_upper(at);
        self.add_members(first + lower as u32, high, levels_left - 1);
        self.finish(at);
    }

    /// Adds a subtree of two parts, and returns where it is.
    fn begin(&mut self, axis: u8) -> usize {
        let content = Content::Parts { axis, upper: 0 };
        self.all.push(Subtree { bounds: Aabb::EMPTY, content, costs: [0.0; LANES] });
        self.all.len() - 1
    }

    /// Makes the subtree that is added next the upper part of the one at `at`.
    fn point_to_upper(&mut self, at: usize) {
        let next = self.all.len() as u32;
        if let Content::Parts { upper, .. } = &mut self.all[at].content {
            *upper = next;
        }
    }

    /// Finds the box and the costs of the subtree at `at`, now that its parts are there.
    fn finish(&mut self, at: usize) {
        let Content::Parts { upper, .. } = self.all[at].content else { return };
        let bounds = self.all[at + 1].bounds.union(&self.get(upper).bounds);
        let mut costs = [0.0; LANES];
        costs[0] = (bounds.half_area() * self.area_scale) as f32 + self.share(at as u32, LANES).1;
        for lanes in 2..=LANES {
            costs[lanes - 1] = self.share(at as u32, lanes).1.min(costs[lanes - 2]);
        }
        (self.all[at].bounds, self.all[at].costs) = (bounds, costs);
    }
}

/// Whether nothing is in a cell of the tree.
fn is_empty(tree: &KdTree, cell: u32) -> bool {
    match tree.nodes[cell as usize] {
        Binary::Leaf { count, .. } => count == 0,
        Binary::Split { upper, .. } => is_empty(tree, cell + 1) && is_empty(tree, upper),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conformance::shapes::icosphere;
    use crate::{KdOptions, Triangles, WideKdTree};
    use glam::{DVec3, Vec3};

    fn member(min: Vec3, max: Vec3) -> Member {
        Member { index: 0, bounds: Aabb { min, max } }
    }

    fn nothing() -> Subtrees {
        Subtrees { all: Vec::new(), area_scale: 1.0 }
    }

    /// Adds a subtree of the parts that `lower` and `upper` add.
    fn add_parts(all: &mut Subtrees, lower: impl Fn(&mut Subtrees), upper: impl Fn(&mut Subtrees)) {
        let at = all.begin(0);
        lower(all);
        all.point_to_upper(at);
        upper(all);
        all.finish(at);
    }

    /// A block in the unit cube at `x`.
    fn add_block(all: &mut Subtrees, x: u8) {
        let min = f32::from(x) * Vec3::X;
        all.add_members(0, &mut [member(min, min + 1.0)], MAX_LEVELS);
    }

    /// The blocks from `x` to 9, parted off one after another.
    fn add_row(all: &mut Subtrees, x: u8, is_mirrored: bool) {
        let first = |all: &mut Subtrees| add_block(all, x);
        let others = |all: &mut Subtrees| add_row(all, x + 1, is_mirrored);
        match (x, is_mirrored) {
            (9, _) => first(all),
            (_, false) => add_parts(all, first, others),
            (_, true) => add_parts(all, others, first),
        }
    }

    /// Two blocks in one place.
    fn add_pair(all: &mut Subtrees) {
        add_parts(all, |all| add_block(all, 0), |all| add_block(all, 0));
    }

    /// Half the surface of `n` blocks in a row is `1 + 2 n`. In seven lanes of eight go blocks; what is left
    /// goes in the last one, and is a node.
    #[test]
    fn lanes_are_shared_so_that_the_fewest_nodes_are_visited() {
        for is_mirrored in [false, true] {
            let mut row = nothing();
            add_row(&mut row, 0, is_mirrored);
            assert_eq!(row.get(0).costs, [28.0, 24.0, 17.0, 15.0, 13.0, 11.0, 9.0, 7.0]);
            for lanes in 2..=LANES {
                let first = if is_mirrored { lanes - 1 } else { 1 };
                assert_eq!(row.opening(0, lanes, false), Some(first), "{lanes} lanes");
            }
            assert_eq!(row.opening(0, 1, false), None);
        }
    }

    #[test]
    fn what_lies_in_one_place_is_opened_only_into_lanes_enough() {
        let mut pairs = nothing();
        add_parts(&mut pairs, add_pair, add_pair);
        // Another node instead of this one saves nothing.
        assert_eq!([2, 3].map(|lanes| pairs.opening(0, lanes, false)), [None; 2]);
        assert_eq!([2, 3].map(|lanes| pairs.opening(0, lanes, true)), [Some(1); 2]);
        assert_eq!(pairs.opening(0, 4, false), Some(2));
    }

    fn contents(nodes: Vec<Binary>, members: &mut [Member]) -> Vec<Content> {
        let triangles = Triangles::new(Vec::new()).unwrap();
        let mut tree = KdTree::build(&triangles, &KdOptions::default()).unwrap();
        tree.nodes = nodes;
        Subtrees::new(&tree, members).all.iter().map(|subtree| subtree.content).collect()
    }

    #[test]
    fn an_empty_half_is_no_subtree() {
        let split = |axis, upper| Binary::Split { axis, position: 0.0, upper };
        let leaf = |first, count| Binary::Leaf { first, count };
        let block = |first, count| Content::Block { first, count };
        let nodes = vec![
            split(0, 4),
            split(1, 3),
            leaf(0, 0),
            leaf(0, 0),
            split(2, 8),
            split(0, 7),
            leaf(0, 0),
            leaf(0, 2),
            split(1, 10),
            leaf(2, 3),
            leaf(5, 0),
        ];
        let parts = Content::Parts { axis: 2, upper: 2 };
        let five = &mut [member(Vec3::ZERO, Vec3::ONE); 5];
        assert_eq!(contents(nodes, five), [parts, block(0, 2), block(2, 3)]);
        for nodes in [vec![leaf(0, 0)], vec![split(1, 2), leaf(0, 0), leaf(0, 0)]] {
            assert_eq!(contents(nodes, &mut []), [block(0, 0)]);
        }
    }

    fn levels(all: &Subtrees, at: u32) -> u32 {
        match all.get(at).content {
            Content::Block { .. } => 0,
            Content::Parts { upper, .. } => 1 + levels(all, at + 1).max(levels(all, upper)),
        }
    }

    /// Points at powers of eight: the furthest is parted off alone, again and again.
    #[test]
    fn after_half_of_the_levels_all_is_halved_evenly() {
        let point = |i: i32| Vec3::splat(2.0_f64.powi(3 * i - 149) as f32);
        let mut members: Vec<_> = (0..69).map(|i| member(point(i), point(i))).collect();
        let mut all = nothing();
        all.add_members(0, &mut members, MAX_LEVELS);
        // 39 are left then, which become 24 and 15; 24 become 16 and 8, 16 become 8 and 8.
        assert_eq!(levels(&all, 0), MAX_LEVELS / 2 + 3);
    }

    #[test]
    fn the_unit_of_length_does_not_matter() {
        let bytes = [-80, 0, 50].map(|exponent| {
            let mesh = icosphere(4).placed(2.0_f64.powi(exponent), DVec3::ZERO);
            WideKdTree::build(&Triangles::new(mesh.triangles()).unwrap()).unwrap().bytes()
        });
        assert_eq!(bytes, [bytes[1]; 3]);
    }
}
