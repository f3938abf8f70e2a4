use crate::LightSample;
use globillum_geom::PdfSolidAngle;
use globillum_material::Density;

/// The technique that finds the emission of triangles. All three are unbiased.
///
/// Delta lights, which no path hits, are found by next event estimation with any of them.
///
/// Scattering alone finds a constant environment and what the camera sees in a mirror. Caustics by way of more than one
/// mirror are found by scattering and, except with `Bsdf`, by rays that photons guide
/// ([`MirrorSampling`](crate::MirrorSampling)); pixels share what scattering finds ([`PathReuse`](crate::PathReuse)). At the
/// edges of lights, the rays of [`Supersampling`](crate::Supersampling) find the lights that the camera sees, directly or in
/// mirrors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Estimator {
    /// BSDF sampling only: paths that hit a light. Low variance for large lights.
    Bsdf,
    /// Next event estimation only. Every diffuse vertex samples a point on a light. It also takes up to one sample by way
    /// of large mirrors and one by way of small ones; vertices after the first diffuse one sample large mirrors with a
    /// probability only. The first diffuse vertex may sample lights and small mirrors several times
    /// ([`Settings::light_samples`]). Low variance for small lights, high very near to large ones.
    ///
    /// [`Settings::light_samples`]: crate::Settings::light_samples
    Light,
    /// Multiple importance sampling: both, weighted by the power heuristic with exponent 1.5 (Veach 1997).
    #[default]
    Mis,
}

impl Estimator {
    /// Whether points on triangles that emit are sampled.
    pub(crate) fn samples_area_lights(self) -> bool {
        self != Self::Bsdf
    }

    /// The weight of emission hit by a direction of density `scattered`, which light sampling would have
    /// sampled with density `light`.
    #[inline(always)]
    pub(crate) fn weight_of_emission(self, scattered: Density, light: impl FnOnce() -> PdfSolidAngle) -> f64 {
        match (self, scattered) {
            (Self::Bsdf, _) | (_, Density::Delta) => 1.0,
            (Self::Light, _) => 0.0,
            (Self::Mis, Density::SolidAngle(scattered)) => scattered.power_heuristic(light()),
        }
    }

    /// The weight of a light sample whose direction scattering would have sampled with density `scattered`.
    #[inline(always)]
    pub(crate) fn weight_of_light(self, light: &LightSample, scattered: PdfSolidAngle) -> f64 {
        match (self, light) {
            (Self::Mis, _) => light.power_heuristic(scattered),
            (Self::Light, _) | (Self::Bsdf, LightSample::Delta(_)) => 1.0,
            (Self::Bsdf, LightSample::Area(_)) => 0.0,
        }
    }
}
