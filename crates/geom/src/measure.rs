//! Probability densities, typed by their measure.

/// A probability density per unit of surface area, `>= 0`.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct PdfArea(pub f64);

/// A probability density per steradian, `>= 0`.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct PdfSolidAngle(pub f64);

impl PdfArea {
    /// The same density per steradian: `p_omega = p_area * r^2 / |cos theta_light|` (Veach 1997, section
    /// 8.2).
    ///
    /// `distance_sq` is the squared distance between the two points, `cos_light` the cosine of the angle
    /// between their connecting line and the normal of the sampled surface. `None` if the quotient is not
    /// finite, as for a surface seen edge-on (`cos_light == 0`).
    pub fn to_solid_angle(self, distance_sq: f64, cos_light: f64) -> Option<PdfSolidAngle> {
        let pdf = self.0 * distance_sq / cos_light.abs();
        pdf.is_finite().then_some(PdfSolidAngle(pdf))
    }
}

impl PdfSolidAngle {
    /// The sum of the densities of `count` samples. It takes the place of one sample's density in the power heuristic, and
    /// in the estimate of which each sample is a part.
    #[must_use]
    pub fn of_samples(self, count: u32) -> Self {
        Self(self.0 * f64::from(count))
    }

    /// The density times the probability `choice_prob`, in `[0, 1]`, of choosing this sampling domain.
    #[must_use]
    pub fn chosen_with(self, choice_prob: f64) -> Self {
        Self(self.0 * choice_prob)
    }

    /// The weight of a sample of this density where another technique samples the same with density `other`:
    /// `pdf^b / (pdf^b + other^b)` with `b = 1.5`, the power heuristic for one sample of each (Veach 1997,
    /// section 9.2.3). NaN if both densities are 0.
    #[inline(always)]
    pub fn power_heuristic(self, other: Self) -> f64 {
        let ratio = other.0 / self.0;
        1.0 / (1.0 + ratio * ratio.sqrt())
    }
}
