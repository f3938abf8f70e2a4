//! Object splits by the surface area heuristic in bins (Wald, "On fast construction of SAH-based bounding
//! volume hierarchies", 2007).

use crate::Aabb;
use crate::accel::prim_ref::PrimRef;
use crate::accel::wide::simd::LANES;
use crate::decide::main_axis;
use glam::Vec4;

/// How many bins there are along an axis.
const BINS: usize = 16;
/// `2^23`. Added to a small positive number, it rounds that to an integer, which is then in the low bits of the sum.
const INTEGER_ROUNDER: f32 = 8_388_608.0;

/// A box as its lower corner and its negated upper one, so that minima unite two boxes.
#[derive(Clone, Copy)]
struct MinBox {
    min: Vec4,
    minus_max: Vec4,
}

impl MinBox {
    const EMPTY: Self = Self { min: Vec4::INFINITY, minus_max: Vec4::INFINITY };

    #[inline(always)]
    fn of(bounds: &Aabb) -> Self {
        Self { min: bounds.min.extend(0.0), minus_max: (-bounds.max).extend(0.0) }
    }

    fn bounds(&self) -> Aabb {
        Aabb { min: self.min.truncate(), max: -self.minus_max.truncate() }
    }

    #[inline(always)]
    fn unite(&mut self, other: &Self) {
        *self = Self { min: self.min.min(other.min), minus_max: self.minus_max.min(other.minus_max) };
    }

    /// [`Aabb::half_area`] of a box that is not empty.
    fn half_area(&self) -> f64 {
        let extent = -self.minus_max.truncate().as_dvec3() - self.min.truncate().as_dvec3();
        extent.x * extent.y + extent.y * extent.z + extent.z * extent.x
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

    /// Leaf blocks that a ray which meets the scene visits here, times half the scene's surface; of a bin that is not
    /// empty.
    fn cost(&self) -> f64 {
        self.bounds.half_area() * self.count.div_ceil(LANES) as f64
    }
}

/// A split between bins: the boxes in those below `bin` along `axis` come first.
#[derive(Clone, Copy)]
struct BinSplit {
    axis: usize,
    bin: usize,
    cost: f64,
}

/// What a split sends to one side or the other.
pub(super) trait Bounded: Copy {
    fn bounds(&self) -> Aabb;

    /// The number of triangles.
    fn count(&self) -> usize;
}

impl Bounded for PrimRef {
    fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn count(&self) -> usize {
        1
    }
}

/// The bins along the three axes, by the centers of boxes.
struct Bins {
    /// Where the first ones begin, and the number of bins for each unit of length.
    start: Vec4,
    rate: Vec4,
}

impl Bins {
    /// The bins for these boxes.
    fn new(items: &[impl Bounded]) -> Self {
        let Aabb { min, max } = center_bounds(items);
        let rate = (max - min).map(|extent| if extent > 0.0 { BINS as f32 / extent } else { 0.0 });
        Self { start: min.extend(0.0), rate: rate.extend(0.0) }
    }

    /// The bins of a box with this center. Rounding is monotone, so centers along an axis have bins in order.
    #[inline(always)]
    fn of(&self, center: Vec4) -> [usize; 4] {
        let bins =
            ((center - self.start) * self.rate - 0.5).clamp(Vec4::ZERO, Vec4::splat(BINS as f32 - 1.0));
        // The last bits of the sum are the nearest integer.
        let [x, y, z, w] = (bins + INTEGER_ROUNDER).to_array().map(|bin| bin.to_bits() as usize % BINS);
        [x, y, z, w]
    }

