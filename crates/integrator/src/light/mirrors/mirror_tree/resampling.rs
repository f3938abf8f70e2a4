use crate::light::child_weights::{ChildWeights, WIDTH, lane_of};

/// A facet of one of several lowest nodes, the candidates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Resampled {
    /// The candidate.
    pub(super) node: usize,
    pub(super) child: usize,
    /// The probability of the child among those of its node.
    pub(super) child_prob: f64,
    /// What the facet shows counts this many times `1 / prob`, where `prob` is the probability of the facet if there were one
    /// candidate: in the mean, once.
    pub(super) weight: f64,
}

/// Chooses a facet of one of the `candidates` by `u` in `[0, 1)`; `None` if none of their facets shows a light. Equal candidates
/// that follow each other are tested once.
///
/// Bounds tell little of how much the facets of a lowest node show, which is often nothing. So several nodes are chosen by
/// their bounds, with probabilities `prob`, and one of those by the importance of its facets (resampled importance sampling;
/// Talbot, Cline and Egbert 2005).
#[inline(always)]
pub(super) fn resample<const CANDIDATES: usize>(
    candidates: [usize; CANDIDATES],
    prob: impl Fn(usize) -> f64,
    mut importance: impl FnMut(usize) -> [f64; WIDTH],
    u: f64,
) -> Option<Resampled> {
    let mut facets = [ChildWeights::of_importance([0.0; WIDTH]); CANDIDATES];
    // What the facets of a candidate show, over the probability of the candidate.
    let mut ratios = [0.0; WIDTH];
    for (k, &node) in candidates.iter().enumerate() {
        if k > 0 && node == candidates[k - 1] {
            (facets[k], ratios[lane_of(k)]) = (facets[k - 1], ratios[lane_of(k - 1)]);
            continue;
        }
        facets[k] = ChildWeights::of_importance(importance(node));
        ratios[lane_of(k)] = facets[k].total() / prob(node);
    }
    let ratios = ChildWeights::of_importance(ratios);
    if ratios.total() <= 0.0 {
        return None;
    }
    let (k, u) = ratios.choose(u);
    let (child, _) = facets[k].choose(u);
    let weight = 1.0 / (CANDIDATES as f64 * ratios.prob(k));
    Some(Resampled { node: candidates[k], child, child_prob: facets[k].prob(child), weight })
}
