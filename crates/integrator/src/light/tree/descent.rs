use super::node::{Child, Node};
use crate::light::child_weights::ChildWeights;

/// A choice on its way from the root to a light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Descent {
    pub(super) child: Child,
    /// The probability of having come here.
    pub(super) prob: f64,
    /// The number in `[0, 1)` that is left for the choices below.
    u: f64,
}

impl Descent {
    /// One that begins at the root with the probability `prob` and the number `u`.
    pub(super) const fn new(prob: f64, u: f64) -> Self {
        Self { child: Child::Node(0), prob, u }
    }

    /// One that has ended at the light `index`.
    pub(super) fn ended(index: u32, prob: f64) -> Self {
        Self { child: Child::Light(index), prob, u: 0.0 }
    }

    /// To a child of `node`.
    #[inline(always)]
    pub(super) fn step(self, node: &Node, weights: &ChildWeights) -> Self {
        let (child, u) = weights.choose(self.u);
        Self { child: node.child(child), prob: self.prob * weights.prob(child), u }
    }
}
