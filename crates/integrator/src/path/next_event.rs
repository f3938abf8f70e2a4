use super::emission_rays::{MAX_REFLECTIONS, reflection};
use super::path_state::Path;
use super::render_context::RenderContext;
use super::shading_point::{MisContext, PriorChoice, ShadingPoint};
use crate::Interaction;
use crate::light::{
    AreaLightSample, ChosenMirror, LargeMirrors, Light, LightSample, LightSampler, MirrorPoint, Mirrors,
    Receiver, SmallMirrors,
};
use crate::sampler::Numbers;
use globillum_geom::{Hit, PdfSolidAngle, Ray, SurfacePoint};
use globillum_material::{Bsdf, Density, Rgb};

/// How many light samples of a vertex have their random numbers computed at once.
const LIGHTS_AT_ONCE: usize = 4;

/// A light sample by way of a mirror. It counts if its ray hits the mirror first, and the light follows.
#[derive(Clone, Copy, Debug)]
pub(super) struct MirrorSample {
    pub(super) by: MirrorSampleKind,
    /// The contribution to the sample if the mirror reflects all light; for each unit of the light's radiance if a point
    /// of the mirror was sampled.
    pub(super) radiance: Rgb,
}

/// What was sampled.
#[derive(Clone, Copy, Debug)]
pub(super) enum MirrorSampleKind {
    /// A point on a light, as the facet of this index shows it.
    Light(u32, SurfacePoint),
    /// A point on the mirror triangle of this index, to show a light of the cluster of this index.
    Point { triangle: u32, cluster: u32 },
}

/// What follows a mirror sample whose ray has hit its mirror.
#[derive(Clone, Copy, Debug)]
pub(super) enum Reflected {
    /// The shadow ray to the sampled point of a light.
    ShadowRay(Ray),
    /// The ray whose hit may be on a light of the cluster of this index.
    Ray(Ray, u32),
}

