use crate::{Aabb, Accel, Hit, Ray, Traverse, Triangles};

/// A k-d tree, halved by one of several [`SplitRule`](crate::SplitRule)s.
///
/// A triangle that straddles a plane is listed on both sides, so the cells along a ray
/// never overlap and can be visited front to back.
#[derive(Clone, Debug)]
pub struct KdTree {
    pub(super) triangles: Triangles,
    /// Depth first: an inner node's lower child follows it.
    pub(crate) nodes: Vec<Node>,
    /// Triangle indices of all leaves, ascending within each.
    pub(crate) references: Vec<u32>,
}

/// One cell of the tree.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Node {
    /// Halved at `axis = position`; the upper half is node `upper`.
    Split { axis: u8, position: f32, upper: u32 },
    /// Not halved: lists `references[first..][..count]`.
    Leaf { first: u32, count: u32 },
}

impl KdTree {
    /// The deepest tree that is ever built, whatever the options ask for.
    pub const MAX_DEPTH: u32 = 60;

    /// Every splitting plane as axis (0 to 2) and position, in depth-first order.
    pub fn planes(&self) -> impl Iterator<Item = (usize, f32)> + '_ {
        self.nodes.iter().filter_map(|node| match *node {
            Node::Split { axis, position, .. } => Some((usize::from(axis), position)),
            Node::Leaf { .. } => None,
        })
    }
}

impl Accel for KdTree {
    fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.closest(ray, &mut ())
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.any(ray, &mut ())
    }

    fn bounds(&self) -> Aabb {
        self.triangles.bounds()
    }

    fn bytes(&self) -> usize {
        self.triangles.bytes() + size_of_val(&*self.nodes) + size_of_val(&*self.references)
    }
}
