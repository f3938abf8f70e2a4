use super::alias_table::AliasTable;
use super::delta::DeltaLight;
use glam::DVec3;
use globillum_geom::{PdfArea, SphericalTriangle, Triangle, Triangles};
use globillum_material::Emission;
use std::f64::consts::FRAC_PI_4;

/// The lights of a scene, its triangles that emit and its delta lights, sampled with probability proportional
/// to power. That of a directional light is its irradiance times the cross-section of the sphere around the
/// bounds of all triangles.
///
/// Each light has a positive probability, a normal number, for any size and radiance. A
/// [`LightSampler`](crate::LightSampler) samples points on lights.
#[derive(Clone, Debug)]
pub struct Lights {
    areas: Vec<AreaLight>,
    deltas: Vec<Delta>,
    /// Over `areas`, then `deltas`.
    table: AliasTable,
    total_power: f64,
}

/// A light that was chosen.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Light<'a> {
    Area(&'a AreaLight),
    Delta(&'a Delta),
}

/// A delta light with its probability of being chosen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Delta {
    pub(crate) light: DeltaLight,
    pub(crate) choice_prob: f64,
}

/// A triangle that emits, with what is precomputed for all shading points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AreaLight {
    pub(crate) triangle: u32,
    pub(crate) emission: Emission,
    pub(crate) normal: DVec3,
    pub(crate) choice_prob: f64,
    pub(crate) area_density: PdfArea,
    middle: DVec3,
    reach_sq: f64,
}

impl AreaLight {
    /// Whether [`SphericalTriangle::new`] may succeed from `point`.
    #[inline(always)]
    pub(crate) fn may_look_large(&self, point: DVec3) -> bool {
        self.middle.distance_squared(point) <= self.reach_sq
    }
}

impl Lights {
    /// The triangles whose `emission`, asked by index, is not black, and those of `deltas` that are not.
    pub(crate) fn of(
        triangles: &Triangles,
        emission: impl Fn(u32) -> Emission,
        deltas: &[DeltaLight],
    ) -> Self {
        let (emitting, mut powers): (Vec<_>, Vec<_>) = triangles
            .live()
            .iter()
            .map(|&index| (index, power(triangles.get(index), &emission(index))))
            .filter(|(_, power)| *power > 0.0)
            .unzip();
        let cross_section = FRAC_PI_4 * triangles.bounds().extent().length_squared();
        let deltas = deltas.iter().map(|&light| (light, light.power(cross_section)));
        let deltas: Vec<_> = deltas.filter(|(_, power)| *power > 0.0).collect();
        powers.extend(deltas.iter().map(|(_, power)| power));
        let total_power = powers.iter().sum();
        let table = AliasTable::new(&powers);
        let mut this = Self { areas: Vec::new(), deltas: Vec::new(), table, total_power };
        let area = |index| this.area_light(index, triangles.get(index), emission(index));
        let delta = |(light, power)| Delta { light, choice_prob: this.share(power) };
        (this.areas, this.deltas) =
            (emitting.into_iter().map(area).collect(), deltas.into_iter().map(delta).collect());
        this
    }

    fn area_light(&self, index: u32, triangle: &Triangle, emission: Emission) -> AreaLight {
        let [a, b, c] = triangle.vertices.map(|v| v.as_dvec3());
        AreaLight {
            triangle: index,
            emission,
            normal: triangle.normal(),
            choice_prob: self.choice_prob(triangle, &emission),
            area_density: self.area_density(&emission),
            middle: (a + b + c) / 3.0,
            reach_sq: SphericalTriangle::reach(triangle).powi(2),
        }
    }

    /// The number of lights of both kinds, without degenerate triangles and black delta lights.
    pub fn len(&self) -> usize {
        self.areas.len() + self.deltas.len()
    }

    /// Whether there are no lights of either kind.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The indices of the triangles that emit, in ascending order, without degenerate triangles.
    pub fn triangles(&self) -> impl Iterator<Item = u32> {
        self.areas.iter().map(|light| light.triangle)
    }

    /// The delta lights that are not black, in the order of the model. In a scene without triangles that can be
    /// hit, a directional light has no power and is left out.
    pub fn delta_lights(&self) -> impl Iterator<Item = &DeltaLight> {
        self.deltas.iter().map(|delta| &delta.light)
    }

    /// Samples a light by `u` in `[0, 1)`; `None` if there is none.
    #[inline(always)]
    pub(crate) fn choose(&self, u: f64) -> Option<Light<'_>> {
        let index = self.table.sample(u)?;
        Some(match self.areas.get(index) {
            Some(light) => Light::Area(light),
            None => Light::Delta(&self.deltas[index - self.areas.len()]),
        })
    }

    /// The probability of choosing `triangle`, which emits `emission`.
    pub(crate) fn choice_prob(&self, triangle: &Triangle, emission: &Emission) -> f64 {
        self.share(power(triangle, emission))
    }

    /// The density per area of a point on a light that emits `emission`, if the point is sampled uniformly
    /// by area. Includes the probability of choosing the light, so that the area cancels.
    pub(crate) fn area_density(&self, emission: &Emission) -> PdfArea {
        PdfArea(self.share(emission.exitance().luminance()))
    }

    /// `power` as a share of that of all lights.
    fn share(&self, power: f64) -> f64 {
        power / self.total_power
    }
}

/// The emitted power, as luminance.
fn power(triangle: &Triangle, emission: &Emission) -> f64 {
    triangle.area() * emission.exitance().luminance()
}
