//! What the samples of a wavefront have gathered.

use globillum_material::Rgb;

/// The sum that radiance is added to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Target {
    /// That of a sample of the wavefront.
    Sample(u32),
    /// That of what the path of a sample finds after its prefix, by a throughput that begins there.
    AfterPrefix(u32),
}

/// Radiance that is added if its shadow ray is not occluded.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contribution {
    pub(super) target: Target,
    pub(super) radiance: Rgb,
}

/// The radiance that the samples of a wavefront have gathered.
#[derive(Debug, Default)]
pub(super) struct RadianceSums {
    pub(super) samples: Vec<Rgb>,
    /// What paths have found after their prefixes: one sum for each sample, or none if paths are not reused.
    pub(super) after_prefixes: Vec<Rgb>,
    /// What suffixes have found by way of mirrors, each with its sample, where such light is rare. The sums above leave it
    /// out.
    pub(super) suffix_caustics: Vec<(u32, Rgb)>,
}

impl Target {
    /// The sample of the path.
    pub(super) fn sample(self) -> u32 {
        let (Self::Sample(sample) | Self::AfterPrefix(sample)) = self;
        sample
    }
}

impl RadianceSums {
    /// Sets the numbers of sums of both kinds, and all sums to black. Forgets caustics.
    pub(super) fn reset(&mut self, samples: usize, after_prefixes: usize) {
        self.suffix_caustics.clear();
        for (sums, count) in [(&mut self.samples, samples), (&mut self.after_prefixes, after_prefixes)] {
            sums.clear();
            sums.resize(count, Rgb::BLACK);
        }
    }

    /// All that the path of a sample has found after its prefix.
    pub(super) fn after_prefix(&self, sample: u32) -> Rgb {
        let sum = self.after_prefixes.get(sample as usize).copied().unwrap_or_default();
        let caustics = self.suffix_caustics.iter().filter(|&&(of, _)| of == sample);
        caustics.fold(sum, |sum, &(_, radiance)| sum + radiance)
    }

    /// The sum of this target.
    #[inline(always)]
    pub(super) fn at(&mut self, target: Target) -> &mut Rgb {
        match target {
            Target::Sample(sample) => &mut self.samples[sample as usize],
            Target::AfterPrefix(sample) => &mut self.after_prefixes[sample as usize],
        }
    }
}
