use globillum_geom::PdfSolidAngle;
use globillum_material::Density;

/// How light is found. All three are unbiased, so each checks the others.
///
/// A constant environment and what the camera sees in a mirror are found by scattering alone, in all
/// three. So is light that a mirror throws on a diffuse surface, unless that mirror is plane
/// ([`MirrorSampling`](crate::MirrorSampling)).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Estimator {
    /// By scattering: paths that happen to meet a light. Good for large lights.
    Bsdf,
    /// By next event: a point on a light is chosen at every diffuse surface, and another one as a plane
    /// mirror shows it. Good for small lights, bad very near to large ones.
    Light,
    /// Both, weighted by the balance heuristic (Veach and Guibas 1995).
    #[default]
    Mis,
}

impl Estimator {
    /// Whether points on lights are chosen.
    pub(crate) fn samples_lights(self) -> bool {
        self != Self::Bsdf
    }

    /// The share of emission met by a direction of density `scattered`, where choosing a point
    /// on a light would have found it with the density that `light` tells.
    #[inline(always)]
    pub(crate) fn weight_of_emission(self, scattered: Density, light: impl FnOnce() -> PdfSolidAngle) -> f64 {
        match (self, scattered) {
            (Self::Bsdf, _) | (_, Density::Delta) => 1.0,
            (Self::Light, _) => 0.0,
            (Self::Mis, Density::SolidAngle(scattered)) => balance(scattered, light()),
        }
    }

    /// The share of a light's point chosen with density `light`, where scattering would have
    /// found it with density `scattered`.
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
