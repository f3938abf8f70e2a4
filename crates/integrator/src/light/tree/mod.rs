//! The light tree: a hierarchy of clusters of lights, in which one is chosen by what it may bring to a point
//! (Conty Estevez and Kulla 2018).

mod build;
mod child_weights;
mod cluster;
mod descent;
mod far_lights;
mod frame;
mod node;

pub(super) use cluster::Cluster;
pub(super) use far_lights::FarLight;

use super::receiver::Receiver;
use child_weights::{LANE_BITS, WIDTH};
use descent::Descent;
use far_lights::FarLights;
use frame::TreeFrame;
use glam::Vec3;
use globillum_geom::SimdLevel;
use node::{Child, Node};

/// A tree over lights, each of which is chosen with a probability above zero at every point.
///
/// The probability is about proportional to the irradiance from the light at the receiver, if the light is visible. It
/// does not depend on the unit of length.
#[derive(Clone, Debug)]
pub(super) struct LightTree {
    /// The first is the root; none if all lights are infinitely far away.
    nodes: Vec<Node>,
    frame: TreeFrame,
    far: Option<FarLights>,
    places: Vec<Place>,
    /// All levels give the same bits.
    level: SimdLevel,
}

/// A light that a tree has chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ChosenLight {
    pub(in crate::light) index: u32,
    /// The probability of the choice.
    pub(in crate::light) prob: f64,
}

/// What the tree knows of a light.
#[derive(Clone, Copy, Debug)]
pub(in crate::light) enum Reach {
    /// Bounds of a light at a finite distance.
    Near(Cluster),
    /// A light infinitely far away.
    Far(FarLight),
}

/// Where the tree has a light.
#[derive(Clone, Copy, Debug)]
enum Place {
    /// The lanes from the root to the light, from the lowest bits up.
    Path(u64),
    /// The probability among all lights that are infinitely far away.
    Far(f64),
}

impl LightTree {
    /// The least probability of all lights at finite or at infinite distance, where there are both.
    const LEAST_PROB: f64 = 1.0 / 1024.0;

    /// A tree over `lights`, of which each has an intensity or irradiance above zero.
    pub(super) fn new(lights: &[Reach]) -> Self {
        let mut near = Vec::new();
        let mut far = Vec::new();
        for (index, light) in (0..).zip(lights) {
            match *light {
                Reach::Near(cluster) => near.push((index, cluster)),
                Reach::Far(light) => far.push((index, light)),
            }
        }
        let mut places = vec![Place::Path(0); lights.len()];
        let total: f64 = far.iter().map(|(_, light)| light.irradiance).sum();
        for (index, light) in &far {
            places[*index as usize] = Place::Far(light.irradiance / total);
        }
        let frame = TreeFrame::around(near.iter().map(|&(_, cluster)| cluster));
        let nodes = build::nodes(&mut near, &frame, |index, path| places[index as usize] = Place::Path(path));
        Self { nodes, frame, far: FarLights::new(&far), places, level: SimdLevel::best() }
    }

    /// Chooses a light for the receiver by each of `us`, in `[0, 1)`.
    #[inline(never)] // compiled once for all accelerators
    pub(super) fn choose<const N: usize>(&self, receiver: Receiver, us: [f64; N]) -> [ChosenLight; N] {
        self.level.run(
            #[inline(always)]
            || {
                let receiver = self.frame.receiver(receiver);
                self.descend([receiver; N], self.begin(receiver, us))
            },
        )
    }

    /// Chooses a light for each of the receivers by the number of the same index, as [`LightTree::choose`] does.
    #[inline(never)]
    pub(super) fn choose_each<const N: usize>(
        &self,
        receivers: [Receiver; N],
        us: [f64; N],
    ) -> [ChosenLight; N] {
        self.level.run(
            #[inline(always)]
            || {
                let (mut receivers, mut descents) = (receivers, [Descent::new(1.0, 0.0); N]);
                for k in 0..N {
                    receivers[k] = self.frame.receiver(receivers[k]);
                    [descents[k]] = self.begin(receivers[k], [us[k]]);
                }
                self.descend(receivers, descents)
            },
        )
    }

