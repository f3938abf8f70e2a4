use super::child_weights::ChildWeights;

/// A choice on its way from the root of a tree to a leaf.
#[derive(Clone, Copy, Debug)]
pub(super) struct Descent<T> {
    /// Where it is.
    pub(super) at: T,
    /// The probability of having come here.
    pub(super) prob: f64,
    /// The number in `[0, 1)` that is left for the choices below.
    pub(super) u: f64,
}

impl<T> Descent<T> {
    /// To one of the children with these weights, `child` by its number.
    #[inline(always)]
    pub(super) fn step<U>(self, weights: &ChildWeights, child: impl FnOnce(usize) -> U) -> Descent<U> {
        let (number, u) = weights.choose(self.u);
        Descent { at: child(number), prob: self.prob * weights.prob(number), u }
    }
}
