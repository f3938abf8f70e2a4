use super::alias_table::{AliasTable, raised};
use super::delta::DeltaLight;
use super::receiver::Receiver;
use super::tree::{ChosenLight, LightMoments, LightTree, TreeLight, VisibilityCount};
use glam::DVec3;
use globillum_geom::{PdfArea, SphericalTriangle, Triangle, Triangles};
use globillum_material::Emission;

/// The lights of a scene, its triangles that emit and its delta lights.
///
/// A light is chosen at each receiver with a probability about proportional to the irradiance that it brings
/// there if it is visible, in a light tree (Conty Estevez and Kulla 2018). A light alone, and two triangles without
/// delta lights, such as a square, are chosen by power, which costs less. A light of less than a 64th of their mean power
/// then counts as if it had that much.
///
/// A render chooses lights less often that are rarely visible in its picture. The
/// [`Scene::light_sampler`](crate::Scene::light_sampler) does not.
///
/// Each light has a positive probability, a normal number, for any size and radiance. A
/// [`LightSampler`](crate::LightSampler) samples points on lights.
#[derive(Clone, Debug)]
pub struct Lights {
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

/// The probability of choosing a triangle that emits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AreaProb {
    pub(crate) prob: f64,
    /// The density of a point that is then sampled uniformly by area, the choice included.
    pub(crate) pdf: PdfArea,
}

/// A triangle that emits, with what is precomputed for all receivers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AreaLight {
    pub(crate) triangle: u32,
    pub(crate) emission: Emission,
    pub(crate) normal: DVec3,
    /// If lights are chosen by power.
    prob: AreaProb,
    area: f64,
    middle: DVec3,
    reach_sq: f64,
}

impl AreaLight {
    /// Of triangle `index`, chosen by `weight`, where `total` is that of all lights.
    fn new(index: u32, triangle: &Triangle, emission: Emission, weight: f64, total: f64) -> Self {
        let [a, b, c] = triangle.vertices.map(|v| v.as_dvec3());
        // 1 unless the light is dim.
        let raise = weight / power(triangle, &emission);
        Self {
            triangle: index,
            emission,
            normal: triangle.normal(),
            prob: AreaProb {
                prob: weight / total,
                // The area cancels.
                pdf: PdfArea(emission.exitance().luminance() * raise / total),
            },
            area: triangle.area(),
            middle: (a + b + c) / 3.0,
            reach_sq: SphericalTriangle::reach(triangle).powi(2),
        }
    }

    /// Whether [`SphericalTriangle::new`] may succeed from `point`.
    #[inline(always)]
    pub(crate) fn may_look_large(&self, point: DVec3) -> bool {
        self.middle.distance_squared(point) <= self.reach_sq
    }

    #[inline(always)]
    fn chosen_with(&self, prob: f64) -> AreaProb {
        AreaProb { prob, pdf: PdfArea(prob / self.area) }
    }

    fn moments(&self, triangle: &Triangle) -> LightMoments {
        let both_sides = !self.emission.toward(-1.0).is_black();
        let intensity = self.emission.toward(1.0).luminance() * self.area;
        LightMoments::of_triangle(triangle.vertices.map(|v| v.as_dvec3()), self.normal, both_sides, intensity)
    }
}

impl Lights {
    /// Up to this number of triangles, two of a square, a light tree costs more than it brings.
    const MOST_BY_POWER: usize = 2;

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
        let area = |(index, &weight): (u32, &f64)| {
            AreaLight::new(index, triangles.get(index), emission(index), weight, total)
        };
        let areas: Vec<_> = emitting.into_iter().zip(&weights).map(area).collect();
        let distribution = match (areas.len(), deltas.len()) {
            (0..=Self::MOST_BY_POWER, 0) => LightDistribution::Power(AliasTable::new(&weights)),
            (0, 1) => LightDistribution::Power(AliasTable::new(&[1.0])),
            _ => {
                let near =
                    areas.iter().map(|light| TreeLight::Near(light.moments(triangles.get(light.triangle))));
                let lights: Vec<_> = near.chain(deltas.iter().map(DeltaLight::tree_light)).collect();
                LightDistribution::Tree(LightTree::new(&lights, &triangles.bounds()))
            }
        };
        Self { areas, deltas, distribution }
    }

    /// The number of lights of both kinds, without degenerate triangles and black delta lights.
    pub fn len(&self) -> usize {
        self.areas.len() + self.deltas.len()
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
        self.len() == 0
    }

    /// The indices of the triangles that emit, in ascending order, without degenerate triangles.
    pub fn triangles(&self) -> impl Iterator<Item = u32> {
        self.areas.iter().map(|light| light.triangle)
    }

    /// The emitted powers of the triangles that emit, as luminance, in ascending order of their indices.
    pub(crate) fn area_powers(&self) -> impl Iterator<Item = f64> {
        self.areas.iter().map(|light| light.area * light.emission.exitance().luminance())
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

    /// The probability with which [`Lights::choose`] chooses triangle `index` for the receiver, to
    /// the bit; `None` if it is not a light.
    pub(crate) fn prob(&self, receiver: Receiver, index: u32) -> Option<AreaProb> {
        let place = self.areas.binary_search_by_key(&index, |light| light.triangle).ok()?;
        let light = &self.areas[place];
        Some(match &self.distribution {
            LightDistribution::Power(_) => light.prob,
            LightDistribution::Tree(tree) => light.chosen_with(tree.prob(receiver, place)),
        })
    }
}

/// The emitted power, as luminance.
fn power(triangle: &Triangle, emission: &Emission) -> f64 {
    triangle.area() * emission.exitance().luminance()
}
