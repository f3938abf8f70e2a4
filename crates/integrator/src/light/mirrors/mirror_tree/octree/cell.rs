use super::cube::Cube;
use super::{Query, Resampled, TriangleNode, resample};
use crate::light::child_weights::{ChildWeights, WIDTH};
use crate::light::systematic::{Chosen, choose_systematically};
use std::sync::OnceLock;

/// A facet that was chosen, as child of a lowest node; with the numbers of a [`Choice`](super::Choice).
#[derive(Clone, Copy, Debug)]
pub(super) struct ChosenChild {
    pub(super) node: u32,
    pub(super) child: usize,
    pub(super) prob: f64,
    pub(super) weight: f64,
}

/// The importances of the facets of a short list to one receiver, as far as they were asked for.
#[derive(Clone, Debug)]
pub(crate) struct KnownImportances {
    of_nodes: [[f64; WIDTH]; Cell::MAX_LEAF_NODES],
    /// A bit for each node that is known.
    known: u8,
}

impl KnownImportances {
    pub(crate) fn none() -> Self {
        const { assert!(Cell::MAX_LEAF_NODES <= u8::BITS as usize) };
        Self { of_nodes: [[0.0; WIDTH]; Cell::MAX_LEAF_NODES], known: 0 }
    }

    /// For another receiver.
    pub(crate) fn forget(&mut self) {
        self.known = 0;
    }

    /// Those of the node at this place of a list, which `find` returns.
    #[inline(always)]
    fn get_or_find(&mut self, place: usize, find: impl FnOnce() -> [f64; WIDTH]) -> [f64; WIDTH] {
        let Some(of_node) = self.of_nodes.get_mut(place) else { return find() };
        if self.known >> place & 1 == 0 {
            (*of_node, self.known) = (find(), self.known | 1 << place);
        }
        *of_node
    }
}

/// Some lowest nodes that may show a light to a point of a cube.
#[derive(Clone, Debug)]
pub(super) struct Cell {
    /// The nodes, in ascending order.
    nodes: Box<[u32]>,
    /// For each node, the sum of the weights up to it. A weight is about the largest importance of the node's facets to a point
    /// of the cube, beside a uniform share.
    ends: Box<[f64]>,
    /// The octants; `None` if the cell has none.
    children: Option<Box<[OnceLock<Cell>; 8]>>,
}

impl Cell {
    /// Where there are more nodes than this, descents in the mirror tree choose as well as lists, in less time.
    pub(super) const MAX_LISTED: usize = 64;

    /// A cell of so few nodes has no octants.
    const MAX_LEAF_NODES: usize = 8;

    /// A cell with octants has more than this many times the nodes that the middle of the cube sees, and as many as a leaf.
    const MIN_EXCESS: f64 = 2.5;

    /// The number of nodes of a cell by which it is found how many of all the middle sees.
    const SAMPLES: usize = 8;

    /// Cells of this size have no octants. The facets extend to between a half and 1.
    const MIN_SIZE: f32 = 1.0 / 32.0;

    /// The share of all weights that is divided evenly, since near nodes have large bounds.
    const UNIFORM_SHARE: f64 = 0.125;

