//! How often samples find lights visible, and a tree that chooses hidden lights less often.

use super::node::Child;
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
    const FEWEST: u32 = 256;

    /// Counted as if it were visible, since a light that no sample finds may be visible from elsewhere.
    const UNSEEN: f64 = 0.25;

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
        let share = (f64::from(self.visible) + Self::UNSEEN) / (f64::from(self.sampled) + Self::UNSEEN);
        (self.sampled >= Self::FEWEST).then_some(share)
    }
}

/// Importances are multiplied by at most this, or by 1: shares of visible samples are known roughly.
const LARGEST_FACTOR: f64 = 0.25;

/// The share of visible samples of those of some clusters that are visible most often; 0 if none has enough samples.
fn largest_share(counts: &[VisibilityCount]) -> f64 {
    counts.iter().filter_map(|count| count.share()).fold(0.0, f64::max)
}

/// By what the importance of a cluster is multiplied, beside clusters of up to the `largest` share.
///
/// It is the root of the ratio of shares. If a light that brings `f` where it is visible is chosen with probability `p`, the
/// mean square over all vertices is `share f^2 / p`. The sum for all lights is least where `p` is proportional to `f` times
/// the root of the share.
fn factor(count: VisibilityCount, largest: f64) -> f64 {
    let root = count.share().map_or(1.0, |share| (share / largest).sqrt());
    if root <= LARGEST_FACTOR { root } else { 1.0 }
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
        let mut this = self.clone();
        let mut is_other = false;
        let mut factor_of = |count: VisibilityCount, largest: f64| {
            let factor = factor(count, largest);
            is_other |= factor < 1.0;
            factor
        };
        // Lights that are infinitely far away stand beside the children of the root.
        let far_share = of_far.share().unwrap_or(0.0);
        let of_root = of_children.first().map_or(0.0, |counts| largest_share(counts)).max(far_share);
        for (index, (node, counts)) in this.nodes.iter_mut().zip(&of_children).enumerate() {
            let largest = if index == 0 { of_root } else { largest_share(counts) };
            for (child, &count) in counts.iter().enumerate() {
                node.scale(child, factor_of(count, largest));
            }
        }
        if let Some(far) = &mut this.far {
            far.scale(factor_of(of_far, of_root));
        }
        is_other.then_some(this)
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
