//! Sorted events: the positions along each axis at which the boxes of a cell's references start and end.
//!
//! Events are sorted once for the whole scene and stay sorted when cells are split, so that all sweeps
//! together take `O(N log N)` (Wald and Havran, "On building fast kd-trees for ray tracing", 2006, section
//! 4.3).

use super::plane::Place;
use crate::accel::prim_ref::PrimRef;
use rayon::prelude::*;

/// The kind of an event, in the order in which a sweep counts events of the same position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    End,
    /// Start and end of a box that is flat along the axis.
    Within,
    Start,
}

/// A position, a kind and the index of a reference, packed into a number that sorts in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Event(u64);

/// The sign bit of an `f32`.
const SIGN: u32 = 1 << 31;
/// The bits of the reference index, beside 2 for the kind and 32 for the position.
const REFERENCE_BITS: u32 = 30;
const REFERENCE_MASK: u64 = (1 << REFERENCE_BITS) - 1;

impl Event {
    fn new(position: f32, kind: Kind, reference: u32) -> Self {
        // Adding zero makes a negative zero positive.
        let bits = (position + 0.0).to_bits();
        // The bits of negative numbers descend, and sort before those of positive ones.
        let ascending = if bits & SIGN != 0 { !bits } else { bits | SIGN };
        Self(u64::from(ascending) << 32 | (kind as u64) << REFERENCE_BITS | u64::from(reference))
    }

    pub(super) fn position(self) -> f32 {
        let ascending = (self.0 >> 32) as u32;
        f32::from_bits(if ascending < SIGN { !ascending } else { ascending ^ SIGN })
    }

    pub(super) fn is_at_position_of(self, other: Self) -> bool {
        self.0 >> 32 == other.0 >> 32
    }

    /// The [`Kind`] as a number.
    pub(super) fn kind(self) -> usize {
        (self.0 >> REFERENCE_BITS & 3) as usize
    }

    fn reference(self) -> u32 {
        (self.0 & REFERENCE_MASK) as u32
    }

    fn of_reference(self, reference: u32) -> Self {
        Self(self.0 & !REFERENCE_MASK | u64::from(reference))
    }

    /// The position and kind.
    fn key(self) -> u64 {
        self.0 >> REFERENCE_BITS
    }
}

/// The events of a cell's references, sorted along each axis.
#[derive(Debug, Default)]
pub(super) struct Events {
    /// The events of all axes, one axis after another.
    all: Vec<Event>,
    /// The end of each axis in `all`.
    ends: [usize; 3],
}

/// Where a reference goes when its cell is split: to an index in the list of one side, or to both sides.
#[derive(Clone, Copy, Debug)]
pub(super) struct Move(u32);

impl Move {
    /// To `index` in the list of `place`; the index has no meaning for [`Place::Both`].
    #[inline]
    pub(super) fn to(place: Place, index: usize) -> Self {
        Self((index as u32) << 2 | place as u32)
    }

    fn is_to(self, place: Place) -> bool {
        self.0 & 3 == place as u32
    }

    fn index(self) -> u32 {
        self.0 >> 2
    }
}

impl Events {
    /// The events of `refs`, the axes sorted in parallel.
    pub(super) fn new(refs: &[PrimRef]) -> Self {
        let mut events = Self { all: Vec::with_capacity(6 * refs.len()), ends: [0; 3] };
        for axis in 0..3 {
            for (reference, index) in refs.iter().zip(0..) {
                push_events(reference, index, axis, &mut events.all);
            }
            events.ends[axis] = events.all.len();
        }
        let [x, y, _] = events.ends;
        let (xy, z) = events.all.split_at_mut(y);
        let (x, y) = xy.split_at_mut(x);
        // References ascend, and the sort is stable, so the bits of their indices need no pass.
        [x, y, z].into_par_iter().for_each(|axis| radsort::sort_by_key(axis, |event| event.key()));
        events
    }

    /// The events along `axis`, sorted.
    pub(super) fn along(&self, axis: usize) -> &[Event] {
        let start = if axis == 0 { 0 } else { self.ends[axis - 1] };
        &self.all[start..self.ends[axis]]
    }

    /// The events of both halves. Events of references that go to one side keep their order; the events of the
    /// parts of straddling references, which are the references from the indices `parts` on, are sorted and merged
    /// into them.
    pub(super) fn divide(&self, moves: &[Move], refs: [&[PrimRef]; 2], parts: [usize; 2]) -> [Self; 2] {
        // One more than the largest number of events, as `distribute` requires.
        let mut sides = refs.map(|refs| Self { all: Vec::with_capacity(6 * refs.len() + 1), ends: [0; 3] });
        let mut fresh = Vec::new();
        for axis in 0..3 {
            let starts = sides.each_ref().map(|side| side.all.len());
            let [lower, upper] = &mut sides;
            distribute(self.along(axis), moves, [&mut lower.all, &mut upper.all], parts);
            for (side, events) in sides.iter_mut().enumerate() {
                fresh.clear();
                for (reference, index) in refs[side].iter().zip(0..).skip(parts[side]) {
                    push_events(reference, index, axis, &mut fresh);
                }
                fresh.sort_unstable();
                merge(&mut events.all, starts[side], &fresh);
                events.ends[axis] = events.all.len();
            }
        }
        sides
    }
}

