//! Sets of rays in hand, and of lanes.

use super::scratch::WIDTH;

/// A set of rays in hand, a bit each. It is kept in a register: were it a list in memory, the place
/// of an entry would depend on a step's outcome, and later loads would wait to know it.
pub(super) type Slots = u64;

/// The members of a set of slots or lanes, ascending. An iterator and no closure: what is not inlined
/// is not compiled for the instruction set.
pub(super) struct Each(pub(super) Slots);

impl Iterator for Each {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        if self.0 == 0 {
            return None;
        }
        let slot = self.0.trailing_zeros() as usize % WIDTH;
        self.0 &= self.0 - 1;
        Some(slot)
    }
}
