//! How often samples find lights visible, and a tree that chooses hidden lights less often.

use super::node::{Child, Node};
use super::{Address, LightTree};
use crate::light::child_weights::{CHILD_BITS, WIDTH};
use std::ops::AddAssign;

/// How often lights were sampled at vertices of paths, and how often they were visible from there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct VisibilityCount {
    sampled: u32,
    visible: u32,
}

impl VisibilityCount {
    /// Fewer samples tell too little.
    const MIN_SAMPLES: u32 = 256;

    /// This much of a sample counts as visible beside those that are: a light that no sample finds may be visible from
    /// elsewhere.
    const PRIOR: f64 = 0.25;

    #[cfg(test)]
    pub(crate) fn new(sampled: u32, visible: u32) -> Self {
        Self { sampled, visible }
    }

    /// Counts one sample.
    pub(crate) fn add(&mut self, is_visible: bool) {
        self.sampled += 1;
        self.visible += u32::from(is_visible);
    }

    /// The share of visible samples; `None` if there are too few.
    fn share(self) -> Option<f64> {
        let share = (f64::from(self.visible) + Self::PRIOR) / (f64::from(self.sampled) + Self::PRIOR);
        (self.sampled >= Self::MIN_SAMPLES).then_some(share)
    }
}

/// Importances are multiplied by at most this, or by 1: shares of visible samples are known roughly.
const MAX_FACTOR: f64 = 0.25;

/// The largest share of visible samples of some clusters. One of which samples tell too little counts as visible everywhere,
/// since a hidden one may have taken its samples.
fn largest_share<'a>(counts: impl IntoIterator<Item = &'a VisibilityCount>) -> f64 {
    counts.into_iter().map(|count| count.share().unwrap_or(1.0)).fold(0.0, f64::max)
}

/// By what the importance of a cluster is multiplied, beside clusters of up to the `largest` share.
///
/// It is the root of the ratio of shares. If a light that brings `f` where it is visible is chosen with probability `p`, the
/// mean square over all vertices is `share f^2 / p`. The sum for all lights is least where `p` is proportional to `f` times
/// the root of the share.
fn factor(count: VisibilityCount, largest: f64) -> f64 {
    let root = count.share().map_or(1.0, |share| (share / largest).sqrt());
    if root <= MAX_FACTOR { root } else { 1.0 }
}

impl AddAssign for VisibilityCount {
    fn add_assign(&mut self, Self { sampled, visible }: Self) {
        self.sampled += sampled;
        self.visible += visible;
    }
}

impl LightTree {
    /// The same tree with lights chosen by their visibility too, if these are the counts of each; `None` if that changes
    /// nothing. The counts of all lights of a cluster tell how often it is visible.
    pub(in crate::light) fn by_visibility(&self, counts: &[VisibilityCount]) -> Option<Self> {
        let mut of_children = vec![[VisibilityCount::default(); WIDTH]; self.nodes.len()];
        let mut of_far = VisibilityCount::default();
        for (address, &count) in self.addresses.iter().zip(counts) {
            match *address {
                _ if count.sampled == 0 => {}
                Address::Far(_) => of_far += count,
                Address::Path(path) => {
                    self.for_each_ancestor(path, |node, child| of_children[node][child] += count)
                }
            }
        }
        // Lights that are infinitely far away stand beside the children of the root.
        let beside = |index: usize| if index == 0 { self.far.as_ref().map(|_| &of_far) } else { None };
        let of_node = |(index, (node, counts)): (usize, (&Node, &[VisibilityCount; WIDTH]))| {
            let largest = largest_share(counts[..node.count()].iter().chain(beside(index)));
            counts.map(|count| factor(count, largest))
        };
        let factors: Vec<_> = self.nodes.iter().zip(&of_children).enumerate().map(of_node).collect();
        let root = self.nodes.first().zip(of_children.first());
        let far_factor = root.map_or(1.0, |(node, counts)| {
            factor(of_far, largest_share(counts[..node.count()].iter().chain(beside(0))))
        });
        if far_factor == 1.0 && factors.as_flattened().iter().all(|&factor| factor == 1.0) {
            return None;
        }
        let mut this = self.clone();
        for (node, factors) in this.nodes.iter_mut().zip(factors) {
            (0..).zip(factors).for_each(|(child, factor)| node.scale(child, factor));
        }
        if let Some(far) = &mut this.far {
            far.scale(far_factor);
        }
        Some(this)
    }

    /// Calls `visit` with each node on the path to a light, and the number of the child that the path goes on to.
    fn for_each_ancestor(&self, mut path: u64, mut visit: impl FnMut(usize, usize)) {
        let mut at = Child::Node(0);
        while let Child::Node(node) = at {
            let child = path as usize % WIDTH;
            visit(node as usize, child);
            at = self.nodes[node as usize].child(child);
            path >>= CHILD_BITS;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lights_that_are_rarely_visible_have_small_factors() {
        let factor_of = |sampled, visible| factor(VisibilityCount { sampled, visible }, 0.8);
        for (sampled, visible) in [(0, 0), (255, 0), (256, 20), (1000, 60), (1000, 1000)] {
            assert_eq!(factor_of(sampled, visible), 1.0, "{visible} of {sampled}");
        }
        assert!((factor_of(10_000, 80) - 0.1).abs() < 1e-3);
        assert!((factor_of(31_250, 0) - 0.003_162).abs() < 1e-5);
        assert!(factor_of(u32::MAX, 0) > 0.0);
    }
}
