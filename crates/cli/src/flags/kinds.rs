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

#[cfg(test)]
mod tests {
    use super::*;
    use globillum::integrator::{Estimates, Settings};
    use globillum::io::PictureData;

    /// Asserts that the files of pictures call each choice as the command line does.
    fn check<Kind: ValueEnum + Copy>(setting: &str, set: impl Fn(&mut Settings, Kind)) {
        for &kind in Kind::value_variants() {
            let mut settings = Settings::new(1, 1, 1);
            set(&mut settings, kind);
            let mut data = PictureData::new(Estimates::unknown(1, 1));
            data.set_settings(&settings);
            let value = kind.to_possible_value().expect("no choice is hidden");
            let (written, expected) =
                (&data.attributes["settings"], format!("{setting}={}", value.get_name()));
            assert!(written.split(' ').any(|pair| pair == expected), "{expected} is not in {written}");
        }
    }

    #[test]
    fn files_have_the_names_of_the_command_line() {
        check("sampler", |settings, kind: SamplerKind| settings.sampler = kind.into());
        check("filter", |settings, kind: FilterKind| settings.filter = kind.into());
        check("estimator", |settings, kind: EstimatorKind| settings.estimator = kind.into());
        check("light_sampling", |settings, kind: LightSamplingKind| settings.light_sampling = kind.into());
        check("mirror_sampling", |settings, kind: MirrorSamplingKind| settings.mirror_sampling = kind.into());
        check("supersampling", |settings, kind: SupersamplingKind| settings.supersampling = kind.into());
        check("path_reuse", |settings, kind: PathReuseKind| settings.path_reuse = kind.into());
        check("guiding", |settings, kind: GuidingKind| settings.guiding = kind.into());
    }
}
