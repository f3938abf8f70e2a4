//! The six split rules that use only the cell and points: the median of the longest side, as in textbooks, and the five
//! of the ANN library (Arya and Mount, 1998).

use super::options::{KdOptions, SplitRule};
use super::plane::{Place, Plane, Side};
use crate::Aabb;
use crate::accel::prim_ref::PrimRef;

/// The split plane of `cell` by `options.rule`; `None` if no plane lies strictly inside the cell.
///
/// # Panics
/// If the rule is the surface area heuristic, which `sweep.rs` implements, or if `refs` is empty.
pub(super) fn choose_plane(options: &KdOptions, cell: &Aabb, refs: &[PrimRef]) -> Option<Plane> {
    let around = Surroundings { cell, refs };
    let plane = match options.rule {
        SplitRule::MedianOfSide => around.median(around.longest_side()),
        SplitRule::MedianOfSpread => around.median(around.widest_spread(|_| true)),
        SplitRule::Midpoint => around.middle(),
        SplitRule::SlidingMidpoint => around.slide(around.middle()),
        SplitRule::Fair => around.fair(options.max_aspect),
        SplitRule::SlidingFair => around.slide(around.fair(options.max_aspect)),
        // Unreachable: the builder calls `cheapest_split` for this rule.
        SplitRule::SurfaceArea => unreachable!("the surface area heuristic sweeps"),
    };
    [plane, around.middle()].into_iter().find(|plane| plane.halves_properly(cell))
}

/// The input of a rule.
struct Surroundings<'a> {
    cell: &'a Aabb,
    refs: &'a [PrimRef],
}

impl Surroundings<'_> {
    fn length(&self, axis: usize) -> f64 {
        self.cell.extent()[axis]
    }

    /// The distance between the smallest and the largest point along `axis`.
    fn spread(&self, axis: usize) -> f64 {
        let points = || self.refs.iter().map(|reference| f64::from(reference.point(axis)));
        points().fold(f64::NEG_INFINITY, f64::max) - points().fold(f64::INFINITY, f64::min)
    }

    fn longest_side(&self) -> usize {
        let longest = self.cell.extent().max_element();
        self.widest_spread(|axis| self.length(axis) == longest)
    }

    /// The axis of the largest spread among the `allowed` ones; the first of equal ones.
    fn widest_spread(&self, allowed: impl Fn(usize) -> bool) -> usize {
        let axes = (0..3).rev().filter(|&axis| allowed(axis));
        axes.max_by(|&a, &b| self.spread(a).total_cmp(&self.spread(b))).unwrap_or(0)
    }

    fn median(&self, axis: usize) -> Plane {
        let mut points: Vec<f32> = self.refs.iter().map(|reference| reference.point(axis)).collect();
        let half = points.len() / 2;
        let (_, &mut position, _) = points.select_nth_unstable_by(half, f32::total_cmp);
        Plane { axis, position, within: Side::Lower }
    }

    fn middle(&self) -> Plane {
        let axis = self.longest_side();
        Plane { axis, position: middle(self.cell.min[axis], self.cell.max[axis]), within: Side::Lower }
    }

    fn fair(&self, max_aspect: f64) -> Plane {
        let longest = self.cell.extent().max_element();
        let axis = self.widest_spread(|axis| 2.0 * longest <= max_aspect * self.length(axis));
        let others = self.length((axis + 1) % 3).max(self.length((axis + 2) % 3));
        // The thinnest half within the bound.
        let slice = others / max_aspect;
        let lowest = (f64::from(self.cell.min[axis]) + slice) as f32;
        let highest = (f64::from(self.cell.max[axis]) - slice) as f32;
        let median = self.median(axis);
        Plane { position: median.position.max(lowest).min(highest), ..median }
    }

    /// The plane, moved to the nearest box if all boxes are on one side of it.
    fn slide(&self, plane: Plane) -> Plane {
        let all = |place| self.refs.iter().all(|reference| plane.place(&reference.bounds) == place);
        let bounds = || self.refs.iter().map(|reference| reference.bounds);
        if all(Place::Upper) {
            let nearest = bounds().map(|b| b.min[plane.axis]).fold(f32::INFINITY, f32::min);
            Plane { position: nearest, within: Side::Upper, ..plane }
        } else if all(Place::Lower) {
            let nearest = bounds().map(|b| b.max[plane.axis]).fold(f32::NEG_INFINITY, f32::max);
            Plane { position: nearest, within: Side::Lower, ..plane }
        } else {
            plane
        }
    }
}

