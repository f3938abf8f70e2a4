//! What precedes the first sample: paths that train a guide, a few paths at fixed places of the picture that find what the
//! scene is like, and photons from the lights. It follows from the scene, the sensor and the settings, so all parts of a
//! picture have the same.

mod caustic_photons;
mod large_mirror_prob;
mod path_settings;
mod rare_caustics;
mod training;

pub(super) use caustic_photons::photon_guide;
pub(crate) use training::guide;

use super::render_context::RenderContext;

/// The context with what probes find.
pub(crate) fn probed<'a>(context: RenderContext<'a>) -> RenderContext<'a> {
    let context = RenderContext { large_mirror_prob: large_mirror_prob::of(&context), ..context };
    let context = RenderContext { shares_caustics: rare_caustics::are_shared(&context), ..context };
    RenderContext { photons: photon_guide(&context), ..context }
}
