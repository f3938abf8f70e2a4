use super::light_points::LightPoints;
use super::mirrors_left::mirrors_left;
use super::path_vertex::PathVertex;
use crate::guide::{Guide, PhotonGuide};
use crate::light::{LargeMirrors, LightSampler, Lights, Mirrors, Receiver, SmallMirrors};
use crate::{
    ElementSample, MirrorSampling, PathReuse, PathStart, Sampler, Scene, Sensor, Settings, Supersampling,
};
use globillum_geom::{Accel, SimdLevel};
use std::sync::Arc;

/// What is rendered: a scene as a sensor measures it, with settings.
#[derive(Debug)]
pub(crate) struct RenderContext<'a> {
    pub(crate) scene: &'a Scene<dyn Accel + 'a>,
    pub(crate) sensor: &'a dyn Sensor,
    pub(crate) settings: &'a Settings,
    /// Whether next event estimation samples lights.
    pub(super) samples_lights: bool,
    /// The lights, chosen by their visibility too; `None` if they are chosen as the scene's.
    pub(super) lights_by_visibility: Option<Arc<Lights>>,
    /// The mirrors in which area lights are sampled; `None` if there are none or the settings rule it out.
    pub(super) mirrors: Option<&'a Mirrors>,
    /// The guide that diffuse vertices scatter by; `None` for the cosine alone.
    pub(super) guide: Option<&'a Guide>,
    /// The probability, above zero, with which a vertex after the first diffuse one samples lights in large mirrors.
    pub(super) large_mirror_prob: f64,
    /// Whether path reuse lowers the variance by more than it raises the time, as far as probes tell.
    pub(super) reuse_pays: bool,
    /// Whether pixels share the caustics that their paths find.
    pub(super) shares_caustics: bool,
    /// The photons by which first diffuse vertices look for caustics of several mirrors; `None` if they do not.
    pub(super) photons: Option<PhotonGuide>,
    /// Where probes look for small lights.
    pub(super) light_points: LightPoints,
    /// The instructions that shade; they change no bit.
    pub(super) simd: SimdLevel,
}

impl<'a> RenderContext<'a> {
    /// A context with the lights of the scene and without guide, photons or shared caustics, which
    /// [`prepare`](super::prepare) adds.
    pub(super) fn new(
        scene: &'a Scene<dyn Accel + 'a>,
        sensor: &'a dyn Sensor,
        settings: &'a Settings,
    ) -> Self {
        let samples_areas = settings.estimator.samples_area_lights();
        let samples_lights = samples_areas || scene.lights().delta_lights().next().is_some();
        let samples_mirrors = samples_areas && settings.mirror_sampling == MirrorSampling::Images;
        let mirrors = samples_mirrors.then(|| scene.mirrors()).filter(|mirrors| !mirrors.is_empty());
        Self {
            scene,
            sensor,
            settings,
            samples_lights,
            lights_by_visibility: None,
            mirrors,
            guide: None,
            large_mirror_prob: 1.0,
            reuse_pays: true,
            shares_caustics: false,
            photons: None,
            light_points: LightPoints::default(),
            simd: SimdLevel::best(),
        }
    }
}

impl RenderContext<'_> {
    /// Whether pixels reuse the paths of other pixels of their square: not if that does not pay, paths have no second bounce
    /// or roulette begins at the first.
    pub(super) fn reuses_paths(&self) -> bool {
        let Settings { max_bounces, roulette, path_reuse, .. } = *self.settings;
        self.reuse_pays
            && path_reuse == PathReuse::Tiles
            && max_bounces.is_none_or(|max| max >= 2)
            && roulette.start > 0
    }

    /// Whether the edges of lights are supersampled.
    pub(super) fn supersamples_lights(&self) -> bool {
        self.settings.supersampling == Supersampling::Lights
            && self.scene.lights().triangles().next().is_some()
    }

    /// Where the path of a sample of `element` begins that the pixel filter places by `u`.
    pub(super) fn path_start(&self, element: (u32, u32), u: [f64; 2]) -> PathStart {
        self.element_start(element, self.settings.filter.place(u))
    }

    /// Where the path of a sample at this offset from the upper left corner of `element` begins, in elements.
    pub(super) fn element_start(&self, element: (u32, u32), offset: [f64; 2]) -> PathStart {
        let Settings { width, height, .. } = *self.settings;
        self.sensor.start(&ElementSample::new(element, offset, [width, height]))
    }

    /// Whether the samples of pixels that reuse each other's paths are one net.
    pub(super) fn stratifies_groups(&self) -> bool {
        self.settings.path_reuse == PathReuse::Tiles && self.settings.sampler == Sampler::Sobol
    }

    /// The lights that vertices sample.
    #[inline(always)]
    pub(super) fn lights(&self) -> &Lights {
        self.lights_by_visibility.as_deref().unwrap_or(self.scene.lights())
    }

    /// What samples lights for `receiver`.
    #[inline(always)]
    pub(super) fn light_sampler(&self, receiver: Receiver) -> LightSampler<'_> {
        let (triangles, sampling) = (self.scene.triangles(), self.settings.light_sampling);
        LightSampler { lights: self.lights(), triangles, sampling, receiver }
    }

    /// What samples lights for the image of a receiver in a mirror. Lights that are hidden elsewhere may be visible there.
    #[inline(always)]
    pub(super) fn light_sampler_in_mirror(&self, image: Receiver) -> LightSampler<'_> {
        LightSampler { lights: self.scene.lights(), ..self.light_sampler(image) }
    }

    /// How many light samples a diffuse vertex takes, by whether it is the first one of the path.
    #[inline(always)]
    pub(super) fn direct_samples(&self, is_first: bool) -> u32 {
        if is_first && self.scene.lights().tree().is_some() { self.settings.light_samples } else { 1 }
    }

    /// The large mirrors in which lights are sampled.
    pub(super) fn large_mirrors(&self) -> Option<&LargeMirrors> {
        self.mirrors?.large.as_ref()
    }

    /// The small mirrors in which lights are sampled.
    pub(super) fn small_mirrors(&self) -> Option<&SmallMirrors> {
        self.mirrors?.small.as_ref()
    }

    /// Whether a vertex samples lights by way of mirrors.
    pub(super) fn samples_in_mirrors(&self, vertex: &PathVertex<'_>) -> bool {
        self.mirrors.is_some()
            && self.may_sample_mirrors(vertex.bounce)
            && vertex.at.material.bsdf.is_diffuse()
    }

    /// Whether vertices of this bounce sample lights by way of mirrors, which takes two bounces: there, and at the mirror.
    pub(super) fn may_sample_mirrors(&self, bounce: u32) -> bool {
        mirrors_left(self.settings, bounce + 1) > 0
    }

    /// The probability with which a diffuse vertex samples lights in large mirrors, by whether it is the first one of the
    /// path.
    #[inline(always)]
    pub(super) fn large_mirror_prob(&self, is_first: bool) -> f64 {
        if is_first { 1.0 } else { self.large_mirror_prob }
    }

    /// How many samples of small mirrors a diffuse vertex takes, by whether it is the first one of the path.
    #[inline(always)]
    pub(super) fn small_mirror_samples(&self, is_first: bool) -> u32 {
        if is_first { self.settings.light_samples } else { 1 }
    }

    /// Whether a prefix that ends at this bounce may be reused. Roulette, which could end the path there, would change
    /// the density of the prefix.
    pub(super) fn may_reuse_prefix(&self, bounce: u32) -> bool {
        self.reuses_paths() && bounce < self.settings.roulette.start
    }
}
