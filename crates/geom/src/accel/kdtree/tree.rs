use crate::accel::by_query::accel_by_query;
use crate::{Accel, Traverse, Triangles};
use std::fmt;

/// A k-d tree, built by one of the [`SplitRule`](crate::SplitRule)s.
///
/// Both children reference a triangle that straddles their split plane. Cells do not overlap, so traversal
/// visits them front to back.
#[derive(Clone)]
pub struct KdTree {
    pub(super) triangles: Triangles,
    /// In depth-first order: an inner node's lower child follows it.
    pub(crate) nodes: Vec<Node>,
    /// The triangle indices of all leaves, ascending within each leaf.
    pub(crate) references: Vec<u32>,
}

/// A node; its cell is the part of the bounds on its side of all planes above.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Node {
    /// An inner node, split at `axis = position`; `upper` is the index of its upper child.
    Split { axis: u8, position: f32, upper: u32 },
    /// A leaf with the triangles `references[first..][..count]`.
    Leaf { first: u32, count: u32 },
}

impl KdTree {
    /// The depth limit: the largest number of planes above a leaf, whatever the options.
    pub const MAX_DEPTH: u32 = 60;

    /// All split planes as axis (0 to 2) and world-space position, in depth-first order.
    pub fn planes(&self) -> impl Iterator<Item = (usize, f32)> + '_ {
        self.nodes.iter().filter_map(|node| match *node {
            Node::Split { axis, position, .. } => Some((usize::from(axis), position)),
            Node::Leaf { .. } => None,
        })
    }
}

impl Accel for KdTree {
    accel_by_query!();

    fn bytes(&self) -> usize {
        self.triangles.bytes() + size_of_val(&*self.nodes) + size_of_val(&*self.references)
    }
}

/// Counts, not the nodes.
impl fmt::Debug for KdTree {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("KdTree")
            .field("triangles", &self.triangles.len())
            .field("nodes", &self.nodes.len())
            .field("references", &self.references.len())
            .field("bytes", &self.bytes())
            .finish_non_exhaustive()
    }
}
