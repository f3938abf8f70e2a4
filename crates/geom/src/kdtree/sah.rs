//! The surface area heuristic: halve a cell where the expected cost of a ray is least.
//!
//! A ray that crosses a cell crosses a part of it with a probability that is the ratio of their
//! surface areas (Goldsmith and Salmon 1987). The cost is piecewise linear in the plane's
//! position, with its minima at the triangles' bounds, so sweeping those finds the best plane
//! (Wald and Havran, "On building fast kd-trees for ray tracing", 2006).

use super::member::Member;
use crate::Aabb;

/// A plane `axis = position`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plane {
    pub(super) axis: usize,
    pub(super) position: f32,
    /// To which side triangles that lie within the plane go.
    pub(super) within: Side,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Lower,
    Upper,
}

/// A plane and how many boxes lie on its two sides; one that straddles it counts for both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Split {
    pub(super) plane: Plane,
    pub(super) counts: [usize; 2],
}

/// Costs in units of deciding one triangle.
#[derive(Clone, Copy)]
pub(super) struct Costs {
    pub(super) traversal: f64,
    pub(super) empty_factor: f64,
}

/// What the sweep meets at a position, in the order in which it must count it.
#[derive(Clone, Copy)]
enum Kind {
    End,
    Within,
    Start,
}

/// A position and what the sweep meets there, as a number that sorts by both.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Event(u64);

impl Event {
    fn new(position: f32, kind: Kind) -> Self {
        let bits = position.to_bits();
        // Negative numbers descend by their bits, and come before the positive ones.
        let ascending = if position.is_sign_negative() { !bits } else { bits | SIGN };
        Self(u64::from(ascending) << 2 | kind as u64)
    }

    fn position(self) -> f32 {
        let ascending = (self.0 >> 2) as u32;
        f32::from_bits(if ascending < SIGN { !ascending } else { ascending ^ SIGN })
    }

    /// The kind as a number.
    fn kind(self) -> usize {
        (self.0 & 3) as usize
    }
}

/// The sign bit of an `f32`.
const SIGN: u32 = 1 << 31;

/// The cheapest plane strictly inside `cell` for its `members`; `None` if deciding them all is no
/// dearer.
pub(super) fn best_split(cell: &Aabb, members: &[Member], costs: Costs) -> Option<Split> {
    let mut best = None;
    let mut best_cost = members.len() as f64;
    let mut events = Vec::with_capacity(2 * members.len());
    for axis in 0..3 {
        if cell.min[axis] == cell.max[axis] {
            continue;
        }
        collect_events(members, axis, &mut events);
        sweep(cell, axis, members.len(), &events, |split| {
            let cost = split_cost(cell, &split, costs);
            if cost < best_cost {
                best_cost = cost;
                best = Some(split);
            }
        });
    }
    best
}

fn collect_events(members: &[Member], axis: usize, events: &mut Vec<Event>) {
    events.clear();
    for Member { bounds, .. } in members {
        let (min, max) = (bounds.min[axis], bounds.max[axis]);
        if min == max {
            events.push(Event::new(min, Kind::Within));
        } else {
            events.extend([Event::new(min, Kind::Start), Event::new(max, Kind::End)]);
        }
    }
    events.sort_unstable();
}

/// Calls `visit` with each candidate for a split.
fn sweep(cell: &Aabb, axis: usize, count: usize, events: &[Event], mut visit: impl FnMut(Split)) {
    let (mut lower, mut upper) = (0, count);
    for here in events.chunk_by(|a, b| a.0 >> 2 == b.0 >> 2) {
        let position = here[0].position();
        let mut of = [0; 3];
        here.iter().for_each(|event| of[event.kind()] += 1);
        let [ends, within, starts] = of;
        upper -= ends + within;
        if cell.min[axis] < position && position < cell.max[axis] {
            let plane = |within| Plane { axis, position, within };
            visit(Split { plane: plane(Side::Lower), counts: [lower + within, upper] });
            if within > 0 {
                visit(Split { plane: plane(Side::Upper), counts: [lower, upper + within] });
            }
        }
        lower += starts + within;
    }
}

fn split_cost(cell: &Aabb, Split { plane, counts }: &Split, costs: Costs) -> f64 {
    let [mut low, mut high] = [*cell; 2];
    low.max[plane.axis] = plane.position;
    high.min[plane.axis] = plane.position;
    let tests = low.half_area() * counts[0] as f64 + high.half_area() * counts[1] as f64;
    let factor = if counts.contains(&0) { costs.empty_factor } else { 1.0 };
    factor * (costs.traversal + tests / cell.half_area())
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    const COSTS: Costs = Costs { traversal: 1.0, empty_factor: 0.8 };

    fn members(boxes: &[Aabb]) -> Vec<Member> {
        boxes.iter().map(|&bounds| Member { index: 0, bounds }).collect()
    }

    #[test]
    fn events_sort_by_position_then_kind() {
        let tiny = f32::from_bits(1);
        let positions = [-f32::MAX, -1.0, -tiny, 0.0, tiny, 1.0, f32::MAX];
        let kinds = [Kind::End, Kind::Within, Kind::Start];
        let events: Vec<Event> =
            positions.iter().flat_map(|&x| kinds.map(|kind| Event::new(x, kind))).collect();
        assert!(events.is_sorted());
        for (i, event) in events.iter().enumerate() {
            assert_eq!((event.position(), event.kind()), (positions[i / 3], i % 3));
        }
    }

    #[test]
    fn the_sweep_counts_every_triangle() {
        let boxes: Vec<Aabb> = [(0.0, 1.0), (1.0, 1.0), (0.5, 3.0), (2.0, 4.0)]
            .map(|(a, b)| Aabb { min: Vec3::new(a, 0.0, 0.0), max: Vec3::new(b, 1.0, 1.0) })
            .to_vec();
        let cell = boxes.iter().fold(Aabb::EMPTY, |a, b| a.union(b));
        let mut events = Vec::new();
        collect_events(&members(&boxes), 0, &mut events);
        sweep(&cell, 0, boxes.len(), &events, |Split { plane, counts }| {
            let s = plane.position;
            let within = |b: &&Aabb| b.min.x == s && b.max.x == s;
            let side = |side| if plane.within == side { boxes.iter().filter(within).count() } else { 0 };
            let low = boxes.iter().filter(|b| b.min.x < s).count() + side(Side::Lower);
            let high = boxes.iter().filter(|b| b.max.x > s).count() + side(Side::Upper);
            assert_eq!(counts, [low, high], "{plane:?}");
        });
    }

    #[test]
    fn empty_space_is_cut_off_and_identical_boxes_are_left_together() {
        let small = Aabb { min: Vec3::ZERO, max: Vec3::splat(0.1) };
        let cell = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
        let members = members(&[small; 100]);
        let split = best_split(&cell, &members, COSTS).unwrap();
        assert_eq!((split.plane.position, split.counts), (0.1, [100, 0]));
        assert_eq!(best_split(&small, &members, COSTS), None);
    }
}
