//! Next event estimation: light samples of a vertex, directly and by way of mirrors, and their weights.

mod choices;
mod large_mirror_rays;
mod small_mirror_rays;

pub(super) use choices::Choices;
pub(super) use large_mirror_rays::LargeMirrorRays;
pub(super) use small_mirror_rays::SmallMirrorRays;

use super::emission_rays::MAX_REFLECTIONS;
use super::path_state::Path;
use super::render_context::RenderContext;
use super::shading_point::{MisContext, PriorChoice, ShadingPoint};
use crate::Interaction;
use crate::light::{LargeMirrors, Light, LightSample, LightSampler, Mirrors, Receiver, SmallMirrors};
use globillum_geom::{Hit, PdfSolidAngle, Ray};
use globillum_material::{Density, Rgb};

/// How many light samples of a vertex have their random numbers computed at once.
const LIGHTS_AT_ONCE: usize = 4;

impl RenderContext<'_> {
    /// The radiance that the surface emits along the path, and its multiple importance sampling weight. `None` if that is
    /// black, or if other camera rays find it.
    #[inline(always)]
    pub(super) fn emitted(
        &self,
        path: &Path,
        bounce: u32,
        hit: &Hit,
        at: &Interaction<'_>,
    ) -> Option<(Rgb, f64)> {
        let emitted = at.emitted();
        if emitted.is_black() || path.mis.supersampled && bounce <= MAX_REFLECTIONS {
            return None;
        }
        Some((emitted, self.weight_of_emission(&path.mis, (hit, at))))
    }

    /// The multiple importance sampling weight of emission that a ray has hit.
    #[inline(always)]
    pub(super) fn weight_of_emission(&self, mis: &MisContext, (hit, at): (&Hit, &Interaction<'_>)) -> f64 {
        let MisContext { density, receiver, mirror, is_first, .. } = *mis;
        let weight =
            |light: &dyn Fn() -> PdfSolidAngle| self.settings.estimator.weight_of_emission(density, light);
        match mirror {
            None => {
                let count = self.direct_samples(is_first);
                weight(&|| self.light_sampler(receiver).pdf(hit, at).of_samples(count))
            }
            // Where the mirror is not sampled, scattering alone finds the light.
            Some(mirror) => self.pdf_by_mirror(mis, mirror, hit, at).map_or(1.0, |pdf| weight(&|| pdf)),
        }
    }

    /// The density of all light samples by way of the triangle `mirror` that hit a light as told; `None` if this mirror is
    /// not sampled.
    #[inline(never)]
    fn pdf_by_mirror(
        &self,
        mis: &MisContext,
        mirror: u32,
        hit: &Hit,
        at: &Interaction<'_>,
    ) -> Option<PdfSolidAngle> {
        let MisContext { receiver, is_first, .. } = *mis;
        let Mirrors { large, small } = self.mirrors?;
        let triangles = self.scene.triangles();
        let by_small = |mirrors: &SmallMirrors| {
            let count = self.small_mirror_samples(is_first);
            mirrors.pdf(triangles, receiver, count, mirror, (hit.triangle, at.point.position))
        };
        let by_large = |mirrors: &LargeMirrors| {
            let chosen = mirrors.choice(triangles, receiver, mirrors.facet_of(mirror)?)?;
            let image = chosen.facet.image_of(receiver);
            let prob = chosen.prob * self.large_mirror_prob(is_first);
            Some(self.light_sampler(image).pdf(hit, at).chosen_with(prob))
        };
        small.as_ref().and_then(by_small).or_else(|| by_large(large.as_ref()?))
    }

    pub(super) fn light_sampler(&self, receiver: Receiver) -> LightSampler<'_> {
        self.scene.light_sampler_of(self.settings.light_sampling, receiver)
    }

    /// Samples lights, and calls `add` with each shadow ray and the contribution if it is not occluded.
    #[inline(always)]
    pub(super) fn next_event(&self, path: &Path, vertex: &ShadingPoint<'_>, mut add: impl FnMut(Ray, Rgb)) {
        let ShadingPoint { at, numbers, bounce, .. } = vertex;
        if !self.samples_lights || at.material.bsdf.is_delta() {
            return;
        }
        let sampler = self.light_sampler(vertex.receiver());
        let count = self.direct_samples(path.is_prefix());
        if count == 1 {
            let light = match vertex.light {
                PriorChoice::Made(chosen) => chosen.map(|chosen| self.scene.lights().chosen(chosen)),
                PriorChoice::Open => sampler.choose([numbers.light])[0],
            };
            if let Some((ray, radiance)) =
                self.light_sample(path, vertex, &sampler, (light, numbers.point), 1)
            {
                add(ray, radiance);
            }
            return;
        }
        for first in (0..count).step_by(LIGHTS_AT_ONCE) {
            let drawn: [_; LIGHTS_AT_ONCE] = path.numbers.lights(*bounce, first, count);
            let lights = sampler.choose(drawn.map(|(choice, _)| choice));
            for (light, (_, point)) in lights.into_iter().zip(drawn).take((count - first) as usize) {
                if let Some((ray, radiance)) =
                    self.light_sample(path, vertex, &sampler, (light, point), count)
                {
                    add(ray, radiance);
                }
            }
        }
    }

    /// One of `count` light samples: the shadow ray to a point on a chosen light, and the contribution if it is not
    /// occluded. `None` if that is black.
    #[inline(always)]
    fn light_sample(
        &self,
        path: &Path,
        vertex: &ShadingPoint<'_>,
        sampler: &LightSampler<'_>,
        (light, point): (Option<Light<'_>>, [f64; 2]),
        count: u32,
    ) -> Option<(Ray, Rgb)> {
        let light = sampler.sample_chosen(&light?, point)?.of_samples(count);
        let radiance = self.scattered(path, vertex, &light)?;
        Some((light.shadow_ray(&vertex.at.point)?, radiance))
    }

    /// The contribution of a light sample: what arrives from it, scattered along the path, times its multiple
    /// importance sampling weight. `None` if that is black.
    #[inline(always)]
    pub(super) fn scattered(
        &self,
        path: &Path,
        vertex @ ShadingPoint { at, frame, wo, .. }: &ShadingPoint<'_>,
        light: &LightSample,
    ) -> Option<Rgb> {
        let wi = frame.to_local(light.direction());
        let scattered = vertex.pdf(wi);
        let weight = self.settings.estimator.weight_of_light(light, scattered);
        let (incident, probability) = light.quotient();
        let value = at.material.bsdf.eval(*wo, wi) * incident;
        let radiance = path.throughput * value * (wi.z.abs() * weight / probability);
        (!radiance.is_black()).then_some(radiance)
    }

    /// `mis` after the path was reflected by the ideal mirror of triangle `index`.
    pub(super) fn mis_after_mirror(&self, mis: MisContext, index: u32) -> MisContext {
        let is_first_mirror = mis.density != Density::Delta && mis.mirror.is_none();
        match self.mirrors.filter(|_| is_first_mirror) {
            Some(_) => MisContext { mirror: Some(index), ..mis },
            None => MisContext { density: Density::Delta, mirror: None, ..mis },
        }
    }
}