/// Appends `events` to the lists of their sides, which get `counts` references; drops those of straddling
/// references.
///
/// The side of an event is unpredictable, so the loop has no branch: it writes every event at the end of both
/// lists, and advances the end of its own.
fn distribute(events: &[Event], moves: &[Move], lists: [&mut Vec<Event>; 2], counts: [usize; 2]) {
    let [lower, upper] = lists;
    let mut ends = [lower.len(), upper.len()];
    lower.resize(ends[0] + 2 * counts[0] + 1, Event(0));
    upper.resize(ends[1] + 2 * counts[1] + 1, Event(0));
    for event in events {
        let to = moves[event.reference() as usize];
        let moved = event.of_reference(to.index());
        lower[ends[0]] = moved;
        upper[ends[1]] = moved;
        ends[0] += usize::from(to.is_to(Place::Lower));
        ends[1] += usize::from(to.is_to(Place::Upper));
    }
    lower.truncate(ends[0]);
    upper.truncate(ends[1]);
}

/// Merges the short sorted list `fresh` into `events[start..]`, from the end.
fn merge(events: &mut Vec<Event>, start: usize, fresh: &[Event]) {
    let mut kept = events.len();
    events.resize(kept + fresh.len(), Event(0));
    let mut end = events.len();
    for &event in fresh.iter().rev() {
        let after = start + first_at_or_after(&events[start..kept], event);
        let to = end - (kept - after);
        events.copy_within(after..kept, to);
        events[to - 1] = event;
        (kept, end) = (after, to - 1);
    }
}

/// The number of events in `kept` that come before `event`: a galloping search from the end.
fn first_at_or_after(kept: &[Event], event: Event) -> usize {
    let mut reach = 1;
    while reach <= kept.len() && kept[kept.len() - reach].key() >= event.key() {
        reach *= 2;
    }
    let (start, end) = (kept.len().saturating_sub(reach), kept.len() - reach / 2);
    start + kept[start..end].partition_point(|e| e.key() < event.key())
}

/// Appends the events along `axis` of `reference`, which has this index in its cell.
fn push_events(reference: &PrimRef, index: u32, axis: usize, events: &mut Vec<Event>) {
    let (min, max) = (reference.bounds.min[axis], reference.bounds.max[axis]);
    if min == max {
        events.push(Event::new(min, Kind::Within, index));
    } else {
        events.extend([Event::new(min, Kind::Start, index), Event::new(max, Kind::End, index)]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Aabb;
    use glam::Vec3;
    use proptest::prelude::*;

    #[test]
    fn events_sort_by_position_then_kind() {
        let tiny = f32::from_bits(1);
        let positions = [-f32::MAX, -1.0, -tiny, 0.0, tiny, 1.0, f32::MAX];
        let kinds = [Kind::End, Kind::Within, Kind::Start];
        let last = (1 << REFERENCE_BITS) - 1;
        let events: Vec<Event> =
            positions.iter().flat_map(|&x| kinds.map(|kind| Event::new(x, kind, last))).collect();
        assert!(events.is_sorted());
        for (i, event) in events.iter().enumerate() {
            assert_eq!((event.position(), event.kind(), event.reference()), (positions[i / 3], i % 3, last));
        }
        assert_eq!(Event::new(-0.0, Kind::End, 7), Event::new(0.0, Kind::End, 7));
    }

    fn reference([a, b]: [i8; 2]) -> PrimRef {
        let (min, max) = (f32::from(a.min(b)), f32::from(a.max(b)));
        PrimRef { index: 0, bounds: Aabb { min: Vec3::splat(min), max: Vec3::splat(max) } }
    }

    /// Positions and kinds. The order of references with equal keys is not specified.
    fn keys(events: &Events, axis: usize) -> Vec<u64> {
        events.along(axis).iter().map(|event| event.key()).collect()
    }

    proptest! {
        #[test]
        fn divided_events_equal_sorted_ones(
            boxes in prop::collection::vec(prop::array::uniform2(-8i8..8), 1..40), at in -8i8..8,
        ) {
            let refs: Vec<PrimRef> = boxes.into_iter().map(reference).collect();
            let at = f32::from(at);
            let straddles = |reference: &PrimRef| reference.bounds.min.x < at && reference.bounds.max.x > at;
            let mut sides = [Vec::new(), Vec::new()];
            let moves: Vec<Move> = refs.iter().map(|reference| {
                if straddles(reference) {
                    return Move::to(Place::Both, 0);
                }
                let side = if reference.bounds.max.x > at { Place::Upper } else { Place::Lower };
                sides[side as usize].push(*reference);
                Move::to(side, sides[side as usize].len() - 1)
            }).collect();
            let parts = sides.each_ref().map(Vec::len);
            for (_, i) in refs.iter().filter(|reference| straddles(reference)).zip(0..) {
                // Arbitrary other boxes, like those that clipping makes.
                sides[0].push(reference([i % 5, 3]));
                sides[1].push(reference([-i % 7, i % 3]));
            }
            let lists = sides.each_ref().map(Vec::as_slice);
            let divided = Events::new(&refs).divide(&moves, lists, parts);
            for (side, refs) in divided.iter().zip(lists) {
                let fresh = Events::new(refs);
                for axis in 0..3 {
                    prop_assert_eq!(keys(side, axis), keys(&fresh, axis));
                }
            }
        }
    }
}
