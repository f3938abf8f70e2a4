//! Triangles, parted by where they are.

use super::simd::LANES;
use crate::Aabb;
use crate::decide::main_axis;
use crate::kdtree::Member;
use glam::Vec3;

/// Boxes are sorted into so many classes along each axis, by their centers.
const BINS: usize = 16;

/// A box by its lower corner and the opposite of its upper one: the least of both numbers, eight times, makes
/// the box around two.
#[derive(Clone, Copy)]
struct Extremes([f32; 8]);

impl Extremes {
    const EMPTY: Self = Self([f32::INFINITY; 8]);

    fn of(bounds: &Aabb) -> Self {
        let Aabb { min, max } = *bounds;
        Self([min.x, min.y, min.z, 0.0, -max.x, -max.y, -max.z, 0.0])
    }

    fn unite(&mut self, other: &Self) {
        for (least, &x) in self.0.iter_mut().zip(&other.0) {
            *least = if x < *least { x } else { *least };
        }
    }

    fn bounds(&self) -> Aabb {
        let [x, y, z, _, minus_x, minus_y, minus_z, _] = self.0;
        Aabb { min: Vec3::new(x, y, z), max: -Vec3::new(minus_x, minus_y, minus_z) }
    }
}

/// What is in a class, or in several.
#[derive(Clone, Copy)]
struct Bin {
    extremes: Extremes,
    count: usize,
}

impl Bin {
    const EMPTY: Self = Self { extremes: Extremes::EMPTY, count: 0 };

    fn add(&mut self, extremes: &Extremes, count: usize) {
        self.extremes.unite(extremes);
        self.count += count;
    }

    /// Blocks that a ray which meets the scene opens here, times the scene's surface.
    fn cost(&self) -> f64 {
        self.extremes.bounds().half_area() * self.count.div_ceil(LANES) as f64
    }
}

/// A way to part boxes: those of classes below `bin` along `axis` come first.
#[derive(Clone, Copy)]
struct Halving {
    axis: usize,
    bin: usize,
    cost: f64,
}

/// The classes of boxes along an axis.
struct Classes {
    axis: usize,
    /// Where the first begins, and how many there are in a unit of length.
    start: f64,
    rate: f64,
}

impl Classes {
    fn new(axis: usize, centers: &Aabb) -> Self {
        let extent = centers.extent()[axis];
        let rate = if extent > 0.0 { BINS as f64 / extent } else { 0.0 };
        Self { axis, start: centers.min[axis].into(), rate }
    }

    fn of(&self, member: &Member) -> usize {
        let along = (f64::from(center(member)[self.axis]) - self.start) * self.rate;
        (along as usize).min(BINS - 1)
    }

    /// The halving of least cost.
    fn best(&self, members: &[Member]) -> Option<Halving> {
        let mut bins = [Bin::EMPTY; BINS];
        for member in members {
            bins[self.of(member)].add(&Extremes::of(&member.bounds), 1);
        }
        let mut upper_costs = [0.0; BINS];
        let (mut upper, mut upper_cost) = (Bin::EMPTY, 0.0);
        for (bin, cost) in bins.iter().zip(&mut upper_costs).rev() {
            if bin.count > 0 {
                upper.add(&bin.extremes, bin.count);
                upper_cost = upper.cost();
            }
            *cost = upper_cost;
        }
        let mut lower = Bin::EMPTY;
        // Beyond an empty class there is nothing new to try.
        let halvings = (1..BINS).filter(|bin| bins[bin - 1].count > 0).filter_map(|bin| {
            lower.add(&bins[bin - 1].extremes, bins[bin - 1].count);
            let cost = lower.cost() + upper_costs[bin];
            (lower.count < members.len()).then_some(Halving { axis: self.axis, bin, cost })
        });
        cheapest(halvings)
    }
}

fn cheapest(halvings: impl Iterator<Item = Halving>) -> Option<Halving> {
    halvings.reduce(|best, next| if next.cost < best.cost { next } else { best })
}

/// The center of a member's box.
fn center(member: &Member) -> Vec3 {
    0.5 * (member.bounds.min + member.bounds.max)
}

