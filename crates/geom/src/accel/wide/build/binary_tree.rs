//! The binary tree that becomes a wide one: bounds of triangles, or of parts of them, split down to leaf blocks.

use super::collapse_cost::{CollapseCosts, expected_visits};
use super::sah::{split, split_in_bins};
use crate::Aabb;
use crate::accel::prim_ref::PrimRef;
use crate::accel::wide::simd::LANES;
use crate::accel::wide::tree::MAX_LEVELS;
use crate::accel::wide::tree::normalize::{power_of_two_below, power_of_two_inverse};

/// A leaf block that fewer rays visit than this, as a share of those that meet the scene, is not split further.
const MIN_SPLIT_VISITS: f64 = 1.0 / 1024.0;

/// A node of the binary tree.
#[derive(Clone, Copy, Debug)]
pub(super) struct BinaryNode {
    /// The bounds of its contents.
    pub(super) bounds: Aabb,
    pub(super) content: Content,
    costs: CollapseCosts,
}

/// What a node of the binary tree becomes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Content {
    /// A leaf block; empty only where the whole tree is.
    Leaf(RefRange),
    /// A node.
    Inner(Split),
    /// A leaf block, or several in lanes of their own.
    Either(RefRange, Split),
}

/// The references `first..first + count`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct RefRange {
    pub(super) first: u32,
    pub(super) count: u32,
}

/// Two children: the next node, which is lower along the axis, and node `upper`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Split {
    pub(super) axis: u8,
    pub(super) upper: u32,
}

impl Content {
    /// The leaf block that it becomes in one lane; `None` if it becomes a node there.
    pub(super) fn leaf(self) -> Option<RefRange> {
        match self {
            Self::Leaf(range) | Self::Either(range, _) => Some(range),
            Self::Inner(_) => None,
        }
    }

    /// The children that share its lanes, if it is given several.
    pub(super) fn split(self) -> Option<Split> {
        match self {
            Self::Inner(split) | Self::Either(_, split) => Some(split),
            Self::Leaf(_) => None,
        }
    }

    /// The same with its upper child at `upper`.
    fn with_upper(self, upper: u32) -> Self {
        match self {
            Self::Leaf(_) => self,
            Self::Inner(split) => Self::Inner(Split { upper, ..split }),
            Self::Either(range, split) => Self::Either(range, Split { upper, ..split }),
        }
    }
}

/// The nodes, depth first.
#[derive(Debug)]
pub(super) struct BinaryTree {
    pub(super) nodes: Vec<BinaryNode>,
    /// A power of two that brings the scene's surface into a range where `f32` suffices, so that costs
    /// do not depend on the unit of length.
    area_scale: f64,
    /// The expected visits below which the triangles of a leaf block are not split: those of [`MIN_SPLIT_VISITS`] of the
    /// rays that meet the scene.
    min_split_visits: f64,
}

impl BinaryTree {
    /// No nodes, of a scene within `bounds`.
    pub(super) fn empty(bounds: &Aabb) -> Self {
        let area = bounds.half_area();
        let area_scale = if area > 0.0 { power_of_two_inverse(power_of_two_below(area)) } else { 1.0 };
        Self { nodes: Vec::new(), area_scale, min_split_visits: MIN_SPLIT_VISITS * area * area_scale }
    }

    /// No nodes, of the same scene.
    pub(super) fn without_nodes(&self) -> Self {
        Self { nodes: Vec::new(), ..*self }
    }

    pub(super) fn node(&self, at: u32) -> &BinaryNode {
        &self.nodes[at as usize]
    }

    /// How many lanes the lower child gets if the node at `at` is opened into up to `lanes` of them; the
    /// upper child gets the others. Each gets at least one. `None` if one lane for the node itself
    /// costs no more, unless it `must_open` and is no leaf block.
    pub(super) fn opening(&self, at: u32, lanes: usize, must_open: bool) -> Option<(Split, usize)> {
        let BinaryNode { content, costs, .. } = self.node(at);
        let split = content.split().filter(|_| lanes >= 2)?;
        let [lower, upper] = self.child_costs(at, split);
        let (first, cost) = lower.share(upper, lanes);
        let is_forced = must_open && content.leaf().is_none();
        (is_forced || cost < costs.in_one_lane()).then_some((split, first))
    }

    fn child_costs(&self, at: u32, split: Split) -> [&CollapseCosts; 2] {
        [at + 1, split.upper].map(|child| &self.node(child).costs)
    }

