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
#[derive(Clone, Copy, Debug)]
pub(super) enum Content {
    /// Triangles for one block, or none.
    Block { first: u32, count: u32 },
    /// Two parts: the next subtree, which is lower along the axis, and subtree `upper`.
    Parts { axis: u8, upper: u32 },
}

/// Subtrees, depth first.
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
            if let Binary::Leaf { first, count } = *node {
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
        let count = tree.nodes.len() + leaves.iter().map(|leaf| leaf.all.len()).sum::<usize>();
        let mut this = Self { all: Vec::with_capacity(count), area_scale };
        this.add_cell(tree, 0, &mut leaves.iter());
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
        if low.bounds.is_empty() {
            return (0, high.costs[lanes - 1]);
        }
        if high.bounds.is_empty() {
            return (lanes, low.costs[lanes - 1]);
        }
        let cost = |first: usize| (first, low.costs[first - 1] + high.costs[lanes - first - 1]);
        (2..lanes).map(cost).fold(cost(1), |best, next| if next.1 < best.1 { next } else { best })
    }

    /// How many lanes the lower part of a subtree gets, if opening it into up to `lanes` of them is
    /// better than to give it one; the upper part gets the others.
    pub(super) fn opening(&self, at: u32, lanes: usize, must_open: bool) -> Option<usize> {
        if lanes < 2 {
            return None;
        }
        let (lower, cost) = self.share(at, lanes);
        (must_open || cost < self.get(at).costs[0]).then_some(lower)
    }

    /// Adds a cell of the tree, and all below it; the next of `leaves` are those in it.
    fn add_cell(&mut self, tree: &KdTree, cell: u32, leaves: &mut std::slice::Iter<'_, Self>) {
        match tree.nodes[cell as usize] {
            Binary::Leaf { .. } => {
                if let Some(leaf) = leaves.next() {
                    self.append(leaf);
                }
            }
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

#[cfg(test)]
mod tests {
    use crate::conformance::shapes::icosphere;
    use crate::{Accel, Triangles, WideKdTree};
    use glam::DVec3;

    #[test]
    fn the_unit_of_length_does_not_matter() {
        let bytes = [-80, 0, 50].map(|exponent| {
            let mesh = icosphere(4).placed(2.0_f64.powi(exponent), DVec3::ZERO);
            WideKdTree::build(&Triangles::new(mesh.triangles()).unwrap()).unwrap().bytes()
        });
        assert_eq!(bytes, [bytes[1]; 3]);
    }
}
