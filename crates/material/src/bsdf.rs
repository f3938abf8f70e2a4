use crate::warp::CosineHemisphere;
use crate::{Reflectance, Rgb};
use glam::DVec3;
use globillum_geom::PdfSolidAngle;
use std::f64::consts::FRAC_1_PI;

/// A bidirectional scattering distribution function, the same on both sides of the surface.
///
/// Directions are unit vectors in the local frame. Light is reflected to the side from which it comes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Bsdf {
    /// Ideal diffuse reflection: the value is `albedo / pi` per steradian.
    Lambert(Reflectance),
    /// Ideal specular reflection, scaled by the reflectance.
    Mirror(Reflectance),
}

/// The density of a sampled direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Density {
    /// A finite density per steradian.
    SolidAngle(PdfSolidAngle),
    /// A delta distribution: all probability in one direction, which no other technique samples.
    Delta,
}

/// A direction sampled by [`Bsdf::sample`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct BsdfSample {
    /// Unit direction, local frame.
    pub wi: DVec3,
    /// `f |cos| / pdf`, the factor on the radiance that arrives along `wi`. Each component is in `[0, 1]`.
    pub weight: Rgb,
    /// The density of `wi`.
    pub density: Density,
}

impl Bsdf {
    /// Samples an incident direction for `wo` by `u` in `[0, 1)^2`, which a mirror ignores. `None` if `wo` lies
    /// in the plane of the surface.
    #[inline(always)]
    pub fn sample(&self, wo: DVec3, u: [f64; 2]) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        Some(match self {
            Self::Lambert(albedo) => {
                let above = CosineHemisphere::sample(u);
                let density = Density::SolidAngle(CosineHemisphere::pdf(above));
                let wi = DVec3::new(above.x, above.y, above.z.copysign(wo.z));
                BsdfSample { wi, weight: albedo.rgb(), density }
            }
            Self::Mirror(reflectance) => {
                let wi = DVec3::new(-wo.x, -wo.y, wo.z);
                BsdfSample { wi, weight: reflectance.rgb(), density: Density::Delta }
            }
        })
    }

    /// The value `f(wo, wi)` per steradian, without the cosine. Black for a mirror, which is a delta, and for
    /// directions on different sides.
    #[inline(always)]
    pub fn eval(&self, wo: DVec3, wi: DVec3) -> Rgb {
        match self {
            Self::Lambert(albedo) if same_side(wo, wi) => albedo.rgb() * FRAC_1_PI,
            _ => Rgb::BLACK,
        }
    }

    /// The density per steradian with which [`sample`](Bsdf::sample) samples `wi`; 0 for a mirror and for
    /// directions on different sides.
    #[inline(always)]
    pub fn pdf(&self, wo: DVec3, wi: DVec3) -> PdfSolidAngle {
        match self {
            Self::Lambert(_) if same_side(wo, wi) => {
                CosineHemisphere::pdf(DVec3::new(wi.x, wi.y, wi.z.abs()))
            }
            _ => PdfSolidAngle(0.0),
        }
    }

    /// Whether the value is constant and directions are sampled by the cosine.
    #[inline(always)]
    pub fn is_diffuse(&self) -> bool {
        matches!(self, Self::Lambert(_))
    }

    /// Whether it is a delta distribution, for which light samples have no effect.
    #[inline(always)]
    pub fn is_delta(&self) -> bool {
        matches!(self, Self::Mirror(_))
    }
}

#[inline(always)]
fn same_side(wo: DVec3, wi: DVec3) -> bool {
    wo.z * wi.z > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn lambert() -> Bsdf {
        Bsdf::Lambert(Reflectance::new(Rgb::new(0.2, 0.5, 0.8)).unwrap())
    }

    #[test]
    fn weight_is_value_times_cosine_over_density() {
        let bsdf = lambert();
        for wo in [DVec3::new(0.6, 0.0, 0.8), DVec3::new(0.6, 0.0, -0.8)] {
            for i in 0..64 {
                let u = [f64::from(i % 8) / 8.0, f64::from(i / 8) / 8.0];
                let s = bsdf.sample(wo, u).unwrap();
                assert!(s.wi.z * wo.z > 0.0);
                let pdf = bsdf.pdf(wo, s.wi);
                assert_eq!(s.density, Density::SolidAngle(pdf));
                let weight = bsdf.eval(wo, s.wi) * (s.wi.z.abs() / pdf.0);
                assert_relative_eq!(weight.g, s.weight.g, max_relative = 1e-15);
                assert_relative_eq!(weight.b, s.weight.b, max_relative = 1e-15);
            }
        }
    }

    #[test]
    fn a_mirror_is_a_delta_and_nothing_else() {
        let mirror = Bsdf::Mirror(Reflectance::new(Rgb::splat(0.9)).unwrap());
        let wo = DVec3::new(0.6, 0.0, -0.8);
        let s = mirror.sample(wo, [0.1, 0.2]).unwrap();
        assert_eq!((s.wi, s.density), (DVec3::new(-0.6, 0.0, -0.8), Density::Delta));
        assert_eq!(mirror.eval(wo, s.wi), Rgb::BLACK);
        assert_eq!(mirror.pdf(wo, s.wi), PdfSolidAngle(0.0));
    }

    #[test]
    fn nothing_passes_through_or_along_the_surface() {
        assert_eq!(lambert().eval(DVec3::Z, -DVec3::Z), Rgb::BLACK);
        assert_eq!(lambert().pdf(DVec3::Z, -DVec3::Z), PdfSolidAngle(0.0));
        assert_eq!(lambert().sample(DVec3::X, [0.5, 0.5]), None);
    }
}
