use super::systematic::{self, Chosen};

/// The number of children of a node.
pub(super) const WIDTH: usize = 16;

const _: () =
    assert!(WIDTH == 16, "the steps of `of_importance` and `choose` are those for sixteen children");

/// The bits of a child's number in a path.
pub(super) const CHILD_BITS: u32 = WIDTH.trailing_zeros();

/// Half of the lanes.
const HALF: usize = WIDTH / 2;

/// The lane of a child in vectors over all children. Children `2 k` and `2 k + 1` have lanes `k` and `HALF + k`, so vectors
/// of half the width add them.
#[inline(always)]
pub(super) const fn lane_of(child: usize) -> usize {
    child % 2 * HALF + child / 2
}

/// The child of this lane.
#[inline(always)]
pub(super) const fn child_of(lane: usize) -> usize {
    lane % HALF * 2 + lane / HALF
}

/// The weights of the children of a node: a child is chosen with a probability proportional to its weight.
#[derive(Clone, Copy, Debug)]
pub(super) struct ChildWeights {
    of_lanes: [f64; WIDTH],
    /// For each lane, the sum of the weights up to that of its child. None is below the one of the child before.
    ends: [f64; WIDTH],
}

impl ChildWeights {
    /// The share of all weights that [`ChildWeights::with_uniform_share`] divides evenly. Where importances are nearly exact,
    /// a share of 1/1024 would bring most of the variance.
    const UNIFORM_SHARE: f64 = 1.0 / 65536.0;

    /// The least sum of importances of which uniform shares are shares, so that they are above zero.
    const MIN_TOTAL: f64 = 1e-280;

    /// Weights equal to these importances, from 0 up: a child without importance is never chosen. [`ChildWeights::choose`]
    /// and [`ChildWeights::prob`] need a total above zero.
    #[inline(always)]
    pub(super) fn of_importance(importance: [f64; WIDTH]) -> Self {
        // Four steps. A sum is the one of a child before it and a rest, so it is not below that when rounded. Zeros
        // are added exactly, so a child without weight has no interval.
        let mut ends = importance;
        for lane in HALF..WIDTH {
            ends[lane] += ends[lane - HALF];
        }
        add_first_halves::<1>(&mut ends);
        add_first_halves::<2>(&mut ends);
        add_first_halves::<4>(&mut ends);
        Self { of_lanes: importance, ends }
    }

    /// Like [`ChildWeights::of_importance`], but with a uniform share: every child has a probability of at least
    /// `UNIFORM_SHARE / count`. Children from `count` on do not exist and have the importance 0.
    #[inline(always)]
    pub(super) fn with_uniform_share(importance: [f64; WIDTH], count: f64) -> Self {
        let Self { mut of_lanes, mut ends } = Self::of_importance(importance);
        let least = Self::UNIFORM_SHARE / (1.0 - Self::UNIFORM_SHARE) / count;
        let least = least * ends[WIDTH - 1].max(Self::MIN_TOTAL);
        for lane in 0..WIDTH {
            of_lanes[lane] += least;
            // Children that do not exist have no interval, and so are never chosen.
            ends[lane] += least * count.min((child_of(lane) + 1) as f64);
        }
        Self { of_lanes, ends }
    }

    /// The sum of all weights.
    #[inline(always)]
    pub(super) fn total(&self) -> f64 {
        self.ends[WIDTH - 1]
    }

    /// The probability of this child.
    #[inline(always)]
    pub(super) fn prob(&self, child: usize) -> f64 {
        self.of_lanes[lane_of(child)] / self.total()
    }

    /// The child that `u` in `[0, 1)` chooses, which has a weight above zero, and the number in `[0, 1)` that is
    /// left for the choice below it.
    #[inline(always)]
    pub(super) fn choose(&self, u: f64) -> (usize, f64) {
        // Below the total also when rounded, as `u` is at most `1 - 2^-53`.
        let at = u * self.total();
        let ends_before = |child: usize| usize::from(self.ends[lane_of(child)] <= at);
        let first = 4 * (ends_before(3) + ends_before(7) + ends_before(11));
        let child = first + ends_before(first) + ends_before(first + 1) + ends_before(first + 2);
        // It is below the width already.
        let child = child % WIDTH;
        let lane = lane_of(child);
        let rest = 1.0 - (self.ends[lane] - at) / self.of_lanes[lane];
        (child, rest.clamp(0.0, 1.0_f64.next_down()))
    }

    /// The children that [`systematic::choose_systematically`] chooses by `u`, and the number that is left.
    #[inline(always)]
    pub(super) fn choose_systematically<const N: usize>(&self, u: f64) -> ([usize; N], f64) {
        systematic::choose_systematically(
            u,
            #[inline(always)]
            |u| {
                let (index, rest) = self.choose(u);
                let weight = self.of_lanes[lane_of(index)];
                Chosen { index, from_start: rest * weight, to_end: (1.0 - rest) * weight }
            },
        )
    }
}

/// The sum of the importances of all children, by lane.
#[inline(always)]
pub(super) fn sum(importance: [f64; WIDTH]) -> f64 {
    ChildWeights::of_importance(importance).total()
}

