use super::resampling::{Resampled, resample};
use super::{Leaf, MirrorImportance, MirrorTree, Root};
use crate::light::child_weights::ChildWeights;
use crate::light::descent::Descent;

/// A mirror that was chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Choice {
    /// Its place in the tree.
    pub(crate) place: u32,
    /// The probability of the choice if there were one candidate, above zero.
    pub(crate) prob: f64,
    /// What the mirror shows counts this many times `1 / prob`: in the mean, once.
    pub(crate) weight: f64,
}

impl MirrorTree {
    /// Chooses a mirror for each of `roots`, by the number of the same index in `[0, 1)`; `None` if none is chosen.
    ///
    /// A descent leads to `CANDIDATES` leaves of one parent, of which one is chosen by its mirrors ([`resample`]). The
    /// descents take turns: they do not depend on each other, so a processor works on all of them.
    #[inline(always)]
    pub(crate) fn choose<F: MirrorImportance, const N: usize, const CANDIDATES: usize>(
        &self,
        roots: &[Option<Root<F>>; N],
        us: [f64; N],
    ) -> [Option<Choice>; N] {
        self.simd.run(
            #[inline(always)]
            || {
                let mut descents = [None; N];
                for (descent, (root, u)) in descents.iter_mut().zip(roots.iter().zip(us)) {
                    *descent = root.as_ref().and_then(
                        #[inline(always)]
                        |root| root.begin(u),
                    );
                }
                for level in 1..self.depth.saturating_sub(1) {
                    for (descent, root) in descents.iter_mut().zip(roots) {
                        let (Some(here), Some(root)) = (*descent, root) else { continue };
                        *descent = self.step(here, root, level);
                    }
                }
                let mut choices = [None; N];
                for (choice, (descent, root)) in choices.iter_mut().zip(descents.iter().zip(roots)) {
                    let (Some(here), Some(root)) = (*descent, root) else { continue };
                    *choice = self.end::<F, CANDIDATES>(here, root);
                }
                // A probability may be too small for a number.
                choices.map(|choice| choice.filter(|choice| choice.prob > 0.0))
            },
        )
    }

    /// To a child of an inner node of this level; `None` if none has a weight.
    #[inline(always)]
    fn step<F: MirrorImportance>(
        &self,
        here: Descent<u32>,
        root: &Root<F>,
        level: u32,
    ) -> Option<Descent<u32>> {
        let weights = self.weights(root, here.at, level)?;
        Some(here.step(&weights, |child| self.child(here.at, child)))
    }

    /// The choice of a mirror at the end of a descent to the level above the leaves, or to the root if that is a leaf.
    #[inline(always)]
    fn end<F: MirrorImportance, const CANDIDATES: usize>(
        &self,
        here: Descent<u32>,
        root: &Root<F>,
    ) -> Option<Choice> {
        if self.depth == 1 {
            let Descent { at: place, prob, .. } =
                here.step(&root.weights, |mirror| self.child(here.at, mirror));
            return Some(Choice { place, prob, weight: 1.0 });
        }
        let weights = self.weights(root, here.at, self.depth - 1)?;
        self.choose_mirror::<F, CANDIDATES>(here, &weights, root)
    }

    /// The choice of a mirror below a node whose children are leaves of these weights.
    #[inline(always)]
    fn choose_mirror<F: MirrorImportance, const CANDIDATES: usize>(
        &self,
        here: Descent<u32>,
        weights: &ChildWeights,
        root: &Root<F>,
    ) -> Option<Choice> {
        let (candidates, u) = weights.choose_systematically::<CANDIDATES>(here.u);
        let Resampled { candidate, child, child_prob, weight } = resample(
            candidates,
            #[inline(always)]
            |child| weights.prob(child),
            #[inline(always)]
            |child| {
                let index = self.child(here.at, child);
                let (number, node) = (index - self.first_leaf, &self.nodes[index as usize]);
                (root.of_mirrors)(&Leaf { number, node, query: &root.query })
            },
            u,
        )?;
        let place = self.child(self.child(here.at, candidate), child);
        Some(Choice { place, prob: here.prob * weights.prob(candidate) * child_prob, weight })
    }
}

impl<F> Root<F> {
    /// A descent at the root; `None` if none is made.
    #[inline(always)]
    fn begin(&self, u: f64) -> Option<Descent<u32>> {
        let prob = self.attempt_prob;
        (u < prob).then(|| Descent { at: 0, prob, u: (u / prob).min(1.0_f64.next_down()) })
    }
}