    /// Adds all of `other`.
    pub(super) fn append(&mut self, other: &Self) {
        let start = self.nodes.len() as u32;
        self.nodes.extend(other.nodes.iter().map(|&node| {
            let upper = node.content.split().map_or(0, |split| split.upper + start);
            BinaryNode { content: node.content.with_upper(upper), ..node }
        }));
    }

    /// Adds references, of which the first is number `first` of all, split down to leaf blocks.
    pub(super) fn add_refs(&mut self, first: u32, refs: &mut [PrimRef], levels_left: u32) {
        if refs.len() <= LANES {
            self.add_leaf(first, refs);
            return;
        }
        let (axis, lower) = split(refs, levels_left <= MAX_LEVELS / 2);
        let (low, high) = refs.split_at_mut(lower);
        let halves = [(first, low), (first + lower as u32, high)];
        self.add_inner(axis, halves, |this, (first, half)| this.add_refs(first, half, levels_left - 1));
    }

    /// Adds references for a leaf block; if many rays visit it, with children for smaller blocks that fewer do.
    fn add_leaf(&mut self, first: u32, refs: &mut [PrimRef]) {
        let bounds = refs.iter().fold(Aabb::EMPTY, |all, reference| all.union(&reference.bounds));
        let range = RefRange { first, count: refs.len() as u32 };
        let visits = expected_visits(&bounds) * self.area_scale;
        let (at, costs) = (self.nodes.len(), CollapseCosts::of_leaf(visits));
        self.nodes.push(BinaryNode { bounds, content: Content::Leaf(range), costs });
        if visits < self.min_split_visits {
            return;
        }
        let Some((axis, lower)) = split_in_bins(refs) else { return };
        let (low, high) = refs.split_at_mut(lower);
        self.add_leaf(first, low);
        let split = Split { axis, upper: self.nodes.len() as u32 };
        self.add_leaf(first + lower as u32, high);
        let [low, high] = self.child_costs(at as u32, split);
        let costs = costs.or_shared(low, high);
        if costs.gain_by_lanes() {
            (self.nodes[at].content, self.nodes[at].costs) = (Content::Either(range, split), costs);
        } else {
            self.nodes.truncate(at + 1);
        }
    }

    /// Adds an inner node, then calls `add` for its lower child and for its upper one.
    pub(super) fn add_inner<T>(
        &mut self,
        axis: u8,
        [lower, upper]: [T; 2],
        mut add: impl FnMut(&mut Self, T),
    ) {
        let at = self.nodes.len();
        let (content, costs) = (Content::Inner(Split { axis, upper: 0 }), CollapseCosts::default());
        self.nodes.push(BinaryNode { bounds: Aabb::EMPTY, content, costs });
        add(self, lower);
        let split = Split { axis, upper: self.nodes.len() as u32 };
        add(self, upper);
        let bounds = self.nodes[at + 1].bounds.union(&self.node(split.upper).bounds);
        let [low, high] = self.child_costs(at as u32, split);
        let costs = CollapseCosts::of_inner(expected_visits(&bounds) * self.area_scale, low, high);
        self.nodes[at] = BinaryNode { bounds, content: Content::Inner(split), costs };
    }
}

#[cfg(test)]
mod tests {
    use super::super::collapse_cost::BLOCK_COST;
    use super::*;
    use glam::Vec3;

    fn reference(min: Vec3, max: Vec3) -> PrimRef {
        PrimRef { index: 0, bounds: Aabb { min, max } }
    }

    fn nothing() -> BinaryTree {
        BinaryTree { nodes: Vec::new(), area_scale: 1.0, min_split_visits: MIN_SPLIT_VISITS }
    }

    /// How many of `lanes` the lower child of the root gets.
    fn opening(all: &BinaryTree, lanes: usize, must_open: bool) -> Option<usize> {
        all.opening(0, lanes, must_open).map(|(_, lower)| lower)
    }

    /// Adds an inner node with the children that `lower` and `upper` add.
    fn add_inner(all: &mut BinaryTree, lower: impl Fn(&mut BinaryTree), upper: impl Fn(&mut BinaryTree)) {
        all.add_inner(0, [&lower as &dyn Fn(&mut BinaryTree), &upper], |all, add| add(all));
    }

