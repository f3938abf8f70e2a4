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
    /// A delta distribution: one direction has all the probability.
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

    /// Whether the surface is ideally diffuse.
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
