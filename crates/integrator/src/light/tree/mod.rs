//! The light tree: a hierarchy of clusters of lights, in which one is chosen by what it may bring to a point (Conty Estevez
//! and Kulla 2018). A cluster is described by moments, which say what it brings on average, instead of bounds.

mod build;
mod far_lights;
mod frame;
mod light_moments;
mod node;
#[cfg(test)]
mod tests;
mod visibility;

pub(super) use far_lights::FarLight;
pub(super) use light_moments::LightMoments;
pub(crate) use visibility::VisibilityCount;

use super::child_weights::{CHILD_BITS, WIDTH};
use super::descent::Descent;
use super::receiver::Receiver;
use far_lights::FarLights;
use frame::TreeFrame;
use glam::Vec3;
use globillum_geom::{Aabb, SimdLevel};
use node::{Child, Node};

/// A tree over lights, each of which is chosen with a probability above zero at every point.
///
/// The probability is about proportional to the irradiance from the light at the receiver, if the light is visible. It
/// does not depend on the unit of length.
#[derive(Clone, Debug)]
pub(crate) struct LightTree {
    /// The first is the root; none if all lights are infinitely far away.
    nodes: Vec<Node>,
    frame: TreeFrame,
    far: Option<FarLights>,
    addresses: Vec<Address>,
    /// All instruction sets give the same bits.
    simd: SimdLevel,
}

/// A light that a tree has chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ChosenLight {
    pub(crate) index: u32,
    /// The probability of the choice.
    pub(in crate::light) prob: f64,
}

/// What the tree knows of a light.
#[derive(Clone, Copy, Debug)]
pub(in crate::light) enum TreeLight {
    /// The moments of a light at a finite distance.
    Near(LightMoments),
    /// A light infinitely far away.
    Far(FarLight),
}

/// How the tree finds a light.
#[derive(Clone, Copy, Debug)]
enum Address {
    /// The numbers of the children from the root to the light, from the lowest bits up.
    Path(u64),
    /// The probability among all lights that are infinitely far away.
    Far(f64),
}

impl LightTree {
    /// The least probability of all lights at finite or at infinite distance, where there are both.
    const MIN_PROB: f64 = 1.0 / 65_536.0;

    /// A tree over `lights`, of which each has an intensity or irradiance above zero, in a scene with these bounds.
    pub(super) fn new(lights: &[TreeLight], scene: &Aabb) -> Self {
        let mut near = Vec::new();
        let mut far = Vec::new();
        for (index, light) in (0..).zip(lights) {
            match *light {
                TreeLight::Near(moments) => near.push((index, moments)),
                TreeLight::Far(light) => far.push((index, light)),
            }
        }
        let mut addresses = vec![Address::Path(0); lights.len()];
        let far = FarLights::new(&far);
        for (index, prob) in far.iter().flat_map(FarLights::probs) {
            addresses[index as usize] = Address::Far(prob);
        }
        let frame = TreeFrame::around(near.iter().map(|&(_, moments)| moments), scene);
        let nodes =
            build::nodes(&mut near, &frame, |index, path| addresses[index as usize] = Address::Path(path));
        Self { nodes, frame, far, addresses, simd: SimdLevel::best() }
    }

    /// The number of lights.
    pub(crate) fn len(&self) -> usize {
        self.addresses.len()
    }

    /// Chooses a light for the receiver by each of `us`, in `[0, 1)`.
    #[inline(never)] // compiled once for all accelerators
    pub(crate) fn choose<const N: usize>(&self, receiver: Receiver, us: [f64; N]) -> [ChosenLight; N] {
        self.simd.run(
            #[inline(always)]
            || {
                let receiver = self.frame.receiver(receiver);
                self.descend([receiver; N], self.begin(receiver, us))
            },
        )
    }

    /// Chooses a light for each of the receivers by the number of the same index, as [`LightTree::choose`] does.
    #[inline(never)]
    pub(crate) fn choose_each<const N: usize>(
        &self,
        receivers: [Receiver; N],
        us: [f64; N],
    ) -> [ChosenLight; N] {
        self.simd.run(
            #[inline(always)]
            || {
                let (mut receivers, mut descents) =
                    (receivers, [Descent { at: Child::Node(0), prob: 1.0, u: 0.0 }; N]);
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
    fn begin<const N: usize>(&self, receiver: Receiver, us: [f64; N]) -> [Descent<Child>; N] {
        let Some(root) = self.nodes.first() else { return us.map(|u| self.choose_far(u, 1.0)) };
        let weights = root.weights(&receiver);
        let far_prob = self.far_prob(weights.total(), receiver.normal);
        us.map(
            #[inline(always)]
            |u| match u < far_prob {
                true => self.choose_far(u / far_prob, far_prob),
                false => {
                    let rest = ((u - far_prob) / (1.0 - far_prob)).min(1.0_f64.next_down());
                    let descent = Descent { at: (), prob: 1.0 - far_prob, u: rest };
                    descent.step(&weights, |number| root.child(number))
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
        mut descents: [Descent<Child>; N],
    ) -> [ChosenLight; N] {
        loop {
            let mut have_ended = true;
            for (descent, receiver) in descents.iter_mut().zip(&receivers) {
                if let Child::Node(index) = descent.at {
                    let node = &self.nodes[index as usize];
                    *descent = descent.step(&node.weights(receiver), |number| node.child(number));
                    have_ended = false;
                }
            }
            if have_ended {
                return descents.map(|Descent { at, prob, .. }| match at {
                    Child::Light(index) | Child::Node(index) => ChosenLight { index, prob },
                });
            }
        }
    }

    /// The probability with which [`LightTree::choose`] chooses the light `index`, to the bit.
    #[inline(never)]
    pub(super) fn prob(&self, receiver: Receiver, index: usize) -> f64 {
        self.simd.run(
            #[inline(always)]
            || self.prob_in_frame(self.frame.receiver(receiver), index),
        )
    }

    #[inline(always)]
    fn prob_in_frame(&self, receiver: Receiver, index: usize) -> f64 {
        let Some(mut node) = self.nodes.first() else { return self.far_share(index, 1.0) };
        let mut weights = node.weights(&receiver);
        let far_prob = self.far_prob(weights.total(), receiver.normal);
        let Address::Path(mut path) = self.addresses[index] else { return self.far_share(index, far_prob) };
        let mut prob = 1.0 - far_prob;
        loop {
            let child = path as usize % WIDTH;
            prob *= weights.prob(child);
            let Child::Node(index) = node.child(child) else { return prob };
            node = &self.nodes[index as usize];
            path >>= CHILD_BITS;
            weights = node.weights(&receiver);
        }
    }

    /// The probability of the lights that are infinitely far away, beside the weight of all others.
    #[inline(always)]
    fn far_prob(&self, near: f64, normal: Vec3) -> f64 {
        let Some(far) = &self.far else { return 0.0 };
        let far = far.irradiance_on(normal);
        let share = far / (far + near);
        share.clamp(Self::MIN_PROB, 1.0 - Self::MIN_PROB)
    }

    fn choose_far(&self, u: f64, far_prob: f64) -> Descent<Child> {
        // Without far lights their probability is 0, and this is not called.
        let far = self.far.as_ref().expect("only called if there are far lights");
        let index = far.choose(u.min(1.0_f64.next_down()));
        Descent { at: Child::Light(index), prob: self.far_share(index as usize, far_prob), u: 0.0 }
    }

    fn far_share(&self, index: usize, far_prob: f64) -> f64 {
        match self.addresses[index] {
            Address::Far(share) => share * far_prob,
            Address::Path(_) => 0.0,
        }
    }
}
