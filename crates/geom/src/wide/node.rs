//! The tree's nodes: three levels of planes in one cache line.

use super::simd::LANES;

/// Seven planes and the eight cells between them.
///
/// The planes are those of a complete binary tree in heap order: below plane `i` lie planes
/// `2 i + 1` and `2 i + 2`, and cell `c` takes the place of plane `7 + c`.
#[repr(C, align(64))]
#[derive(Clone, Debug)]
pub(super) struct Node {
    /// Positions, and in the last lane the axes, so that one load fetches both. NaN separates
    /// nothing: both sides are the whole cell.
    pub(super) planes: [f32; LANES],
    /// What is in each cell.
    pub(super) children: [u32; LANES],
}

/// The first place in heap order that is a cell and not a plane.
pub(super) const FIRST_CELL: usize = 7;

/// Makes the axes a normal number when read as `f32`: denormal operands are slow.
const NORMAL: u32 = 0x3f80_0000;

impl Node {
    /// A node that separates and holds nothing.
    pub(super) fn empty() -> Self {
        let mut planes = [f32::NAN; LANES];
        planes[7] = f32::from_bits(NORMAL);
        Self { planes, children: [Child::EMPTY; LANES] }
    }

    pub(super) fn set_plane(&mut self, index: usize, axis: u8, position: f32) {
        self.planes[index] = position;
        self.planes[7] = f32::from_bits(self.axes() | u32::from(axis) << (2 * index));
    }

    #[inline(always)]
    pub(super) fn axis(&self, plane: usize) -> usize {
        (self.axes() >> (2 * plane) & 3) as usize % 3
    }

    /// Two bits a plane, the first plane lowest.
    #[inline]
    pub(super) fn axes(&self) -> u32 {
        self.planes[7].to_bits()
    }
}

/// What is in a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Child {
    /// A node, by index.
    Node(u32),
    /// A block of `count` triangles, 1 to 8; see [`Blocks`](super::blocks::Blocks).
    Block { first: u32, count: u32 },
}

impl Child {
    /// Nothing.
    pub(super) const EMPTY: u32 = u32::MAX;
    pub(super) const ROOT: u32 = 0;
    /// Lies at the bottom of every stack.
    pub(super) const END: u32 = 1 << 30;
    const BLOCK: u32 = 1 << 31;
    const PLACE_BITS: u32 = 27;
    /// Where the node or block is, in its vector.
    pub(super) const PLACE: u32 = (1 << Self::PLACE_BITS) - 1;
    /// More triangle references than this can not be told apart.
    pub(super) const MAX_REFERENCES: usize = (1 << Self::PLACE_BITS) - LANES;

    pub(super) fn pack(self) -> u32 {
        match self {
            Self::Node(index) => index,
            Self::Block { first, count } => Self::BLOCK | (count - 1) << Self::PLACE_BITS | first,
        }
    }

    /// 1 for a block, 0 for a node.
    #[inline(always)]
    pub(super) fn is_block(packed: u32) -> u32 {
        packed >> 31
    }

    /// 1 for the end of a search, 0 for a node.
    #[inline(always)]
    pub(super) fn is_end(packed: u32) -> u32 {
        packed >> 30 & !(packed >> 31) & 1
    }

    /// The first reference of a block and their count.
    #[inline(always)]
    pub(super) fn block(packed: u32) -> (usize, usize) {
        ((packed & Self::PLACE) as usize, (packed >> Self::PLACE_BITS & 7) as usize + 1)
    }
}
