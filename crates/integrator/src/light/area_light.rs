use super::tree::LightMoments;
use super::triangle_part::TrianglePart;
use glam::DVec3;
use globillum_geom::{PdfArea, SphericalTriangle, Triangle};
use globillum_material::Emission;

/// The probability of choosing a triangle that emits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AreaProb {
    pub(crate) prob: f64,
    /// The density of a point that is then sampled uniformly by area, the choice included.
    pub(crate) pdf: PdfArea,
}

/// A triangle that emits or a part of one, with what is precomputed for all receivers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AreaLight {
    pub(crate) triangle: u32,
    pub(super) part: TrianglePart,
    pub(crate) emission: Emission,
    pub(crate) normal: DVec3,
    /// That of the whole triangle, if lights are chosen by power.
    pub(super) prob: AreaProb,
    area: f64,
    middle: DVec3,
    reach_sq: f64,
}

impl AreaLight {
    /// A part of triangle `index`, which is chosen by `weight`, where `total` is that of all lights.
    pub(super) fn new(
        index: u32,
        triangle: &Triangle,
        part: TrianglePart,
        emission: Emission,
        weight: f64,
        total: f64,
    ) -> Self {
        let vertices = part.vertices(triangle);
        // 1 unless the light is dim.
        let raise = weight / power(triangle, &emission);
        Self {
            triangle: index,
            part,
            emission,
            normal: triangle.normal(),
            prob: AreaProb {
                prob: weight / total,
                // The area cancels.
                pdf: PdfArea(emission.exitance().luminance() * raise / total),
            },
            area: triangle.area() * part.area_share(),
            middle: vertices.iter().sum::<DVec3>() / 3.0,
            reach_sq: SphericalTriangle::reach_of_vertices(vertices).powi(2),
        }
    }

    /// Whether it is a whole triangle or the first part of one.
    pub(super) fn is_first_of_triangle(&self) -> bool {
        self.part.number() == 0
    }

    /// The emitted power of the whole triangle, as luminance.
    pub(super) fn power_of_triangle(&self) -> f64 {
        self.area / self.part.area_share() * self.emission.exitance().luminance()
    }

    /// Whether [`SphericalTriangle::of_vertices`] may succeed for this light and `point`.
    #[inline(always)]
    pub(super) fn may_look_large(&self, point: DVec3) -> bool {
        self.middle.distance_squared(point) <= self.reach_sq
    }

    #[inline(always)]
    pub(super) fn chosen_with(&self, prob: f64) -> AreaProb {
        AreaProb { prob, pdf: PdfArea(prob / self.area) }
    }

    pub(super) fn moments(&self, triangle: &Triangle) -> LightMoments {
        let both_sides = !self.emission.toward(-1.0).is_black();
        let intensity = self.emission.toward(1.0).luminance() * self.area;
        LightMoments::of_triangle(self.part.vertices(triangle), self.normal, both_sides, intensity)
    }
}

/// The emitted power, as luminance.
pub(super) fn power(triangle: &Triangle, emission: &Emission) -> f64 {
    triangle.area() * emission.exitance().luminance()
}