impl PrimRef {
    /// The coordinate of the center of the bounds.
    fn point(&self, axis: usize) -> f32 {
        middle(self.bounds.min[axis], self.bounds.max[axis])
    }
}

fn middle(min: f32, max: f32) -> f32 {
    // The difference does not overflow for coordinates within the domain.
    min + (max - min) / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    const CELL: Aabb = Aabb { min: Vec3::ZERO, max: Vec3::new(8.0, 4.0, 2.0) };

    /// The plane of `rule` for cubes of side `size` around `points`.
    fn plane(rule: SplitRule, points: &[[f32; 3]], size: f32) -> Option<(usize, f32)> {
        let half = Vec3::splat(size / 2.0);
        let around = |&p: &[f32; 3]| Aabb { min: Vec3::from(p) - half, max: Vec3::from(p) + half };
        let refs: Vec<PrimRef> = points.iter().map(|p| PrimRef { index: 0, bounds: around(p) }).collect();
        choose_plane(&KdOptions::by_rule(rule), &CELL, &refs).map(|plane| (plane.axis, plane.position))
    }

    #[test]
    fn medians_follow_the_side_or_the_spread() {
        let points = [[1.0, 0.5, 1.0], [1.5, 2.0, 1.0], [2.0, 3.5, 1.0]];
        assert_eq!(plane(SplitRule::MedianOfSide, &points, 0.5), Some((0, 1.5)));
        assert_eq!(plane(SplitRule::MedianOfSpread, &points, 0.5), Some((1, 2.0)));
    }

    #[test]
    fn the_midpoint_slides_to_the_first_box() {
        let points = [[1.0, 0.5, 1.0], [1.5, 2.0, 1.0], [2.0, 3.5, 1.0]];
        assert_eq!(plane(SplitRule::Midpoint, &points, 0.5), Some((0, 4.0)));
        assert_eq!(plane(SplitRule::SlidingMidpoint, &points, 0.5), Some((0, 2.25)));
        let far = points.map(|[x, y, z]| [8.0 - x, y, z]);
        assert_eq!(plane(SplitRule::SlidingMidpoint, &far, 0.5), Some((0, 5.75)));
        // The plane stays if a box straddles it.
        assert_eq!(plane(SplitRule::SlidingMidpoint, &points, 4.5), Some((0, 4.0)));
    }

    #[test]
    fn fair_splits_keep_their_aspect() {
        // Only a split of the side of length 8 keeps the bound of 3; the thinnest half is 4/3.
        let low = [[0.5, 0.5, 1.0], [0.75, 2.0, 1.0], [6.0, 3.5, 1.0]];
        assert_eq!(plane(SplitRule::Fair, &low, 0.25), Some((0, 4.0 / 3.0)));
        let high = low.map(|[x, y, z]| [8.0 - x, y, z]);
        assert_eq!(plane(SplitRule::Fair, &high, 0.25), Some((0, (8.0 - 4.0 / 3.0_f64) as f32)));
        let middle = [[1.0, 0.5, 1.0], [3.0, 2.0, 1.0], [6.0, 3.5, 1.0]];
        assert_eq!(plane(SplitRule::Fair, &middle, 0.25), Some((0, 3.0)));
        assert_eq!(plane(SplitRule::SlidingFair, &middle, 0.25), Some((0, 3.0)));
        // All boxes are below the thinnest half: the upper half is empty, and larger with the sliding rule.
        assert_eq!(plane(SplitRule::Fair, &low[..2], 0.25), Some((0, 4.0 / 3.0)));
        assert_eq!(plane(SplitRule::SlidingFair, &low[..2], 0.25), Some((0, 0.875)));
    }

    #[test]
    fn a_plane_at_a_face_is_replaced_by_the_middle() {
        let wall = [[0.0, 0.5, 1.0], [0.0, 2.0, 1.0], [0.0, 3.5, 1.0]];
        assert_eq!(plane(SplitRule::MedianOfSide, &wall, 0.0), Some((0, 4.0)));
        let ulp = Aabb { min: Vec3::ONE, max: Vec3::ONE.map(f32::next_up) };
        let reference = PrimRef { index: 0, bounds: ulp };
        assert_eq!(choose_plane(&KdOptions::by_rule(SplitRule::Midpoint), &ulp, &[reference]), None);
    }
}
