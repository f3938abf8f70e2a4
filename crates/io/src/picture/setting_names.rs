//! The names of settings in picture files, as the command line has them.
//!
//! They are part of the file format: the names of variants may change, these may not.

use globillum_integrator::{
    Estimator, Guiding, LightSampling, MirrorSampling, PathReuse, PixelFilter, Sampler, Supersampling,
};

/// The name of a variant that is newer than this table.
const UNNAMED: &str = "unnamed";

pub(super) fn sampler(sampler: Sampler) -> &'static str {
    match sampler {
        Sampler::Independent => "independent",
        Sampler::Sobol => "sobol",
        _ => UNNAMED,
    }
}

pub(super) fn filter(filter: PixelFilter) -> &'static str {
    match filter {
        PixelFilter::Box => "box",
        PixelFilter::Tent => "tent",
        _ => UNNAMED,
    }
}

pub(super) fn estimator(estimator: Estimator) -> &'static str {
    match estimator {
        Estimator::Bsdf => "bsdf",
        Estimator::Light => "light",
        Estimator::Mis => "mis",
        _ => UNNAMED,
    }
}

pub(super) fn light_sampling(sampling: LightSampling) -> &'static str {
    match sampling {
        LightSampling::Area => "area",
        LightSampling::SolidAngle => "solid-angle",
        _ => UNNAMED,
    }
}

pub(super) fn mirror_sampling(sampling: MirrorSampling) -> &'static str {
    match sampling {
        MirrorSampling::Off => "off",
        MirrorSampling::Images => "images",
        _ => UNNAMED,
    }
}

pub(super) fn supersampling(supersampling: Supersampling) -> &'static str {
    match supersampling {
        Supersampling::Off => "off",
        Supersampling::Lights => "lights",
        _ => UNNAMED,
    }
}

pub(super) fn path_reuse(path_reuse: PathReuse) -> &'static str {
    match path_reuse {
        PathReuse::Off => "off",
        PathReuse::Tiles => "tiles",
        _ => UNNAMED,
    }
}

pub(super) fn guiding(guiding: Guiding) -> &'static str {
    match guiding {
        Guiding::Off => "off",
        Guiding::Trained => "trained",
        _ => UNNAMED,
    }
}
