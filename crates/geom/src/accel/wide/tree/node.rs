//! A node: the bounds of up to eight children, what each child is, and the order in which to visit them.

use crate::accel::wide::simd::LANES;
use crate::{Aabb, GeomError};

/// Up to eight children, a lane each, in four cache lines. Children that no plane of a k-d tree
/// separates may overlap.
#[repr(C, align(64))]
#[derive(Clone, Debug)]
pub(crate) struct Node {
    /// The faces of the children's bounds: lower and upper along x, along y, along z. A lane without a
    /// child has its bounds inverted, so that no ray meets them.
    pub(crate) faces: [[f32; LANES]; 6],
    /// The children, [packed](Child::pack).
    pub(crate) children: [u32; LANES],
    /// For each octant that a direction may lie in, the lanes from near to far, three bits each.
    pub(crate) orders: [u32; 8],
}

impl Node {
    /// A node without children.
    pub(crate) fn empty() -> Self {
        let (lower, upper) = ([f32::INFINITY; LANES], [f32::NEG_INFINITY; LANES]);
        let faces = [lower, upper, lower, upper, lower, upper];
        Self { faces, children: [Child::ROOT; LANES], orders: [0; 8] }
    }

    /// Puts a child with the given bounds in a lane.
    pub(crate) fn set(&mut self, lane: usize, bounds: &Aabb, child: Child) {
        for axis in 0..3 {
            self.faces[2 * axis][lane] = bounds.min[axis];
            self.faces[2 * axis + 1][lane] = bounds.max[axis];
        }
        self.children[lane] = child.pack();
    }

    /// The faces through which rays toward `octant` enter the children's slabs along `axis`, and those
    /// through which they leave them.
    #[inline(always)]
    pub(crate) fn slabs(&self, axis: usize, octant: u8) -> [&[f32; LANES]; 2] {
        let down = usize::from(octant >> axis & 1);
        [&self.faces[2 * axis + down], &self.faces[2 * axis + 1 - down]]
    }
}

/// A child of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Child {
    /// A node, by index.
    Node(u32),
    /// A leaf block of `count` triangles, 1 to 8.
    Block { first: u32, count: u32 },
}

impl Child {
    pub(crate) const ROOT: u32 = 0;
    /// The child at the bottom of the stack of a ray that is traversed by itself. It ends the traversal.
    pub(crate) const END: u32 = 1 << 30;
    const BLOCK: u32 = 1 << 31;
    const PLACE_BITS: u32 = 27;
    /// The bits that say where the node or block is, in its vector.
    pub(crate) const PLACE: u32 = (1 << Self::PLACE_BITS) - 1;
    /// More triangle references than this cannot be addressed.
    const MAX_REFERENCES: usize = (1 << Self::PLACE_BITS) - LANES;

    /// Refuses more references than can be addressed.
    pub(crate) fn check_references(count: usize) -> Result<(), GeomError> {
        let (requested, budget) = (count as u64, Self::MAX_REFERENCES as u64);
        if requested > budget {
            return Err(GeomError::Budget { what: "wide BVH references", requested, budget });
        }
        Ok(())
    }

    /// The child in 32 bits.
    pub(crate) fn pack(self) -> u32 {
        match self {
            Self::Node(index) => index,
            Self::Block { first, count } => Self::BLOCK | (count - 1) << Self::PLACE_BITS | first,
        }
    }

    /// Whether it is a leaf block.
    #[inline(always)]
    pub(crate) fn is_block(packed: u32) -> bool {
        packed & Self::BLOCK != 0
    }

    /// Whether it ends the traversal.
    #[inline(always)]
    pub(crate) fn is_end(packed: u32) -> bool {
        packed == Self::END
    }

    /// The first reference of a block and their count.
    #[inline(always)]
    pub(crate) fn block(packed: u32) -> (usize, usize) {
        ((packed & Self::PLACE) as usize, (packed >> Self::PLACE_BITS & 7) as usize + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn references_must_fit() {
        let limit = Child::MAX_REFERENCES;
        assert_eq!(Child::check_references(limit), Ok(()));
        let error = GeomError::Budget {
            what: "wide BVH references",
            requested: limit as u64 + 1,
            budget: limit as u64,
        };
        assert_eq!(Child::check_references(limit + 1), Err(error));
        // The last blocks that there may be, and as many nodes.
        for count in 1..=LANES {
            let packed = Child::Block { first: (limit - count) as u32, count: count as u32 }.pack();
            assert!(Child::is_block(packed) && !Child::is_end(packed));
            assert_eq!(Child::block(packed), (limit - count, count));
        }
        let packed = Child::Node(limit as u32).pack();
        assert!(!Child::is_block(packed) && !Child::is_end(packed));
        assert_eq!((packed & Child::PLACE) as usize, limit);
    }
}
