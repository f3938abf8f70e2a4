use super::checkpoints::CheckpointFlags;
use super::kinds::{
    EstimatorKind, GuidingKind, LightSamplingKind, MirrorSamplingKind, PathReuseKind, SamplerKind,
    SupersamplingKind,
};
use super::stop::StopFlags;
use crate::parse;
use globillum::integrator::Settings;
use serde::Serialize;

#[derive(clap::Args, Clone, Debug, Serialize)]
#[command(next_help_heading = "Sampling")]
pub(crate) struct SamplingFlags {
    /// Samples per pixel, or per point [default: 64, or no limit with --error or --seconds]
    ///
    /// The render ends at this number even if --error or --seconds would let it go on. Without it,
    /// --passes alone says how many passes there are.
    #[arg(long, visible_alias = "samples", value_name = "N", value_parser = parse::integer(1..=u32::MAX))]
    #[arg(allow_negative_numbers = true)]
    pub(crate) spp: Option<u32>,
    /// Samples per pixel in one pass, a power of two
    ///
    /// A picture is made of whole passes. The points of the Sobol' sampler are stratified within a pass, and
    /// the standard error is estimated from the differences between passes. Longer passes lower the variance of
    /// pixels, though not always that of means over many, and leave fewer to tell the error: with some hundred samples per
    /// pixel, try 32 or 64.
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = parse::power_of_two(1 << 16))]
    #[arg(allow_negative_numbers = true)]
    pub(crate) pass_spp: u32,
    /// Seed of the random numbers, from 0 to 2^64 - 1
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = parse::integer(0..=u64::MAX))]
    #[arg(allow_negative_numbers = true)]
    seed: u64,
    /// Sampler: where random numbers come from
    #[arg(long, value_enum, default_value_t = SamplerKind::Sobol)]
    sampler: SamplerKind,
    /// Estimator of the radiance along a path
    #[arg(long, value_enum, default_value_t = EstimatorKind::Mis)]
    estimator: EstimatorKind,
    /// How next event estimation chooses a point on a light
    #[arg(long, value_enum, default_value_t = LightSamplingKind::SolidAngle)]
    light_sampling: LightSamplingKind,
    /// Light samples at the first diffuse vertex of a path, where there are several lights or small mirrors
    ///
    /// A power of two up to 16. It counts for three emitting triangles and more, a point, spot or directional light beside
    /// another light, and mirrors that are small beside the lights, as the triangles of a curved mirror are. Elsewhere
    /// there is one.
    #[arg(long, value_name = "N", default_value_t = 4)]
    #[arg(value_parser = parse::power_of_two(Settings::MAX_LIGHT_SAMPLES), allow_negative_numbers = true)]
    light_samples: u32,
    /// Whether next event estimation also reaches lights by way of mirrors
    #[arg(long, value_enum, default_value_t = MirrorSamplingKind::Images)]
    mirror_sampling: MirrorSamplingKind,
    /// Supersampling: whether the edges of lights get more camera rays; off for points
    #[arg(long, value_enum, default_value_t = SupersamplingKind::Lights)]
    supersampling: SupersamplingKind,
    /// Path reuse: whether pixels of a tile share path suffixes; off for points
    #[arg(long, value_enum, default_value_t = PathReuseKind::Tiles)]
    path_reuse: PathReuseKind,
    /// Path guiding: how diffuse surfaces sample the directions of scattered paths
    #[arg(long, value_enum, default_value_t = GuidingKind::Off)]
    guiding: GuidingKind,
    /// Most bounces of a path, at most 2^20 [default: no limit]
    ///
    /// 0 leaves emitted radiance only, 1 adds direct illumination. A limit biases the picture: radiance of
    /// more bounces is missing. Without one, Russian roulette alone ends paths, which has no bias.
    #[arg(long, value_name = "N", value_parser = parse::integer(0..=Settings::MAX_BOUNCES))]
    #[arg(allow_negative_numbers = true)]
    max_bounces: Option<u32>,
}

/// Samples of a pixel if no flag says anything else.
const SAMPLES: u32 = 64;

impl SamplingFlags {
    /// Samples of a pixel at which the render ends; `None` if only the error or the time ends it.
    pub(super) fn limit(&self, stop: &StopFlags, checkpoints: &CheckpointFlags) -> Option<u32> {
        self.spp.or_else(|| match &checkpoints.passes {
            Some(passes) => Some(passes.end.saturating_mul(self.pass_spp)),
            None if stop.is_given() => None,
            None => Some(SAMPLES),
        })
    }

    /// Switches off what only pixels with neighbours have, which points have not.
    pub(super) fn leave_neighbours(&mut self) {
        (self.path_reuse, self.supersampling) = (PathReuseKind::Off, SupersamplingKind::Off);
    }

    /// Changes what these flags decide, but for the number of samples.
    pub(crate) fn apply_to(&self, settings: &mut Settings) {
        settings.pass_samples = self.pass_spp;
        settings.seed = self.seed;
        settings.sampler = self.sampler.into();
        settings.estimator = self.estimator.into();
        settings.light_sampling = self.light_sampling.into();
        settings.light_samples = self.light_samples;
        settings.mirror_sampling = self.mirror_sampling.into();
        settings.supersampling = self.supersampling.into();
        settings.path_reuse = self.path_reuse.into();
        settings.guiding = self.guiding.into();
        settings.max_bounces = self.max_bounces;
    }
}
