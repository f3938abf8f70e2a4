//! The binary tree that is made a wide one: the cells of a k-d tree, and below its leaves parts of
//! what they hold, down to what fits into a block.

use super::halve::{halve, part};
use super::simd::LANES;
use super::space::{power_of_two_below, power_of_two_inverse};
use crate::kdtree::{KdTree, Member, Node as Binary};
use crate::{Aabb, Accel};
use rayon::prelude::*;

/// Most levels below a leaf of the k-d tree that may be nodes. Half of them are enough to halve any number of
/// triangles. (What a block may be parted into is never a node.)
pub(super) const MAX_LEVELS: u32 = 60;

/// A box is flat that is thinner than this part of its longest side.
const FLAT: f64 = 1.0 / 256.0;
/// What a ray's visit to a block costs, in visits to a node (measured, docs/performance.md).
const BLOCK_COST: f64 = 4.0;
/// Blocks that fewer rays visit than this, as a share of those that meet the scene, are not parted further.
const FEW: f64 = 1.0 / 1024.0;

/// A subtree.
#[derive(Clone, Copy, Debug)]
pub(super) struct Subtree {
    /// The box of what it holds.
    pub(super) bounds: Aabb,
    pub(super) content: Content,
    /// The least expected cost of a ray, in visits to nodes and in proportion, if the subtree is given
    /// 1, 2, .. 8 lanes of a node (Ylitie, Karras and Laine, 2017, section 3).
    costs: [f32; LANES],
}

/// What is in a subtree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Content {
    /// Triangles for one block; none only where the whole tree has none.
    Block(Block),
    /// Triangles for a node.
    Parts(Parts),
    /// Triangles for one block, or for several in lanes of their own.
    Either(Block, Parts),
}

/// The triangles of so many members, from number `first` on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Block {
    pub(super) first: u32,
    pub(super) count: u32,
}

/// Two parts: the next subtree, which is lower along the axis, and subtree `upper`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Parts {
    pub(super) axis: u8,
    pub(super) upper: u32,
}

impl Content {
    /// What goes in a block, if it is given one lane; `None` if that is a node's.
    pub(super) fn block(self) -> Option<Block> {
        match self {
            Self::Block(block) | Self::Either(block, _) => Some(block),
            Self::Parts(_) => None,
        }
    }

    /// What goes in its lanes, if it is given several.
    pub(super) fn parts(self) -> Option<Parts> {
        match self {
            Self::Parts(parts) | Self::Either(_, parts) => Some(parts),
            Self::Block(_) => None,
        }
    }

    /// The same with parts, the upper of which is at `upper`.
    fn with_upper(self, upper: u32) -> Self {
        match self {
            Self::Block(_) => self,
            Self::Parts(parts) => Self::Parts(Parts { upper, ..parts }),
            Self::Either(block, parts) => Self::Either(block, Parts { upper, ..parts }),
        }
    }
}

/// Subtrees, depth first. Where a cell of the tree has nothing in one half, its other half alone is here.
#[derive(Debug)]
pub(super) struct Subtrees {
    all: Vec<Subtree>,
    /// What makes the scene's surface, times it, a number for which `f32` has range enough: a power of
    /// two, so that costs do not depend on the unit of length.
    area_scale: f64,
    /// [`FEW`] of the rays that meet the scene, in proportion.
    few: f64,
}

impl Subtrees {
    /// Those of a tree. `members`, what is in its leaves, one for each reference, are reordered
    /// within each leaf, so that those of a block come one after another.
    ///
    /// Leaves are parted side by side on the threads of the current rayon pool.
    pub(super) fn new(tree: &KdTree, members: &mut [Member]) -> Self {
        let area = tree.bounds().half_area();
        let area_scale = if area > 0.0 { power_of_two_inverse(power_of_two_below(area)) } else { 1.0 };
        let few = FEW * area * area_scale;
        let (mut leaves, mut rest) = (Vec::new(), members);
        for node in &tree.nodes {
            if let Binary::Leaf { first, count: count @ 1.. } = *node {
                let (leaf, others) = rest.split_at_mut(count as usize);
                leaves.push((first, leaf));
                rest = others;
            }
        }
        let part = |(first, leaf): (u32, &mut [Member])| {
            let mut parts = Self { all: Vec::new(), area_scale, few };
            parts.add_members(first, leaf, MAX_LEVELS);
            parts
        };
        let leaves: Vec<Self> = leaves.into_par_iter().map(part).collect();
        // Each plane has something on both sides.
        let planes = leaves.len().saturating_sub(1);
        let count = planes + leaves.iter().map(|leaf| leaf.all.len()).sum::<usize>();
        let mut this = Self { all: Vec::with_capacity(count), area_scale, few };
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
        let Some(Parts { upper, .. }) = self.get(at).content.parts() else { return (0, 0.0) };
        let (low, high) = (self.get(at + 1), self.get(upper));
        let cost = |first: usize| (first, low.costs[first - 1] + high.costs[lanes - first - 1]);
        (2..lanes).map(cost).fold(cost(1), |best, next| if next.1 < best.1 { next } else { best })
    }