    /// Those of the nodes `among` that may show a light to `cube`, from the middle of which `query` is.
    #[inline(always)]
    pub(super) fn among(among: &[u32], all: &[TriangleNode], query: &Query, cube: &Cube) -> Self {
        let (mut nodes, mut ends, mut total) = (Vec::new(), Vec::new(), 0.0);
        for &node in among {
            let importance = all[node as usize].largest_importance(query, cube.radius());
            if importance > 0.0 {
                total += importance;
                nodes.push(node);
                ends.push(total);
            }
        }
        let uniform = total / nodes.len() as f64;
        for (k, end) in (1..).zip(&mut ends) {
            *end += Self::UNIFORM_SHARE * (f64::from(k) * uniform - *end);
        }
        // An octant has about half of the nodes or more, so cells of the least size would not be listed.
        let has_many = nodes.len() as f32 * Self::MIN_SIZE > Self::MAX_LISTED as f32 * cube.size();
        let may_have_octants =
            cube.size() > Self::MIN_SIZE && nodes.len() > Self::MAX_LEAF_NODES && !has_many;
        let has_octants = may_have_octants && {
            let samples = (0..Self::SAMPLES).map(|i| nodes[i * nodes.len() / Self::SAMPLES]);
            let seen =
                samples.filter(|&node| all[node as usize].largest_importance(query, 0.0) > 0.0).count();
            let seen = seen as f64 / Self::SAMPLES as f64 * nodes.len() as f64;
            nodes.len() as f64 > Self::MIN_EXCESS * (seen + Self::MAX_LEAF_NODES as f64)
        };
        Self { nodes: nodes.into(), ends: ends.into(), children: has_octants.then(Box::default) }
    }

    /// The nodes that may show a light.
    pub(super) fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// The octants, of which each is made when it is needed; `None` if the cell has none.
    #[inline(always)]
    pub(super) fn children(&self) -> Option<&[OnceLock<Self>; 8]> {
        self.children.as_deref()
    }

    /// The sum of all weights.
    #[inline(always)]
    pub(super) fn total(&self) -> f64 {
        self.ends.last().copied().unwrap_or(0.0)
    }

    /// Chooses a facet by `u` in `[0, 1)`; `None` if the facets of all candidates show no light. `known` are importances to the
    /// receiver of `query` in this cell.
    ///
    /// `CANDIDATES` nodes are chosen by their weights, and one of those by its facets ([`resample`]).
    #[inline(always)]
    pub(super) fn choose<const CANDIDATES: usize>(
        &self,
        all: &[TriangleNode],
        query: &Query,
        known: &mut KnownImportances,
        u: f64,
    ) -> Option<ChosenChild> {
        let (candidates, u) = self.choose_systematically::<CANDIDATES>(u);
        let Resampled { node: place, child, child_prob, weight } = resample(
            candidates,
            #[inline(always)]
            |place| self.prob_of(place),
            #[inline(always)]
            |place| {
                known.get_or_find(
                    place,
                    #[inline(always)]
                    || all[self.nodes[place] as usize].importance(query),
                )
            },
            u,
        )?;
        let prob = self.prob_of(place) * child_prob;
        Some(ChosenChild { node: self.nodes[place], child, prob, weight })
    }

    /// The probability of a facet if there were one candidate, to the bit that of [`Cell::choose`]; `None` if it is never
    /// chosen.
    #[inline(always)]
    pub(super) fn prob(&self, all: &[TriangleNode], query: &Query, node: u32, child: usize) -> Option<f64> {
        let place = self.nodes.binary_search(&node).ok()?;
        let of_facets = ChildWeights::of_importance(all[node as usize].importance(query));
        (of_facets.total() > 0.0).then(|| self.prob_of(place) * of_facets.prob(child))
    }

    /// The probability of choosing the node at this place in the list.
    #[inline(always)]
    fn prob_of(&self, place: usize) -> f64 {
        (self.ends[place] - self.end_before(place)) / self.total()
    }

    #[inline(always)]
    fn end_before(&self, place: usize) -> f64 {
        if place == 0 { 0.0 } else { self.ends[place - 1] }
    }

    /// The places of the nodes that [`choose_systematically`] chooses by `u`, and the number that is left.
    #[inline(always)]
    fn choose_systematically<const N: usize>(&self, u: f64) -> ([usize; N], f64) {
        choose_systematically(
            u,
            #[inline(always)]
            |u| {
                let at = u * self.total();
                // Rounding may reach the end of the last.
                let index = self.ends.partition_point(|&end| end <= at).min(self.nodes.len() - 1);
                Chosen { index, from_start: at - self.end_before(index), to_end: self.ends[index] - at }
            },
        )
    }
}
