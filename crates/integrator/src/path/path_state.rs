use super::shading_point::MisContext;
use super::stage::Stage;
use crate::Roulette;
use crate::sampler::Numbers;
use globillum_material::Rgb;

/// The state of a path between two bounces.
#[derive(Clone, Copy, Debug)]
pub(super) struct Path {
    pub(super) target: Target,
    pub(super) stage: Stage,
    pub(super) numbers: Numbers,
    /// The throughput of the path, or of its suffix from where that begins.
    pub(super) throughput: Rgb,
    /// The density with which the directions of the same part of the path were sampled, over their density by the BSDFs
    /// alone. 1 without a guide.
    pub(super) guide_ratio: f64,
    /// The largest throughput, by component, of the prefixes that may reuse what follows; that of the path's own prefix if
    /// no other may. White as long as `throughput` is that of the whole path.
    pub(super) prefix_throughput: Rgb,
    pub(super) mis: MisContext,
}

/// The sum that radiance is added to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Target {
    /// That of a sample of the wavefront.
    Sample(u32),
    /// That of the suffix of a sample's path, which prefixes share.
    Suffix(u32),
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
    /// One for each sample, or none if paths are not reused.
    pub(super) suffixes: Vec<Rgb>,
    /// What suffixes have found by way of mirrors, each with its sample, where such light is rare. It is not part of the
    /// sums.
    pub(super) suffix_caustics: Vec<(u32, Rgb)>,
}

impl Path {
    /// The path of a sample before it has met anything.
    pub(super) fn new(sample: u32, numbers: Numbers) -> Self {
        Self {
            target: Target::Sample(sample),
            stage: Stage::Prefix,
            numbers,
            throughput: Rgb::WHITE,
            guide_ratio: 1.0,
            prefix_throughput: Rgb::WHITE,
            mis: MisContext::of_camera(),
        }
    }

    /// Whether no vertex before the present one was diffuse.
    #[inline(always)]
    pub(super) fn is_prefix(&self) -> bool {
        self.stage == Stage::Prefix
    }

    /// Makes what follows the suffix: with a throughput of one, and added to a sum of its own.
    #[inline(always)]
    pub(super) fn leave_prefix(&mut self) {
        (self.throughput, self.guide_ratio) = (Rgb::WHITE, 1.0);
        self.target = Target::Suffix(self.target.sample());
    }

    /// Whether Russian roulette may end the path. Not between mirrors after the prefix: what is found by way of them must
    /// follow from the first one.
    #[inline(always)]
    pub(super) fn plays_roulette(&self) -> bool {
        !matches!(self.stage, Stage::Reflected(_))
    }

    /// Whether the path survives Russian roulette by `u` in `[0, 1)`; scales its throughput. A guide changes nothing: it
    /// leads where a low throughput meets much light.
    #[inline(always)]
    pub(super) fn survives(&mut self, roulette: Roulette, u: f64) -> bool {
        let reflected = (self.prefix_throughput * self.throughput).max_component() * self.guide_ratio;
        let uncapped = reflected / roulette.threshold;
        let survive_prob = uncapped.min(Roulette::MAX_SURVIVE_PROB);
        self.throughput = self.throughput / survive_prob;
        u < survive_prob
    }
}

impl Target {
    pub(super) fn sample(self) -> u32 {
        let (Self::Sample(sample) | Self::Suffix(sample)) = self;
        sample
    }
}

impl RadianceSums {
    /// Sets the numbers of samples and suffixes, and all sums to black. Forgets caustics.
    pub(super) fn reset(&mut self, samples: usize, suffixes: usize) {
        self.suffix_caustics.clear();
        for (sums, count) in [(&mut self.samples, samples), (&mut self.suffixes, suffixes)] {
            sums.clear();
            sums.resize(count, Rgb::BLACK);
        }
    }

    /// All that the suffix of a sample has found.
    pub(super) fn of_suffix(&self, sample: u32) -> Rgb {
        let sum = self.suffixes.get(sample as usize).copied().unwrap_or_default();
        let caustics = self.suffix_caustics.iter().filter(|&&(of, _)| of == sample);
        caustics.fold(sum, |sum, &(_, radiance)| sum + radiance)
    }

    #[inline(always)]
    pub(super) fn at(&mut self, target: Target) -> &mut Rgb {
        match target {
            Target::Sample(sample) => &mut self.samples[sample as usize],
            Target::Suffix(sample) => &mut self.suffixes[sample as usize],
        }
    }
}
