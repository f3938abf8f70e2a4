use crate::hash::{fold, nth, unit};

/// The first of the numbers by which keys of parts are hashed, beyond those of samples.
const PARTS: u64 = 1 << 32;

/// What draws random numbers in place of a pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) enum ReservedStream {
    Photons,
    CausticProbes,
    SkyProbes,
    LightProbes,
}

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

    /// The stream of path or probe `index`, whatever the seed. No picture has as many pixels.
    pub(crate) fn reserved(of: ReservedStream, index: u32) -> Self {
        Self::new(0, u64::MAX - of as u64, index)
    }

    /// A stream of its own for part `part` of the sample.
    pub(crate) fn part(&self, part: u32) -> Self {
        Self { key: fold(self.key, PARTS + u64::from(part)) }
    }

    /// A number uniform in `[0, 1)`, a multiple of `2^-53`.
    #[inline]
    pub fn uniform(&self, dimension: u32) -> f64 {
        self.number(dimension.into())
    }

    /// The numbers of `dimension` and the one after it, so that `dimension + 2` is the next that is free.
    #[inline]
    pub fn uniform_pair(&self, dimension: u32) -> [f64; 2] {
        // The last dimension has one after it, too.
        [u64::from(dimension), u64::from(dimension) + 1].map(|dimension| self.number(dimension))
    }

    #[inline]
    fn number(&self, dimension: u64) -> f64 {
        unit(nth(self.key, dimension))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_are_the_numbers_of_two_dimensions() {
        let stream = Stream::new(1, 2, 3);
        assert_eq!(stream.uniform_pair(7), [stream.uniform(7), stream.uniform(8)]);
        let [last, after] = stream.uniform_pair(u32::MAX);
        assert_eq!(last, stream.uniform(u32::MAX));
        assert!(after != stream.uniform(0), "{after}");
    }
}
