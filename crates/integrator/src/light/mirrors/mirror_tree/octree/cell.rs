use super::cube::Cube;
use super::{Query, Resampled, TriangleLeaf, resample};
use crate::light::child_weights::{ChildWeights, WIDTH};
use crate::light::systematic::{Chosen, choose_systematically};
use std::sync::OnceLock;

/// The importances of the mirrors of a short list to one receiver, as far as they were asked for.
#[derive(Clone, Debug)]
pub(crate) struct KnownImportances {
    of_leaves: [[f64; WIDTH]; Cell::MAX_UNDIVIDED],
    /// A bit for each leaf that is known.
    known: u8,
}

impl KnownImportances {
    pub(crate) fn none() -> Self {
        const { assert!(Cell::MAX_UNDIVIDED <= u8::BITS as usize) };
        Self { of_leaves: [[0.0; WIDTH]; Cell::MAX_UNDIVIDED], known: 0 }
    }

    /// For another receiver.
    pub(crate) fn forget(&mut self) {
        self.known = 0;
    }

    /// Those of the leaf at this place of a list, which `find` returns.
    #[inline(always)]
    fn get_or_find(&mut self, place: usize, find: impl FnOnce() -> [f64; WIDTH]) -> [f64; WIDTH] {
        let Some(of_leaf) = self.of_leaves.get_mut(place) else { return find() };
        if self.known >> place & 1 == 0 {
            (*of_leaf, self.known) = (find(), self.known | 1 << place);
        }
        *of_leaf
    }
}

/// Some leaves that may show a light to a point of a cube.
#[derive(Clone, Debug)]
pub(super) struct Cell {
    /// The leaves, in ascending order.
    leaves: Box<[u32]>,
    /// For each leaf, the sum of the weights up to it. A weight is about the largest importance of the leaf's mirrors to a point
    /// of the cube, beside a uniform share.
    ends: Box<[f64]>,
    /// The octants; `None` if the cell has none.
    children: Option<Box<[OnceLock<Cell>; 8]>>,
}

impl Cell {
    /// Where there are more leaves than this, descents in the mirror tree choose as well as lists, in less time.
    pub(super) const MAX_LISTED: usize = 64;

    /// A cell of so few leaves has no octants.
    const MAX_UNDIVIDED: usize = 8;

    /// A cell with octants has more than this many times the leaves that the middle of the cube sees, plus `MAX_UNDIVIDED`.
    const MIN_EXCESS: f64 = 2.5;

    /// The number of leaves of a cell by which it is found how many of all the middle sees.
    const SAMPLES: usize = 8;

    /// Cells of this size have no octants. The mirrors extend to between a half and 1.
    const MIN_SIZE: f32 = 1.0 / 32.0;

    /// The share of all weights that is divided evenly, since near leaves have large bounds.
    const UNIFORM_SHARE: f64 = 0.125;

    /// Those of the leaves `among` that may show a light to `cube`, from the middle of which `query` is.
    #[inline(always)]
    pub(super) fn among(among: &[u32], all: &[TriangleLeaf], query: &Query, cube: &Cube) -> Self {
        let (mut leaves, mut ends, mut total) = (Vec::new(), Vec::new(), 0.0);
        for &leaf in among {
            let importance = all[leaf as usize].largest_importance(query, cube.radius());
            if importance > 0.0 {
                total += importance;
                leaves.push(leaf);
                ends.push(total);
            }
        }
        let uniform = total / leaves.len() as f64;
        for (k, end) in (1..).zip(&mut ends) {
            *end += Self::UNIFORM_SHARE * (f64::from(k) * uniform - *end);
        }
        // An octant has about half of the leaves or more, so cells of the least size would not be listed.
        let has_many = leaves.len() as f32 * Self::MIN_SIZE > Self::MAX_LISTED as f32 * cube.size();
        let may_have_octants =
            cube.size() > Self::MIN_SIZE && leaves.len() > Self::MAX_UNDIVIDED && !has_many;
        let has_octants = may_have_octants && {
            let samples = (0..Self::SAMPLES).map(|i| leaves[i * leaves.len() / Self::SAMPLES]);
            let seen =
                samples.filter(|&leaf| all[leaf as usize].largest_importance(query, 0.0) > 0.0).count();
            let seen = seen as f64 / Self::SAMPLES as f64 * leaves.len() as f64;
            leaves.len() as f64 > Self::MIN_EXCESS * (seen + Self::MAX_UNDIVIDED as f64)
        };
        Self { leaves: leaves.into(), ends: ends.into(), children: has_octants.then(Box::default) }
    }

    /// The leaves that may show a light.
    pub(super) fn leaves(&self) -> &[u32] {
        &self.leaves
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

    /// Chooses a mirror of a leaf, by its place in the list, by `u` in `[0, 1)`; `None` if the mirrors of all candidates show no light. `known` are importances to the
    /// receiver of `query` in this cell.
    ///
    /// `CANDIDATES` leaves are chosen by their weights, and one of those by its mirrors ([`resample`]).
    #[inline(always)]
    pub(super) fn choose<const CANDIDATES: usize>(
        &self,
        all: &[TriangleLeaf],
        query: &Query,
        known: &mut KnownImportances,
        u: f64,
    ) -> Option<Resampled> {
        let (candidates, u) = self.choose_systematically::<CANDIDATES>(u);
        resample(
            candidates,
            #[inline(always)]
            |place| self.prob_of(place),
            #[inline(always)]
            |place| {
                known.get_or_find(
                    place,
                    #[inline(always)]
                    || all[self.leaves[place] as usize].importance(query),
                )
            },
            u,
        )
    }

    /// The probability of a mirror if there were one candidate, to the bit that of [`Cell::choose`]; `None` if it is never
    /// chosen.
    #[inline(always)]
    pub(super) fn prob(&self, all: &[TriangleLeaf], query: &Query, leaf: u32, child: usize) -> Option<f64> {
        let place = self.leaves.binary_search(&leaf).ok()?;
        let of_mirrors = ChildWeights::of_importance(all[leaf as usize].importance(query));
        (of_mirrors.total() > 0.0).then(|| self.prob_of(place) * of_mirrors.prob(child))
    }

    /// The probability of choosing the leaf at this place in the list.
    #[inline(always)]
    pub(super) fn prob_of(&self, place: usize) -> f64 {
        (self.ends[place] - self.end_before(place)) / self.total()
    }

    #[inline(always)]
    fn end_before(&self, place: usize) -> f64 {
        if place == 0 { 0.0 } else { self.ends[place - 1] }
    }

    /// The places of the leaves that [`choose_systematically`] chooses by `u`, and the number that is left.
    #[inline(always)]
    fn choose_systematically<const N: usize>(&self, u: f64) -> ([usize; N], f64) {
        choose_systematically(
            u,
            #[inline(always)]
            |u| {
                let at = u * self.total();
                // Rounding may reach the end of the last.
                let index = self.ends.partition_point(|&end| end <= at).min(self.leaves.len() - 1);
                Chosen { index, from_start: at - self.end_before(index), to_end: self.ends[index] - at }
            },
        )
    }
}