    /// The choices at the root for the receiver, in the tree's frame, by each of `us`.
    #[inline(always)]
    fn begin<const N: usize>(&self, receiver: Receiver, us: [f64; N]) -> [Descent; N] {
        let Some(root) = self.nodes.first() else { return us.map(|u| self.choose_far(u, 1.0)) };
        let weights = root.weights(&receiver);
        let far_prob = self.far_prob(weights.total(), receiver.side);
        us.map(
            #[inline(always)]
            |u| match u < far_prob {
                true => self.choose_far(u / far_prob, far_prob),
                false => {
                    let rest = ((u - far_prob) / (1.0 - far_prob)).min(1.0_f64.next_down());
                    Descent::new(1.0 - far_prob, rest).step(root, &weights)
                }
            },
        )
    }

    /// The ends of `descents`, each for one of the receivers. They do not depend on each other, so a processor works
    /// on several at once.
    #[inline(always)]
    fn descend<const N: usize>(
        &self,
        receivers: [Receiver; N],
        mut descents: [Descent; N],
    ) -> [ChosenLight; N] {
        loop {
            let mut have_ended = true;
            for (descent, receiver) in descents.iter_mut().zip(&receivers) {
                if let Child::Node(index) = descent.child {
                    let node = &self.nodes[index as usize];
                    *descent = descent.step(node, &node.weights(receiver));
                    have_ended = false;
                }
            }
            if have_ended {
                return descents.map(|Descent { child, prob, .. }| match child {
                    Child::Light(index) | Child::Node(index) => ChosenLight { index, prob },
                });
            }
        }
    }

    /// The probability with which [`LightTree::choose`] chooses the light `index`, to the bit.
    #[inline(never)]
    pub(super) fn prob(&self, receiver: Receiver, index: usize) -> f64 {
        self.level.run(
            #[inline(always)]
            || self.prob_at_level(self.frame.receiver(receiver), index),
        )
    }

    #[inline(always)]
    fn prob_at_level(&self, receiver: Receiver, index: usize) -> f64 {
        let Some(mut node) = self.nodes.first() else { return self.far_share(index, 1.0) };
        let mut weights = node.weights(&receiver);
        let far_prob = self.far_prob(weights.total(), receiver.side);
        let Place::Path(mut path) = self.places[index] else { return self.far_share(index, far_prob) };
        let mut prob = 1.0 - far_prob;
        loop {
            let lane = path as usize % WIDTH;
            prob *= weights.prob(lane);
            let Child::Node(index) = node.child(lane) else { return prob };
            node = &self.nodes[index as usize];
            path >>= LANE_BITS;
            weights = node.weights(&receiver);
        }
    }

    /// The probability of the lights that are infinitely far away, beside the weight of all others.
    #[inline(always)]
    fn far_prob(&self, near: f64, side: Vec3) -> f64 {
        let Some(far) = &self.far else { return 0.0 };
        let far = far.irradiance_on(side);
        let share = far / (far + near);
        share.clamp(Self::LEAST_PROB, 1.0 - Self::LEAST_PROB)
    }

    fn choose_far(&self, u: f64, far_prob: f64) -> Descent {
        // Without far lights their probability is 0, and this is not called.
        let far = self.far.as_ref().expect("only called if there are far lights");
        let index = far.choose(u.min(1.0_f64.next_down()));
        Descent::ended(index, self.far_share(index as usize, far_prob))
    }

