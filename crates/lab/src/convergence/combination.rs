//! The compared combinations of estimator, sampler and path reuse.

use globillum::integrator::{Estimator, PathReuse, Sampler, Settings};
use globillum_cli::AccelKind;

/// The settings that are compared, except the accelerator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Combination {
    pub(crate) estimator: Estimator,
    pub(crate) sampler: Sampler,
    pub(crate) path_reuse: PathReuse,
    /// `None` for all but [`Combination::TRUNCATED`].
    pub(crate) max_bounces: Option<u32>,
}

const ESTIMATORS: [Estimator; 3] = [Estimator::Bsdf, Estimator::Light, Estimator::Mis];
const SAMPLERS: [Sampler; 2] = [Sampler::Independent, Sampler::Sobol];

impl Combination {
    /// The number of [`Combination::unbiased`].
    pub(crate) const UNBIASED: usize = ESTIMATORS.len() * SAMPLERS.len() + 1;

    /// Biased on purpose in scenes with illumination by more than two bounces, to show that the report detects
    /// bias.
    pub(crate) const TRUNCATED: Self = Self {
        estimator: Estimator::Mis,
        sampler: Sampler::Independent,
        path_reuse: PathReuse::Off,
        max_bounces: Some(2),
    };

    /// The default.
    const REUSE: Self = Self {
        estimator: Estimator::Mis,
        sampler: Sampler::Sobol,
        path_reuse: PathReuse::Tiles,
        max_bounces: None,
    };

    /// All combinations with unbiased estimators.
    pub(crate) fn unbiased() -> impl Iterator<Item = Self> {
        let path_reuse = PathReuse::Off;
        let with = move |estimator| {
            SAMPLERS.map(|sampler| Self { estimator, sampler, path_reuse, max_bounces: None })
        };
        ESTIMATORS.into_iter().flat_map(with).chain([Self::REUSE])
    }

    /// Sets these values in `settings`.
    pub(crate) fn apply(self, settings: &mut Settings) {
        (settings.estimator, settings.sampler) = (self.estimator, self.sampler);
        (settings.path_reuse, settings.max_bounces) = (self.path_reuse, self.max_bounces);
    }

    /// The estimator in words.
    pub(crate) fn estimator_name(self) -> String {
        let name = match self.estimator {
            Estimator::Bsdf => "Bsdf",
            Estimator::Light => "Light",
            Estimator::Mis => "Mis",
            _ => "unknown",
        };
        match (self.max_bounces, self.path_reuse) {
            (Some(limit), _) => format!("{name}, at most {limit} bounces"),
            (None, PathReuse::Off) => name.to_owned(),
            (None, _) => format!("{name}, path reuse"),
        }
    }

    /// A name for files: `mis-sobol-reuse`.
    pub(crate) fn file_name(self) -> String {
        let estimator = match self.estimator {
            Estimator::Bsdf => "bsdf",
            Estimator::Light => "light",
            Estimator::Mis => "mis",
            _ => "unknown",
        };
        let sampler = match self.sampler {
            Sampler::Independent => "independent",
            Sampler::Sobol => "sobol",
            _ => "unknown",
        };
        let reuse = if self.path_reuse == PathReuse::Off { "" } else { "-reuse" };
        let limit = self.max_bounces.map_or(String::new(), |limit| format!("-{limit}-bounces"));
        format!("{estimator}-{sampler}{reuse}{limit}")
    }

    /// The sampler in words.
    pub(crate) fn sampler_name(self) -> &'static str {
        match self.sampler {
            Sampler::Independent => "independent",
            Sampler::Sobol => "Sobol'",
            _ => "unknown",
        }
    }
}

/// The accelerator in words.
pub(crate) fn accel_name(accel: AccelKind) -> &'static str {
    match accel {
        AccelKind::Wide => "wide BVH",
        AccelKind::Kd => "k-d tree",
        AccelKind::Grid => "uniform grid",
        AccelKind::Brute => "brute force",
    }
}
