use crate::light::child_weights::{ChildWeights, WIDTH, lane_of};

/// A mirror of one of several leaves, the candidates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Resampled {
    pub(super) candidate: usize,
    /// The number of the mirror among the children of the leaf.
    pub(super) child: usize,
    /// The probability of the mirror among those of its leaf.
    pub(super) child_prob: f64,
    /// What the mirror shows counts this many times `1 / prob`, where `prob` is the probability of the mirror if there were one
    /// candidate: in the mean, once.
    pub(super) weight: f64,
}

/// Chooses a mirror of one of the `candidates` by `u` in `[0, 1)`; `None` if none of their mirrors shows a light. Equal candidates
/// that follow each other are tested once.
///
/// Bounds tell little of how much the mirrors of a leaf show, which is often nothing. So several leaves are chosen by
/// their bounds, with probabilities `prob`, and one of those by the importance of its mirrors (resampled importance sampling;
/// Talbot, Cline and Egbert 2005).
#[inline(always)]
pub(super) fn resample<const CANDIDATES: usize>(
    candidates: [usize; CANDIDATES],
    prob: impl Fn(usize) -> f64,
    mut importance: impl FnMut(usize) -> [f64; WIDTH],
    u: f64,
) -> Option<Resampled> {
    let mut mirrors = [ChildWeights::of_importance([0.0; WIDTH]); CANDIDATES];
    // What the mirrors of a candidate show, over the probability of the candidate.
    let mut ratios = [0.0; WIDTH];
    for (k, &candidate) in candidates.iter().enumerate() {
        if k > 0 && candidate == candidates[k - 1] {
            (mirrors[k], ratios[lane_of(k)]) = (mirrors[k - 1], ratios[lane_of(k - 1)]);
            continue;
        }
        mirrors[k] = ChildWeights::of_importance(importance(candidate));
        ratios[lane_of(k)] = mirrors[k].total() / prob(candidate);
    }
    let ratios = ChildWeights::of_importance(ratios);
    if ratios.total() <= 0.0 {
        return None;
    }
    let (k, u) = ratios.choose(u);
    let (child, _) = mirrors[k].choose(u);
    let weight = 1.0 / (CANDIDATES as f64 * ratios.prob(k));
    Some(Resampled { candidate: candidates[k], child, child_prob: mirrors[k].prob(child), weight })
}
