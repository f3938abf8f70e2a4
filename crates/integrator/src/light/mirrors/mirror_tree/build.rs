use super::bounds::{Bounds, Item};
use super::node::Node;
use crate::light::child_weights::{CHILD_BITS, WIDTH};
use glam::DVec3;
use rayon::prelude::*;

/// The nodes of a tree, and where its items are.
pub(super) struct Built {
    /// Level by level, the root first.
    pub(super) nodes: Vec<Node>,
    /// The number of levels.
    pub(super) depth: u32,
    /// The index of the first leaf.
    pub(super) first_leaf: u32,
    /// For each item, the numbers of the children from the root to it, from the lowest bits up.
    pub(super) paths: Vec<u32>,
}

/// In the choice of the axis of a split, a difference of normals of 1 counts as much as an eighth of the largest
/// coordinate of the scene.
const POSITION_WEIGHT: f64 = 8.0;

/// Items that share a node.
struct Group<'a> {
    items: &'a mut [Item],
    path: u32,
}

impl<'a> Group<'a> {
    /// The node of this level, whose children have indices from `first` and at most `capacity` items, and their groups.
    fn node(self, capacity: usize, level: u32, first: u32) -> (Node, Vec<Group<'a>>) {
        let count = self.items.len().div_ceil(capacity);
        let parts = split(self.items, count);
        let bounds: Vec<_> = parts.par_iter().map(|part| Bounds::around(part)).collect();
        let path_to = |child: u32| self.path | child << (CHILD_BITS * level);
        let children = (0..).zip(parts).map(|(child, items)| Group { items, path: path_to(child) }).collect();
        (Node::new(&bounds, first), children)
    }
}

/// Builds a tree over `items`, all of which have the same depth. Brings them into the order of the leaves'
/// children.
pub(super) fn build(items: &mut [Item]) -> Built {
    let (mut capacity, mut depth) = (WIDTH, 1);
    while capacity < items.len() {
        (capacity, depth) = (capacity * WIDTH, depth + 1);
    }
    let (mut nodes, mut first_leaf) = (Vec::new(), 0);
    let mut groups = vec![Group { items, path: 0 }];
    for level in 0..depth {
        (capacity, first_leaf) = (capacity / WIDTH, nodes.len() as u32);
        // Items are counted from 0.
        let mut next = if level + 1 < depth { nodes.len() + groups.len() } else { 0 };
        let firsts = groups.iter().map(|group| {
            let count = group.items.len().div_ceil(capacity);
            next += count;
            (next - count) as u32
        });
        let firsts: Vec<_> = firsts.collect();
        let built =
            groups.into_par_iter().zip(firsts).map(|(group, first)| group.node(capacity, level, first));
        let (of_level, children): (Vec<_>, Vec<_>) = built.unzip();
        nodes.extend(of_level);
        groups = children.into_iter().flatten().collect();
    }
    Built { nodes, depth, first_leaf, paths: groups.iter().map(|group| group.path).collect() }
}

/// Splits `items` into `count` groups of about equal size, in each of which they keep their order.
fn split(items: &mut [Item], count: usize) -> Vec<&mut [Item]> {
    if count == 1 {
        return vec![items];
    }
    let before = count / 2;
    let middle = (items.len() * before).div_ceil(count);
    divide(items, middle);
    let (a, b) = items.split_at_mut(middle);
    let (mut a, b) = rayon::join(|| split(a, before), || split(b, count - before));
    a.extend(b);
    a
}

/// Brings the first `middle` of `items` to the front, along the axis of positions or of normals on which they extend
/// farthest.
///
/// Both parts keep the order of their items: what is summed up over one must not depend on how a library selects.
fn divide(items: &mut [Item], middle: usize) {
    let keys_of = |item: &Item| [POSITION_WEIGHT * item.center_in_frame, item.normal];
    let extent = |kind: usize| {
        let keys = || items.iter().map(|item| keys_of(item)[kind]);
        keys().fold(DVec3::NEG_INFINITY, DVec3::max) - keys().fold(DVec3::INFINITY, DVec3::min)
    };
    let extents = [extent(0), extent(1)];
    let kind = usize::from(extents[1].max_element() > extents[0].max_element());
    let axis = extents[kind].max_position();
    let key = |item: &Item| keys_of(item)[kind][axis];
    let compare = |a: &(f64, u32), b: &(f64, u32)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
    let mut keys: Vec<_> = items.iter().map(|item| (key(item), item.mirror)).collect();
    let (_, &mut first_after, _) = keys.select_nth_unstable_by(middle, compare);
    items.sort_by_key(|item| compare(&(key(item), item.mirror), &first_after).is_ge());
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Stream;

    /// The groups of a split are about as large as each other, and within each items are in the order that they had.
    #[test]
    fn a_split_keeps_the_order_within_its_groups() {
        let item = |mirror: u32| {
            let numbers = Stream::new(21, 0, mirror);
            let vector = |k: u32| DVec3::from_array([0, 1, 2].map(|axis| numbers.uniform(k + axis) - 0.5));
            let (center, normal) = (vector(0), vector(3).normalize());
            Item { mirror, center_in_frame: center, center, radius: 0.1, normal, area: 1.0, body: 1 }
        };
        for count in [2, 3, 16] {
            let mut items: Vec<_> = (0..1000).map(item).collect();
            let groups = split(&mut items, count);
            assert_eq!(groups.len(), count);
            for group in groups {
                assert!(group.len().abs_diff(1000 / count) <= 1, "{count}: {}", group.len());
                assert!(group.is_sorted_by_key(|item| item.mirror), "{count}");
            }
        }
    }
}
