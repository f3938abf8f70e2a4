use super::light_moments::twice_positive_part;
use crate::light::alias_table::{AliasTable, raised};
use glam::{DVec3, Vec3};

/// A light infinitely far away.
#[derive(Clone, Copy, Debug)]
pub(in crate::light) struct FarLight {
    /// On a plane that faces it, as luminance; above zero.
    pub(in crate::light) irradiance: f64,
    /// The unit vector toward it.
    pub(in crate::light) direction: DVec3,
}

/// The lights that are infinitely far away, chosen among themselves by irradiance, [raised] for dim ones.
#[derive(Clone, Debug)]
pub(super) struct FarLights {
    table: AliasTable,
    /// Their indices in the scene, each with its probability.
    lights: Vec<(u32, f64)>,
    /// The sum of all.
    irradiance: f64,
    /// The mean of the directions toward them, by irradiance.
    direction: Vec3,
    /// The most that their variance along an axis can be: the sum of those along three.
    variance: f32,
}

impl FarLights {
    /// `None` if there are none. Each comes with its index in the scene.
    pub(super) fn new(lights: &[(u32, FarLight)]) -> Option<Self> {
        if lights.is_empty() {
            return None;
        }
        let irradiances: Vec<_> = lights.iter().map(|(_, light)| light.irradiance).collect();
        let irradiance = irradiances.iter().sum();
        let direction: DVec3 =
            lights.iter().map(|(_, light)| light.irradiance / irradiance * light.direction).sum();
        let weights = raised(irradiances);
        let total: f64 = weights.iter().sum();
        let with_prob = |((index, _), weight): (&(u32, FarLight), &f64)| (*index, weight / total);
        Some(Self {
            table: AliasTable::new(&weights),
            lights: lights.iter().zip(&weights).map(with_prob).collect(),
            irradiance,
            direction: direction.as_vec3(),
            variance: (1.0 - direction.length_squared()).max(0.0) as f32,
        })
    }

    /// Multiplies the irradiance from all by `factor`.
    pub(super) fn scale(&mut self, factor: f64) {
        self.irradiance *= factor;
    }

    /// The irradiance from all, about, on the side of a surface to which `side` points.
    #[inline(always)]
    pub(super) fn irradiance_on(&self, normal: Vec3) -> f64 {
        self.irradiance * f64::from(0.5 * twice_positive_part(normal.dot(self.direction), self.variance))
    }

    /// The index of the light that `u` in `[0, 1)` chooses.
    pub(super) fn choose(&self, u: f64) -> u32 {
        // `FarLights::new` returns `None` without a light.
        let place = self.table.sample(u).expect("there is a light");
        self.lights[place].0
    }

    /// The index of each light, and its probability among all.
    pub(super) fn probs(&self) -> impl Iterator<Item = (u32, f64)> {
        self.lights.iter().copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Stream;

    fn unit(numbers: Stream, dimension: u32) -> DVec3 {
        DVec3::from_array([0, 1, 2].map(|k| 2.0 * numbers.uniform(dimension + k) - 1.0)).normalize()
    }

    /// A single light brings its irradiance times the cosine, and nothing from behind; several bring together at most what
    /// is assumed.
    #[test]
    fn cosines_bound_those_of_all_lights() {
        for i in 0..1000 {
            let numbers = Stream::new(13, 0, i);
            let (middle, spread) = (unit(numbers, 0), numbers.uniform(3));
            let light = |k: u32| {
                let direction = (middle + spread * unit(numbers, 4 + 4 * k)).normalize();
                (k, FarLight { irradiance: 1.0 + f64::from(k), direction })
            };
            let lights: Vec<_> = (0..4).map(light).collect();
            let normal = unit(numbers, 30).as_vec3();
            let brings = |(_, light): &(u32, FarLight)| {
                light.irradiance * normal.as_dvec3().dot(light.direction).max(0.0)
            };
            let assumed = |lights: &[_]| FarLights::new(lights).unwrap().irradiance_on(normal);
            assert!((assumed(&lights[..1]) - brings(&lights[0])).abs() < 1e-6, "{i}");
            let (together, bound) = (lights.iter().map(brings).sum::<f64>(), assumed(&lights));
            assert!(bound >= together - 1e-5 && bound <= 10.0, "{i}: {bound}, {together}");
            // The directions differ from each other by at most twice the spread.
            assert!(bound <= together + 10.0 * 2.0 * spread, "{i}: {bound}, {together}");
        }
    }
}
