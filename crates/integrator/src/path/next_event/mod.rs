//! Next event estimation: light samples of a vertex, directly and by way of mirrors.

mod choices;
mod large_mirror_rays;
mod small_mirror_rays;

pub(super) use choices::Choices;
pub(super) use large_mirror_rays::LargeMirrorRays;
pub(super) use small_mirror_rays::SmallMirrorRays;

use super::path_state::Path;
use super::path_vertex::{PathVertex, PriorChoice};
use super::render_context::RenderContext;
use crate::light::{Light, LightSample, LightSampler};
use globillum_geom::Ray;
use globillum_material::Rgb;

/// How many light samples of a vertex have their random numbers computed at once.
const LIGHTS_AT_ONCE: usize = 4;

impl RenderContext<'_> {
    /// Samples lights, and calls `add` with each shadow ray and the contribution if it is not occluded.
    #[inline(always)]
    pub(super) fn next_event(&self, path: &Path, vertex: &PathVertex<'_>, mut add: impl FnMut(Ray, Rgb)) {
        let PathVertex { at, numbers, bounce, .. } = vertex;
        if !self.samples_lights || at.material.bsdf.is_delta() {
            return;
        }
        let sampler = self.light_sampler(vertex.at.receiver());
        let count = self.direct_samples(vertex.is_first);
        if count == 1 {
            let light = match vertex.light {
                PriorChoice::Made(chosen) => chosen.map(|chosen| self.lights().chosen(chosen)),
                PriorChoice::Open => sampler.choose([numbers.light])[0],
            };
            if let Some((ray, radiance)) = self.light_sample(path, vertex, &sampler, light, numbers.point, 1)
            {
                add(ray, radiance);
            }
            return;
        }
        for first in (0..count).step_by(LIGHTS_AT_ONCE) {
            let drawn: [_; LIGHTS_AT_ONCE] = path.numbers.lights(*bounce, first, count);
            let lights = sampler.choose(drawn.map(|(u_light, _)| u_light));
            for (light, (_, point)) in lights.into_iter().zip(drawn).take((count - first) as usize) {
                if let Some((ray, radiance)) = self.light_sample(path, vertex, &sampler, light, point, count)
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
        vertex: &PathVertex<'_>,
        sampler: &LightSampler<'_>,
        light: Option<Light<'_>>,
        point: [f64; 2],
        count: u32,
    ) -> Option<(Ray, Rgb)> {
        let light = sampler.sample_chosen(&light?, point)?.of_samples(count);
        let radiance = self.light_contribution(path, vertex, &light)?;
        Some((light.shadow_ray(&vertex.at.point)?, radiance))
    }

    /// The contribution of a light sample: what arrives from it, scattered along the path, times its multiple
    /// importance sampling weight. `None` if that is black.
    #[inline(always)]
    pub(super) fn light_contribution(
        &self,
        path: &Path,
        vertex @ PathVertex { at, frame, wo, .. }: &PathVertex<'_>,
        light: &LightSample,
    ) -> Option<Rgb> {
        let wi = frame.to_local(light.direction());
        let bsdf_pdf = vertex.pdf(wi);
        let weight = self.settings.estimator.weight_of_light(light, bsdf_pdf);
        let (incident, probability) = light.quotient();
        let value = at.material.bsdf.eval(*wo, wi) * incident;
        let radiance = path.throughput * value * (wi.z.abs() * weight / probability);
        (!radiance.is_black()).then_some(radiance)
    }
}
