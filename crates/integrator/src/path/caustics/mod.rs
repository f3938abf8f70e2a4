//! Caustics: light that a diffuse vertex receives by way of mirrors alone. Where light samples hardly ever find those of
//! first diffuse vertices, pixels [share](shared_caustics) what paths find of them, and [photon rays](photon_rays) look for
//! the part that comes by way of several mirrors. Those of later vertices are shared with [suffixes](super::reuse).

mod photon_rays;
mod shared_caustics;

pub(super) use photon_rays::{MIN_MIRRORS, PhotonRays};
pub(super) use shared_caustics::{MIN_WEIGHT, SharedCaustics};
