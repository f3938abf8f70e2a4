use crate::hash::{fold, nth, unit};

/// The independent random numbers of one sample of one pixel, addressed by dimension.
///
/// Counter-based: a number depends on seed, pixel, sample and dimension only, so samples can be computed in
/// any order. The key is a hash of seed, pixel and sample; dimensions follow the sequence of SplitMix64
/// (Steele, Lea and Flood, "Fast Splittable Pseudorandom Number Generators", 2014).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stream {
    key: u64,
}

impl Stream {
    /// The stream of sample `sample` of pixel `pixel` (counted row by row) for `seed`.
    pub fn new(seed: u64, pixel: u64, sample: u32) -> Self {
        Self { key: [seed, pixel, u64::from(sample)].into_iter().fold(0, fold) }
    }

    /// A number uniform in `[0, 1)`, a multiple of `2^-53`.
    #[inline]
    pub fn uniform(&self, dimension: u32) -> f64 {
        unit(nth(self.key, u64::from(dimension)))
    }

    /// The numbers of `dimension` and the one after it.
    #[inline]
    pub fn uniform_pair(&self, dimension: u32) -> [f64; 2] {
        [self.uniform(dimension), self.uniform(dimension + 1)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbouring_addresses_give_unrelated_numbers() {
        let base = Stream::new(1, 2, 3);
        let others = [Stream::new(2, 2, 3), Stream::new(1, 3, 3), Stream::new(1, 2, 4), Stream::new(2, 1, 3)];
        for other in others {
            assert!((0..64).all(|d| base.uniform(d) != other.uniform(d)));
        }
        assert_eq!(base, Stream::new(1, 2, 3));
    }

    /// 256 x 256 equal cells over consecutive pixels, samples and dimensions: chi-square with
    /// 65,535 degrees of freedom, accepted within 5.85 standard deviations of its mean.
    #[test]
    fn pairs_of_numbers_fill_the_square_evenly() {
        type Address = fn(u32) -> [f64; 2];
        let along_pixels: Address = |i| {
            let number = |j: u32| Stream::new(0, u64::from(i + j), 0).uniform(0);
            [number(0), number(1)]
        };
        let along_samples: Address = |i| Stream::new(0, 0, i).uniform_pair(0);
        let along_dimensions: Address = |i| Stream::new(0, 0, 0).uniform_pair(2 * i);
        for address in [along_pixels, along_samples, along_dimensions] {
            let mut counts = vec![0_u32; 1 << 16];
            let draws = 1_u32 << 21;
            for i in 0..draws {
                let [a, b] = address(i).map(|u| (u * 256.0) as usize);
                counts[256 * a + b] += 1;
            }
            let expected = f64::from(draws) / 65536.0;
            let chi_sq: f64 = counts.iter().map(|&n| (f64::from(n) - expected).powi(2) / expected).sum();
            let z = (chi_sq - 65535.0) / (2.0 * 65535.0_f64).sqrt();
            assert!(z.abs() < 5.85, "z = {z}");
        }
    }
}
