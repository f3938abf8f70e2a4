use std::ops::AddAssign;

/// What a render did, counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Counters {
    /// Rays from the camera, one a sample.
    pub camera_rays: u64,
    /// Rays along scattered directions.
    pub bounce_rays: u64,
    /// Segments between a surface and a light; by way of a mirror, both parts of it. Where pixels share
    /// paths, those between their surfaces too.
    pub shadow_rays: u64,
    /// Paths that roulette ended.
    pub roulette_ends: u64,
    /// Paths that the limit on bounces ended: where this is above zero, light may be missing.
    pub limit_ends: u64,
}

impl Counters {
    pub(crate) const COUNT: usize = 5;

    pub(crate) fn to_array(self) -> [u64; Self::COUNT] {
        [self.camera_rays, self.bounce_rays, self.shadow_rays, self.roulette_ends, self.limit_ends]
    }

    pub(crate) fn from_array(counters: [u64; Self::COUNT]) -> Self {
        let [camera_rays, bounce_rays, shadow_rays, roulette_ends, limit_ends] = counters;
        Self { camera_rays, bounce_rays, shadow_rays, roulette_ends, limit_ends }
    }

    /// Rays of all kinds.
    pub fn rays(&self) -> u64 {
        self.camera_rays + self.bounce_rays + self.shadow_rays
    }
}

impl AddAssign for Counters {
    fn add_assign(&mut self, other: Self) {
        let own = self.to_array();
        let other = other.to_array();
        // Saturating, since counters read from a file may be anything.
        *self = Self::from_array(std::array::from_fn(|i| own[i].saturating_add(other[i])));
    }
}