    /// How many lanes the lower part of a subtree gets, if opening it into up to `lanes` of them is better than
    /// to give it one, or if it is a node's and must be opened; the upper part gets the others. Either gets one
    /// at least.
    pub(super) fn opening(&self, at: u32, lanes: usize, must_open: bool) -> Option<(Parts, usize)> {
        let Subtree { content, costs, .. } = self.get(at);
        let parts = content.parts().filter(|_| lanes >= 2)?;
        let (lower, cost) = self.share(at, lanes);
        let is_forced = must_open && content.block().is_none();
        (is_forced || cost < costs[0]).then_some((parts, lower))
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
        self.all.extend(other.all.iter().map(|&subtree| {
            let upper = subtree.content.parts().map_or(0, |parts| parts.upper + start);
            Subtree { content: subtree.content.with_upper(upper), ..subtree }
        }));
    }

    /// Adds members, of which the first is number `first` of all, parted into blocks.
    fn add_members(&mut self, first: u32, members: &mut [Member], levels_left: u32) {
        if members.len() <= LANES {
            self.add_block(first, members);
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

    /// Adds members for a block; if many rays visit it, with parts for smaller blocks that fewer do.
    fn add_block(&mut self, first: u32, members: &mut [Member]) {
        let bounds = members.iter().fold(Aabb::EMPTY, |all, m| all.union(&m.bounds));
        let block = Block { first, count: members.len() as u32 };
        let visits = rays(&bounds) * self.area_scale;
        let (at, costs) = (self.all.len(), [(BLOCK_COST * visits) as f32; LANES]);
        self.all.push(Subtree { bounds, content: Content::Block(block), costs });
        if visits < self.few {
            return;
        }
        let Some((axis, lower)) = part(members) else { return };
        let (low, high) = members.split_at_mut(lower);
        self.add_block(first, low);
        self.all[at].content = Content::Either(block, Parts { axis, upper: self.all.len() as u32 });
        self.add_block(first + lower as u32, high);
        self.share_lanes(at);
        if self.all[at].costs[LANES - 1] >= costs[0] {
            self.all.truncate(at + 1);
            self.all[at].content = Content::Block(block);
        }
    }

    /// Adds a subtree of two parts, and returns where it is.
    fn begin(&mut self, axis: u8) -> usize {
        let content = Content::Parts(Parts { axis, upper: 0 });
        self.all.push(Subtree { bounds: Aabb::EMPTY, content, costs: [0.0; LANES] });
        self.all.len() - 1
    }

    /// Makes the subtree that is added next the upper part of the one at `at`.
    fn point_to_upper(&mut self, at: usize) {
        let next = self.all.len() as u32;
        self.all[at].content = self.all[at].content.with_upper(next);
    }

    /// Finds the box and the costs of the subtree at `at`, now that its parts are there.
    fn finish(&mut self, at: usize) {
        let Some(Parts { upper, .. }) = self.all[at].content.parts() else { return };
        let bounds = self.all[at + 1].bounds.union(&self.get(upper).bounds);
        let visits = rays(&bounds) * self.area_scale;
        self.all[at].bounds = bounds;
        self.all[at].costs[0] = visits as f32 + self.share(at as u32, LANES).1;
        self.share_lanes(at);
    }

    /// Finds the costs of a subtree in several lanes, now that its parts and that in one lane are known.
    fn share_lanes(&mut self, at: usize) {
        for lanes in 2..=LANES {
            let cost = self.share(at as u32, lanes).1;
            let costs = &mut self.all[at].costs;
            costs[lanes - 1] = cost.min(costs[lanes - 2]);
        }
    }
}

/// How many rays meet a box, in proportion: half its surface (Goldsmith and Salmon, 1987).
///
/// A flat one counts half. Of the lines that meet a wall or a table's top, half are rays that start there, and
/// leave it behind. (A needle counts as flat, too; few rays meet it.)
fn rays(bounds: &Aabb) -> f64 {
    let extent = bounds.extent();
    let is_flat = extent.min_element() < FLAT * extent.max_element();
    bounds.half_area() * if is_flat { 0.5 } else { 1.0 }
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
        Subtrees { all: Vec::new(), area_scale: 1.0, few: FEW }
    }

    /// How many of so many lanes the lower part of all gets.
    fn opening(all: &Subtrees, lanes: usize, must_open: bool) -> Option<usize> {
        all.opening(0, lanes, must_open).map(|(_, lower)| lower)
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
            let blocks = 10.0 * 3.0 * BLOCK_COST as f32;
            let nodes = [28.0, 24.0, 17.0, 15.0, 13.0, 11.0, 9.0, 7.0];
            assert_eq!(row.get(0).costs, nodes.map(|visits| visits + blocks));
            for lanes in 2..=LANES {
                let first = if is_mirrored { lanes - 1 } else { 1 };
                assert_eq!(opening(&row, lanes, false), Some(first), "{lanes} lanes");
            }
            assert_eq!(opening(&row, 1, false), None);
        }
    }

