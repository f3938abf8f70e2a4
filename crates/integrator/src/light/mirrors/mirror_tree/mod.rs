//! The mirror tree: a hierarchy of bounds of mirrors, in which one is chosen by what it may show to a point.

mod bounds;
mod build;
mod choice;
mod lanes;
mod node;
mod octree;
mod resampling;
mod triangle_leaf;

use super::light_bounds::LightBounds;
use crate::light::child_weights::{CHILD_BITS, ChildWeights, WIDTH};
use crate::light::receiver::Receiver;
use crate::light::unit_of_length::units_per_length;
use bounds::Item;
use build::Built;
pub(super) use choice::Choice;
use glam::DVec3;
use globillum_geom::{Aabb, SimdLevel, Triangles};
use node::{Node, Query};
pub(super) use octree::{CellView, KnownImportances, MirrorOctree};
pub(super) use triangle_leaf::TriangleLeaf;
use triangle_leaf::TriangleMirror;

/// A tree over mirrors, bounded by spheres and cones of normals.
#[derive(Clone, Debug)]
pub(super) struct MirrorTree {
    /// Level by level, the root first.
    nodes: Vec<Node>,
    /// The number of levels.
    depth: u32,
    /// The index of the first leaf. All leaves are nodes of the last level.
    first_leaf: u32,
    /// For each mirror, the numbers of the children from the root to it, from the lowest bits up.
    paths: Vec<u32>,
    /// The bounds of closed bodies.
    bodies: Vec<Aabb>,
    /// Coordinates in the tree are distances from `origin` times `scale`, a power of two; those of the mirrors are within
    /// `[-1, 1]`. Single precision rounds them by up to `2^-24`, so of mirrors smaller than that, one that shows a light may
    /// have a probability of zero.
    origin: DVec3,
    scale: f64,
    /// All instruction sets give the same bits.
    simd: SimdLevel,
}

/// What the tree is told of a mirror.
#[derive(Clone, Copy, Debug)]
pub(super) struct MirrorBounds {
    pub(super) bounds: Aabb,
    pub(super) normal: DVec3,
    pub(super) area: f64,
    /// The place of the closed body; `None` if the mirror is not part of one.
    pub(super) body: Option<u32>,
}

/// A leaf, and the query of its mirrors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leaf<'a> {
    /// Its place among the leaves.
    pub(super) number: u32,
    pub(super) node: &'a Node,
    pub(super) query: &'a Query,
}

