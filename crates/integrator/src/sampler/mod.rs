//! Random numbers, addressed by (seed, pixel, sample, dimension).

mod nested;
mod sobol;
mod stream;

pub use stream::Stream;

use sobol::SobolPoint;
use std::ops::Range;

/// Where random numbers come from. A picture's mean is right with either; the error differs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Sampler {
    /// Independent numbers, a hash of their address: the error falls as the square root of the
    /// number of samples, and their spread tells it.
    Independent,
    /// Sobol' points under Owen's scrambling, stratified over each pass of a pixel. Passes are
    /// independent replicates, and their spread tells the error.
    #[default]
    Sobol,
}

/// The random numbers of one sample of one pixel.
///
/// One address always gives the same number, so any sample can be computed alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Numbers {
    Independent(Stream),
    Sobol(SobolPoint),
}

impl Sampler {
    /// The most samples in a pass.
    pub(crate) const MAX_PASS: u32 = 1 << SobolPoint::MAX_DIGITS;

    /// The numbers of sample `sample` of pixel `pixel` (counted row by row), one of the samples
    /// `pass` that are stratified together.
    pub(crate) fn numbers(self, seed: u64, pixel: u64, sample: u32, pass: &Range<u32>) -> Numbers {
        debug_assert!(pass.contains(&sample));
        match self {
            Self::Independent => Numbers::Independent(Stream::new(seed, pixel, sample)),
            Self::Sobol => {
                let digits = pass.len().next_power_of_two().trailing_zeros();
                Numbers::Sobol(SobolPoint::new(seed, pixel, pass.start, sample - pass.start, digits))
            }
        }
    }
}

impl Numbers {
    /// A number uniform in `[0, 1)`, a multiple of `2^-53`.
    #[inline]
    pub(crate) fn uniform(&self, dimension: u32) -> f64 {
        match self {
            Self::Independent(stream) => stream.uniform(dimension),
            Self::Sobol(point) => point.uniform(dimension),
        }
    }

    /// A point uniform in the unit square, which takes up `dimension` and the one after it.
    #[inline]
    pub(crate) fn uniform_pair(&self, dimension: u32) -> [f64; 2] {
        match self {
            Self::Independent(stream) => stream.uniform_pair(dimension),
            Self::Sobol(point) => point.uniform_pair(dimension),
        }
    }

