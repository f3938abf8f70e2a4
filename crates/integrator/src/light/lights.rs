use super::alias_table::{AliasTable, raised};
use super::area_light::{AreaLight, AreaProb, power};
use super::delta::DeltaLight;
use super::receiver::Receiver;
use super::tree::{ChosenLight, LightTree, TreeLight, VisibilityCount};
use super::triangle_part::TrianglePart;
use globillum_geom::{SurfacePoint, Triangles};
use globillum_material::Emission;

/// The lights of a scene, its triangles that emit and its delta lights.
///
/// A light is chosen at each receiver with a probability about proportional to the irradiance that it brings
/// there if it is visible, in a light tree (Conty Estevez and Kulla 2018). A light alone, and two triangles without
/// delta lights, such as a square, are chosen by power, which costs less, unless they are more than 10,000 times as long
/// as wide. A light of less than a 64th of their mean power then counts as if it had that much.
///
/// In the tree a triangle much longer than wide, as of a tube, is several lights, each a part of it.
///
/// A render chooses lights less often that are rarely visible in its picture. The
/// [`Scene::light_sampler`](crate::Scene::light_sampler) does not.
///
/// Each light has a positive probability, a normal number, for any size and radiance. A
/// [`LightSampler`](crate::LightSampler) samples points on lights.
#[derive(Clone, Debug)]
pub struct Lights {
    /// In ascending order of their triangles; the parts of one follow each other.
    areas: Vec<AreaLight>,
    deltas: Vec<DeltaLight>,
    distribution: LightDistribution,
}

/// How a light is chosen, by its index in `areas`, then `deltas`.
#[derive(Clone, Debug)]
enum LightDistribution {
    /// The same everywhere: of up to two triangles by power, [raised] for a dim one; or the only delta light.
    Power(AliasTable),
    /// By what they bring to the receiver.
    Tree(LightTree),
}

