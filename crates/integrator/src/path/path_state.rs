use super::mis::MisContext;
use super::radiance_sums::Target;
use super::reuse_stage::ReuseStage;
use crate::Roulette;
use crate::sampler::Numbers;
use globillum_material::Rgb;

/// The state of a path between two bounces.
#[derive(Clone, Copy, Debug)]
pub(super) struct Path {
    pub(super) target: Target,
    pub(super) stage: ReuseStage,
    pub(super) numbers: Numbers,
    /// The throughput of the path, or of what follows its prefix.
    pub(super) throughput: Rgb,
    /// The density with which the directions of the same part of the path were sampled, over their density by the BSDFs
    /// alone. 1 without a guide.
    pub(super) guide_ratio: f64,
    /// The largest throughput, by component, of the prefixes that may reuse what follows; that of the path's own prefix if
    /// no other may. White as long as `throughput` is that of the whole path.
    pub(super) largest_prefix_throughput: Rgb,
    pub(super) mis: MisContext,
}

impl Path {
    /// The path of a sample before it has met anything.
    pub(super) fn new(sample: u32, numbers: Numbers, mis: MisContext) -> Self {
        Self {
            target: Target::Sample(sample),
            stage: ReuseStage::Prefix,
            numbers,
            throughput: Rgb::WHITE,
            guide_ratio: 1.0,
            largest_prefix_throughput: Rgb::WHITE,
            mis,
        }
    }

    /// Whether the path has not met a diffuse vertex yet.
    #[inline(always)]
    pub(super) fn is_prefix(&self) -> bool {
        self.stage == ReuseStage::Prefix
    }

    /// Begins what follows the prefix: with a throughput of one, and added to a sum of its own.
    #[inline(always)]
    pub(super) fn leave_prefix(&mut self) {
        (self.throughput, self.guide_ratio) = (Rgb::WHITE, 1.0);
        self.target = Target::AfterPrefix(self.target.sample());
    }

    /// Whether Russian roulette may end the path. Between mirrors after the prefix it may not: other pixels find the same
    /// light from the first mirror without roulette.
    #[inline(always)]
    pub(super) fn plays_roulette(&self) -> bool {
        !matches!(self.stage, ReuseStage::Reflected(_))
    }

    /// Whether the path survives Russian roulette by `u` in `[0, 1)`; scales its throughput. A guide sends paths of low
    /// throughput toward bright light. `guide_ratio` undoes that, so the probability is as without a guide.
    #[inline(always)]
    pub(super) fn survives(&mut self, roulette: Roulette, u: f64) -> bool {
        let reflected = (self.largest_prefix_throughput * self.throughput).max_component() * self.guide_ratio;
        let uncapped = reflected / roulette.threshold;
        let survive_prob = uncapped.min(Roulette::MAX_SURVIVE_PROB);
        self.throughput /= survive_prob;
        u < survive_prob
    }
}
