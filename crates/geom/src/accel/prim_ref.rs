use crate::{Aabb, Triangles};

/// A reference to a triangle, with the bounds of the triangle or of its part in a cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PrimRef {
    /// The triangle's index.
    pub(crate) index: u32,
    /// Conservative bounds, not empty.
    pub(crate) bounds: Aabb,
}

impl PrimRef {
    /// The whole triangle of this index.
    pub(crate) fn new(triangles: &Triangles, index: u32) -> Self {
        Self { index, bounds: triangles.get(index).bounds() }
    }
}