    #[test]
    fn what_lies_in_one_place_is_opened_only_into_lanes_enough() {
        let mut pairs = nothing();
        add_parts(&mut pairs, add_pair, add_pair);
        // Another node instead of this one saves nothing.
        assert_eq!([2, 3].map(|lanes| opening(&pairs, lanes, false)), [None; 2]);
        assert_eq!([2, 3].map(|lanes| opening(&pairs, lanes, true)), [Some(1); 2]);
        assert_eq!(opening(&pairs, 4, false), Some(2));
    }

    /// What a ray costs that meets a box of half the surface 1.
    const UNIT: f32 = BLOCK_COST as f32;

    /// Two triangles of each of three walls of a unit cube.
    fn corner() -> [Member; 6] {
        [0, 1, 2, 0, 1, 2].map(|axis: usize| {
            let mut max = Vec3::ONE;
            max[axis] = 0.0;
            member(Vec3::ZERO, max)
        })
    }

    #[test]
    fn walls_are_boxed_apart_where_lanes_are_free() {
        let mut walls = nothing();
        walls.add_members(0, &mut corner(), MAX_LEVELS);
        // Any two have the box of all.
        let [all, apart] = [3.0 * UNIT, 1.5 * UNIT];
        assert_eq!(walls.get(0).costs, [all, all, apart, apart, apart, apart, apart, apart]);
        assert_eq!([1, 2].map(|lanes| opening(&walls, lanes, true)), [None; 2]);
        assert!(walls.opening(0, 3, false).is_some());
    }

    #[test]
    fn what_fills_its_box_stays_together() {
        let cube = |i: u8| {
            let min = Vec3::new((i & 1).into(), (i >> 1 & 1).into(), (i >> 2).into());
            member(min, min + 1.0)
        };
        let mut cubes = nothing();
        cubes.add_members(0, &mut [0, 1, 2, 3, 4, 5, 6, 7].map(cube), MAX_LEVELS);
        assert_eq!(cubes.get(0).costs, [12.0 * UNIT; LANES]);
        assert_eq!(cubes.get(0).content, Content::Block(Block { first: 0, count: 8 }));
        assert_eq!(cubes.all.len(), 1);
    }

    #[test]
    fn what_few_rays_visit_is_not_parted() {
        for (few, count) in [(3.0, 5), (3.1, 1)] {
            let mut walls = Subtrees { few, ..nothing() };
            walls.add_members(0, &mut corner(), MAX_LEVELS);
            assert_eq!(walls.all.len(), count, "{few}");
        }
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
        let block = |first, count| Content::Block(Block { first, count });
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
        let parts = Content::Parts(Parts { axis: 2, upper: 2 });
        let five = &mut [member(Vec3::ZERO, Vec3::ONE); 5];
        assert_eq!(contents(nodes, five), [parts, block(0, 2), block(2, 3)]);
        for nodes in [vec![leaf(0, 0)], vec![split(1, 2), leaf(0, 0), leaf(0, 0)]] {
            assert_eq!(contents(nodes, &mut []), [block(0, 0)]);
        }
    }

    fn levels(all: &Subtrees, at: u32) -> u32 {
        match all.get(at).content {
            Content::Parts(Parts { upper, .. }) => 1 + levels(all, at + 1).max(levels(all, upper)),
            _ => 0,
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

    /// Coordinates are rounded elsewhere then, so that boxes are not quite the same.
    #[test]
    fn nor_does_it_by_other_factors_than_powers_of_two() {
        let subtrees = [1.0, 1.1, 1.2, 1.4, 1.7].map(|scale| {
            let mesh = icosphere(5).placed(scale, DVec3::ZERO);
            let triangles = Triangles::new(mesh.triangles()).unwrap();
            let options = KdOptions { traversal_cost: 400.0, ..KdOptions::default() };
            let (tree, mut members) = KdTree::build_with_members(&triangles, &options).unwrap();
            Subtrees::new(&tree, &mut members).all.len()
        });
        let near = |count: &usize| count.abs_diff(subtrees[0]) < subtrees[0] / 100;
        assert!(subtrees.iter().all(near), "{subtrees:?}");
    }
}
