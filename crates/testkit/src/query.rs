//! The queries by which accelerators are measured and compared.

use crate::accelerators::Measurable;
use crate::hash::Fnv;
use crate::rays::Rays;
use globillum_geom::{Accel, Counts, Hit, Ray};

/// A kind of query and a kind of ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Query {
    /// The closest hit of camera rays: coherent.
    ClosestCamera,
    /// The closest hit of bounce rays: incoherent.
    ClosestBounce,
    /// Any hit of shadow rays: coherent.
    AnyShadow,
    /// Any hit of bounce rays: incoherent.
    AnyBounce,
}

impl Query {
    /// Every query.
    pub const ALL: [Self; 4] = [Self::ClosestCamera, Self::ClosestBounce, Self::AnyShadow, Self::AnyBounce];

    /// A short name: the query and the rays.
    pub const fn name(self) -> &'static str {
        match self {
            Self::ClosestCamera => "closest camera",
            Self::ClosestBounce => "closest bounce",
            Self::AnyShadow => "any shadow",
            Self::AnyBounce => "any bounce",
        }
    }

    /// The rays of the query.
    pub fn rays(self, rays: &Rays) -> &[Ray] {
        match self {
            Self::ClosestCamera => &rays.camera,
            Self::ClosestBounce | Self::AnyBounce => &rays.bounce,
            Self::AnyShadow => &rays.shadow,
        }
    }

    fn asks_for_any(self) -> bool {
        matches!(self, Self::AnyShadow | Self::AnyBounce)
    }

    /// The total traversal counts.
    pub fn count(self, accel: &dyn Measurable, rays: &Rays) -> Counts {
        let mut counts = Counts::default();
        for ray in self.rays(rays) {
            counts += if self.asks_for_any() { accel.count_any(ray).1 } else { accel.count_closest(ray).1 };
        }
        counts
    }

    /// Traces all rays once and returns a hash of the answers.
    pub fn answer(self, accel: &dyn Accel, rays: &Rays, buffers: &mut Buffers) -> u64 {
        let mut hash = Fnv::default();
        self.run(accel, rays, buffers);
        if self.asks_for_any() {
            buffers.occluded.iter().for_each(|&occluded| hash.add(u64::from(occluded)));
        } else {
            buffers.hits.iter().for_each(|hit| hash.add_hit(hit));
        }
        hash.0
    }

    /// Traces all rays once.
    pub fn run(self, accel: &dyn Accel, rays: &Rays, buffers: &mut Buffers) {
        if self.asks_for_any() {
            accel.occluded_batch(self.rays(rays), &mut buffers.occluded);
        } else {
            accel.intersect_batch(self.rays(rays), &mut buffers.hits);
        }
    }
}

/// Buffers for the answers.
#[derive(Clone, Debug, Default)]
pub struct Buffers {
    hits: Vec<Option<Hit>>,
    occluded: Vec<bool>,
}