/// A light that was chosen, with the probability of the choice.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Light<'a> {
    Area(&'a AreaLight, AreaProb),
    Delta(&'a DeltaLight, f64),
}

impl Lights {
    /// Up to this number of triangles, two of a square, a light tree costs more than it brings.
    const MAX_BY_POWER: usize = 2;

    /// The most parts into which the long triangles of a tree are cut, about. None is cut where more than a third of that
    /// are long.
    const MAX_PARTS: usize = 4096;

    /// The triangles whose `emission`, asked by index, is not black, and those of `deltas` that are not.
    pub(crate) fn of(
        triangles: &Triangles,
        emission: impl Fn(u32) -> Emission,
        deltas: &[DeltaLight],
    ) -> Self {
        let (emitting, powers): (Vec<_>, Vec<_>) = triangles
            .live()
            .iter()
            .map(|&index| (index, power(triangles.get(index), &emission(index))))
            .filter(|(_, power)| *power > 0.0)
            .unzip();
        let deltas: Vec<_> = deltas.iter().filter(|light| !light.is_black()).copied().collect();
        let weights = raised(powers);
        let total: f64 = weights.iter().sum();
        let all = || emitting.iter().map(|&index| triangles.get(index));
        let is_by_power =
            emitting.len() <= Self::MAX_BY_POWER && deltas.is_empty() && !all().any(TrianglePart::is_needle);
        let most = if is_by_power { 1 } else { TrianglePart::most_of_each(all(), Self::MAX_PARTS) };
        let parts = |(index, &weight): (u32, &f64)| {
            let (triangle, emission) = (triangles.get(index), emission(index));
            TrianglePart::of(triangle, most)
                .map(move |part| AreaLight::new(index, triangle, part, emission, weight, total))
        };
        let areas: Vec<_> = emitting.into_iter().zip(&weights).flat_map(parts).collect();
        let distribution = match deltas.len() {
            _ if is_by_power => LightDistribution::Power(AliasTable::new(&weights)),
            1 if areas.is_empty() => LightDistribution::Power(AliasTable::new(&[1.0])),
            _ => {
                let near =
                    areas.iter().map(|light| TreeLight::Near(light.moments(triangles.get(light.triangle))));
                let lights: Vec<_> = near.chain(deltas.iter().map(DeltaLight::tree_light)).collect();
                LightDistribution::Tree(LightTree::new(&lights, &triangles.bounds()))
            }
        };
        Self { areas, deltas, distribution }
    }

    /// The number of lights of both kinds, without degenerate triangles and black delta lights. A triangle in
    /// parts counts once.
    pub fn len(&self) -> usize {
        self.triangles().count() + self.deltas.len()
    }

    /// The tree in which lights are chosen at each receiver anew; `None` if they are chosen by power.
    pub(crate) fn tree(&self) -> Option<&LightTree> {
        match &self.distribution {
            LightDistribution::Power(_) => None,
            LightDistribution::Tree(tree) => Some(tree),
        }
    }

    /// The same lights, chosen by their visibility too, if `counts` holds those of each by its index in the tree; `None` if
    /// that changes nothing.
    pub(crate) fn by_visibility(&self, counts: &[VisibilityCount]) -> Option<Self> {
        let distribution = LightDistribution::Tree(self.tree()?.by_visibility(counts)?);
        Some(Self { areas: self.areas.clone(), deltas: self.deltas.clone(), distribution })
    }

    /// Whether there are no lights of either kind.
    pub fn is_empty(&self) -> bool {
        self.areas.is_empty() && self.deltas.is_empty()
    }

    /// The indices of the triangles that emit, in ascending order, without degenerate triangles.
    pub fn triangles(&self) -> impl Iterator<Item = u32> {
        self.areas.iter().filter(|light| light.is_first_of_triangle()).map(|light| light.triangle)
    }

    /// The emitted powers of the triangles that emit, as luminance, in ascending order of their indices.
    pub(crate) fn area_powers(&self) -> impl Iterator<Item = f64> {
        let first = self.areas.iter().filter(|light| light.is_first_of_triangle());
        first.map(AreaLight::power_of_triangle)
    }

    /// The delta lights that are not black, in the order of the model.
    pub fn delta_lights(&self) -> impl Iterator<Item = &DeltaLight> {
        self.deltas.iter()
    }

    /// Chooses a light for the receiver by each of `us`, in `[0, 1)`; `None` if there are none.
    #[inline(always)]
    pub(crate) fn choose<const N: usize>(&self, receiver: Receiver, us: [f64; N]) -> [Option<Light<'_>>; N] {
        match &self.distribution {
            LightDistribution::Power(table) => us.map(|u| Some(self.light(table.sample(u)?, None))),
            LightDistribution::Tree(tree) => {
                tree.choose(receiver, us).map(|chosen| Some(self.chosen(chosen)))
            }
        }
    }

    /// The light that the [tree](Lights::tree) has chosen.
    #[inline(always)]
    pub(crate) fn chosen(&self, ChosenLight { index, prob }: ChosenLight) -> Light<'_> {
        self.light(index as usize, Some(prob))
    }

    /// The light of this index, with the probability of its choice; that by power if `prob` is `None`.
    #[inline(always)]
    fn light(&self, index: usize, prob: Option<f64>) -> Light<'_> {
        match self.areas.get(index) {
            Some(light) => Light::Area(light, prob.map_or(light.prob, |prob| light.chosen_with(prob))),
            None => Light::Delta(&self.deltas[index - self.areas.len()], prob.unwrap_or(1.0)),
        }
    }

    /// The light with this point of `triangles`, and the probability with which [`Lights::choose`] chooses it for the
    /// receiver, to the bit; `None` if the triangle is not a light.
    pub(crate) fn light_at(
        &self,
        point: &SurfacePoint,
        triangles: &Triangles,
        receiver: Receiver,
    ) -> Option<(&AreaLight, AreaProb)> {
        let first = self.areas.partition_point(|light| light.triangle < point.triangle);
        let light = self.areas.get(first).filter(|light| light.triangle == point.triangle)?;
        let number = light.part.number_at(triangles.get(point.triangle), point.position);
        let place = first + number as usize;
        let light = &self.areas[place];
        let prob = match &self.distribution {
            LightDistribution::Power(_) => light.prob,
            LightDistribution::Tree(tree) => light.chosen_with(tree.prob(receiver, place)),
        };
        Some((light, prob))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use globillum_geom::Triangle;
    use globillum_material::{Rgb, Sides};

    #[test]
    fn a_triangle_in_parts_has_its_own_power() {
        let [a, b, c, d] =
            [(0.0, 0.0), (9.0, 0.0), (9.0, 0.1), (0.0, 0.1)].map(|(x, z)| Vec3::new(x, 1.0, z));
        let square = Triangle::new(Vec3::ZERO, Vec3::X, Vec3::Z);
        let triangles = Triangles::new([&[square], &Triangle::quad(a, b, c, d)[..]].concat()).unwrap();
        let glow = Emission::new(Rgb::WHITE, Sides::Front).unwrap();
        let lights = Lights::of(&triangles, |_| glow, &[]);
        assert_eq!((lights.areas.len(), lights.len()), (1 + 31 + 31, 3));
        for (index, found) in lights.triangles().zip(lights.area_powers()) {
            let expected = power(triangles.get(index), &glow);
            assert!((found / expected - 1.0).abs() < 1e-12, "{index}: {found}, {expected}");
        }
    }
}
