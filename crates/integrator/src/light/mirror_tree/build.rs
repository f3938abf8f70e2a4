use super::bounds::{Bounds, Item};
use super::node::{LANE_BITS, Node, WIDTH};
use glam::DVec3;

/// The nodes of a tree, and where its items are.
pub(super) struct Built {
    /// Level by level, the root first.
    pub(super) nodes: Vec<Node>,
    /// The number of levels.
    pub(super) depth: u32,
    /// For each item, the lanes from the root to it, from the lowest bits up.
    pub(super) paths: Vec<u32>,
}

/// In the choice of the axis of a split, a difference of normals of 1 counts as much as a quarter of the largest
/// coordinate.
const POSITION_WEIGHT: f64 = 4.0;

/// Items that share a node.
struct Group<'a> {
    items: &'a mut [Item],
    path: u32,
}

/// Builds a tree over `items`, all of which have the same depth. Brings them into the order of the lowest nodes'
/// children.
pub(super) fn build(items: &mut [Item]) -> Built {
    let (mut capacity, mut depth) = (WIDTH, 1);
    while capacity < items.len() {
        (capacity, depth) = (capacity * WIDTH, depth + 1);
    }
    let mut nodes = Vec::new();
    let mut groups = vec![Group { items, path: 0 }];
    for level in 0..depth {
        capacity /= WIDTH;
        // Items are counted from 0.
        let first = if level + 1 < depth { nodes.len() + groups.len() } else { 0 };
        let mut children = Vec::new();
        for Group { items, path } in groups {
            let before = children.len();
            let mut parts = Vec::new();
            let count = items.len().div_ceil(capacity);
            split(items, count, &mut parts);
            let bounds: Vec<_> = parts.iter().map(|part| Bounds::around(part)).collect();
            nodes.push(Node::new(&bounds, (first + before) as u32));
            let path_to = |lane: u32| path | lane << (LANE_BITS * level);
            children.extend((0..).zip(parts).map(|(lane, items)| Group { items, path: path_to(lane) }));
        }
        groups = children;
    }
    Built { nodes, depth, paths: groups.iter().map(|group| group.path).collect() }
}

/// Splits `items` into `count` groups of about equal size.
fn split<'a>(items: &'a mut [Item], count: usize, groups: &mut Vec<&'a mut [Item]>) {
    if count == 1 {
        groups.push(items);
        return;
    }
    let before = count / 2;
    let middle = (items.len() * before).div_ceil(count);
    sort_around(items, middle);
    let (a, b) = items.split_at_mut(middle);
    split(a, before, groups);
    split(b, count - before, groups);
}

/// Sorts `items` into those before and after `middle`, along the axis of positions or of normals on which they extend
/// farthest.
fn sort_around(items: &mut [Item], middle: usize) {
    let places = |item: &Item| [POSITION_WEIGHT * item.centre, item.normal];
    let extent = |kind: usize| {
        let places = || items.iter().map(|item| places(item)[kind]);
        places().fold(DVec3::NEG_INFINITY, DVec3::max) - places().fold(DVec3::INFINITY, DVec3::min)
    };
    let extents = [extent(0), extent(1)];
    let kind = usize::from(extents[1].max_element() > extents[0].max_element());
    let axis = extents[kind].max_position();
    let key = |item: &Item| places(item)[kind][axis];
    items.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)).then(a.facet.cmp(&b.facet)));
}
