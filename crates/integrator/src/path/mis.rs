//! The weights of emission in multiple importance sampling (Veach and Guibas 1995): a path that hits a light by scattering
//! shares it with the light samples that could have found the same point.

use super::emission_rays::FoundEmission;
use super::mirrors_left::MAX_MIRRORS;
use super::render_context::RenderContext;
use crate::Interaction;
use crate::light::{LargeMirrors, Mirrors, Receiver, SmallMirrors};
use glam::{DVec3, Vec3};
use globillum_geom::PdfSolidAngle;
use globillum_material::Density;

/// The density of a path's current direction, and where a light sample of the same direction would have been taken: what
/// the weight of emission depends on.
#[derive(Clone, Copy, Debug)]
pub(super) struct MisContext {
    /// A delta if no light sample could have found what the ray hits: after the camera, and after mirrors by way of which
    /// lights are not sampled. `receiver`, `mirror` and `is_first` are then not used.
    pub(super) density: Density,
    /// The last diffuse vertex, whose light samples could have found the same point.
    pub(super) receiver: Receiver,
    /// The mirror triangle that the path hit since.
    mirror: Option<u32>,
    /// Whether `receiver` is the first diffuse vertex of the path, which may have several light samples.
    is_first: bool,
    /// Whether the rays of supersampling find the lights that the path meets before its first diffuse vertex.
    supersampled: bool,
}

impl MisContext {
    /// That of a ray from the camera. `supersampled` tells whether the rays of supersampling find the lights that it shows.
    #[inline(always)]
    pub(super) fn of_camera(supersampled: bool) -> Self {
        let receiver = Receiver { position: DVec3::ZERO, normal: Vec3::ZERO };
        Self { supersampled, ..Self::scattered(Density::Delta, receiver, false) }
    }

    /// That of a direction that the diffuse vertex `receiver` scattered with this density. `is_first` tells whether that is
    /// the first one of the path.
    #[inline(always)]
    pub(super) fn scattered(density: Density, receiver: Receiver, is_first: bool) -> Self {
        Self { density, receiver, mirror: None, is_first, supersampled: false }
    }

    /// After the ideal mirror of triangle `index` has reflected the path. Lights are sampled by way of one mirror at most.
    pub(super) fn after_mirror(self, context: &RenderContext<'_>, index: u32) -> Self {
        if context.mirrors.is_some() && !self.is_specular() {
            Self { mirror: Some(index), ..self }
        } else {
            Self { density: Density::Delta, mirror: None, ..self }
        }
    }

    /// Whether the path has hit a mirror since, or begun at the camera.
    pub(super) fn is_specular(&self) -> bool {
        self.mirror.is_some() || self.density == Density::Delta
    }

    /// Whether the rays of supersampling find the emission that the ray has hit at this bounce.
    #[inline(always)]
    pub(super) fn is_supersampled(&self, bounce: u32) -> bool {
        self.supersampled && bounce <= MAX_MIRRORS
    }

    /// The weight of the emission that the ray has hit.
    #[inline(always)]
    pub(super) fn weight(&self, context: &RenderContext<'_>, at: &Interaction<'_>) -> f64 {
        let estimator = context.settings.estimator;
        let weight = |light: &dyn Fn() -> PdfSolidAngle| estimator.weight_of_emission(self.density, light);
        match self.mirror {
            None => {
                let count = context.direct_samples(self.is_first);
                weight(&|| context.light_sampler(self.receiver).pdf(at).of_samples(count))
            }
            // Where the mirror is not sampled, scattering alone finds the light.
            Some(mirror) => self.pdf_by_mirror(context, mirror, at).map_or(1.0, |pdf| weight(&|| pdf)),
        }
    }

    /// The weight of what an emission ray has found that triangle `mirror` reflected first.
    pub(super) fn weight_by_mirror(
        self,
        context: &RenderContext<'_>,
        mirror: u32,
        found: &FoundEmission<'_>,
    ) -> f64 {
        // By way of a second mirror, no light is sampled.
        if found.mirrors > 0 { 1.0 } else { self.after_mirror(context, mirror).weight(context, found.at) }
    }

    /// The density of all light samples by way of the triangle `mirror` that hit a light at `at`; `None` if this mirror is
    /// not sampled.
    #[inline(never)]
    fn pdf_by_mirror(
        &self,
        context: &RenderContext<'_>,
        mirror: u32,
        at: &Interaction<'_>,
    ) -> Option<PdfSolidAngle> {
        let Self { receiver, is_first, .. } = *self;
        let Mirrors { large, small } = context.mirrors?;
        let triangles = context.scene.triangles();
        let by_small = |mirrors: &SmallMirrors| {
            let count = context.small_mirror_samples(is_first);
            mirrors.pdf(triangles, receiver, count, mirror, &at.point)
        };
        let by_large = |mirrors: &LargeMirrors| {
            let chosen = mirrors.chosen(triangles, receiver, mirrors.facet_of(mirror)?)?;
            let image = chosen.facet.image_of(receiver);
            let prob = chosen.prob * context.large_mirror_prob(is_first);
            Some(context.light_sampler_in_mirror(image).pdf(at).chosen_with(prob))
        };
        small.as_ref().and_then(by_small).or_else(|| by_large(large.as_ref()?))
    }
}
