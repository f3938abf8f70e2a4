use super::cost::CostModel;
use super::tree::KdTree;
use crate::GeomError;

/// The choice of the split plane of a [`KdTree`] cell.
///
/// Leaf criteria, limits, clipping and layout are the same for all rules. Those from
/// [`MedianOfSpread`](SplitRule::MedianOfSpread) to [`SlidingFair`](SplitRule::SlidingFair) are those of the ANN library
/// for points (Arya and Mount, 1998); [`MedianOfSide`](SplitRule::MedianOfSide) is the rule of textbooks. Here a *point* is
/// the center of the bounds of a triangle's part in the cell; both halves reference a triangle that straddles the plane. If
/// the plane of a rule does not lie strictly inside the cell, the cell is split in the middle of its longest side.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum SplitRule {
    /// At the median point along the longest side of the cell.
    MedianOfSide,
    /// At the median point along the axis of the largest spread of the points; the standard rule of ANN.
    MedianOfSpread,
    /// In the middle of the longest side; of equal sides, that of the largest spread of the points.
    Midpoint,
    /// [`Midpoint`](SplitRule::Midpoint), but a plane with all triangles on one side slides to the nearest of
    /// their bounds, so that the empty half is as large as possible.
    SlidingMidpoint,
    /// As near to the median point as the bound [`KdOptions::max_aspect`] on the aspect ratio of both halves
    /// allows, along the axis of the largest spread of the points, of those axes on which a split in the
    /// middle keeps the bound.
    Fair,
    /// [`Fair`](SplitRule::Fair), but a plane with all triangles on one side slides as in
    /// [`SlidingMidpoint`](SplitRule::SlidingMidpoint), regardless of the aspect ratio.
    SlidingFair,
    /// Surface area heuristic: the least expected cost of a ray over all planes at the faces of triangles'
    /// bounds (MacDonald and Booth, 1990; Wald and Havran, 2006).
    #[default]
    SurfaceArea,
}

impl SplitRule {
    /// All rules.
    pub const ALL: [Self; 7] = [
        Self::MedianOfSide,
        Self::MedianOfSpread,
        Self::Midpoint,
        Self::SlidingMidpoint,
        Self::Fair,
        Self::SlidingFair,
        Self::SurfaceArea,
    ];
}

/// Options for building a [`KdTree`].
///
/// Made by `default` and then changed, since fields may be added:
///
/// ```
/// let mut options = globillum_geom::KdOptions::default();
/// options.leaf_size = 4;
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct KdOptions {
    /// The choice of split planes.
    pub rule: SplitRule,
    /// The largest number of planes above a leaf, at most [`KdTree::MAX_DEPTH`]; larger values count as that, which is the
    /// default.
    pub max_depth: u32,
    /// A cell with at most this many triangles, 1 by default, becomes a leaf; `maxPrims` of pbrt.
    pub leaf_size: u32,
    /// The number of consecutive planes, 0 by default, that are tried although they do not pay. A plane pays if it lowers
    /// the expected cost of a ray. If the finished subtree is not cheaper than a leaf, it is replaced by the leaf. The
    /// `badRefines` of pbrt counts all such planes from the root on, and the third makes a leaf.
    ///
    /// Any value is valid, since the number of trials is bounded ([`KdTree::build_with`]). The surface area
    /// heuristic does not gain from it; the other rules gain much in scenes aligned with their planes
    /// (docs/accelerators.md). On curved meshes, 3 lowers the expected cost by at most 1 % more than 1.
    pub lookahead: u32,
    /// The cost of visiting an inner node, in units of one triangle test; finite and `>= 0`. The default, 2,
    /// is measured (docs/accelerators.md).
    pub traversal_cost: f64,
    /// The factor on the cost of a split with an empty half, traversal included, in `(0, 1]`; 0.9 by default (the lambda of
    /// Wald and Havran 2006). In pbrt, 1 minus `emptyBonus` is the factor on the cost of triangle tests alone.
    pub empty_factor: f64,
    /// The bound of the fair rules on the ratio of a cell's longest to its shortest side; finite and `>= 2`; 3 by
    /// default.
    pub max_aspect: f64,
}

impl Default for KdOptions {
    fn default() -> Self {
        Self {
            rule: SplitRule::default(),
            max_depth: KdTree::MAX_DEPTH,
            leaf_size: 1,
            lookahead: 0,
            traversal_cost: 2.0,
            empty_factor: 0.9,
            max_aspect: 3.0,
        }
    }
}

impl KdOptions {
    /// The default options with this `rule`.
    pub fn by_rule(rule: SplitRule) -> Self {
        Self { rule, ..Self::default() }
    }

    pub(super) fn validate(&self) -> Result<(), GeomError> {
        let param = |name, value, range| Err(GeomError::Param { name, value, range });
        if !(self.traversal_cost.is_finite() && self.traversal_cost >= 0.0) {
            return param("traversal_cost", self.traversal_cost, "[0, inf)");
        }
        if !(self.empty_factor > 0.0 && self.empty_factor <= 1.0) {
            return param("empty_factor", self.empty_factor, "(0, 1]");
        }
        if !(self.max_aspect.is_finite() && self.max_aspect >= 2.0) {
            return param("max_aspect", self.max_aspect, "[2, inf)");
        }
        Ok(())
    }

    pub(super) fn costs(&self) -> CostModel {
        CostModel { traversal: self.traversal_cost, empty_factor: self.empty_factor }
    }
}
