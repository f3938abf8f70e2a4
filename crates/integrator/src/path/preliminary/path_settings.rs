use crate::{PathReuse, Settings, Supersampling};

/// The settings of paths that precede the first sample of a picture: this many of each pixel, by this seed. Pixels share
/// nothing, each vertex takes one light sample, and lights are not supersampled.
pub(super) fn path_settings(settings: &Settings, samples: u32, seed: u64) -> Settings {
    Settings {
        samples,
        pass_samples: samples,
        seed,
        light_samples: 1,
        path_reuse: PathReuse::Off,
        supersampling: Supersampling::Off,
        ..*settings
    }
}
