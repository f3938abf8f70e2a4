use super::path_state::Path;
use super::render_context::RenderContext;
use super::shading_point::{MisContext, ShadingPoint};
use crate::Interaction;
use crate::light::{AreaLightSample, Image, LightSample, LightSampler};
use glam::DVec3;
use globillum_geom::{Hit, Ray, SurfacePoint};
use globillum_material::{Bsdf, Density, Rgb};

/// A light sample by way of a plane mirror. It counts if its ray hits the mirror first and the segment from
/// there to the light is not occluded.
#[derive(Clone, Copy, Debug)]
pub(super) struct MirrorSample {
    /// The index of the mirror.
    pub(super) plane: usize,
    /// The point on the light.
    pub(super) light: SurfacePoint,
    /// The contribution to the sample if the mirror reflects all light.
    pub(super) radiance: Rgb,
}

impl RenderContext<'_> {
    /// The radiance that the surface emits along the path, times its multiple importance sampling weight.
    #[inline(always)]
    pub(super) fn emitted(&self, path: &Path, hit: &Hit, at: &Interaction<'_>) -> Rgb {
        let emitted = at.emitted();
        if emitted.is_black() {
            return emitted;
        }
        let MisContext { density, from, from_prob, .. } = path.mis;
        let by_light_sample = || self.light_sampler(from).pdf(hit, at).chosen_with(from_prob);
        emitted * self.settings.estimator.weight_of_emission(density, by_light_sample)
    }

    fn light_sampler(&self, from: DVec3) -> LightSampler<'_> {
        self.scene.light_sampler(self.settings.light_sampling, from)
    }

    /// Samples a light: the shadow ray, and the contribution if it is not occluded.
    #[inline(always)]
    pub(super) fn next_event(&self, path: &Path, vertex: &ShadingPoint<'_>) -> Option<(Ray, Rgb)> {
        let ShadingPoint { at, numbers, .. } = vertex;
        if !self.samples_lights || at.material.bsdf.is_delta() {
            return None;
        }
        let light = self.light_sampler(at.point.position).sample(numbers.light, numbers.point)?;
        let radiance = self.scattered(path, vertex, &light)?;
        Some((light.shadow_ray(&at.point)?, radiance))
    }

    /// Samples a point on an area light as a plane mirror shows it, with the ray that must hit the mirror.
    pub(super) fn next_event_in_mirror(
        &self,
        path: &Path,
        vertex: &ShadingPoint<'_>,
    ) -> Option<(Ray, MirrorSample)> {
        let ShadingPoint { at, bounce, .. } = vertex;
        let mirrors = self.mirrors?;
        // Two bounces: at this vertex, and at the mirror.
        let within_limit = self.settings.max_bounces.is_none_or(|max| *bounce + 1 < max);
        if !within_limit || at.material.bsdf.is_delta() {
            return None;
        }
        let position = at.point.position;
        let image = mirrors.choose(position, || path.numbers.mirror(*bounce))?;
        let Image { mirror, plane, choice_prob, .. } = image;
        let (choice, u) = path.numbers.light_in_mirror(*bounce);
        let light = match self.light_sampler(image.position).sample(choice, u)? {
            LightSample::Area(light) => light,
            LightSample::Delta(_) => return None,
        };
        if !mirror.same_side(position, light.point.position) {
            return None;
        }
        let direction = mirror.reflect(light.direction);
        let pdf = light.pdf.chosen_with(choice_prob);
        let reflected = LightSample::Area(AreaLightSample { direction, pdf, ..light });
        let radiance = self.scattered(path, vertex, &reflected)?;
        let ray = at.point.spawn(direction);
        mirror.is_hit_by(&ray).then_some((ray, MirrorSample { plane, light: light.point, radiance }))
    }

    /// The contribution of a light sample: what arrives from it, scattered along the path, times its multiple
    /// importance sampling weight. `None` if that is black.
    #[inline(always)]
    fn scattered(
        &self,
        path: &Path,
        ShadingPoint { at, frame, wo, .. }: &ShadingPoint<'_>,
        light: &LightSample,
    ) -> Option<Rgb> {
        let wi = frame.to_local(light.direction());
        let scattered = at.material.bsdf.pdf(*wo, wi);
        let weight = self.settings.estimator.weight_of_light(light, scattered);
        let (incident, probability) = light.quotient();
        let value = at.material.bsdf.eval(*wo, wi) * incident;
        let radiance = path.throughput * value * (wi.z.abs() * weight / probability);
        (!radiance.is_black()).then_some(radiance)
    }

    /// The shadow ray from the mirror to the light, and the contribution if it is not occluded; `None` if
    /// `hit`, where the ray of the sample ended, is not on the mirror.
    pub(super) fn reflected(&self, sample: &MirrorSample, hit: Option<Hit>) -> Option<(Ray, Rgb)> {
        let mirrors = self.mirrors?;
        let hit = hit.filter(|hit| mirrors.plane_of(hit.triangle) == Some(sample.plane))?;
        let Bsdf::Mirror(reflectance) = self.scene.material(hit.triangle).bsdf else { return None };
        let radiance = sample.radiance * reflectance.rgb();
        if radiance.is_black() {
            return None;
        }
        let point = self.scene.triangles().surface_point(hit.triangle, hit.u, hit.v);
        Some((point.segment_to(&sample.light)?, radiance))
    }

    /// `mis` after the path was reflected by the ideal mirror of triangle `index`.
    pub(super) fn mis_after_mirror(&self, mis: MisContext, index: u32) -> MisContext {
        match self.image_of(mis, index) {
            Some(Image { position, choice_prob, .. }) => {
                MisContext { from: position, from_prob: choice_prob, in_mirror: true, ..mis }
            }
            None => MisContext { density: Density::Delta, ..mis },
        }
    }

    /// The image, in the mirror of triangle `index`, from which a light sample could have been taken.
    fn image_of(&self, mis: MisContext, index: u32) -> Option<Image<'_>> {
        let is_first_mirror = mis.density != Density::Delta && !mis.in_mirror;
        let mirrors = self.mirrors.filter(|_| is_first_mirror)?;
        mirrors.image_in(mirrors.plane_of(index)?, mis.from)
    }
}
