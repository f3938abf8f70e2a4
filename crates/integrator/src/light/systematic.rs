/// What a number chooses from a list of weights.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chosen {
    pub(super) index: usize,
    /// How far the number is above the start of its interval and below the end, in units of weight.
    pub(super) from_start: f64,
    pub(super) to_end: f64,
}

/// What the numbers `(u + k) / N` choose from a list of weights, for `k` from 0 to `N - 1`, and the number in `[0, 1)` that is
/// left: it is uniform for those choices. `choose` takes numbers in `[0, 1)`, and each of its choices has the probabilities of a
/// single one.
#[inline(always)]
pub(super) fn choose_systematically<const N: usize>(
    u: f64,
    choose: impl Fn(f64) -> Chosen,
) -> ([usize; N], f64) {
    let (mut indices, mut from_start, mut to_end) = ([0; N], f64::INFINITY, f64::INFINITY);
    for (k, index) in indices.iter_mut().enumerate() {
        let chosen = choose(((u + k as f64) / N as f64).min(1.0_f64.next_down()));
        *index = chosen.index;
        (from_start, to_end) = (from_start.min(chosen.from_start), to_end.min(chosen.to_end));
    }
    (indices, (from_start / (from_start + to_end)).clamp(0.0, 1.0_f64.next_down()))
}
