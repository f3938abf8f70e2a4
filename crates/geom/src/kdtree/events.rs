//! Sorted events: where, along each axis, the boxes of a cell's members begin and end.
//!
//! Sorted once for the whole scene and kept sorted while cells are halved, so that finding all
//! planes takes `O(N log N)` in all (Wald and Havran, "On building fast kd-trees for ray tracing",
//! 2006, section 4.3).

use super::member::Member;
use super::plane::Side;

/// What is met at a position, in the order in which a sweep must count it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    End,
    Within,
    Start,
}

/// A position, what is met there, and whose it is; as a number that sorts in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Event(u64);

/// The sign bit of an `f32`.
const SIGN: u32 = 1 << 31;
/// Bits for the member, so that with two for the kind and 32 for the position 64 are full.
const MEMBER_BITS: u32 = 30;
const MEMBER_MASK: u64 = (1 << MEMBER_BITS) - 1;

impl Event {
    fn new(position: f32, kind: Kind, member: u32) -> Self {
        // Adding zero turns the negative zero into the other one.
        let bits = (position + 0.0).to_bits();
        // Negative numbers descend by their bits, and come before the positive ones.
        let ascending = if bits & SIGN != 0 { !bits } else { bits | SIGN };
        Self(u64::from(ascending) << 32 | (kind as u64) << MEMBER_BITS | u64::from(member))
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
        (self.0 >> MEMBER_BITS & 3) as usize
    }

    fn member(self) -> u32 {
        (self.0 & MEMBER_MASK) as u32
    }

    fn of_member(self, member: u32) -> Self {
        Self(self.0 & !MEMBER_MASK | u64::from(member))
    }

    /// All but the member.
    fn key(self) -> u64 {
        self.0 >> MEMBER_BITS
    }
}

/// The events of a cell's members, sorted along each axis.
#[derive(Debug, Default)]
pub(super) struct Events {
    /// Axis by axis.
    all: Vec<Event>,
    /// Where each axis ends.
    ends: [usize; 3],
}

/// What becomes of a member when its cell is halved: the side that alone lists it and its place
/// there, or that it straddles the plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Move(u32);

impl Move {
    pub(super) const STRADDLES: Self = Self(u32::MAX);

    pub(super) fn to(side: Side, place: usize) -> Self {
        Self((place as u32) << 1 | side as u32)
    }

    fn target(self) -> Option<(usize, u32)> {
        (self.0 != Self::STRADDLES.0).then_some(((self.0 & 1) as usize, self.0 >> 1))
    }
}

impl Events {
    pub(super) fn new(members: &[Member]) -> Self {
        let mut events = Self { all: Vec::with_capacity(6 * members.len()), ends: [0; 3] };
        for axis in 0..3 {
            let start = events.all.len();
            for (member, place) in members.iter().zip(0..) {
                push_events(member, place, axis, &mut events.all);
            }
            events.all[start..].sort_unstable();
            events.ends[axis] = events.all.len();
        }
        events
    }

    pub(super) fn along(&self, axis: usize) -> &[Event] {
        let start = if axis == 0 { 0 } else { self.ends[axis - 1] };
        &self.all[start..self.ends[axis]]
    }

    /// The events of both sides: those of `moves` keep their order, into which those of straddling
    /// members, the places `parts` among the members of each side, are sorted.
    pub(super) fn divide(
        &self,
        moves: &[Move],
        members: [&[Member]; 2],
        parts: &[Vec<u32>; 2],
        scratch: &mut Vec<Event>,
    ) -> [Self; 2] {
        let mut sides = members.map(|m| Self { all: Vec::with_capacity(6 * m.len()), ends: [0; 3] });
        for axis in 0..3 {
            scratch.clear();
            let mut fresh = [0..0, 0..0];
            for side in 0..2 {
                let start = scratch.len();
                for &place in &parts[side] {
                    push_events(&members[side][place as usize], place, axis, scratch);
                }
                scratch[start..].sort_unstable();
                fresh[side] = start..scratch.len();
            }
            for event in self.along(axis) {
                let Some((side, place)) = moves[event.member() as usize].target() else { continue };
                let all = &mut sides[side].all;
                while let Some(&next) = scratch[fresh[side].clone()].first()
                    && next.key() < event.key()
                {
                    all.push(next);
                    fresh[side].start += 1;
                }
                all.push(event.of_member(place));
            }
            for (side, rest) in sides.iter_mut().zip(fresh) {
                side.all.extend_from_slice(&scratch[rest]);
                side.ends[axis] = side.all.len();
            }
        }
        sides
    }
}

/// Adds the events of `member`, which is at `place` among the members of its cell.
fn push_events(member: &Member, place: u32, axis: usize, events: &mut Vec<Event>) {
    let (min, max) = (member.bounds.min[axis], member.bounds.max[axis]);
    if min == max {
        events.push(Event::new(min, Kind::Within, place));
    } else {
        events.extend([Event::new(min, Kind::Start, place), Event::new(max, Kind::End, place)]);
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
        let last = (1 << MEMBER_BITS) - 1;
        let events: Vec<Event> =
            positions.iter().flat_map(|&x| kinds.map(|kind| Event::new(x, kind, last))).collect();
        assert!(events.is_sorted());
        for (i, event) in events.iter().enumerate() {
            assert_eq!((event.position(), event.kind(), event.member()), (positions[i / 3], i % 3, last));
        }
        assert_eq!(Event::new(-0.0, Kind::End, 7), Event::new(0.0, Kind::End, 7));
    }

    fn member([a, b]: [i8; 2]) -> Member {
        let (min, max) = (f32::from(a.min(b)), f32::from(a.max(b)));
        Member { index: 0, bounds: Aabb { min: Vec3::splat(min), max: Vec3::splat(max) } }
    }

    /// Position and kind: members may be numbered in any order among equals.
    fn keys(events: &Events, axis: usize) -> Vec<u64> {
        events.along(axis).iter().map(|event| event.key()).collect()
    }

    proptest! {
        #[test]
        fn dividing_is_as_good_as_sorting_anew(
            boxes in prop::collection::vec(prop::array::uniform2(-8i8..8), 1..40), at in -8i8..8,
        ) {
            let members: Vec<Member> = boxes.into_iter().map(member).collect();
            let (mut sides, mut parts, mut moves) = ([Vec::new(), Vec::new()], [Vec::new(), Vec::new()], Vec::new());
            for m in &members {
                let (below, above) = (m.bounds.min.x < f32::from(at), m.bounds.max.x > f32::from(at));
                let straddles = below && above;
                for side in 0..2 {
                    if straddles {
                        parts[side].push(sides[side].len() as u32);
                        // Some other box, as clipping makes them.
                        sides[side].push(member([at, at + side as i8]));
                    } else if (side == 1) == above {
                        moves.push(Move::to([Side::Lower, Side::Upper][side], sides[side].len()));
                        sides[side].push(*m);
                    }
                }
                if straddles {
                    moves.push(Move::STRADDLES);
                }
            }
            let lists = sides.each_ref().map(Vec::as_slice);
            let divided = Events::new(&members).divide(&moves, lists, &parts, &mut Vec::new());
            for (side, members) in divided.iter().zip(lists) {
                let fresh = Events::new(members);
                for axis in 0..3 {
                    prop_assert_eq!(keys(side, axis), keys(&fresh, axis));
                }
            }
        }
    }
}
