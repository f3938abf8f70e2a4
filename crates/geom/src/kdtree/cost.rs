//! What a ray that meets a cell is expected to cost.
//!
//! It meets a part of the cell with a probability that is the ratio of their surface areas
//! (Goldsmith and Salmon, 1987).

use super::plane::Split;
use crate::Aabb;

/// Costs in units of deciding one triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct CostModel {
    pub(super) traversal: f64,
    pub(super) empty_factor: f64,
}

impl CostModel {
    /// Expected cost of a ray that meets `cell`, if both parts were leaves.
    pub(super) fn of_split(&self, cell: &Aabb, split: &Split) -> f64 {
        AxisCosts::new(self, cell, split.plane.axis).of(split)
    }
}

/// The cost of every split of one cell along one axis: linear in the plane's position.
#[derive(Clone, Copy)]
pub(super) struct AxisCosts {
    costs: CostModel,
    min: f64,
    max: f64,
    /// Half the area of the cell's two faces across the axis, as a share of half the cell's.
    faces: f64,
    /// What each unit of length along the axis adds to that share.
    per_length: f64,
}

impl AxisCosts {
    pub(super) fn new(costs: &CostModel, cell: &Aabb, axis: usize) -> Self {
        let (extent, half_area) = (cell.extent(), cell.half_area());
        let (a, b) = (extent[(axis + 1) % 3], extent[(axis + 2) % 3]);
        Self {
            costs: *costs,
            min: f64::from(cell.min[axis]),
            max: f64::from(cell.max[axis]),
            faces: a * b / half_area,
            per_length: (a + b) / half_area,
        }
    }

    pub(super) fn of(&self, split: &Split) -> f64 {
        let [lower, upper] = split.counts.map(|count| count as f64);
        let at = f64::from(split.plane.position);
        let tests = lower * (self.faces + self.per_length * (at - self.min))
            + upper * (self.faces + self.per_length * (self.max - at));
        let factor = if split.counts.contains(&0) { self.costs.empty_factor } else { 1.0 };
        factor * (self.costs.traversal + tests)
    }
}
