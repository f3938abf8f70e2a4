use super::member::Member;
use super::plane::Plane;
use super::tree::Node;

/// A subtree under construction, with indices relative to its own start.
#[derive(Debug, Default)]
pub(super) struct Branch {
    /// In depth-first order: an inner node's lower child follows it.
    pub(super) nodes: Vec<Node>,
    /// The members of all leaves, by ascending triangle index within each leaf.
    pub(super) members: Vec<Member>,
}

impl Branch {
    /// The number of nodes and of members.
    pub(super) fn len(&self) -> (usize, usize) {
        (self.nodes.len(), self.members.len())
    }

    /// Appends a leaf with these members.
    pub(super) fn add_leaf(&mut self, mut members: Vec<Member>) {
        members.sort_unstable_by_key(|m| m.index);
        let (first, count) = (self.members.len() as u32, members.len() as u32);
        self.members.append(&mut members);
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

    /// Appends all nodes and members of `other`.
    pub(super) fn append(&mut self, other: &Self) {
        let (nodes, members) = (self.nodes.len() as u32, self.members.len() as u32);
        self.nodes.extend(other.nodes.iter().map(|&node| match node {
            Node::Split { axis, position, upper } => Node::Split { axis, position, upper: upper + nodes },
            Node::Leaf { first, count } => Node::Leaf { first: first + members, count },
        }));
        self.members.extend_from_slice(&other.members);
    }

    /// Replaces all nodes since [`Branch::len`] was `start` by one leaf.
    pub(super) fn collapse(&mut self, start: (usize, usize)) {
        self.nodes.truncate(start.0);
        let mut members = self.members.split_off(start.1);
        members.sort_unstable_by_key(|m| m.index);
        members.dedup_by(|part, all| {
            let is_same = part.index == all.index;
            if is_same {
                all.bounds = all.bounds.union(&part.bounds);
            }
            is_same
        });
        self.add_leaf(members);
    }
}
