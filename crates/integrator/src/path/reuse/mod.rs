//! What pixels share: the suffixes of their paths, the caustics that paths find, and the photons that guide to them.

mod caustics;
mod photon_rays;
mod pixel_groups;
mod prefixes;
mod reuse_vertex;

pub(super) use caustics::{Caustics, LEAST_WEIGHT, mis_weight_by_mirror};
pub(super) use photon_rays::{LEAST_MIRRORS, PhotonRays, most_mirrors};
pub(super) use pixel_groups::{Groups, square_around};
pub(super) use prefixes::Prefixes;
