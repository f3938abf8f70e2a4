use super::Node;
use super::plane::Plane;

/// A part of a tree under construction, whose nodes and references are counted from its own start.
#[derive(Debug, Default)]
pub(super) struct Branch {
    /// Depth first: an inner node's lower child follows it.
    pub(super) nodes: Vec<Node>,
    pub(super) references: Vec<u32>,
}

impl Branch {
    /// How many nodes and references there are.
    pub(super) fn len(&self) -> (usize, usize) {
        (self.nodes.len(), self.references.len())
    }

    pub(super) fn add_leaf(&mut self, triangles: impl Iterator<Item = u32>) {
        let first = self.references.len();
        self.references.extend(triangles);
        self.references[first..].sort_unstable();
        let count = self.references.len() - first;
        self.nodes.push(Node::Leaf { first: first as u32, count: count as u32 });
    }

    /// Adds an inner node; its upper child is known only after all nodes below the lower one.
    pub(super) fn add_split(&mut self, plane: &Plane) {
        self.nodes.push(Node::Split { axis: plane.axis as u8, position: plane.position, upper: 0 });
    }

    /// Makes the node that is added next the upper child of node `parent`.
    pub(super) fn point_to_upper(&mut self, parent: usize) {
        let next = self.nodes.len() as u32;
        if let Node::Split { upper, .. } = &mut self.nodes[parent] {
            *upper = next;
        }
    }

    /// Adds all of `other`.
    pub(super) fn append(&mut self, other: &Self) {
        let (nodes, references) = (self.nodes.len() as u32, self.references.len() as u32);
        self.nodes.extend(other.nodes.iter().map(|&node| match node {
            Node::Split { axis, position, upper } => Node::Split { axis, position, upper: upper + nodes },
            Node::Leaf { first, count } => Node::Leaf { first: first + references, count },
        }));
        self.references.extend_from_slice(&other.references);
    }

    /// Makes one leaf of all that was added since [`Branch::len`] was `start`.
    pub(super) fn collapse(&mut self, start: (usize, usize)) {
        self.nodes.truncate(start.0);
        let mut listed = self.references.split_off(start.1);
        listed.sort_unstable();
        listed.dedup();
        self.add_leaf(listed.into_iter());
    }
}
