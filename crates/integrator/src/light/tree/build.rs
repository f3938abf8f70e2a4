use super::frame::TreeFrame;
use super::light_moments::LightMoments;
use super::node::{Child, Node};
use crate::light::child_weights::{CHILD_BITS, WIDTH};
use glam::DVec3;
use std::collections::VecDeque;

/// A light by its index.
pub(super) type IndexedLight = (u32, LightMoments);

/// From this level on clusters are halved by the number of their lights, so that a path fits 64 bits: there are
/// fewer lights than `16^8`.
const FIRST_HALVED_LEVEL: u32 = 8;

const _: () = assert!((FIRST_HALVED_LEVEL + u32::BITS / CHILD_BITS) * CHILD_BITS <= u64::BITS);

/// The number of intervals whose borders are tried as split planes.
const BINS: usize = 16;

/// The lights below a node that is not built yet.
struct Pending<'a> {
    lights: &'a mut [IndexedLight],
    level: u32,
    path: u64,
}

/// Builds the nodes of a tree over `lights` in this frame, the root first; none without lights. Calls `found` with each light
/// and the path to it.
pub(super) fn nodes(
    lights: &mut [IndexedLight],
    frame: &TreeFrame,
    mut found: impl FnMut(u32, u64),
) -> Vec<Node> {
    let mut nodes = Vec::new();
    if lights.is_empty() {
        return nodes;
    }
    let mut pending = VecDeque::from([Pending { lights, level: 0, path: 0 }]);
    // Breadth first: the index of a child is the number of nodes built and pending.
    while let Some(Pending { lights, level, path }) = pending.pop_front() {
        let first_child = nodes.len() + 1 + pending.len();
        let mut children = Vec::with_capacity(WIDTH);
        let mut inner = 0;
        for (child, Group { lights, moments }) in (0..).zip(groups(lights, level)) {
            let path = path | child << (CHILD_BITS * level);
            match lights {
                [(light, _)] => {
                    found(*light, path);
                    children.push((Child::Light(*light), moments));
                }
                lights => {
                    children.push((Child::Node((first_child + inner) as u32), moments));
                    pending.push_back(Pending { lights, level: level + 1, path });
                    inner += 1;
                }
            }
        }
        nodes.push(Node::new(&children, frame));
    }
    nodes
}

/// Lights that share a child, with their moments.
struct Group<'a> {
    lights: &'a mut [IndexedLight],
    moments: LightMoments,
}

/// Splits `lights` into at most `WIDTH` groups, each time the costliest one.
fn groups(lights: &mut [IndexedLight], level: u32) -> Vec<Group<'_>> {
    let by_cost = level < FIRST_HALVED_LEVEL;
    let cost = |group: &Group<'_>| match group.lights.len() {
        1 => f64::NEG_INFINITY,
        _ if by_cost => group.moments.cost(),
        count => count as f64,
    };
    let moments = union(lights);
    let mut groups = vec![Group { lights, moments }];
    while groups.len() < WIDTH {
        // It begins with one group, and a split adds one.
        let (index, costliest) =
            (0..).zip(groups.iter().map(cost)).max_by(|a, b| a.1.total_cmp(&b.1)).expect("there is a group");
        if costliest == f64::NEG_INFINITY {
            break;
        }
        let group = groups.swap_remove(index);
        let halves = if by_cost { best_split(group.lights) } else { halve(group.lights) };
        groups.extend(halves);
    }
    groups
}

fn halve(lights: &mut [IndexedLight]) -> [Group<'_>; 2] {
    let (left, right) = lights.split_at_mut(lights.len() / 2);
    [left, right].map(|lights| Group { moments: union(lights), lights })
}

/// Splits two or more lights into the two groups of least cost, along the axis on which they extend farthest.
fn best_split(lights: &mut [IndexedLight]) -> [Group<'_>; 2] {
    let centers = || lights.iter().map(|(_, moments)| moments.center);
    let min = centers().fold(DVec3::INFINITY, DVec3::min);
    let max = centers().fold(DVec3::NEG_INFINITY, DVec3::max);
    let axis = (max - min).max_position();
    let scale = BINS as f64 / (max[axis] - min[axis]);
    // The product is not a number where all centers coincide; the cast makes 0 of it.
    let bin =
        |(_, moments): &IndexedLight| (((moments.center[axis] - min[axis]) * scale) as usize).min(BINS - 1);
    let mut bins = [None::<LightMoments>; BINS];
    for light in &*lights {
        let moments = &mut bins[bin(light)];
        *moments = join(*moments, Some(light.1));
    }
    let Some(Split { border, moments: [left, right] }) = best_border(&bins) else { return halve(lights) };
    lights.sort_by_key(|light| bin(light) >= border);
    let middle = lights.partition_point(|light| bin(light) < border);
    let (before, after) = lights.split_at_mut(middle);
    [Group { lights: before, moments: left }, Group { lights: after, moments: right }]
}

/// A split before the bin `border`, with the moments of both sides.
struct Split {
    border: usize,
    moments: [LightMoments; 2],
}

/// The split that costs least; `None` if all lights are in one bin.
fn best_border(bins: &[Option<LightMoments>; BINS]) -> Option<Split> {
    let mut after = [None; BINS];
    let mut joined = None;
    for border in (1..BINS).rev() {
        joined = join(joined, bins[border]);
        after[border] = joined;
    }
    let mut before = None;
    let splits = (1..BINS).filter_map(|border| {
        before = join(before, bins[border - 1]);
        Some(Split { border, moments: [before?, after[border]?] })
    });
    let cost = |split: &Split| split.moments.iter().map(LightMoments::cost).sum::<f64>();
    splits.min_by(|a, b| cost(a).total_cmp(&cost(b)))
}

fn join(a: Option<LightMoments>, b: Option<LightMoments>) -> Option<LightMoments> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.union(&b)),
        (a, b) => a.or(b),
    }
}

/// The moments of one or more lights.
fn union(lights: &[IndexedLight]) -> LightMoments {
    let all = lights.iter().map(|(_, moments)| *moments);
    // No group is empty: a split leaves a light on each side.
    all.reduce(|a, b| a.union(&b)).expect("a group has a light")
}