    /// The split of least cost; `None` if all are in one bin along each axis.
    fn best(&self, items: &[impl Bounded]) -> Option<BinSplit> {
        let mut bins = [[Bin::EMPTY; BINS]; 3];
        // Bit `bin` is set for a bin that is not empty.
        let mut filled = [0_u32; 3];
        for item in items {
            let (bounds, count, of) = (MinBox::of(&item.bounds()), item.count(), self.of(center(item)));
            for axis in 0..3 {
                bins[axis][of[axis]].add(&bounds, count);
                filled[axis] |= 1 << of[axis];
            }
        }
        cheapest((0..3).filter_map(|axis| best_along(axis, &bins[axis], filled[axis])))
    }
}

/// The split of least cost between the bins of one axis; `None` if only one is `filled`.
fn best_along(axis: usize, bins: &[Bin; BINS], filled: u32) -> Option<BinSplit> {
    let mut upper_costs = [0.0; BINS];
    let (mut upper, mut remaining) = (Bin::EMPTY, filled);
    while remaining != 0 {
        let bin = remaining.ilog2() as usize;
        upper.add(&bins[bin].bounds, bins[bin].count);
        upper_costs[bin] = upper.cost();
        remaining ^= 1 << bin;
    }
    let (mut lower, mut remaining) = (Bin::EMPTY, filled);
    let splits = std::iter::from_fn(|| {
        let last = remaining.trailing_zeros() as usize;
        remaining &= remaining.wrapping_sub(1);
        (remaining != 0).then(|| {
            lower.add(&bins[last].bounds, bins[last].count);
            let bin = remaining.trailing_zeros() as usize;
            BinSplit { axis, bin, cost: lower.cost() + upper_costs[bin] }
        })
    });
    cheapest(splits)
}

fn cheapest(splits: impl Iterator<Item = BinSplit>) -> Option<BinSplit> {
    splits.reduce(|best, next| if next.cost < best.cost { next } else { best })
}

/// The center of a box, and 0.
#[inline(always)]
pub(super) fn center(item: &impl Bounded) -> Vec4 {
    let Aabb { min, max } = item.bounds();
    (0.5 * (min + max)).extend(0.0)
}

/// The bounds of all centers.
pub(super) fn center_bounds(items: &[impl Bounded]) -> Aabb {
    let mut all = MinBox::EMPTY;
    for center in items.iter().map(center) {
        all.unite(&MinBox { min: center, minus_max: -center });
    }
    all.bounds()
}

/// Reorders `items` so that those below the split of least expected cost come first. Returns its axis, and how
/// many these are; `None` if all are in one place.
pub(super) fn split_in_bins(items: &mut [impl Bounded]) -> Option<(u8, usize)> {
    let bins = Bins::new(items);
    let BinSplit { axis, bin, .. } = bins.best(items)?;
    let mut upper = Vec::with_capacity(items.len());
    let mut lower = 0;
    for at in 0..items.len() {
        let item = items[at];
        if bins.of(center(&item))[axis] < bin {
            items[lower] = item;
            lower += 1;
        } else {
            upper.push(item);
        }
    }
    items[lower..].copy_from_slice(&upper);
    Some((axis as u8, lower))
}

/// [`split_in_bins`] for more references than a leaf block holds. If `must_balance`, or if all are in one place, it
/// splits at the median instead, rounded up to whole blocks.
pub(super) fn split(refs: &mut [PrimRef], must_balance: bool) -> (u8, usize) {
    let split = if must_balance { None } else { split_in_bins(refs) };
    split.unwrap_or_else(|| {
        let axis = main_axis(center_bounds(refs).extent());
        refs.sort_by(|a, b| center(a)[axis].total_cmp(&center(b)[axis]));
        (axis as u8, refs.len().div_ceil(2).next_multiple_of(LANES))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use proptest::prelude::*;

    fn reference(index: usize, [x, y, z]: [i8; 3], size: u8) -> PrimRef {
        let min = Vec3::new(x.into(), y.into(), z.into());
        PrimRef { index: index as u32, bounds: Aabb { min, max: min + f32::from(size) } }
    }

    /// Half the surface of the box of all, times the leaf blocks that they fill.
    fn cost(refs: &[PrimRef]) -> f64 {
        let mut all = Bin::EMPTY;
        refs.iter().for_each(|reference| all.add(&MinBox::of(&reference.bounds), 1));
        all.cost()
    }

    #[test]
    fn what_lies_apart_is_split() {
        // Every other one lies far up along z.
        let mut refs: Vec<_> = (0..20).map(|i| reference(i, [i as i8, 3, 100 * (i % 2) as i8], 1)).collect();
        assert_eq!(split(&mut refs, false), (2, 10));
        assert!(
            refs[..10].iter().all(|reference| reference.index % 2 == 0)
                && refs[10..].iter().all(|reference| reference.index % 2 == 1)
        );
    }

    #[test]
    fn what_lies_in_one_place_is_split_into_whole_blocks() {
        let mut refs: Vec<_> = (0..41).map(|i| reference(i, [5, 5, 5], 2)).collect();
        assert_eq!(split(&mut refs, false), (0, 24));
        assert!(refs.iter().zip(0..).all(|(reference, i)| reference.index == i));
    }

    proptest! {
        #[test]
        fn nothing_is_lost_and_no_bin_would_have_been_better(
            boxes in prop::collection::vec((prop::array::uniform3(-20i8..20), 0u8..4), 9..80), must_balance: bool,
        ) {
            let mut refs: Vec<_> =
                boxes.iter().enumerate().map(|(i, &(corner, size))| reference(i, corner, size)).collect();
            let before = refs.clone();
            let (axis, lower) = split(&mut refs, must_balance);
            let mut indices: Vec<_> = refs.iter().map(|reference| reference.index).collect();
            indices.sort_unstable();
            prop_assert!(indices.into_iter().eq(0..before.len() as u32));
            let (low, high) = refs.split_at(lower);
            prop_assert!(!low.is_empty() && !high.is_empty());
            let along = |reference: &PrimRef| center(reference)[usize::from(axis)];
            let last = low.iter().map(along).fold(f32::NEG_INFINITY, f32::max);
            prop_assert!(high.iter().all(|reference| along(reference) >= last));
            if must_balance {
                prop_assert_eq!(lower, before.len().div_ceil(2).next_multiple_of(LANES));
                return Ok(());
            }
            let bins = Bins::new(&before);
            for axis in 0..3 {
                for bin in 1..BINS {
                    let (a, b): (Vec<_>, Vec<_>) =
                        before.iter().partition(|reference| bins.of(center(*reference))[axis] < bin);
                    if !a.is_empty() && !b.is_empty() {
                        prop_assert!(cost(low) + cost(high) <= cost(&a) + cost(&b));
                    }
                }
            }
        }
    }
}
