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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Stream;
    use glam::Vec3;
    use globillum_material::{Rgb, Sides};

    impl Light<'_> {
        fn area(&self) -> &AreaLight {
            match self {
                Self::Area(light) => light,
                Self::Delta(delta) => panic!("{delta:?} was chosen"),
            }
        }
    }

    /// Triangles of area 1/2 and of these radiances.
    fn lights(radiances: &[f64]) -> (Triangles, Lights) {
        let corner = |i: usize| Vec3::new(i as f32, 0.0, 0.0);
        let triangle = |i| Triangle::new(corner(i), corner(i) + Vec3::X, corner(i) + Vec3::Y);
        let triangles = Triangles::new((0..radiances.len()).map(triangle).collect()).unwrap();
        let emission = |i: u32| Emission::new(Rgb::splat(radiances[i as usize]), Sides::Front).unwrap();
        let lights = Lights::of(&triangles, emission, &[]);
        (triangles, lights)
    }

    #[test]
    fn what_does_not_emit_is_never_chosen() {
        let (_, lights) = lights(&[0.0, 1.0, 0.0, 3.0, 0.0]);
        assert_eq!(lights.len(), 2);
        for i in 0..10_000 {
            let light = lights.choose(Stream::new(1, 0, i).uniform(0)).unwrap();
            assert!(light.area().emission.toward(1.0).g > 0.0);
        }
        assert!(self::lights(&[0.0]).1.is_empty());
    }

    /// The least power that a light may have beside the greatest: neither is lost.
    #[test]
    fn the_weakest_light_has_a_chance_beside_the_strongest() {
        let (least, most) = (f32::from_bits(1), Triangles::MAX_COORDINATE);
        let lights = [
            (least, Rgb::new(0.0, 0.0, Emission::MIN_RADIANCE), Sides::Front),
            (most, Rgb::splat(Emission::MAX_RADIANCE), Sides::Both),
        ];
        let corners = [Vec3::NEG_ONE, Vec3::new(1.0, -1.0, 1.0), Vec3::ONE];
        let triangles = lights.map(|(size, ..)| Triangle { vertices: corners.map(|v| v * size) });
        let emissions = lights.map(|(_, radiance, sides)| Emission::new(radiance, sides).unwrap());
        let triangles = Triangles::new(triangles.to_vec()).unwrap();
        let chosen = Lights::of(&triangles, |i| emissions[i as usize], &[]);
        let [weak, strong] = [0, 1].map(|i| &chosen.areas[i]);
        assert!(weak.choice_prob.is_normal() && weak.choice_prob < 1e-200, "{weak:?}");
        assert!(weak.area_density.0.is_normal() && strong.area_density.0.is_normal(), "{weak:?}, {strong:?}");
        assert_eq!(strong.choice_prob, 1.0);
        assert_eq!(chosen.choose(0.0).unwrap().area().triangle, 0);
    }

    /// Lights of both kinds share one choice, by power over fifteen orders of magnitude.
    #[test]
    fn delta_lights_are_chosen_among_triangles_by_their_power() {
        let (triangles, areas) = lights(&[2.0, 0.0, 3.0]);
        let delta = |i: i32| DeltaLight::point(Vec3::ZERO, Rgb::splat(10.0_f64.powi(i - 7))).unwrap();
        let sun = DeltaLight::directional(Vec3::X, Rgb::splat(5.0)).unwrap();
        let black = DeltaLight::point(Vec3::ZERO, Rgb::BLACK).unwrap();
        let deltas: Vec<DeltaLight> = (0..16).map(delta).chain([black, sun]).collect();
        let emission = |i: u32| match areas.areas.iter().find(|light| light.triangle == i) {
            Some(light) => light.emission,
            None => Emission::NONE,
        };
        let both = Lights::of(&triangles, emission, &deltas);
        assert_eq!((both.len(), both.delta_lights().count(), both.is_empty()), (19, 17, false));
        assert!(both.delta_lights().eq(deltas.iter().filter(|light| **light != black)));
        // The triangles are 3 by 1.
        let cross_section = std::f64::consts::PI * (3.0 * 3.0 + 1.0) / 4.0;
        let powers = deltas.iter().map(|light| light.power(cross_section));
        let total = areas.total_power + powers.sum::<f64>();
        assert!((both.total_power / total - 1.0).abs() < 1e-14);
        let of_areas = both
            .areas
            .iter()
            .zip(&areas.areas)
            .map(|(shared, alone)| (shared.choice_prob, alone.choice_prob * areas.total_power));
        let of_deltas = both.deltas.iter().map(|delta| (delta.choice_prob, delta.light.power(cross_section)));
        for (choice_prob, power) in of_areas.chain(of_deltas) {
            assert!((choice_prob / (power / total) - 1.0).abs() < 1e-13, "{choice_prob}, {power}");
        }
        // Evenly spaced numbers are as many for each light as its probability says.
        let n = 1_000_000;
        let (mut by_triangle, mut by_sun) = (0, 0);
        for i in 0..n {
            match both.choose((f64::from(i) + 0.5) / f64::from(n)).unwrap() {
                Light::Area(_) => by_triangle += 1,
                Light::Delta(delta) => by_sun += i32::from(delta.light == sun),
            }
        }
        for (count, power) in [(by_triangle, areas.total_power), (by_sun, sun.power(cross_section))] {
            assert!((f64::from(count) / f64::from(n) - power / total).abs() < 1e-4, "{count}, {power}");
        }
    }

    /// Nothing can be hit, so the light has nothing to illuminate.
    #[test]
    fn a_directional_light_without_triangles_is_left_out() {
        let sun = DeltaLight::directional(Vec3::X, Rgb::WHITE).unwrap();
        let none = Triangles::new(Vec::new()).unwrap();
        assert!(Lights::of(&none, |_| Emission::NONE, &[sun]).is_empty());
    }

    /// A million lights whose powers differ by a factor of 1e12 are chosen in proportion.
    #[test]
    fn a_million_lights_are_chosen_by_their_power() {
        let radiances: Vec<f64> = (0..1_000_000).map(|i| 10.0_f64.powi(i % 13 - 6)).collect();
        let (triangles, lights) = lights(&radiances);
        let total: f64 = radiances.iter().sum();
        // One cell for each radiance: counts of the rarest are pooled.
        let (mut counts, draws) = ([0_u32; 13], 2_000_000);
        for i in 0..draws {
            let light = *lights.choose(Stream::new(2, 0, i).uniform(0)).unwrap().area();
            let radiance = light.emission.toward(1.0).g;
            counts[(radiance.log10().round() + 6.0) as usize] += 1;
            let prob = lights.choice_prob(triangles.get(light.triangle), &light.emission);
            assert_eq!(prob, light.choice_prob);
            assert!((prob / (radiance / total) - 1.0).abs() < 1e-9);
            assert!((light.area_density.0 / (2.0 * prob) - 1.0).abs() < 1e-12);
        }
        let (mut chi_sq, mut pool, mut cells) = (0.0, (0.0, 0.0), 0.0);
        for (i, &count) in (0..).zip(&counts) {
            let share = radiances.iter().skip(i).step_by(13).sum::<f64>() / total;
            pool = (pool.0 + f64::from(count), pool.1 + share * f64::from(draws));
            if pool.1 >= 5.0 {
                chi_sq += (pool.0 - pool.1).powi(2) / pool.1;
                (pool, cells) = ((0.0, 0.0), cells + 1.0);
            }
        }
        // Exceeded with a probability of 5e-9 at five degrees of freedom.
        assert!(cells == 6.0 && chi_sq < 47.3, "{chi_sq} over {cells} cells: {counts:?}");
    }
}