    fn far_share(&self, index: usize, far_prob: f64) -> f64 {
        match self.places[index] {
            Place::Far(share) => share * far_prob,
            Place::Path(_) => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Stream;
    use glam::DVec3;
    use std::f64::consts::{FRAC_PI_3, PI};

    /// Uniform in `[-1, 1]^3`.
    fn vector(numbers: Stream, dimension: u32) -> DVec3 {
        DVec3::from_array([0, 1, 2].map(|k| 2.0 * numbers.uniform(dimension + k) - 1.0))
    }

    /// `n` lights of all kinds, of intensities over twelve orders of magnitude, every seventh infinitely far
    /// away; positions times `unit`.
    fn lights(n: u32, unit: f64) -> Vec<Reach> {
        let light = |i: u32| {
            let numbers = Stream::new(7, n.into(), i);
            let intensity = 10.0_f64.powf(12.0 * numbers.uniform(0) - 6.0);
            let (at, axis) = (unit * vector(numbers, 1), vector(numbers, 4).normalize());
            let beside = |dimension| at + 0.05 * unit * vector(numbers, dimension);
            match i % 7 {
                0..=3 => {
                    let vertices = [at, beside(7), beside(10)];
                    Reach::Near(Cluster::of_triangle(vertices, axis, i.is_multiple_of(2), intensity))
                }
                4 => Reach::Near(Cluster::of_point(at, intensity)),
                5 => Reach::Near(Cluster::of_spot(at, axis, FRAC_PI_3, intensity)),
                _ => Reach::Far(FarLight { irradiance: intensity, direction: axis }),
            }
        };
        (0..n).map(light).collect()
    }

    /// At the lights, between them, and far away, on surfaces of all directions.
    fn receivers() -> impl Iterator<Item = Receiver> {
        let side = |i| vector(Stream::new(12, 0, i), 0).normalize().as_vec3();
        (0..).zip(places()).map(move |(i, position)| Receiver { position, side: side(i) })
    }

    fn places() -> impl Iterator<Item = DVec3> {
        (0..6).map(|i| vector(Stream::new(8, 0, i), 0) * [1.0, 0.1, 3.0][i as usize % 3]).chain([
            DVec3::ZERO,
            DVec3::splat(1e9),
            Cluster::centre(&near(&lights(40, 1.0)[4])),
        ])
    }

    fn near(reach: &Reach) -> Cluster {
        match reach {
            Reach::Near(cluster) => *cluster,
            Reach::Far(light) => panic!("{light:?}"),
        }
    }

    #[test]
    fn each_light_has_a_chance_and_all_together_certainty() {
        for n in [1, 2, 7, 8, 9, 40, 1000] {
            let tree = LightTree::new(&lights(n, 1.0));
            for receiver in receivers() {
                let probs = (0..n as usize).map(|index| tree.prob(receiver, index));
                let (sum, least) =
                    probs.fold((0.0, 1.0_f64), |(sum, least), prob| (sum + prob, prob.min(least)));
                assert!((sum - 1.0).abs() < 1e-12, "{n} lights from {receiver:?}: {sum}");
                assert!(least > 1e-30, "{n} lights from {receiver:?}: {least}");
            }
        }
    }

    /// Each light has an interval of `u`, or one in each of two columns of the table for the lights infinitely
    /// far away: of evenly spaced numbers it gets its share, to within one for each end.
    #[test]
    fn lights_are_chosen_with_their_probability() {
        for n in [1, 5, 40, 300] {
            let tree = LightTree::new(&lights(n, 1.0));
            for receiver in receivers() {
                let (draws, mut counts) = (10_000, vec![0.0; n as usize]);
                for i in 0..draws {
                    let [chosen] = tree.choose(receiver, [(f64::from(i) + 0.5) / f64::from(draws)]);
                    let (index, prob) = (chosen.index as usize, chosen.prob);
                    assert_eq!(
                        prob.to_bits(),
                        tree.prob(receiver, index).to_bits(),
                        "light {index} from {receiver:?}"
                    );
                    counts[index] += 1.0;
                }
                for (index, count) in counts.iter().enumerate() {
                    let expected = f64::from(draws) * tree.prob(receiver, index);
                    let ends = if matches!(tree.places[index], Place::Path(_)) { 1.001 } else { n as f64 };
                    assert!(
                        f64::abs(count - expected) <= ends,
                        "light {index} of {n} from {receiver:?}: {count}, {expected}"
                    );
                }
            }
        }
    }

    /// What lights infinitely far away leave of the largest number below 1 must not round to 1. Each light has a
    /// probability above 1e-8.
    #[test]
    fn the_largest_number_chooses_the_last_light() {
        let tree = LightTree::new(&lights(40, 1.0));
        for i in 0..200 {
            let numbers = Stream::new(11, 0, i);
            let receiver =
                Receiver { position: vector(numbers, 0), side: vector(numbers, 3).as_vec3().normalize() };
            let [last, before] = tree.choose(receiver, [1.0_f64.next_down(), 1.0 - 1e-12]);
            assert_eq!(last, before, "{i}");
        }
    }

    #[test]
    fn several_choices_at_once_are_those_one_by_one() {
        let tree = LightTree::new(&lights(300, 1.0));
        let receivers: Vec<_> = receivers().collect();
        for i in 0..1000 {
            let numbers = Stream::new(10, 0, i);
            let us = [0, 1, 2, 3].map(|k| numbers.uniform(k));
            let four =
                [4, 5, 6, 7].map(|k| receivers[(numbers.uniform(k) * receivers.len() as f64) as usize]);
            let alone = |receiver: Receiver, u: f64| tree.choose(receiver, [u])[0];
            assert_eq!(tree.choose_each(four, us), std::array::from_fn(|k| alone(four[k], us[k])), "{i}");
            assert_eq!(tree.choose(four[0], us), us.map(|u| alone(four[0], u)), "{i}");
        }
    }

    #[test]
    fn the_unit_of_length_does_not_matter() {
        for unit in [2.0_f64.powi(-40), 2.0_f64.powi(60)] {
            // Irradiances from infinity have a unit of their own.
            let lights = |unit| {
                let near = lights(100, unit).into_iter().filter(|light| matches!(light, Reach::Near(_)));
                LightTree::new(&near.collect::<Vec<_>>())
            };
            let (tree, scaled) = (lights(1.0), lights(unit));
            for receiver in receivers() {
                for i in 0..100 {
                    let u = f64::from(i) / 100.0;
                    assert_eq!(
                        tree.choose(receiver, [u]),
                        scaled.choose(Receiver { position: unit * receiver.position, ..receiver }, [u]),
                        "{unit} {receiver:?} {u}"
                    );
                }
            }
        }
    }

    /// Two equal lights at distances 1 and 10, one that turns its back, and one behind the surface.
    #[test]
    fn near_lights_in_front_that_face_the_receiver_are_preferred() {
        let light = |x: f64, axis| {
            let vertices = [DVec3::Y, DVec3::Z, DVec3::NEG_ONE].map(|v| DVec3::new(x, 0.0, 0.0) + 1e-3 * v);
            Reach::Near(Cluster::of_triangle(vertices, axis, false, 1.0))
        };
        let [toward, away] = [DVec3::NEG_X, DVec3::X];
        let tree =
            LightTree::new(&[light(1.0, toward), light(10.0, toward), light(0.5, away), light(-0.5, away)]);
        let receiver = Receiver { position: DVec3::ZERO, side: Vec3::X };
        let [near, distant, averted, behind] = [0, 1, 2, 3].map(|index| tree.prob(receiver, index));
        assert!((0.985..0.995).contains(&near) && (0.009..0.011).contains(&distant), "{near} {distant}");
        assert!([averted, behind].iter().all(|prob| (0.0002..0.0003).contains(prob)), "{averted} {behind}");
    }

    /// The cosines that a node assumes for a cluster are not below those of any of its lights, so that no light that
    /// shines on a receiver seems not to.
    #[test]
    fn bounds_contain_what_they_bound() {
        let lights: Vec<Cluster> =
            lights(400, 1.0).iter().filter(|light| matches!(light, Reach::Near(_))).map(near).collect();
        let node = |mut cluster: Cluster| {
            cluster.intensity = 1.0;
            Node::new(&[(Child::Light(0), cluster)], &TreeFrame::around(std::iter::empty()))
        };
        let mut shining = 0;
        for group in lights.chunks(4) {
            let union = group.iter().copied().reduce(|a, b| a.union(&b)).unwrap();
            let union_node = node(union);
            for i in 0..100 {
                let numbers = Stream::new(9, 0, i);
                let (position, side) = (2.0 * vector(numbers, 0), vector(numbers, 3).normalize());
                let assumed = union_node.importance(&Receiver { position, side: side.as_vec3() })[0]
                    * position.distance_squared(union.centre()).max(union.radius().powi(2));
                for &light in group {
                    let direction = (position - light.centre()).normalize();
                    let cos = light.axis.dot(direction);
                    let cos = if light.both_sides { cos.abs() } else { cos };
                    // A point light shines the same in all directions.
                    let cos = if light.tilt == PI { 1.0 } else { cos };
                    let cos_in = -side.dot(direction);
                    if cos > 1e-6 + libm::cos(light.spread) && cos_in > 0.0 {
                        shining += 1;
                        assert!(assumed >= cos * cos_in - 1e-5, "{assumed} {cos} {cos_in}");
                    }
                }
            }
        }
        assert!(shining > 10_000, "{shining}");
    }
}
