//! What precedes the first sample of a render. *Preliminary paths* are all that are traced for it:
//!
//! - [training paths](training), from which a guide learns;
//! - probes, paths at fixed places of the picture, which find [which lights are visible](light_visibility), [how often to
//!   sample lights in mirrors](large_mirror_prob), [whether path reuse pays](path_reuse), and [whether caustics are
//!   rare](rare_caustics);
//! - paths from the lights, which leave [photons](caustic_photons).
//!
//! Without paths it is found where the sensor may see small lights ([`LightPoints`]).
//!
//! All of this follows from the scene, the sensor and the settings, so it is the same for all parts of a picture.

mod caustic_photons;
mod large_mirror_prob;
mod light_visibility;
mod path_reuse;
mod path_starts;
mod rare_caustics;
mod training;

pub(super) use caustic_photons::photon_guide;
pub(crate) use training::train_guide;

use super::light_points::LightPoints;
use super::render_context::RenderContext;
use crate::guide::Guide;
use crate::{Scene, Sensor, Settings};
use globillum_geom::Accel;
use std::ops::ControlFlow;
use std::sync::Arc;

/// What is rendered, with this guide and all else that precedes the first sample. Breaks if `cancelled` before the end.
pub(crate) fn prepare<'a>(
    scene: &'a Scene<dyn Accel + 'a>,
    sensor: &'a dyn Sensor,
    settings: &'a Settings,
    guide: Option<&'a Guide>,
    cancelled: impl Fn() -> bool + Sync,
) -> ControlFlow<(), RenderContext<'a>> {
    let context = RenderContext { guide, ..RenderContext::new(scene, sensor, settings) };
    let lights_by_visibility = light_visibility::lights(&context).map(Arc::new);
    let context = RenderContext { lights_by_visibility, ..context };
    let context = RenderContext { large_mirror_prob: large_mirror_prob::of(&context), ..context };
    let context = RenderContext { reuse_pays: path_reuse::pays(&context), ..context };
    let context = RenderContext { shares_caustics: rare_caustics::are_shared(&context), ..context };
    let context = RenderContext { photons: photon_guide(&context, cancelled)?, ..context };
    let light_points = match context.supersamples_lights() {
        true => LightPoints::of(scene, sensor, [settings.width, settings.height]),
        false => LightPoints::default(),
    };
    ControlFlow::Continue(RenderContext { light_points, ..context })
}
