use super::FactorError;
use crate::param::Param;
use crate::{Sampler, Settings};
use globillum_material::Sides;

/// How view factors are computed. With triangles and patches it determines their bits, except for `threads`.
///
/// Made by [`FactorSettings::new`] and then changed, since fields may be added.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct FactorSettings {
    /// Passes, in `[2, 2^20]`, unless `error` ends the run before.
    pub passes: u32,
    /// Rays of each patch in one pass, a power of two in `[1, 2^16]`. They are stratified together: longer passes
    /// give smaller errors, which rest on the number of passes.
    pub pass_rays: u32,
    /// Goal, above 0 and finite; `None`, the default, for none: the run ends when
    /// [`FactorAccuracy::relative_rmse`](super::FactorAccuracy::relative_rmse) is at most this: the estimate itself, not
    /// the upper end of an interval as in [`Stop`](crate::Stop).
    ///
    /// It is judged after [`FactorSettings::MIN_PASSES`] passes, each time that an eighth more (rounded down, at least
    /// one) is traced, and after the last pass: at numbers of passes that do not depend on the factors, nor on where a
    /// run was broken off. So up to an eighth more passes are traced than the goal needs.
    pub error: Option<f64>,
    /// The goal is that of factors of at least this value, in `[0, 1]`; 0.001 by default. A run that finds that no
    /// factor is as large fails with [`FactorError::NoneAsLarge`].
    pub least_factor: f64,
    /// The sides that radiate, of all triangles.
    pub sides: Sides,
    /// Which random numbers are used.
    pub seed: u64,
    /// Worker threads, at most [`Settings::MAX_THREADS`]; 0 for one per processor. Each computation starts its own, also in
    /// a thread pool of the caller; of many at a time, each may have 1.
    pub threads: usize,
}

impl FactorSettings {
    /// The goal is not judged by fewer passes: a run of fewer never ends by its goal.
    pub const MIN_PASSES: u32 = 8;
    /// The most passes: `2^20`.
    pub const MAX_PASSES: u32 = 1 << 20;
    /// Rays of a patch in one pass, by default and if there are enough.
    const PASS_RAYS: u64 = 4096;
    /// Passes that few rays are divided into.
    const FEW_PASSES: u64 = 16;

    /// At least `rays` rays of each patch: in passes of 4096, or if these are fewer than 16, in 16 passes or more of a
    /// smaller power of two; below 16 rays, in passes of one ray, and at least two of them. More than 2^32 rays take longer
    /// passes, of up to 2^16 rays, and more than 2^36 are not taken. No goal, front sides, seed 0, all threads.
    pub fn new(rays: u64) -> Self {
        let few = (rays / Self::FEW_PASSES).clamp(1, Self::PASS_RAYS);
        // As many as the most passes need.
        let many = rays.div_ceil(Self::MAX_PASSES.into()).clamp(1, Sampler::MAX_PASS.into());
        let pass_rays = u64::max(1 << few.ilog2(), many.next_power_of_two());
        let passes = rays.div_ceil(pass_rays).clamp(2, Self::MAX_PASSES.into());
        Self {
            passes: passes as u32,
            pass_rays: pass_rays as u32,
            error: None,
            least_factor: 1e-3,
            sides: Sides::Front,
            seed: 0,
            threads: 0,
        }
    }

    /// Whether the goal is judged after `done` passes.
    pub(super) fn judges(&self, done: u32) -> bool {
        let mut judged = Self::MIN_PASSES;
        while judged < done {
            judged += judged / 8;
        }
        judged == done || (done >= Self::MIN_PASSES && done == self.passes)
    }

    /// Checks every setting against its range; [`FactorRun::run`](super::FactorRun::run) does so too.
    ///
    /// # Errors
    /// [`FactorError::Param`] for the first one outside.
    pub fn validate(&self) -> Result<(), FactorError> {
        let Self { passes, pass_rays, error, least_factor, threads, .. } = *self;
        let are_passes = (2..=Self::MAX_PASSES).contains(&passes);
        let is_factor = (0.0..=1.0).contains(&least_factor);
        let params = [
            Some(Param::new(are_passes, "passes", passes, "[2, 2^20]")),
            Some(Settings::pass_param("pass_rays", pass_rays)),
            error.map(|error| Param::positive("error", error)),
            Some(Param::new(is_factor, "least_factor", least_factor, "[0, 1]")),
            Some(Settings::threads_param(threads)),
        ];
        match Param::first_outside(params.into_iter().flatten()) {
            Some(Param { name, value, range, .. }) => Err(FactorError::Param { name, value, range }),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn goals_are_judged_each_time_an_eighth_is_added_and_at_the_end() {
        let mut settings = FactorSettings::new(1 << 20);
        settings.passes = 26;
        let judged: Vec<u32> = (0..30).filter(|&done| settings.judges(done)).collect();
        assert_eq!(judged, [8, 9, 10, 11, 12, 13, 14, 15, 16, 18, 20, 22, 24, 26, 27]);
        settings.passes = 7;
        assert!(!settings.judges(7));
    }

    #[test]
    fn at_least_as_many_rays_are_taken() {
        for (rays, passes, pass_rays) in [
            (0, 2, 1),
            (1, 2, 1),
            (15, 15, 1),
            (16, 16, 1),
            (1 << 16, 16, 4096),
            (1 << 32, 1 << 20, 4096),
            ((1 << 32) + 1, (1 << 19) + 1, 8192),
            (1 << 34, 1 << 20, 1 << 14),
            (1 << 36, 1 << 20, 1 << 16),
            (u64::MAX, 1 << 20, 1 << 16),
        ] {
            let settings = FactorSettings::new(rays);
            assert_eq!((settings.passes, settings.pass_rays), (passes, pass_rays), "{rays} rays");
            settings.validate().expect("they are in range");
        }
    }
}
