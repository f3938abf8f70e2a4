//! Maps from the unit square to directions, with density and inverse.

use glam::DVec3;
use globillum_geom::PdfSolidAngle;
use std::f64::consts::{FRAC_1_PI, TAU};

/// Cosine-weighted directions of the upper hemisphere (Malley's method).
///
/// `u[0]` is the squared sine of the polar angle, `u[1]` the azimuth as a fraction of a turn.
#[derive(Clone, Copy, Debug)]
pub struct CosineHemisphere;

impl CosineHemisphere {
    /// The unit direction for `u` in `[0, 1)^2`; its cosine is above zero for every such `u`.
    #[inline(always)]
    pub fn sample(u: [f64; 2]) -> DVec3 {
        let radius = u[0].sqrt();
        // libm gives the same bits on every platform.
        let (sin, cos) = libm::sincos(TAU * u[1]);
        DVec3::new(radius * cos, radius * sin, (1.0 - u[0]).max(0.0).sqrt())
    }

    /// Density per steradian of the unit direction `w`: `cos / pi`, and 0 below the horizon.
    #[inline(always)]
    pub fn pdf(w: DVec3) -> PdfSolidAngle {
        PdfSolidAngle(w.z.max(0.0) * FRAC_1_PI)
    }

    /// The random numbers, in `[0, 1)`, that give the unit direction `w` of the upper hemisphere.
    pub fn invert(w: DVec3) -> [f64; 2] {
        let turn = libm::atan2(w.y, w.x) / TAU;
        let u = [w.x * w.x + w.y * w.y, if turn < 0.0 { turn + 1.0 } else { turn }];
        u.map(|x| x.clamp(0.0, 1.0_f64.next_down()))
    }
}
