use super::cost::CostModel;
use super::tree::KdTree;
use crate::GeomError;

/// Where a [`KdTree`] halves a cell.
///
/// All rules share everything else: leaf criteria, limits, the cutting of triangles at the faces
/// of cells, the layout. The first six are those of the ANN library for points (Arya and Mount,
/// 1998). Here a *point* is the middle of the box around a triangle's part in the cell, and a
/// triangle that straddles a plane is listed on both sides. Where a rule's plane would leave a
/// cell whole, the cell is halved in the middle of its longest side.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum SplitRule {
    /// At the median point along the longest side of the cell.
    MedianOfSide,
    /// At the median point along the axis on which the points spread furthest; ANN's standard
    /// rule.
    MedianOfSpread,
    /// In the middle of the longest side; of equal ones, the one along which points spread
    /// furthest.
    Midpoint,
    /// As [`Midpoint`](SplitRule::Midpoint); but a plane with all triangles on one side slides to
    /// the first of their boxes, and so cuts off all the empty space there is.
    SlidingMidpoint,
    /// Along the axis on which points spread furthest, of those on which half a cell would keep
    /// its longest side within [`KdOptions::max_aspect`] times that half; as near to the median
    /// point as that bound allows.
    Fair,
    /// As [`Fair`](SplitRule::Fair); but a plane with all triangles on one side slides as in
    /// [`SlidingMidpoint`](SplitRule::SlidingMidpoint), whatever the aspect of what it cuts off.
    SlidingFair,
    /// Where the expected cost of a ray is least, over all planes at triangles' boxes: the surface
    /// area heuristic (MacDonald and Booth, 1990; Wald and Havran, 2006).
    #[default]
    SurfaceArea,
}

impl SplitRule {
    /// Every rule.
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

/// How a [`KdTree`] is built.
///
/// ```
/// use globillum_geom::{KdOptions, SplitRule};
///
/// let mut options = KdOptions::by_rule(SplitRule::SlidingMidpoint);
/// options.leaf_size = 4;
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct KdOptions {
    /// Where cells are halved.
    pub rule: SplitRule,
    /// Most planes above a leaf; more than [`KdTree::MAX_DEPTH`] counts as that.
    pub max_depth: u32,
    /// A cell with at most this many triangles is not halved.
    pub leaf_size: u32,
    /// A plane pays if it lowers the expected cost of a ray. So many planes in a row are tried that
    /// do not pay by themselves; if all that follows has not paid for them in the end, they are
    /// taken out again. The surface area heuristic gains nothing by it, the other rules much in
    /// scenes aligned with their planes (docs/accelerators.md).
    ///
    /// Any number is allowed: what is tried is bounded whatever the number ([`KdTree::build`]). On curved meshes 3
    /// lower the expected cost by at most 1 % more than 1 do.
    pub lookahead: u32,
    /// Cost of visiting an inner node, in units of deciding one triangle; finite and `>= 0`. The
    /// default was measured (docs/accelerators.md).
    pub traversal_cost: f64,
    /// Factor on the cost of a split that cuts off an empty cell, in `(0, 1]`.
    pub empty_factor: f64,
    /// The fair rules' bound on a cell's longest side over its shortest, `>= 2`.
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
    /// The default options, but for the rule.
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