    /// A number and a point of one decision, uniform in the unit cube, which take up `dimension` and
    /// the two after it.
    #[inline]
    pub(crate) fn uniform_triple(&self, dimension: u32) -> (f64, [f64; 2]) {
        match self {
            Self::Independent(stream) => (stream.uniform(dimension), stream.uniform_pair(dimension + 1)),
            Self::Sobol(point) => point.uniform_triple(dimension),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Samples of a pass.
    const PASS: u32 = 16;

    /// The numbers of one sample, in passes of [`PASS`].
    fn numbers(sampler: Sampler, pixel: u64, sample: u32) -> Numbers {
        let first = sample / PASS * PASS;
        sampler.numbers(1, pixel, sample, &(first..first + PASS))
    }

    const BOTH: [Sampler; 2] = [Sampler::Independent, Sampler::Sobol];

    /// Standard normal equivalent of chi-square with `dof` degrees of freedom (Wilson, Hilferty 1931).
    fn normal_equivalent(chi_sq: f64, dof: f64) -> f64 {
        let spread = 2.0 / (9.0 * dof);
        ((chi_sq / dof).cbrt() - (1.0 - spread)) / spread.sqrt()
    }

    /// `z` of the hypothesis that `points` fill 16 x 16 equal cells evenly.
    fn evenness(points: impl Iterator<Item = [f64; 2]>) -> f64 {
        let (mut counts, mut draws) = ([0_u32; 256], 0.0);
        for [x, y] in points {
            counts[16 * (x * 16.0) as usize + (y * 16.0) as usize] += 1;
            draws += 1.0;
        }
        let expected = draws / 256.0;
        let chi_sq = counts.iter().map(|&n| (f64::from(n) - expected).powi(2) / expected).sum();
        normal_equivalent(chi_sq, 255.0)
    }

    #[test]
    fn one_sample_of_every_pixel_or_pass_fills_the_square_evenly() {
        let draws = 1_u32 << 18;
        for sampler in BOTH {
            for (dimension, index) in [(0, 0), (3, 5), (700, 15)] {
                let over_pixels = (0..draws).map(|i| numbers(sampler, u64::from(i), index));
                let over_passes = (0..draws).map(|i| numbers(sampler, 9, PASS * i + index));
                for z in [
                    evenness(over_pixels.map(|n| n.uniform_pair(dimension))),
                    evenness(over_passes.map(|n| n.uniform_pair(dimension))),
                ] {
                    assert!(z.abs() < 5.85, "{sampler:?}, dimension {dimension}: z = {z}");
                }
            }
        }
    }

    /// Different dimensions of one sample, and one dimension of neighbouring samples of different
    /// pixels, must not depend on each other: their pairs fill the square too.
    #[test]
    fn different_addresses_are_independent() {
        let draws = 1_u32 << 18;
        for sampler in BOTH {
            // One sample in each pass: those of one pass are dependent on purpose.
            let numbers = |pixel: u64, i: u32| numbers(sampler, pixel, PASS * i + i % PASS);
            let dimensions = (0..draws).map(|i| [numbers(3, i).uniform(0), numbers(3, i).uniform(2)]);
            let coordinates =
                (0..draws).map(|i| [numbers(3, i).uniform_pair(0)[1], numbers(3, i).uniform_pair(5)[1]]);
            let pixels = (0..draws).map(|i| [numbers(3, i).uniform(4), numbers(4, i).uniform(4)]);
            let passes = (0..draws).map(|i| [numbers(3, i).uniform(4), numbers(3, i + 1).uniform(4)]);
            for z in [evenness(dimensions), evenness(coordinates), evenness(pixels), evenness(passes)] {
                assert!(z.abs() < 5.85, "{sampler:?}: z = {z}");
            }
        }
    }

    /// Within a pass, dimensions are matched by random permutations, as in Latin hypercubes: the
    /// integral of a product of two of them has the variance of as many independent samples, times
    /// n / (n - 1) (Stein, "Large Sample Properties of Simulations Using Latin Hypercube Sampling",
    /// 1987). Were they matched in less random a way, the variance would be twice that, or all.
    #[test]
    fn padded_dimensions_do_not_line_up() {
        let (passes, n) = (1_u32 << 14, f64::from(PASS));
        let (mut sum, mut sum_sq) = ([0.0; 4], [0.0; 4]);
        for first in (0..passes).map(|i| i * PASS) {
            let mut products = [0.0; 4];
            for sample in first..first + PASS {
                let numbers = numbers(Sampler::Sobol, 9, sample);
                let ([a, b], [c, d]) = (numbers.uniform_pair(0), numbers.uniform_pair(2));
                for (product, [x, y]) in products.iter_mut().zip([[a, c], [a, d], [b, c], [b, d]]) {
                    *product += (x - 0.5) * (y - 0.5) / n;
                }
            }
            for i in 0..4 {
                sum[i] += products[i];
                sum_sq[i] += products[i] * products[i];
            }
        }
        for i in 0..4 {
            let variance = sum_sq[i] / f64::from(passes);
            assert!(sum[i].abs() < 5.85 * (variance * f64::from(passes)).sqrt(), "{i}: mean of {}", sum[i]);
            // One product has variance 1/144; an estimate from so many passes a deviation of 1.2 %.
            let ratio = variance * 144.0 * (n - 1.0);
            assert!((ratio - 1.0).abs() < 5.85 * 0.012, "{i}: {ratio} times the variance expected");
        }
    }

    #[test]
    fn numbers_lie_below_one() {
        for (sampler, length) in BOTH.into_iter().flat_map(|s| [1, 3, 16, Sampler::MAX_PASS].map(|n| (s, n)))
        {
            for first in [0, u32::MAX - length] {
                for sample in [first, first + length - 1] {
                    let numbers = sampler.numbers(u64::MAX, u64::MAX, sample, &(first..first + length));
                    let [x, y] = numbers.uniform_pair(u32::MAX - 1);
                    assert!((0.0..1.0).contains(&x) && (0.0..1.0).contains(&y));
                }
            }
        }
    }
}
