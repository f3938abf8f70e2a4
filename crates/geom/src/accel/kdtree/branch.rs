use super::plane::Plane;
use super::tree::Node;
use crate::accel::prim_ref::PrimRef;

/// A subtree under construction, with indices relative to its own start.
#[derive(Debug, Default)]
pub(super) struct Branch {
    /// In depth-first order: an inner node's lower child follows it.
    pub(super) nodes: Vec<Node>,
    /// The references of all leaves, by ascending triangle index within each leaf.
    pub(super) refs: Vec<PrimRef>,
}

impl Branch {
    /// The number of nodes and of references.
    pub(super) fn len(&self) -> (usize, usize) {
        (self.nodes.len(), self.refs.len())
    }

    /// Appends a leaf with these references.
    pub(super) fn add_leaf(&mut self, mut refs: Vec<PrimRef>) {
        refs.sort_unstable_by_key(|reference| reference.index);
        let (first, count) = (self.refs.len() as u32, refs.len() as u32);
        self.refs.append(&mut refs);
        self.nodes.push(Node::Leaf { first, count });
    }

    /// Appends an inner node. [`Branch::point_to_upper`] sets its upper child, after the nodes of the lower
    /// one.
    pub(super) fn add_split(&mut self, plane: &Plane) {
        self.nodes.push(Node::Split { axis: plane.axis as u8, position: plane.position, upper: 0 });
    }

    /// Makes the next node that is appended the upper child of node `parent`.
    pub(super) fn point_to_upper(&mut self, parent: usize) {
        let next = self.nodes.len() as u32;
        if let Node::Split { upper, .. } = &mut self.nodes[parent] {
            *upper = next;
        }
    }

    /// Appends all nodes and references of `other`.
    pub(super) fn append(&mut self, other: &Self) {
        let (nodes, refs) = (self.nodes.len() as u32, self.refs.len() as u32);
        self.nodes.extend(other.nodes.iter().map(|&node| match node {
            Node::Split { axis, position, upper } => Node::Split { axis, position, upper: upper + nodes },
            Node::Leaf { first, count } => Node::Leaf { first: first + refs, count },
        }));
        self.refs.extend_from_slice(&other.refs);
    }

    /// Replaces all nodes since [`Branch::len`] was `start` by one leaf.
    pub(super) fn collapse(&mut self, start: (usize, usize)) {
        self.nodes.truncate(start.0);
        let mut refs = self.refs.split_off(start.1);
        refs.sort_unstable_by_key(|reference| reference.index);
        refs.dedup_by(|part, all| {
            let is_same = part.index == all.index;
            if is_same {
                all.bounds = all.bounds.union(&part.bounds);
            }
            is_same
        });
        self.add_leaf(refs);
    }
}
