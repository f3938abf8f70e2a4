/// The number of children of a node.
pub(super) const WIDTH: usize = 8;

/// The bits of a lane in a path.
pub(super) const LANE_BITS: u32 = WIDTH.trailing_zeros();

/// The weights of the children of a node: a child is chosen with a probability proportional to its weight.
#[derive(Clone, Copy, Debug)]
pub(super) struct ChildWeights {
    of_lanes: [f64; WIDTH],
    /// The sums of the weights up to each lane, none below the one before it.
    ends: [f64; WIDTH],
}

impl ChildWeights {
    /// The share of all weights that [`ChildWeights::with_uniform_share`] divides evenly. Where importances are nearly exact,
    /// a share of 1/1024 would bring most of the variance.
    const UNIFORM_SHARE: f64 = 1.0 / 65536.0;

    /// The least sum of importances of which uniform shares are shares, so that they are above zero.
    const LEAST_TOTAL: f64 = 1e-280;

    /// Weights equal to these importances, from 0 up: a child without importance is never chosen. [`ChildWeights::choose`] and
    /// [`ChildWeights::prob`] need a total above zero.
    #[inline(always)]
    pub(super) fn of_importance(importance: [f64; WIDTH]) -> Self {
        // Three steps over all lanes. A sum is the one at a lane before it and a rest, so it is not below that when rounded.
        // Zeros are added exactly, so a lane without weight has no interval.
        let [a, b, c, d, e, f, g, h] = importance;
        let [a, b, c, d, e, f, g, h] = [a, b + a, c, d + c, e, f + e, g, h + g];
        let [a, b, c, d, e, f, g, h] = [a, b, c + b, d + b, e, f, g + f, h + f];
        Self { of_lanes: importance, ends: [a, b, c, d, e + d, f + d, g + d, h + d] }
    }

    /// Like [`ChildWeights::of_importance`], but with a uniform share: every child has a probability of at least
    /// `UNIFORM_SHARE / count`. Lanes from `count` on have no child and the importance 0.
    #[inline(always)]
    pub(super) fn with_uniform_share(importance: [f64; WIDTH], count: f64) -> Self {
        let Self { mut of_lanes, mut ends } = Self::of_importance(importance);
        let least = Self::UNIFORM_SHARE / (1.0 - Self::UNIFORM_SHARE) / count;
        let least = least * ends[WIDTH - 1].max(Self::LEAST_TOTAL);
        for lane in 0..WIDTH {
            of_lanes[lane] += least;
            // Lanes without a child have no interval, and so are never chosen.
            ends[lane] += least * count.min((lane + 1) as f64);
        }
        Self { of_lanes, ends }
    }

    /// The sum of all weights.
    #[inline(always)]
    pub(super) fn total(&self) -> f64 {
        self.ends[WIDTH - 1]
    }

    /// The probability of the child at `lane`.
    #[inline(always)]
    pub(super) fn prob(&self, lane: usize) -> f64 {
        self.of_lanes[lane] / self.total()
    }

    /// The lane of the child that `u` in `[0, 1)` chooses, which has a weight above zero, and the number in `[0, 1)` that is
    /// left for the choice below it.
    #[inline(always)]
    pub(super) fn choose(&self, u: f64) -> (usize, f64) {
        // Below the total also when rounded, as `u` is at most `1 - 2^-53`.
        let at = u * self.total();
        let below: i64 = self.ends.map(|end| i64::from(end <= at)).iter().sum();
        let lane = below as usize % WIDTH;
        let rest = 1.0 - (self.ends[lane] - at) / self.of_lanes[lane];
        (lane, rest.clamp(0.0, 1.0_f64.next_down()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Stream;

    /// Importances over twelve orders of magnitude, a third of them 0, and the number of children.
    fn importances(i: u32) -> ([f64; WIDTH], usize) {
        let numbers = Stream::new(5, 0, i);
        let count = 1 + (8.0 * numbers.uniform(0)) as usize;
        let of_child = |lane: u32| match numbers.uniform(1 + lane) {
            u if u < 1.0 / 3.0 => 0.0,
            u => 10.0_f64.powf(18.0 * u - 12.0),
        };
        (std::array::from_fn(|lane| if lane < count { of_child(lane as u32) } else { 0.0 }), count)
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
                let (lane, left) = weights.choose(u);
                assert!(weights.prob(lane) > 0.0 && (0.0..1.0).contains(&left), "{i}: {u}, {lane}, {left}");
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
            for (lane, importance) in importance.into_iter().take(count).enumerate() {
                let prob = weights.prob(lane);
                let least = ChildWeights::UNIFORM_SHARE / count as f64;
                let share = if total > 0.0 { importance / total } else { 1.0 / count as f64 };
                let expected = (1.0 - ChildWeights::UNIFORM_SHARE) * share + least;
                assert!((prob - expected).abs() < 1e-15, "{i}, {lane}: {prob}, {expected}");
                for (place, rest) in [(0.001, 0.001), (0.5, 0.5), (0.999, 0.999)] {
                    let (chosen, left) = weights.choose(start + place * prob);
                    assert_eq!(chosen, lane, "{i}: {place} of {prob}");
                    assert!((left - rest).abs() < 1e-15 / prob, "{i}, {lane}: {left}, {rest}");
                }
                start += prob;
            }
            assert!((start - 1.0).abs() < 1e-14, "{i}: {start}");
            assert_eq!(weights.choose(1.0_f64.next_down()).0, count - 1, "{i}");
            assert_eq!(weights.choose(0.0), (0, 0.0), "{i}");
        }
    }
}
