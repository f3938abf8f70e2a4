//! The expected cost of a ray that intersects a cell.
//!
//! The probability that it intersects a part of the cell is the ratio of their surface areas (Goldsmith and
//! Salmon, 1987).

use super::plane::Split;
use crate::Aabb;

/// Costs in units of one triangle test.
#[derive(Clone, Copy, Debug)]
pub(super) struct CostModel {
    pub(super) traversal: f64,
    pub(super) empty_factor: f64,
}

impl CostModel {
    /// The expected cost of a ray that intersects `cell`, if both halves are leaves.
    pub(super) fn of_split(&self, cell: &Aabb, split: &Split) -> f64 {
        AxisCosts::new(self, cell, split.plane.axis).of(split)
    }
}

/// The costs of the splits of one cell along one axis, linear in the plane's position between events.
#[derive(Clone, Copy)]
pub(super) struct AxisCosts {
    costs: CostModel,
    min: f64,
    max: f64,
    /// The area of a face orthogonal to the axis, divided by half the cell's area.
    faces: f64,
    /// The increase of that ratio per unit of length along the axis.
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
