//! Choices by the names they have on the command line.

use clap::ValueEnum;
use globillum::integrator::{
    Estimator, Guiding, LightSampling, MirrorSampling, PathReuse, PixelFilter, Sampler, Supersampling,
};
use serde::Serialize;

/// Choices of the library, whose variants have help for the command line.
macro_rules! kinds {
    ($($kind:ident of $choice:ident { $($(#[$help:meta])* $variant:ident,)+ })+) => {
        $(
            #[derive(Clone, Copy, Debug, Serialize, ValueEnum)]
            #[serde(rename_all = "kebab-case")]
            pub(crate) enum $kind {
                $($(#[$help])* $variant,)+
            }

            impl From<$kind> for $choice {
                fn from(kind: $kind) -> Self {
                    match kind {
                        $($kind::$variant => Self::$variant,)+
                    }
                }
            }
        )+
    };
}

kinds! {
    SamplerKind of Sampler {
        /// Independent random numbers
        Independent,
        /// Sobol' points with Owen scrambling, stratified within each pass
        Sobol,
    }
    FilterKind of PixelFilter {
        /// The pixel's own square, evenly
        Box,
        /// A pyramid two pixels wide
        Tent,
    }
    EstimatorKind of Estimator {
        /// BSDF sampling alone: paths that happen to meet a light
        Bsdf,
        /// Next event estimation alone: points chosen on lights
        Light,
        /// Both, weighted by multiple importance sampling
        Mis,
    }
    LightSamplingKind of LightSampling {
        /// Uniformly by area
        Area,
        /// Uniformly by solid angle
        SolidAngle,
    }
    MirrorSamplingKind of MirrorSampling {
        /// Only by scattering
        Off,
        /// In all ideal mirrors, plane or curved. Light by way of two mirrors or more is left to scattering and, where pixels
        /// share caustics, to rays guided by photons
        Images,
    }
    SupersamplingKind of Supersampling {
        /// One camera ray per sample
        Off,
        /// Sixteen more where neighbouring pixels see different emission, also in mirrors, or where a small light is; 32
        /// instead of these if the pixel sees a curved mirror
        Lights,
    }
    PathReuseKind of PathReuse {
        /// Each pixel rests on its own paths; errors of pixels are independent
        Off,
        /// Groups of sixteen pixels, one of each block of 4 x 4, share path suffixes from their second diffuse vertex, the
        /// environment, and points of the Sobol' sampler; a tile shares caustics where they are rare
        Tiles,
    }
    GuidingKind of Guiding {
        /// By the cosine
        Off,
        /// Half by the cosine, half by what training paths found: for light that most directions miss, such as that through
        /// a door ajar
        Trained,
    }
}