/// Reorders `members` so that a lower part of them comes first, where the blocks' expected cost is least (Wald,
/// "On fast construction of SAH-based bounding volume hierarchies", 2007). Returns along which axis, and how
/// many these are; `None` if all are in one place.
pub(super) fn part(members: &mut [Member]) -> Option<(u8, usize)> {
    let centers = Aabb::around(members.iter().map(center));
    let halvings = (0..3).filter_map(|axis| Classes::new(axis, &centers).best(members));
    let Halving { axis, bin, .. } = cheapest(halvings)?;
    let classes = Classes::new(axis, &centers);
    let (lower, upper): (Vec<_>, Vec<_>) = members.iter().partition(|m| classes.of(m) < bin);
    let (first, second) = members.split_at_mut(lower.len());
    first.copy_from_slice(&lower);
    second.copy_from_slice(&upper);
    Some((axis as u8, lower.len()))
}

/// [`part`] for members that are more than a block holds: if `must_balance`, or if all are in one place, into
/// whole blocks, as many as possible in either part.
pub(super) fn halve(members: &mut [Member], must_balance: bool) -> (u8, usize) {
    let parted = if must_balance { None } else { part(members) };
    parted.unwrap_or_else(|| {
        let axis = main_axis(Aabb::around(members.iter().map(center)).extent());
        members.sort_by(|a, b| center(a)[axis].total_cmp(&center(b)[axis]));
        (axis as u8, members.len().div_ceil(2).next_multiple_of(LANES))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn member(index: usize, [x, y, z]: [i8; 3], size: u8) -> Member {
        let min = Vec3::new(x.into(), y.into(), z.into());
        Member { index: index as u32, bounds: Aabb { min, max: min + f32::from(size) } }
    }

    /// Half the surface of the box of all, times the blocks that they fill.
    fn cost(members: &[Member]) -> f64 {
        let mut all = Bin::EMPTY;
        members.iter().for_each(|m| all.add(&Extremes::of(&m.bounds), 1));
        all.cost()
    }

    #[test]
    fn what_lies_apart_is_parted() {
        // Every other one lies far up along z.
        let mut members: Vec<_> = (0..20).map(|i| member(i, [i as i8, 3, 100 * (i % 2) as i8], 1)).collect();
        assert_eq!(halve(&mut members, false), (2, 10));
        assert!(
            members[..10].iter().all(|m| m.index % 2 == 0) && members[10..].iter().all(|m| m.index % 2 == 1)
        );
    }

    #[test]
    fn what_lies_in_one_place_is_halved_into_whole_blocks() {
        let mut members: Vec<_> = (0..41).map(|i| member(i, [5, 5, 5], 2)).collect();
        assert_eq!(halve(&mut members, false), (0, 24));
        assert!(members.iter().zip(0..).all(|(m, i)| m.index == i));
    }

    proptest! {
        #[test]
        fn nothing_is_lost_and_no_class_would_have_been_better(
            boxes in prop::collection::vec((prop::array::uniform3(-20i8..20), 0u8..4), 9..80), must_balance: bool,
        ) {
            let mut members: Vec<_> =
                boxes.iter().enumerate().map(|(i, &(corner, size))| member(i, corner, size)).collect();
            let before = members.clone();
            let (axis, lower) = halve(&mut members, must_balance);
            let mut indices: Vec<_> = members.iter().map(|m| m.index).collect();
            indices.sort_unstable();
            prop_assert!(indices.into_iter().eq(0..before.len() as u32));
            let (low, high) = members.split_at(lower);
            prop_assert!(!low.is_empty() && !high.is_empty());
            let along = |m: &Member| center(m)[usize::from(axis)];
            let last = low.iter().map(along).fold(f32::NEG_INFINITY, f32::max);
            prop_assert!(high.iter().all(|m| along(m) >= last));
            if must_balance {
                prop_assert_eq!(lower, before.len().div_ceil(2).next_multiple_of(LANES));
                return Ok(());
            }
            let centers = Aabb::around(before.iter().map(center));
            for axis in 0..3 {
                let classes = Classes::new(axis, &centers);
                for bin in 1..BINS {
                    let (a, b): (Vec<_>, Vec<_>) = before.iter().partition(|m| classes.of(m) < bin);
                    if !a.is_empty() && !b.is_empty() {
                        prop_assert!(cost(low) + cost(high) <= cost(&a) + cost(&b));
                    }
                }
            }
        }
    }
}
