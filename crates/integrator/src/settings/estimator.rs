use globillum_geom::PdfSolidAngle;
use globillum_material::Density;

/// The technique that finds emission. All three are unbiased.
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
    /// Whether lights are sampled.
    pub(crate) fn samples_lights(self) -> bool {
        self != Self::Bsdf
    }

    /// The weight of emission hit by a direction of density `scattered`, which light sampling would have
    /// sampled with density `light`.
    #[inline(always)]
    pub(crate) fn weight_of_emission(self, scattered: Density, light: impl FnOnce() -> PdfSolidAngle) -> f64 {
        match (self, scattered) {
            (Self::Bsdf, _) | (_, Density::Delta) => 1.0,
            (Self::Light, _) => 0.0,
            (Self::Mis, Density::SolidAngle(scattered)) => balance(scattered, light()),
        }
    }

    /// The weight of a light sample of density `light`, which scattering would have sampled with density
    /// `scattered`.
    #[inline(always)]
    pub(crate) fn weight_of_light(self, light: PdfSolidAngle, scattered: PdfSolidAngle) -> f64 {
        match self {
            Self::Mis => balance(light, scattered),
            Self::Bsdf | Self::Light => 1.0,
        }
    }
}

/// The balance heuristic for one sample of each of two techniques (Veach 1997, section 9.2.2).
#[inline(always)]
fn balance(own: PdfSolidAngle, other: PdfSolidAngle) -> f64 {
    own.0 / (own.0 + other.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shares_of_the_two_techniques_add_up_to_one() {
        let (scattered, light) = (PdfSolidAngle(0.3), PdfSolidAngle(7.0));
        for estimator in [Estimator::Light, Estimator::Mis] {
            let shares = estimator.weight_of_emission(Density::SolidAngle(scattered), || light)
                + estimator.weight_of_light(light, scattered);
            assert!((shares - 1.0).abs() < 1e-15, "{estimator:?}");
        }
        assert_eq!(Estimator::Bsdf.weight_of_emission(Density::SolidAngle(scattered), || light), 1.0);
    }
}
