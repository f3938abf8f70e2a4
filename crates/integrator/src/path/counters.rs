use std::ops::AddAssign;

/// Counts of what a render did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Counters {
    /// Camera rays: one for each sample whose path begins with a ray, and those of
    /// [supersampling](crate::Supersampling) as they leave the camera. A sample of irradiance begins at a point and has
    /// none.
    pub camera_rays: u64,
    /// Rays in scattered directions.
    pub bounce_rays: u64,
    /// Segments between a surface and a light, both segments by way of a mirror, the connections of path reuse, and the
    /// rays by which pixels share caustics or that photons guide to them.
    pub shadow_rays: u64,
    /// Paths that Russian roulette ended.
    pub roulette_ends: u64,
    /// Paths that the limit on bounces ended. Above zero, light may be missing.
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

    /// The sum of camera, bounce and shadow rays, at most [`u64::MAX`]. It leaves out the rays of supersampling after their
    /// first mirror, probes, paths of photons, and the rays that train a guide.
    pub fn rays(&self) -> u64 {
        self.camera_rays.saturating_add(self.bounce_rays).saturating_add(self.shadow_rays)
    }
}

impl AddAssign for Counters {
    fn add_assign(&mut self, other: Self) {
        let own = self.to_array();
        let other = other.to_array();
        // Saturated, since counters read from a file may have any value.
        *self = Self::from_array(std::array::from_fn(|i| own[i].saturating_add(other[i])));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_do_not_overflow() {
        assert_eq!(Counters::from_array([1, 2, 3, 4, 5]).rays(), 6);
        assert_eq!(Counters::from_array([u64::MAX, 1, 1, 0, 0]).rays(), u64::MAX);
    }
}
