//! What a node of the binary tree costs in 1 to 8 lanes of a wide node (Ylitie, Karras and Laine, "Efficient
//! incoherent ray traversal on GPUs through compressed wide BVHs", 2017, section 3).

use crate::Aabb;
use crate::accel::wide::simd::LANES;

/// Bounds are flat if they are thinner than this part of their longest side.
const MAX_FLAT_THICKNESS: f64 = 1.0 / 256.0;
/// The cost of a visit to a leaf block, in visits to a node (measured, docs/performance.md).
pub(super) const BLOCK_COST: f64 = 4.0;

/// The least expected cost of a subtree in 1, 2, .. 8 lanes: visits to nodes, in the unit of [`expected_visits`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct CollapseCosts(pub(super) [f32; LANES]);

impl CollapseCosts {
    /// The costs of a leaf block that gets `visits`: it takes one lane, however many there are.
    pub(super) fn of_leaf(visits: f64) -> Self {
        Self([(BLOCK_COST * visits) as f32; LANES])
    }

    /// The costs of an inner node that gets `visits`: in one lane it becomes a node, whose lanes its
    /// children share; in several lanes the children share these.
    pub(super) fn of_inner(visits: f64, low: &Self, high: &Self) -> Self {
        Self([visits as f32 + low.share(high, LANES).1; LANES]).or_shared(low, high)
    }

    /// The same cost in one lane; in several, the least of what fewer lanes cost and what the children
    /// cost that share them.
    pub(super) fn or_shared(mut self, low: &Self, high: &Self) -> Self {
        for lanes in 2..=LANES {
            self.0[lanes - 1] = low.share(high, lanes).1.min(self.0[lanes - 2]);
        }
        self
    }

    /// How many of `lanes`, at least 2, the lower of two children best gets, and the cost of both.
    pub(super) fn share(&self, high: &Self, lanes: usize) -> (usize, f32) {
        let cost = |first: usize| (first, self.0[first - 1] + high.0[lanes - first - 1]);
        (2..lanes).map(cost).fold(cost(1), |best, next| if next.1 < best.1 { next } else { best })
    }

    pub(super) fn in_one_lane(&self) -> f32 {
        self.0[0]
    }

    /// Whether all lanes cost less than one.
    pub(super) fn gain_by_lanes(&self) -> bool {
        self.0[LANES - 1] < self.0[0]
    }
}

/// A number proportional to how many rays meet a box: half its surface (Goldsmith and Salmon, 1987).
///
/// A flat one counts half. Of the lines that meet a wall or a table top, half are rays that start on
/// it and leave it behind. (A needle counts as flat, too; few rays meet it.)
pub(super) fn expected_visits(bounds: &Aabb) -> f64 {
    let extent = bounds.extent();
    let is_flat = extent.min_element() < MAX_FLAT_THICKNESS * extent.max_element();
    bounds.half_area() * if is_flat { 0.5 } else { 1.0 }
}
