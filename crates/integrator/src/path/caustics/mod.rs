//! Caustics: light that a first diffuse vertex receives by way of mirrors alone, which light samples do not find. What
//! scattered paths find of it is [shared](shared_caustics) by pixels, and [photon rays](photon_rays) look for the part that
//! comes by way of several mirrors.

mod photon_rays;
mod shared_caustics;

pub(super) use photon_rays::{LEAST_MIRRORS, PhotonRays, most_mirrors};
pub(super) use shared_caustics::{LEAST_WEIGHT, SharedCaustics};
