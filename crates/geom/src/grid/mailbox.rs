/// The triangles decided last, so that one which several cells along a ray list is not decided
/// again in each (Amanatides and Woo, 1987, section 3; in a table as of Benthin, 2006).
#[derive(Debug)]
pub(super) struct Mailbox([u32; SLOTS]);

/// A triangle's slot is its index modulo this; a newer one takes the older one's place.
const SLOTS: usize = 16;

impl Mailbox {
    pub(super) fn new() -> Self {
        // No triangle has this index.
        Self([u32::MAX; SLOTS])
    }

    /// Whether `triangle` is none of those remembered; remembers it.
    #[inline]
    pub(super) fn is_new(&mut self, triangle: u32) -> bool {
        let slot = &mut self.0[triangle as usize % SLOTS];
        std::mem::replace(slot, triangle) != triangle
    }
}
