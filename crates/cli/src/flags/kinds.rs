//! Choices by the names they have on the command line.

use clap::ValueEnum;
use globillum::integrator::{
    Estimator, Guiding, LightSampling, MirrorSampling, PathReuse, PixelFilter, Sampler, Supersampling,
};
use serde::Serialize;

#[derive(Clone, Copy, Debug, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum SamplerKind {
    /// Independent random numbers
    Independent,
    /// Sobol' points with Owen scrambling, stratified within each pass
    Sobol,
}

impl From<SamplerKind> for Sampler {
    fn from(kind: SamplerKind) -> Self {
        match kind {
            SamplerKind::Independent => Self::Independent,
            SamplerKind::Sobol => Self::Sobol,
        }
    }
}

#[derive(Clone, Copy, Debug, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum FilterKind {
    /// The pixel's own square, evenly
    Box,
    /// A pyramid two pixels wide
    Tent,
}

impl From<FilterKind> for PixelFilter {
    fn from(kind: FilterKind) -> Self {
        match kind {
            FilterKind::Box => Self::Box,
            FilterKind::Tent => Self::Tent,
        }
    }
}

#[derive(Clone, Copy, Debug, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum EstimatorKind {
    /// BSDF sampling alone: paths that happen to meet a light
    Bsdf,
    /// Next event estimation alone: points chosen on lights
    Light,
    /// Both, weighted by multiple importance sampling
    Mis,
}

impl From<EstimatorKind> for Estimator {
    fn from(kind: EstimatorKind) -> Self {
        match kind {
            EstimatorKind::Bsdf => Self::Bsdf,
            EstimatorKind::Light => Self::Light,
            EstimatorKind::Mis => Self::Mis,
        }
    }
}

#[derive(Clone, Copy, Debug, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum LightSamplingKind {
    /// Uniformly by area
    Area,
    /// Uniformly by solid angle
    SolidAngle,
}

impl From<LightSamplingKind> for LightSampling {
    fn from(kind: LightSamplingKind) -> Self {
        match kind {
            LightSamplingKind::Area => Self::Area,
            LightSamplingKind::SolidAngle => Self::SolidAngle,
        }
    }
}

#[derive(Clone, Copy, Debug, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum MirrorSamplingKind {
    /// Only by scattering
    Off,
    /// In all ideal mirrors, plane or curved. Light by way of two mirrors or more is left to scattering and, where pixels
    /// share caustics, to rays guided by photons
    Images,
}

impl From<MirrorSamplingKind> for MirrorSampling {
    fn from(kind: MirrorSamplingKind) -> Self {
        match kind {
            MirrorSamplingKind::Off => Self::Off,
            MirrorSamplingKind::Images => Self::Images,
        }
    }
}

#[derive(Clone, Copy, Debug, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum SupersamplingKind {
    /// One camera ray per sample
    Off,
    /// Sixteen more where neighbouring pixels see different emission, also in mirrors; 32 more if the pixel sees a curved
    /// mirror
    Lights,
}

impl From<SupersamplingKind> for Supersampling {
    fn from(kind: SupersamplingKind) -> Self {
        match kind {
            SupersamplingKind::Off => Self::Off,
            SupersamplingKind::Lights => Self::Lights,
        }
    }
}

#[derive(Clone, Copy, Debug, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum PathReuseKind {
    /// Each pixel rests on its own paths; errors of pixels are independent
    Off,
    /// Groups of sixteen pixels, one of each block of 4 x 4, share path suffixes from their second diffuse vertex, the
    /// environment, and points of the Sobol' sampler; a tile shares caustics where they are rare
    Sixteens,
}

impl From<PathReuseKind> for PathReuse {
    fn from(kind: PathReuseKind) -> Self {
        match kind {
            PathReuseKind::Off => Self::Off,
            PathReuseKind::Sixteens => Self::Sixteens,
        }
    }
}

#[derive(Clone, Copy, Debug, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum GuidingKind {
    /// By the cosine
    Off,
    /// Half by the cosine, half by what training paths found: for light that most directions miss, such as that through
    /// a door ajar
    Trained,
}

impl From<GuidingKind> for Guiding {
    fn from(kind: GuidingKind) -> Self {
        match kind {
            GuidingKind::Off => Self::Off,
            GuidingKind::Trained => Self::Trained,
        }
    }
}
