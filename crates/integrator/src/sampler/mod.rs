//! Random numbers, addressed by (seed, pixel, sample, dimension).

mod bounce_numbers;
mod decision;
mod digits;
mod member;
mod nested;
mod numbers;
mod sobol;
mod stream;
#[cfg(test)]
mod tests;

pub(crate) use bounce_numbers::BounceNumbers;
pub(crate) use decision::MirrorSize;
pub(crate) use member::Member;
pub(crate) use numbers::Numbers;
pub(crate) use sobol::SobolPoint;
pub(crate) use stream::ReservedStream;
pub use stream::Stream;

use decision::Decision;
use sobol::SobolPoints;
use std::ops::Range;

/// The source of random numbers. It changes the error of a picture, not its mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Sampler {
    /// Independent numbers, hashes of their address. The error falls with the square root of the number of
    /// samples, and is estimated from their variance.
    Independent,
    /// Sobol' points with Owen scrambling, stratified over each pass of a pixel, and of tiles of pixels where these
    /// depend on each other anyway ([`PathReuse::Tiles`](crate::PathReuse)). Passes are independent replicates; the
    /// error is estimated from their variance.
    #[default]
    Sobol,
}

impl Sampler {
    /// The most samples in a pass.
    pub(crate) const MAX_PASS: u32 = 1 << 16;

    /// The most parts of a sample.
    pub(crate) const MAX_PARTS: u32 = 16;

    /// The numbers of sample `sample` of a member. The samples `pass` are stratified together. Independent numbers have no
    /// nets: each member must be [alone](Member::alone).
    pub(crate) fn numbers(self, seed: u64, member: Member, sample: u32, pass: &Range<u32>) -> Numbers {
        debug_assert!(pass.contains(&sample));
        match self {
            Self::Independent => Numbers::Independent(Stream::new(seed, member.net, sample)),
            Self::Sobol => {
                let digits = pass.len().next_power_of_two().trailing_zeros();
                Numbers::Sobol(SobolPoint::new(seed, member, pass.start, sample - pass.start, digits))
            }
        }
    }

    /// The positions in a pixel of the `N` rays that supersample lights for `sample`, one of the samples `pass`: uniform in
    /// the unit square. By Sobol' points, those of all samples of the pass are one net. `N` is 16 or 32.
    #[inline(always)]
    pub(crate) fn ray_positions<const N: usize>(
        self,
        seed: u64,
        pixel: u64,
        sample: u32,
        pass: &Range<u32>,
    ) -> [[f64; 2]; N] {
        let decision = const { Decision::supersampling(N as u32) };
        match self {
            Self::Independent => {
                let stream = Stream::new(seed, pixel, sample);
                std::array::from_fn(|i| stream.uniform_pair(decision.dimension() + 2 * i as u32))
            }
            Self::Sobol => {
                let digits = (pass.len().next_power_of_two() * N).trailing_zeros();
                let first = (sample - pass.start) * N as u32;
                let first = SobolPoint::new(seed, Member::alone(pixel), pass.start, first, digits);
                let [x, y] = SobolPoints::<N>::successive(&first).uniform(decision);
                std::array::from_fn(|i| [x[i], y[i]])
            }
        }
    }
}
