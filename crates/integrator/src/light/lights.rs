use super::alias_table::AliasTable;
use glam::DVec3;
use globillum_geom::{PdfArea, SphericalTriangle, Triangle, Triangles};
use globillum_material::Emission;

/// The lights of a scene: its triangles that emit, sampled with probability proportional to power.
///
/// Each light has a positive probability, a normal number, for any size and radiance. A
/// [`LightSampler`](crate::LightSampler) samples points on lights.
#[derive(Clone, Debug)]
pub struct Lights {
    /// In the order of `table`.
    lights: Vec<Light>,
    table: AliasTable,
    total_power: f64,
}

/// A triangle that emits, with what is precomputed for all shading points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Light {
    pub(crate) triangle: u32,
    pub(crate) emission: Emission,
    pub(crate) normal: DVec3,
    pub(crate) choice_prob: f64,
    pub(crate) area_density: PdfArea,
    middle: DVec3,
    reach_sq: f64,
}

impl Light {
    /// Whether [`SphericalTriangle::new`] may succeed from `point`.
    #[inline(always)]
    pub(crate) fn may_look_large(&self, point: DVec3) -> bool {
        self.middle.distance_squared(point) <= self.reach_sq
    }
}

impl Lights {
    /// The triangles whose `emission`, asked by index, is not black.
    pub(crate) fn of(triangles: &Triangles, emission: impl Fn(u32) -> Emission) -> Self {
        let (emitting, powers): (Vec<_>, Vec<_>) = triangles
            .live()
            .iter()
            .map(|&index| (index, power(triangles.get(index), &emission(index))))
            .filter(|(_, power)| *power > 0.0)
            .unzip();
        let total_power = powers.iter().sum();
        let mut this = Self { lights: Vec::new(), table: AliasTable::new(&powers), total_power };
        let light = |index| this.light(index, triangles.get(index), emission(index));
        this.lights = emitting.into_iter().map(light).collect();
        this
    }

    fn light(&self, index: u32, triangle: &Triangle, emission: Emission) -> Light {
        let [a, b, c] = triangle.vertices.map(|v| v.as_dvec3());
        Light {
            triangle: index,
            emission,
            normal: triangle.normal(),
            choice_prob: self.choice_prob(triangle, &emission),
            area_density: self.area_density(&emission),
            middle: (a + b + c) / 3.0,
            reach_sq: SphericalTriangle::reach(triangle).powi(2),
        }
    }

    /// The number of lights.
    pub fn len(&self) -> usize {
        self.lights.len()
    }

    /// Whether there are no lights.
    pub fn is_empty(&self) -> bool {
        self.lights.is_empty()
    }

    /// The indices of the triangles that emit, in ascending order, without degenerate triangles.
    pub fn triangles(&self) -> impl Iterator<Item = u32> {
        self.lights.iter().map(|light| light.triangle)
    }

    /// Samples a light by `u` in `[0, 1)`; `None` if there is none.
    #[inline(always)]
    pub(crate) fn choose(&self, u: f64) -> Option<&Light> {
        Some(&self.lights[self.table.sample(u)?])
    }

    /// The probability of choosing `triangle`, which emits `emission`.
    pub(crate) fn choice_prob(&self, triangle: &Triangle, emission: &Emission) -> f64 {
        power(triangle, emission) / self.total_power
    }

    /// The density per area of a point on a light that emits `emission`, if the point is sampled uniformly
    /// by area. Includes the probability of choosing the light, so that the area cancels.
    pub(crate) fn area_density(&self, emission: &Emission) -> PdfArea {
        PdfArea(emission.exitance().luminance() / self.total_power)
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

    /// Triangles of area 1/2 and of these radiances.
    fn lights(radiances: &[f64]) -> (Triangles, Lights) {
        let corner = |i: usize| Vec3::new(i as f32, 0.0, 0.0);
        let triangle = |i| Triangle::new(corner(i), corner(i) + Vec3::X, corner(i) + Vec3::Y);
        let triangles = Triangles::new((0..radiances.len()).map(triangle).collect()).unwrap();
        let emission = |i: u32| Emission::new(Rgb::splat(radiances[i as usize]), Sides::Front).unwrap();
        let lights = Lights::of(&triangles, emission);
        (triangles, lights)
    }

    #[test]
    fn what_does_not_emit_is_never_chosen() {
        let (_, lights) = lights(&[0.0, 1.0, 0.0, 3.0, 0.0]);
        assert_eq!(lights.len(), 2);
        for i in 0..10_000 {
            let light = lights.choose(Stream::new(1, 0, i).uniform(0)).unwrap();
            assert!(light.emission.toward(1.0).g > 0.0);
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
        let chosen = Lights::of(&Triangles::new(triangles.to_vec()).unwrap(), |i| emissions[i as usize]);
        let [weak, strong] = [0, 1].map(|i| &chosen.lights[i]);
        assert!(weak.choice_prob.is_normal() && weak.choice_prob < 1e-200, "{weak:?}");
        assert!(weak.area_density.0.is_normal() && strong.area_density.0.is_normal(), "{weak:?}, {strong:?}");
        assert_eq!(strong.choice_prob, 1.0);
        assert_eq!(chosen.choose(0.0).unwrap().triangle, 0);
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
            let light = lights.choose(Stream::new(2, 0, i).uniform(0)).unwrap();
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
