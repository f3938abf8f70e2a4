use crate::light::PlaneMirrors;
use crate::{Camera, MirrorSampling, PathReuse, Scene, Settings};
use globillum_geom::{Accel, SimdLevel};

/// What is rendered: a scene as a camera sees it, with settings.
#[derive(Debug)]
pub(crate) struct Job<'a, A> {
    pub(crate) scene: &'a Scene<A>,
    pub(crate) camera: &'a Camera,
    pub(crate) settings: &'a Settings,
    /// The mirrors in which lights are sampled; `None` if there are none or the settings rule it out.
    pub(super) mirrors: Option<&'a PlaneMirrors>,
    /// The instructions that shade; they change no bit.
    pub(super) simd: SimdLevel,
}

impl<'a, A: Accel> Job<'a, A> {
    pub(crate) fn new(scene: &'a Scene<A>, camera: &'a Camera, settings: &'a Settings) -> Self {
        let samples_mirrors =
            settings.mirror_sampling == MirrorSampling::Planes && settings.estimator.samples_lights();
        let mirrors = samples_mirrors.then(|| scene.mirrors()).filter(|mirrors| !mirrors.is_empty());
        Self { scene, camera, settings, mirrors, simd: SimdLevel::best() }
    }
}

impl<A> Job<'_, A> {
    /// Whether pixels reuse the paths of their neighbours.
    pub(super) fn reuses_paths(&self) -> bool {
        self.settings.path_reuse_in_effect() == PathReuse::Fours
    }

    /// Whether a prefix may end at this bounce. Roulette, which could end the path there, would change
    /// the density of the prefix.
    pub(super) fn may_end_prefix(&self, bounce: u32) -> bool {
        self.reuses_paths() && bounce < self.settings.roulette.start
    }
}
