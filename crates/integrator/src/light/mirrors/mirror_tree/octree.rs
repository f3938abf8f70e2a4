//! An octree over the scene, whose cells list the leaves of a mirror tree that may show a light to a point of theirs.
//!
//! A descent in the mirror tree goes by bounds of leaves, which tell little: most descents end where no mirror shows a light. A
//! cell is tested against the mirrors themselves, once for all points that receive light in it.

mod cell;
mod cube;

use super::resampling::{Resampled, resample};
use super::{Choice, LightBounds, MirrorTree, Query, TriangleLeaf, Viewpoint};
use crate::light::receiver::Receiver;
use cell::Cell;
pub(crate) use cell::KnownImportances;
use cube::Cube;
use glam::Vec3;
use globillum_geom::Triangles;

/// The leaves of a mirror tree that may show a light of one cluster, by place of the receiver.
///
/// Cells are made when a receiver first asks for them. What they hold does not depend on who asks, or when.
#[derive(Clone, Debug)]
pub(crate) struct MirrorOctree {
    lights: LightBounds,
    cube: Cube,
    root: Cell,
}

/// What the cell of a receiver tells of the mirrors.
#[derive(Clone, Copy)]
pub(crate) enum CellView<'a> {
    /// They show no light.
    Empty,
    /// Those that may show a light are listed.
    Listed(ListedMirrors<'a>),
    /// Those that may show a light are not listed: they are too many, or the receiver is outside of the octree.
    Unlisted,
}

/// The list of a cell and a receiver in it.
#[derive(Clone, Copy)]
pub(crate) struct ListedMirrors<'a> {
    cell: &'a Cell,
    query: Query,
}

impl MirrorOctree {
    /// The most leaves of a tree for which octrees pay: their cells test them all.
    const MAX_LEAVES: usize = 1024;

    /// The most pairs of a leaf and a cluster of lights, which limit the memory of all octrees.
    const MAX_PAIRS: usize = 4096;

    /// Whether octrees for this many clusters of lights pay, by the number of leaves.
    pub(crate) fn pays(leaves: usize, clusters: usize) -> bool {
        leaves <= Self::MAX_LEAVES && leaves * clusters <= Self::MAX_PAIRS
    }

    /// An octree over all points of the scene, for these lights and all lowest `leaves` of the tree.
    pub(crate) fn new(
        tree: &MirrorTree,
        triangles: &Triangles,
        lights: LightBounds,
        leaves: &[TriangleLeaf],
    ) -> Self {
        let scene = triangles.bounds();
        let center = ((scene.center() - tree.origin) * tree.scale).as_vec3();
        let cube = Cube::around(center, (scene.extent().max_element() * tree.scale) as f32);
        let all: Vec<u32> = (0..leaves.len() as u32).collect();
        let root = tree.cell(&all, leaves, lights, &cube);
        Self { lights, cube, root }
    }

    /// What the cell of `receiver` tells of the mirrors.
    #[inline(always)]
    pub(crate) fn view(
        &self,
        tree: &MirrorTree,
        leaves: &[TriangleLeaf],
        receiver: Receiver,
    ) -> CellView<'_> {
        let query = tree.query(&Viewpoint { receiver, lights: self.lights });
        let (mut cell, mut cube) = (&self.root, self.cube);
        if !cube.contains(query.from) {
            return CellView::Unlisted;
        }
        while let Some(children) = cell.children() {
            let octant;
            (octant, cube) = cube.octant(query.from);
            cell = children[octant].get_or_init(|| tree.cell(cell.leaves(), leaves, self.lights, &cube));
        }
        match cell.leaves().len() {
            0 => CellView::Empty,
            1..=Cell::MAX_LISTED => CellView::Listed(ListedMirrors { cell, query }),
            _ => CellView::Unlisted,
        }
    }
}

