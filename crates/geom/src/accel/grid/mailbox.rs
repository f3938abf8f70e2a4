use crate::Ray;

/// The triangles tested last: mailboxing avoids repeated tests of a triangle that several cells along a ray
/// reference (Amanatides and Woo, 1987, section 3), here with a hash table per ray (Benthin, 2006).
#[derive(Debug)]
pub(super) struct Mailbox([u32; SLOTS]);

/// The size of the table. A triangle's slot is its index modulo this; a newer entry replaces the older one.
const SLOTS: usize = 16;

impl Mailbox {
    pub(super) fn new() -> Self {
        Self([Ray::NO_TRIANGLE; SLOTS])
    }

    /// Whether `triangle` is not in the table; inserts it.
    #[inline]
    pub(super) fn is_new(&mut self, triangle: u32) -> bool {
        let slot = &mut self.0[triangle as usize % SLOTS];
        std::mem::replace(slot, triangle) != triangle
    }
}
