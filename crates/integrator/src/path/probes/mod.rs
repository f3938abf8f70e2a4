//! Probes: a few paths at fixed places of the picture that find what the scene is like, before the first sample, and
//! photons from the lights. They follow from the scene, the sensor and the settings, so all parts of a picture have the
//! same.

mod caustic_photons;
mod large_mirror_prob;
mod rare_caustics;

pub(super) use caustic_photons::photon_guide;

use super::render_context::RenderContext;

/// The context with what probes find.
pub(crate) fn probed<'a>(context: RenderContext<'a>) -> RenderContext<'a> {
    let context = RenderContext { large_mirror_prob: large_mirror_prob::of(&context), ..context };
    let context = RenderContext { shares_caustics: rare_caustics::are_shared(&context), ..context };
    RenderContext { photons: photon_guide(&context), ..context }
}