impl RenderContext<'_> {
    /// The radiance that the surface emits along the path, times its multiple importance sampling weight.
    #[inline(always)]
    pub(super) fn emitted(&self, path: &Path, bounce: u32, hit: &Hit, at: &Interaction<'_>) -> Rgb {
        let emitted = at.emitted();
        if emitted.is_black() {
            return emitted;
        }
        if path.mis.supersampled && bounce <= MAX_REFLECTIONS {
            return Rgb::BLACK;
        }
        emitted * self.weight_of_emission(&path.mis, (hit, at))
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

    fn light_sampler(&self, receiver: Receiver) -> LightSampler<'_> {
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

    /// Samples area lights as mirrors show them, and calls `add` with each ray that must hit a mirror.
    pub(super) fn next_event_in_mirrors(
        &self,
        path: &Path,
        vertex: &ShadingPoint<'_>,
        mut add: impl FnMut(Ray, MirrorSample),
    ) {
        let ShadingPoint { at, bounce, .. } = vertex;
        let Some(Mirrors { large, small }) = self.mirrors else { return };
        if !self.may_sample_mirrors(*bounce) || at.material.bsdf.is_delta() {
            return;
        }
        let mut add_seen = |by: MirrorSampleKind, seen: AreaLightSample| {
            let Some(radiance) = self.scattered(path, vertex, &LightSample::Area(seen)) else { return };
            add(at.point.spawn(seen.direction), MirrorSample { by, radiance });
        };
        // Two kinds of samples, each with random numbers of its own.
        if let Some((by, seen)) =
            large.as_ref().and_then(|mirrors| self.large_mirror_sample(mirrors, path, vertex))
        {
            add_seen(by, seen);
        }
        if let Some(mirrors) = small {
            self.sample_small_mirrors(mirrors, path, vertex, add_seen);
        }
    }

    /// A point on a light, sampled from the image of the shading point in a facet (image method).
    fn large_mirror_sample(
        &self,
        mirrors: &LargeMirrors,
        path: &Path,
        vertex: &ShadingPoint<'_>,
    ) -> Option<(MirrorSampleKind, AreaLightSample)> {
        let ShadingPoint { at, bounce, .. } = vertex;
        let (triangles, receiver) = (self.scene.triangles(), vertex.receiver());
        let (decision, sample_prob) = (2 * bounce, self.large_mirror_prob(path.is_prefix()));
        let number = || path.numbers.mirror(decision);
        // What the decision to sample leaves of its number chooses the mirror.
        let rest = (sample_prob < 1.0).then(|| number() / sample_prob);
        if rest.is_some_and(|rest| rest >= 1.0) {
            return None;
        }
        let chosen = mirrors.choose(triangles, receiver, || rest.unwrap_or_else(number))?;
        let facet = chosen.facet;
        let drawn = vertex.large_mirror_numbers;
        let (choice, u) = drawn.unwrap_or_else(|| path.numbers.light_in_mirror(decision));
        let light = match self.light_sampler(facet.image_of(receiver)).sample(choice, u)? {
            LightSample::Area(light) => light,
            LightSample::Delta(_) => return None,
        };
        if !facet.same_side(receiver.position, light.point.position) {
            return None;
        }
        let (direction, pdf) =
            (facet.reflect(light.direction), light.pdf.chosen_with(chosen.prob * sample_prob));
        let is_hit = facet.may_be_hit_by(triangles, &at.point.spawn(direction));
        let by = MirrorSampleKind::Light(chosen.index, light.point);
        is_hit.then_some((by, AreaLightSample { direction, pdf, ..light }))
    }

    /// Samples points on small mirror triangles, and calls `add` with each: it may show a light of radiance 1.
    fn sample_small_mirrors(
        &self,
        mirrors: &SmallMirrors,
        path: &Path,
        vertex: &ShadingPoint<'_>,
        mut add: impl FnMut(MirrorSampleKind, AreaLightSample),
    ) {
        let count = self.small_mirror_samples(path.is_prefix());
        let mut add_chosen = |chosen: ChosenMirror, point: [f64; 2]| {
            let (triangles, receiver) = (self.scene.triangles(), vertex.receiver());
            let Some(sample) = mirrors.sample(triangles, receiver, count, chosen, point) else { return };
            let MirrorPoint { triangle, point, direction, pdf, cluster } = sample;
            let seen = AreaLightSample { point, direction, radiance: Rgb::WHITE, pdf };
            add(MirrorSampleKind::Point { triangle, cluster }, seen);
        };
        match (vertex.mirror, count) {
            (PriorChoice::Made(chosen), _) => {
                if let Some(chosen) = chosen {
                    add_chosen(chosen, path.numbers.light_in_mirror(small_mirror_decision(vertex.bounce)).1);
                }
            }
            (PriorChoice::Open, 1) => self.choose_mirrors::<1>(mirrors, path, vertex, count, add_chosen),
            (PriorChoice::Open, 2) => self.choose_mirrors::<2>(mirrors, path, vertex, count, add_chosen),
            // A power of two.
            (PriorChoice::Open, _) => self.choose_mirrors::<4>(mirrors, path, vertex, count, add_chosen),
        }
    }

    /// Chooses `N` at a time of the small mirrors for `count` samples of a vertex, and calls `add` with each and two numbers for
    /// a point on it. `N` divides `count`.
    fn choose_mirrors<const N: usize>(
        &self,
        mirrors: &SmallMirrors,
        path: &Path,
        vertex: &ShadingPoint<'_>,
        count: u32,
        mut add: impl FnMut(ChosenMirror, [f64; 2]),
    ) {
        let decision = small_mirror_decision(vertex.bounce);
        for first in (0..count).step_by(N) {
            let parts: [_; N] = path.numbers.parts(first, count);
            let us = self.simd.run(
                #[inline(always)]
                || Numbers::mirrors(&parts, decision),
            );
            let chosen = mirrors.choose([vertex.receiver(); N], count, us);
            if chosen.iter().all(Option::is_none) {
                continue;
            }
            let points = self.simd.run(
                #[inline(always)]
                || Numbers::lights_in_mirrors(&parts, decision),
            );
            for (chosen, (_, point)) in chosen.into_iter().zip(points) {
                if let Some(chosen) = chosen {
                    add(chosen, point);
                }
            }
        }
    }

    /// The contribution of a light sample: what arrives from it, scattered along the path, times its multiple
    /// importance sampling weight. `None` if that is black.
    #[inline(always)]
    fn scattered(
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

    /// What follows `ray` of a mirror sample, and the contribution if that reaches the light; `None` if `hit`, where the
    /// ray ended, is not on the mirror.
    pub(super) fn reflected(
        &self,
        sample: &MirrorSample,
        ray: &Ray,
        hit: Option<Hit>,
    ) -> Option<(Reflected, Rgb)> {
        let mirrors = &self.mirrors?.large;
        let facet_of = |index: u32| mirrors.as_ref()?.facet_of(index);
        let is_on_mirror = |hit: &Hit| match sample.by {
            MirrorSampleKind::Light(facet, _) => facet_of(hit.triangle) == Some(facet),
            MirrorSampleKind::Point { triangle, .. } => hit.triangle == triangle,
        };
        let hit = hit.filter(is_on_mirror)?;
        let Bsdf::Mirror(reflectance) = self.scene.material(hit.triangle).bsdf else { return None };
        let radiance = sample.radiance * reflectance.rgb();
        if radiance.is_black() {
            return None;
        }
        let point = self.scene.triangles().surface_point(hit.triangle, hit.u, hit.v);
        let next = match sample.by {
            MirrorSampleKind::Light(_, light) => Reflected::ShadowRay(point.segment_to(&light)?),
            MirrorSampleKind::Point { cluster, .. } => {
                Reflected::Ray(reflection(&point, ray.direction), cluster)
            }
        };
        Some((next, radiance))
    }

    /// The radiance from where a ray from a mirror has hit; black if that is not on a light of `cluster`.
    pub(super) fn shown(&self, ray: &Ray, hit: &Hit, cluster: u32) -> Rgb {
        let emitted = self.scene.interaction(ray, hit).emitted();
        let of_cluster =
            || self.small_mirrors().and_then(|mirrors| mirrors.cluster_of(hit.triangle)) == Some(cluster);
        if !emitted.is_black() && of_cluster() { emitted } else { Rgb::BLACK }
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

/// The decision for a small mirror at a bounce. Those for large ones have even numbers.
pub(super) const fn small_mirror_decision(bounce: u32) -> u32 {
    2 * bounce + 1
}