    /// A block in the unit cube at `x`.
    fn add_unit(all: &mut BinaryTree, x: u8) {
        let min = f32::from(x) * Vec3::X;
        all.add_refs(0, &mut [reference(min, min + 1.0)], MAX_LEVELS);
    }

    /// The blocks from `x` to 9, split off one after another.
    fn add_row(all: &mut BinaryTree, x: u8, is_mirrored: bool) {
        let first = |all: &mut BinaryTree| add_unit(all, x);
        let others = |all: &mut BinaryTree| add_row(all, x + 1, is_mirrored);
        match (x, is_mirrored) {
            (9, _) => first(all),
            (_, false) => add_inner(all, first, others),
            (_, true) => add_inner(all, others, first),
        }
    }

    /// Two blocks in one place.
    fn add_pair(all: &mut BinaryTree) {
        add_inner(all, |all| add_unit(all, 0), |all| add_unit(all, 0));
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
            assert_eq!(row.node(0).costs, CollapseCosts(nodes.map(|visits| visits + blocks)));
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
        add_inner(&mut pairs, add_pair, add_pair);
        // Another node instead of this one saves nothing.
        assert_eq!([2, 3].map(|lanes| opening(&pairs, lanes, false)), [None; 2]);
        assert_eq!([2, 3].map(|lanes| opening(&pairs, lanes, true)), [Some(1); 2]);
        assert_eq!(opening(&pairs, 4, false), Some(2));
    }

    /// What a ray costs that meets a box of half the surface 1.
    const UNIT: f32 = BLOCK_COST as f32;

    /// Two triangles of each of three walls of a unit cube.
    fn corner() -> [PrimRef; 6] {
        [0, 1, 2, 0, 1, 2].map(|axis: usize| {
            let mut max = Vec3::ONE;
            max[axis] = 0.0;
            reference(Vec3::ZERO, max)
        })
    }

    #[test]
    fn walls_get_bounds_of_their_own_where_lanes_are_free() {
        let mut walls = nothing();
        walls.add_refs(0, &mut corner(), MAX_LEVELS);
        // Any two have the box of all.
        let [all, apart] = [3.0 * UNIT, 1.5 * UNIT];
        assert_eq!(walls.node(0).costs, CollapseCosts([all, all, apart, apart, apart, apart, apart, apart]));
        assert_eq!([1, 2].map(|lanes| opening(&walls, lanes, true)), [None; 2]);
        assert!(walls.opening(0, 3, false).is_some());
    }

    #[test]
    fn what_fills_its_box_stays_together() {
        let cube = |i: u8| {
            let min = Vec3::new((i & 1).into(), (i >> 1 & 1).into(), (i >> 2).into());
            reference(min, min + 1.0)
        };
        let mut cubes = nothing();
        cubes.add_refs(0, &mut [0, 1, 2, 3, 4, 5, 6, 7].map(cube), MAX_LEVELS);
        assert_eq!(cubes.node(0).costs, CollapseCosts([12.0 * UNIT; LANES]));
        assert_eq!(cubes.node(0).content, Content::Leaf(RefRange { first: 0, count: 8 }));
        assert_eq!(cubes.nodes.len(), 1);
    }

    #[test]
    fn what_few_rays_visit_is_not_split() {
        for (min_split_visits, count) in [(3.0, 5), (3.1, 1)] {
            let mut walls = BinaryTree { min_split_visits, ..nothing() };
            walls.add_refs(0, &mut corner(), MAX_LEVELS);
            assert_eq!(walls.nodes.len(), count, "{min_split_visits}");
        }
    }

    fn levels(all: &BinaryTree, at: u32) -> u32 {
        match all.node(at).content {
            Content::Inner(Split { upper, .. }) => 1 + levels(all, at + 1).max(levels(all, upper)),
            _ => 0,
        }
    }

    /// Points at powers of eight: the furthest is split off alone, again and again.
    #[test]
    fn after_half_of_the_levels_all_is_halved_evenly() {
        let point = |i: i32| Vec3::splat(2.0_f64.powi(3 * i - 149) as f32);
        let mut refs: Vec<_> = (0..69).map(|i| reference(point(i), point(i))).collect();
        let mut all = nothing();
        all.add_refs(0, &mut refs, MAX_LEVELS);
        // 39 are left then, which become 24 and 15; 24 become 16 and 8, 16 become 8 and 8.
        assert_eq!(levels(&all, 0), MAX_LEVELS / 2 + 3);
    }
}