/// Adds the sum of the first half of each block of children to all sums in the second half. A half has this many columns; a
/// column has the children of lanes `k` and `HALF + k`.
#[inline(always)]
fn add_first_halves<const COLUMNS: usize>(ends: &mut [f64; WIDTH]) {
    let sums: [f64; HALF] = std::array::from_fn(|column| ends[HALF + column]);
    for (lane, end) in ends.iter_mut().enumerate() {
        let column = lane % HALF;
        if column & COLUMNS != 0 {
            *end += sums[(column & !(COLUMNS - 1)) - 1];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Stream;

    /// Importances over twelve orders of magnitude, a third of them 0, and the number of children.
    fn importances(i: u32) -> ([f64; WIDTH], usize) {
        let numbers = Stream::new(5, 0, i);
        let count = 1 + (WIDTH as f64 * numbers.uniform(0)) as usize;
        let importance = |child: u32| match numbers.uniform(1 + child) {
            u if u < 1.0 / 3.0 => 0.0,
            u => 10.0_f64.powf(18.0 * u - 12.0),
        };
        let of_child = |child: usize| if child < count { importance(child as u32) } else { 0.0 };
        (std::array::from_fn(|lane| of_child(child_of(lane))), count)
    }

    #[test]
    fn a_child_without_importance_is_never_chosen() {
        for i in 0..1000 {
            let (importance, _) = importances(i);
            let weights = ChildWeights::of_importance(importance);
            if weights.total() == 0.0 {
                continue;
            }
            let borders = weights.ends.map(|end| end / weights.total());
            let us = borders.iter().flat_map(|&u| [u.next_down(), u, u.next_up()]);
            for u in us.chain([0.0, 1.0_f64.next_down()]).filter(|u| (0.0..1.0).contains(u)) {
                let (child, left) = weights.choose(u);
                assert!(weights.prob(child) > 0.0 && (0.0..1.0).contains(&left), "{i}: {u}, {child}, {left}");
            }
        }
    }

    /// Of evenly spaced numbers, those that choose the same children leave evenly spaced numbers; a child is among the children
    /// as often as `N` single choices take it.
    #[test]
    fn systematic_choices_have_the_probabilities_of_single_ones() {
        const N: usize = 4;
        let count = 4096;
        for i in 0..100 {
            let weights = ChildWeights::of_importance(importances(i).0);
            if weights.total() == 0.0 {
                continue;
            }
            let mut times = [0_u32; WIDTH];
            let mut rests = std::collections::HashMap::<_, Vec<f64>>::new();
            for k in 0..count {
                let (children, rest) =
                    weights.choose_systematically::<N>((f64::from(k) + 0.5) / f64::from(count));
                children.iter().for_each(|&child| times[child] += 1);
                rests.entry(children).or_default().push(rest);
            }
            for (child, times) in times.into_iter().enumerate() {
                let expected = (N * count as usize) as f64 * weights.prob(child);
                assert!(
                    (f64::from(times) - expected).abs() <= 1.0 + 1e-9,
                    "{i}, {child}: {times}, {expected}"
                );
            }
            for (children, rests) in rests {
                let share = 1.0 / rests.len() as f64;
                for (k, rest) in rests.iter().enumerate() {
                    let expected = (k as f64 + 0.5) * share;
                    assert!((rest - expected).abs() <= share, "{i}, {children:?}: {rest}, {expected}");
                }
            }
            for u in [0.0, 1.0_f64.next_down()] {
                let (children, rest) = weights.choose_systematically::<N>(u);
                assert!(
                    children.iter().all(|&child| weights.prob(child) > 0.0) && (0.0..1.0).contains(&rest)
                );
            }
        }
    }

    #[test]
    fn a_child_is_chosen_where_its_interval_begins_and_ends() {
        for i in 0..1000 {
            let (importance, count) = importances(i);
            let weights = ChildWeights::with_uniform_share(importance, count as f64);
            let total: f64 = importance.iter().sum();
            let mut start = 0.0;
            for child in 0..count {
                let importance = importance[lane_of(child)];
                let prob = weights.prob(child);
                let least = ChildWeights::UNIFORM_SHARE / count as f64;
                let share = if total > 0.0 { importance / total } else { 1.0 / count as f64 };
                let expected = (1.0 - ChildWeights::UNIFORM_SHARE) * share + least;
                assert!((prob - expected).abs() < 1e-15, "{i}, {child}: {prob}, {expected}");
                for (within, rest) in [(0.001, 0.001), (0.5, 0.5), (0.999, 0.999)] {
                    let (chosen, left) = weights.choose(start + within * prob);
                    assert_eq!(chosen, child, "{i}: {within} of {prob}");
                    assert!((left - rest).abs() < 1e-15 / prob, "{i}, {child}: {left}, {rest}");
                }
                start += prob;
            }
            assert!((start - 1.0).abs() < 1e-14, "{i}: {start}");
            assert_eq!(weights.choose(1.0_f64.next_down()).0, count - 1, "{i}");
            assert_eq!(weights.choose(0.0), (0, 0.0), "{i}");
        }
    }
}