impl ListedMirrors<'_> {
    /// What a place in a cell sees, over what its bounds allow.
    const SHARE_SEEN: f64 = 0.25;

    /// The probability that any mirror is chosen.
    #[inline(always)]
    fn attempt_prob(&self, attempts: f64) -> f64 {
        (Self::SHARE_SEEN * self.cell.total() * attempts).min(1.0)
    }
}

impl MirrorTree {
    /// Chooses one of the listed mirrors by `u` in `[0, 1)`; `None` if none is chosen. The probability of any choice is
    /// `attempts` times about what the receiver sees of the list, where that is less than 1. `known` are importances to this
    /// receiver for these lights.
    #[inline(always)]
    pub(crate) fn choose_listed<const CANDIDATES: usize>(
        &self,
        leaves: &[TriangleLeaf],
        listed: ListedMirrors<'_>,
        known: &mut KnownImportances,
        attempts: f64,
        u: f64,
    ) -> Option<Choice> {
        let attempt_prob = listed.attempt_prob(attempts);
        if u >= attempt_prob {
            return None;
        }
        let u = (u / attempt_prob).min(1.0_f64.next_down());
        let cell = listed.cell;
        let Resampled { candidate, child, child_prob, weight } = self.simd.run(
            #[inline(always)]
            || cell.choose::<CANDIDATES>(leaves, &listed.query, known, u),
        )?;
        let prob = attempt_prob * (cell.prob_of(candidate) * child_prob);
        (prob > 0.0).then_some(Choice { place: self.place(cell.leaves()[candidate], child), prob, weight })
    }

    /// The [`Choice::prob`] of the mirror at `place`, to the bit; `None` if [`MirrorTree::choose_listed`] never chooses it.
    #[inline(always)]
    pub(crate) fn prob_of_listed(
        &self,
        leaves: &[TriangleLeaf],
        listed: ListedMirrors<'_>,
        attempts: f64,
        place: u32,
    ) -> Option<f64> {
        let (leaf, child) = self.leaf_of(place);
        let of_cell = self.simd.run(
            #[inline(always)]
            || listed.cell.prob(leaves, &listed.query, leaf, child),
        )?;
        let prob = listed.attempt_prob(attempts) * of_cell;
        (prob > 0.0).then_some(prob)
    }

    /// The cell of a cube, with those of the leaves `among` that may show these lights there.
    #[cold]
    #[inline(never)]
    fn cell(&self, among: &[u32], all: &[TriangleLeaf], lights: LightBounds, cube: &Cube) -> Cell {
        let query = self.query_of_cube(cube, lights);
        self.simd.run(
            #[inline(always)]
            || Cell::among(among, all, &query, cube),
        )
    }

    /// What the receivers in a cube ask; their normals are not told.
    fn query_of_cube(&self, cube: &Cube, lights: LightBounds) -> Query {
        let position = self.origin + cube.center().as_dvec3() / self.scale;
        let query = self.query(&Viewpoint { receiver: Receiver { position, normal: Vec3::ZERO }, lights });
        let around = self.bodies_within(position, f64::from(cube.radius()) / self.scale);
        Query { around: query.around | around, ..query }
    }
}

#[cfg(test)]
impl MirrorOctree {
    /// The leaves with an importance to `receiver`, which is in the octree, and for each whether it may be chosen.
    pub(crate) fn leaves_with_importance(
        &self,
        tree: &MirrorTree,
        leaves: &[TriangleLeaf],
        receiver: Receiver,
    ) -> Vec<bool> {
        let query = tree.query(&Viewpoint { receiver, lights: self.lights });
        assert!(self.cube.contains(query.from));
        let view = self.view(tree, leaves, receiver);
        let is_listed = |leaf: u32| match view {
            CellView::Empty => false,
            CellView::Listed(listed) => listed.cell.leaves().contains(&leaf),
            CellView::Unlisted => true,
        };
        let with_importance =
            (0..).zip(leaves).filter(|(_, leaf)| leaf.importance(&query).iter().any(|&x| x > 0.0));
        with_importance.map(|(leaf, _)| is_listed(leaf)).collect()
    }
}
