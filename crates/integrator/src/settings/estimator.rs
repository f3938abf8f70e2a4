use crate::LightSample;
use globillum_geom::PdfSolidAngle;
use globillum_material::Density;

/// The technique that finds the emission of triangles. All three are unbiased.
///
/// Delta lights, which no path hits, are found by next event estimation with any of them.
///
/// Scattering alone finds a constant environment, what the camera sees in a mirror, and caustics, except
/// those of plane mirrors ([`MirrorSampling`](crate::MirrorSampling)).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Estimator {
    /// BSDF sampling only: paths that hit a light. Low variance for large lights.
    Bsdf,
    /// Next event estimation only: a point on a light is sampled at every diffuse vertex, and another one
    /// by way of a plane mirror. Low variance for small lights, high very near to large ones.
    Light,
    /// Multiple importance sampling: both, weighted by the balance heuristic (Veach and Guibas 1995).
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
            (Self::Mis, Density::SolidAngle(scattered)) => scattered.balance(light()),
        }
    }

    /// The weight of a light sample whose direction scattering would have sampled with density `scattered`.
    #[inline(always)]
    pub(crate) fn weight_of_light(self, light: &LightSample, scattered: PdfSolidAngle) -> f64 {
        match (self, light) {
            (Self::Mis, _) => light.balance(scattered),
            (Self::Light, _) | (Self::Bsdf, LightSample::Delta(_)) => 1.0,
            (Self::Bsdf, LightSample::Area(_)) => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{DeltaLight, LightSampler, LightSampling, Lights};
    use glam::{DVec3, Vec3};
    use globillum_geom::{Triangle, Triangles};
    use globillum_material::{Emission, Rgb, Sides};

    const ALL: [Estimator; 3] = [Estimator::Bsdf, Estimator::Light, Estimator::Mis];

    /// A sample of a scene's only light: a triangle that emits `radiance`, or one of `deltas`.
    fn sample(radiance: f64, deltas: &[DeltaLight]) -> LightSample {
        let triangles = Triangles::new(vec![Triangle::new(Vec3::Z, Vec3::X, Vec3::Y)]).unwrap();
        let emission = Emission::new(Rgb::splat(radiance), Sides::Both).unwrap();
        let lights = &Lights::of(&triangles, |_| emission, deltas);
        let sampling = LightSampling::Area;
        let sampler = LightSampler { lights, triangles: &triangles, sampling, from: DVec3::ZERO };
        sampler.sample(0.5, [0.5; 2]).unwrap()
    }

    #[test]
    fn the_shares_of_the_two_techniques_add_up_to_one() {
        let sample = sample(1.0, &[]);
        let LightSample::Area(light) = sample else { panic!("the triangle") };
        let scattered = PdfSolidAngle(0.3);
        let shares = ALL.map(|estimator| {
            let by_scattering = estimator.weight_of_emission(Density::SolidAngle(scattered), || light.pdf);
            (by_scattering, estimator.weight_of_light(&sample, scattered))
        });
        assert_eq!(shares[..2], [(1.0, 0.0), (0.0, 1.0)]);
        assert!((shares[2].0 + shares[2].1 - 1.0).abs() < 1e-15 && shares[2].0 > 0.0 && shares[2].1 > 0.0);
    }

    #[test]
    fn each_technique_has_all_of_a_delta_light() {
        let sample = sample(0.0, &[DeltaLight::point(Vec3::ONE, Rgb::WHITE).unwrap()]);
        let weights = ALL.map(|estimator| estimator.weight_of_light(&sample, PdfSolidAngle(0.3)));
        assert_eq!(weights, [1.0; 3]);
    }
}