/// The importance of the mirrors of a leaf, by lane; 0 for those that show no light.
pub(super) trait MirrorImportance: Fn(&Leaf<'_>) -> [f64; WIDTH] {}

impl<F: Fn(&Leaf<'_>) -> [f64; WIDTH]> MirrorImportance for F {}

/// From where a mirror is chosen, and to show what.
#[derive(Clone, Copy, Debug)]
pub(super) struct Viewpoint {
    pub(super) receiver: Receiver,
    pub(super) lights: LightBounds,
}

/// The bit of mirrors that are in no body.
const OPEN: u32 = 1 << 31;

/// The bit of the body at this place, or of none.
fn bit_of(body: Option<u32>) -> u32 {
    body.map_or(OPEN, |body| 1 << body)
}

impl MirrorTree {
    /// A tree over one or more mirrors, and their order in the tree.
    pub(super) fn new(
        triangles: &Triangles,
        mirrors: &[MirrorBounds],
        bodies: Vec<Aabb>,
    ) -> (Self, Vec<u32>) {
        let scene = triangles.bounds();
        let of_mirrors = mirrors.iter().fold(Aabb::EMPTY, |all, mirror| all.union(&mirror.bounds));
        let [(origin, scale), (middle, scale_of_scene)] = [of_mirrors, scene].map(|bounds| {
            let (size, center) = (0.5 * bounds.extent().max_element(), bounds.center());
            (center, units_per_length(size, center, &scene))
        });
        let item = |(mirror, of): (u32, &MirrorBounds)| Item {
            mirror,
            center_in_frame: (of.bounds.center() - middle) * scale_of_scene,
            center: (of.bounds.center() - origin) * scale,
            radius: 0.5 * of.bounds.extent().length() * scale,
            normal: of.normal,
            area: of.area * scale * scale,
            body: bit_of(of.body),
        };
        let mut items: Vec<_> = (0..).zip(mirrors).map(item).collect();
        let Built { nodes, depth, first_leaf, paths } = build::build(&mut items);
        let order = items.iter().map(|item| item.mirror).collect();
        (Self { nodes, depth, first_leaf, paths, bodies, origin, scale, simd: SimdLevel::best() }, order)
    }

    /// The leaves of a tree over triangles, in their order. `triangle` returns the mirror at a place with its vertices.
    pub(super) fn triangle_leaves(
        &self,
        triangle: impl Fn(u32) -> (MirrorBounds, [DVec3; 3]),
    ) -> Vec<TriangleLeaf> {
        let mirror = |place: u32| {
            let (MirrorBounds { normal, body, .. }, vertices) = triangle(place);
            let [a, b, c] = vertices.map(|vertex| (vertex - self.origin) * self.scale);
            let is_front = (b - a).cross(c - a).dot(normal) > 0.0;
            let vertices = if is_front { [a, b, c] } else { [a, c, b] };
            TriangleMirror { vertices, body: bit_of(body) }
        };
        let leaves = &self.nodes[self.first_leaf as usize..];
        let ends = leaves[1..].iter().map(|node| node.first).chain([self.paths.len() as u32]);
        let mirrors =
            leaves.iter().zip(ends).map(|(node, end)| (node.first..end).map(mirror).collect::<Vec<_>>());
        mirrors.map(|mirrors| TriangleLeaf::new(&mirrors)).collect()
    }

    /// Where choices begin; `None` if none is ever made.
    ///
    /// The probability of any choice is `attempts` times the importance of the tree, where that is less than 1.
    #[inline(always)]
    pub(super) fn root<F: MirrorImportance>(
        &self,
        at: &Viewpoint,
        attempts: f64,
        of_mirrors: F,
    ) -> Option<Root<F>> {
        self.simd.run(
            #[inline(always)]
            || {
                let query = self.query(at);
                let weights = self.weights_of_children(&query, 0, 1, &of_mirrors)?;
                let attempt_prob = (weights.total() * attempts).min(1.0);
                Some(Root { query, weights, attempt_prob, of_mirrors })
            },
        )
    }

    /// The [`Choice::prob`] of the mirror at `place`, to the bit; `None` if [`MirrorTree::choose`] never chooses it.
    #[inline(always)]
    pub(super) fn prob<F: MirrorImportance>(&self, root: &Root<F>, place: u32) -> Option<f64> {
        self.simd.run(
            #[inline(always)]
            || {
                let (mut index, mut path, mut prob) = (0, self.paths[place as usize], root.attempt_prob);
                for level in 1..=self.depth {
                    let weights = self.weights(root, index, level)?;
                    let child = path as usize % WIDTH;
                    path >>= CHILD_BITS;
                    prob *= weights.prob(child);
                    index = self.child(index, child);
                }
                (prob > 0.0).then_some(prob)
            },
        )
    }

    /// The weights of the children of a node of this level, as a root sees them; `None` if none has any.
    #[inline(always)]
    fn weights<F: MirrorImportance>(&self, root: &Root<F>, index: u32, level: u32) -> Option<ChildWeights> {
        if level == 1 {
            return Some(root.weights);
        }
        self.weights_of_children(&root.query, index, level, &root.of_mirrors)
    }

    /// The weights of the children of a node of this level; `None` if none has any.
    #[inline(always)]
    fn weights_of_children(
        &self,
        query: &Query,
        index: u32,
        level: u32,
        of_mirrors: &impl MirrorImportance,
    ) -> Option<ChildWeights> {
        let node = &self.nodes[index as usize];
        let importance = if level < self.depth {
            node.importance(query)
        } else {
            of_mirrors(&Leaf { number: index - self.first_leaf, node, query })
        };
        let weights = ChildWeights::of_importance(importance);
        (weights.total() > 0.0).then_some(weights)
    }

    /// The index of this child of a node, or the place of this mirror of a leaf.
    #[inline(always)]
    fn child(&self, node: u32, child: usize) -> u32 {
        self.nodes[node as usize].first + child as u32
    }

    /// The number of the leaf that has the mirror at `place`, and that of its child.
    #[inline(always)]
    fn leaf_of(&self, place: u32) -> (u32, usize) {
        let (mut index, mut path) = (0, self.paths[place as usize]);
        for _ in 1..self.depth {
            index = self.child(index, path as usize % WIDTH);
            path >>= CHILD_BITS;
        }
        (index - self.first_leaf, path as usize)
    }

    /// The place of this mirror of a leaf.
    #[inline(always)]
    fn place(&self, leaf: u32, child: usize) -> u32 {
        self.child(self.first_leaf + leaf, child)
    }

    /// The bits of the bodies that a point within `radius` of `position` may be within.
    fn bodies_within(&self, position: DVec3, radius: f64) -> u32 {
        let is_near = |Aabb { min, max }: &Aabb| {
            (position + radius).cmpge(min.as_dvec3()).all() && (position - radius).cmple(max.as_dvec3()).all()
        };
        (0..).zip(&self.bodies).fold(0, |all, (body, bounds)| all | u32::from(is_near(bounds)) << body)
    }

    /// Whether `from` is outside of this body.
    pub(super) fn is_outside(&self, body: u32, from: DVec3) -> bool {
        let Aabb { min, max } = self.bodies[body as usize];
        !(from.cmpge(min.as_dvec3()).all() && from.cmple(max.as_dvec3()).all())
    }

    #[inline(always)]
    fn query(&self, at: &Viewpoint) -> Query {
        let to_frame = |position: DVec3| ((position - self.origin) * self.scale).as_vec3();
        let within = |body: u32| u32::from(!self.is_outside(body, at.receiver.position)) << body;
        Query {
            from: to_frame(at.receiver.position),
            normal: at.receiver.normal,
            lights: to_frame(at.lights.center),
            lights_half_extents: (at.lights.half_extents * self.scale).as_vec3(),
            lights_radius: (at.lights.radius * self.scale) as f32,
            around: (0..self.bodies.len() as u32).fold(OPEN, |all, body| all | within(body)),
        }
    }
}

/// The root of a tree as it is seen from a receiver.
#[derive(Clone, Copy)]
pub(super) struct Root<F> {
    query: Query,
    weights: ChildWeights,
    /// The probability that any mirror is chosen.
    attempt_prob: f64,
    of_mirrors: F,
}
