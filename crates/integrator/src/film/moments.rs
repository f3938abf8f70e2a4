use globillum_material::Rgb;

/// Sum of the samples, and squared deviations of the observations from their mean, of one pixel.
///
/// Deviations are kept instead of squares, so that nothing cancels where the spread is small beside
/// the mean; two sets are joined by the pairwise formula of Chan, Golub and LeVeque ("Algorithms
/// for Computing the Sample Variance", 1983), here with weights.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Moments {
    /// Sum of all samples.
    pub(crate) sum: Rgb,
    /// Sum of the squared deviations of observations, each weighted by its samples.
    pub(crate) spread: Rgb,
}

/// How much a set of [`Moments`] rests on; the same for all pixels of a pass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Tally {
    /// Samples of each pixel.
    pub(crate) samples: u64,
    /// Independent observations among them: single samples, or means of whole passes.
    pub(crate) observations: u64,
}

impl Tally {
    pub(crate) fn joined(self, other: Self) -> Self {
        Self { samples: self.samples + other.samples, observations: self.observations + other.observations }
    }
}

impl Moments {
    /// This and `other` as one set, where they rest on so many samples, both above zero.
    pub(crate) fn joined(&self, samples: u64, other: &Self, other_samples: u64) -> Self {
        let (n, m) = (samples as f64, other_samples as f64);
        let apart = other.sum / m - self.sum / n;
        Self {
            sum: self.sum + other.sum,
            spread: self.spread + other.spread + apart * apart * (n * m / (n + m)),
        }
    }

    /// Adds one sample, an observation of its own, to `before` earlier ones.
    pub(crate) fn add(&mut self, sample: Rgb, before: u64) {
        let one = Self { sum: sample, spread: Rgb::BLACK };
        *self = if before == 0 { one } else { self.joined(before, &one, 1) };
    }

    /// Whether samples can add up to this: finite numbers, and no spread below zero.
    pub(crate) fn are_possible(&self) -> bool {
        let spread = self.spread.to_array();
        self.sum.is_finite() && self.spread.is_finite() && spread.into_iter().all(|x| x >= 0.0)
    }

    pub(crate) fn mean(&self, tally: Tally) -> Rgb {
        if tally.samples == 0 { Rgb::BLACK } else { self.sum / tally.samples as f64 }
    }

    /// Infinite for fewer than two observations.
    pub(crate) fn variance_of_mean(&self, tally: Tally) -> Rgb {
        if tally.observations < 2 {
            return Rgb::splat(f64::INFINITY);
        }
        self.spread / ((tally.observations - 1) as f64 * tally.samples as f64)
    }
}

/// The mean; NaN of no values.
pub(crate) fn mean(values: impl Iterator<Item = Rgb>) -> Rgb {
    let (mut sum, mut count) = (Rgb::BLACK, 0.0);
    for value in values {
        sum += value;
        count += 1.0;
    }
    sum / count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_spread_around_a_large_mean_is_not_lost() {
        let mut moments = Moments::default();
        for (before, x) in (0..).zip([4.0, 7.0, 13.0, 16.0]) {
            moments.add(Rgb::splat(1e9 + x), before);
        }
        let variance = moments.variance_of_mean(Tally { samples: 4, observations: 4 }).b;
        approx::assert_relative_eq!(variance, 30.0 / 4.0, max_relative = 1e-12);
    }
}
