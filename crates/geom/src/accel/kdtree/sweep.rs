//! The surface area heuristic: split a cell where the expected cost of a ray is least.
//!
//! The cost is piecewise linear in the plane's position between the faces of triangles' boxes, so a sweep
//! over the faces finds the minimum (Wald and Havran, "On building fast kd-trees for ray tracing", 2006).

use super::cost::{AxisCosts, CostModel};
use super::events::{Event, Events};
use super::plane::{Plane, Side, Split};
use crate::Aabb;

/// The cheapest split of `cell`, which has `count` references; `None` if no face of a box is strictly inside the
/// cell.
pub(super) fn cheapest_split(cell: &Aabb, count: usize, events: &Events, costs: &CostModel) -> Option<Split> {
    let mut cheapest = None;
    let mut least = f64::INFINITY;
    for axis in 0..3 {
        let costs = AxisCosts::new(costs, cell, axis);
        sweep(cell, axis, count, events.along(axis), |split| {
            let cost = costs.of(&split);
            if cost < least {
                least = cost;
                cheapest = Some(split);
            }
        });
    }
    cheapest
}

/// Calls `visit` with each candidate split along `axis`.
fn sweep(cell: &Aabb, axis: usize, count: usize, events: &[Event], mut visit: impl FnMut(Split)) {
    let (mut lower, mut upper) = (0, count);
    let mut rest = events;
    while let Some(&first) = rest.first() {
        let mut of = [0; 3];
        while let Some((&event, later)) = rest.split_first()
            && event.is_at_position_of(first)
        {
            of[event.kind()] += 1;
            rest = later;
        }
        let [ends, within, starts] = of;
        upper -= ends + within;
        let plane = |within| Plane { axis, position: first.position(), within };
        if plane(Side::Lower).halves_properly(cell) {
            visit(Split { plane: plane(Side::Lower), counts: [lower + within, upper] });
            if within > 0 {
                visit(Split { plane: plane(Side::Upper), counts: [lower, upper + within] });
            }
        }
        lower += starts + within;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::prim_ref::PrimRef;
    use glam::Vec3;

    const COSTS: CostModel = CostModel { traversal: 1.0, empty_factor: 0.8 };

    fn refs(boxes: &[Aabb]) -> Vec<PrimRef> {
        boxes.iter().map(|&bounds| PrimRef { index: 0, bounds }).collect()
    }

    #[test]
    fn the_sweep_counts_every_triangle() {
        let boxes = [(0.0, 1.0), (1.0, 1.0), (0.5, 3.0), (2.0, 4.0)]
            .map(|(a, b)| Aabb { min: Vec3::new(a, 0.0, 0.0), max: Vec3::new(b, 1.0, 1.0) });
        let (refs, cell) = (refs(&boxes), boxes.iter().fold(Aabb::EMPTY, |a, b| a.union(b)));
        let mut visited = 0;
        sweep(&cell, 0, boxes.len(), Events::new(&refs).along(0), |split| {
            assert_eq!(split, Split::count(split.plane, refs.iter().map(|reference| &reference.bounds)));
            visited += 1;
        });
        assert_eq!(visited, 5);
    }

    #[test]
    fn empty_space_is_cut_off_and_identical_boxes_stay_together() {
        let small = Aabb { min: Vec3::ZERO, max: Vec3::splat(0.1) };
        let cell = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
        let refs = refs(&[small; 100]);
        let events = Events::new(&refs);
        let split = cheapest_split(&cell, 100, &events, &COSTS).unwrap();
        assert_eq!((split.plane.position, split.counts), (0.1, [100, 0]));
        assert_eq!(cheapest_split(&small, 100, &events, &COSTS), None);
    }
}
