use std::ops::AddAssign;

/// What a render did, counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Counters {
    /// Rays from the camera, one a sample.
    pub camera_rays: u64,
    /// Rays along scattered directions.
    pub bounce_rays: u64,
    /// Segments between a surface and a light.
    pub shadow_rays: u64,
    /// Paths that roulette ended.
    pub roulette_ends: u64,
    /// Paths that the limit on bounces ended: where this is above zero, light may be missing.
    pub limit_ends: u64,
}

impl Counters {
    /// Rays of all kinds.
    pub fn rays(&self) -> u64 {
        self.camera_rays + self.bounce_rays + self.shadow_rays
    }
}

impl AddAssign for Counters {
    fn add_assign(&mut self, other: Self) {
        self.camera_rays += other.camera_rays;
        self.bounce_rays += other.bounce_rays;
        self.shadow_rays += other.shadow_rays;
        self.roulette_ends += other.roulette_ends;
        self.limit_ends += other.limit_ends;
    }
}
