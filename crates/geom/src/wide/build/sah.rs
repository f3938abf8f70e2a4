//! Object splits by the surface area heuristic in bins (Wald, "On fast construction of SAH-based bounding
//! volume hierarchies", 2007).

use crate::Aabb;
use crate::decide::main_axis;
use crate::kdtree::Member;
use crate::wide::simd::LANES;
use glam::Vec3;

/// How many bins there are along an axis.
const BINS: usize = 16;

/// A box as its lower corner and its negated upper one, so that eight minima unite two boxes.
#[derive(Clone, Copy)]
struct MinBox([f32; 8]);

impl MinBox {
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

/// The contents of a bin, or of several.
#[derive(Clone, Copy)]
struct Bin {
    bounds: MinBox,
    count: usize,
}

impl Bin {
    const EMPTY: Self = Self { bounds: MinBox::EMPTY, count: 0 };

    fn add(&mut self, bounds: &MinBox, count: usize) {
        self.bounds.unite(bounds);
        self.count += count;
    }

    /// Leaf blocks that a ray which meets the scene visits here, times half the scene's surface.
    fn cost(&self) -> f64 {
        self.bounds.bounds().half_area() * self.count.div_ceil(LANES) as f64
    }
}

/// A split between bins: the boxes in those below `bin` along `axis` come first.
#[derive(Clone, Copy)]
struct BinSplit {
    axis: usize,
    bin: usize,
    cost: f64,
}

/// The bins along an axis, by the centers of boxes.
struct Bins {
    axis: usize,
    /// Where the first begins, and the number of bins for each unit of length.
    start: f64,
    rate: f64,
}

impl Bins {
    fn new(axis: usize, centers: &Aabb) -> Self {
        let extent = centers.extent()[axis];
        let rate = if extent > 0.0 { BINS as f64 / extent } else { 0.0 };
        Self { axis, start: centers.min[axis].into(), rate }
    }

    fn of(&self, member: &Member) -> usize {
        let along = (f64::from(center(member)[self.axis]) - self.start) * self.rate;
        (along as usize).min(BINS - 1)
    }

    /// The split of least cost; `None` if all are in one bin.
    fn best(&self, members: &[Member]) -> Option<BinSplit> {
        let mut bins = [Bin::EMPTY; BINS];
        for member in members {
            bins[self.of(member)].add(&MinBox::of(&member.bounds), 1);
        }
        let mut upper_costs = [0.0; BINS];
        let (mut upper, mut upper_cost) = (Bin::EMPTY, 0.0);
        for (bin, cost) in bins.iter().zip(&mut upper_costs).rev() {
            if bin.count > 0 {
                upper.add(&bin.bounds, bin.count);
                upper_cost = upper.cost();
            }
            *cost = upper_cost;
        }
        let mut lower = Bin::EMPTY;
        // A split above an empty bin is the same as the one below it.
        let splits = (1..BINS).filter(|bin| bins[bin - 1].count > 0).filter_map(|bin| {
            lower.add(&bins[bin - 1].bounds, bins[bin - 1].count);
            let cost = lower.cost() + upper_costs[bin];
            (lower.count < members.len()).then_some(BinSplit { axis: self.axis, bin, cost })
        });
        cheapest(splits)
    }
}

fn cheapest(splits: impl Iterator<Item = BinSplit>) -> Option<BinSplit> {
    splits.reduce(|best, next| if next.cost < best.cost { next } else { best })
}

/// The center of a member's box.
fn center(member: &Member) -> Vec3 {
    0.5 * (member.bounds.min + member.bounds.max)
}

/// Reorders `members` so that those below the split of least expected cost come first. Returns its axis, and how
/// many these are; `None` if all are in one place.
pub(super) fn split_in_bins(members: &mut [Member]) -> Option<(u8, usize)> {
    let centers = Aabb::around(members.iter().map(center));
    let splits = (0..3).filter_map(|axis| Bins::new(axis, &centers).best(members));
    let BinSplit { axis, bin, .. } = cheapest(splits)?;
    let bins = Bins::new(axis, &centers);
    let (lower, upper): (Vec<_>, Vec<_>) = members.iter().partition(|m| bins.of(m) < bin);
    let (first, second) = members.split_at_mut(lower.len());
    first.copy_from_slice(&lower);
    second.copy_from_slice(&upper);
    Some((axis as u8, lower.len()))
}

/// [`split_in_bins`] for more members than a leaf block holds. If `must_balance`, or if all are in one place, it
/// splits at the median instead, rounded up to whole blocks.
pub(super) fn split(members: &mut [Member], must_balance: bool) -> (u8, usize) {
    let split = if must_balance { None } else { split_in_bins(members) };
    split.unwrap_or_else(|| {
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

    /// Half the surface of the box of all, times the leaf blocks that they fill.
    fn cost(members: &[Member]) -> f64 {
        let mut all = Bin::EMPTY;
        members.iter().for_each(|m| all.add(&MinBox::of(&m.bounds), 1));
        all.cost()
    }

    #[test]
    fn what_lies_apart_is_split() {
        // Every other one lies far up along z.
        let mut members: Vec<_> = (0..20).map(|i| member(i, [i as i8, 3, 100 * (i % 2) as i8], 1)).collect();
        assert_eq!(split(&mut members, false), (2, 10));
        assert!(
            members[..10].iter().all(|m| m.index % 2 == 0) && members[10..].iter().all(|m| m.index % 2 == 1)
        );
    }

    #[test]
    fn what_lies_in_one_place_is_split_into_whole_blocks() {
        let mut members: Vec<_> = (0..41).map(|i| member(i, [5, 5, 5], 2)).collect();
        assert_eq!(split(&mut members, false), (0, 24));
        assert!(members.iter().zip(0..).all(|(m, i)| m.index == i));
    }

    proptest! {
        #[test]
        fn nothing_is_lost_and_no_bin_would_have_been_better(
            boxes in prop::collection::vec((prop::array::uniform3(-20i8..20), 0u8..4), 9..80), must_balance: bool,
        ) {
            let mut members: Vec<_> =
                boxes.iter().enumerate().map(|(i, &(corner, size))| member(i, corner, size)).collect();
            let before = members.clone();
            let (axis, lower) = split(&mut members, must_balance);
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
                let bins = Bins::new(axis, &centers);
                for bin in 1..BINS {
                    let (a, b): (Vec<_>, Vec<_>) = before.iter().partition(|m| bins.of(m) < bin);
                    if !a.is_empty() && !b.is_empty() {
                        prop_assert!(cost(low) + cost(high) <= cost(&a) + cost(&b));
                    }
                }
            }
        }
    }
}
