//! The mirror tree: a hierarchy of bounds of facets, in which one is chosen by what it may show to a point.

mod bounds;
mod build;
mod choice;
mod lanes;
mod node;
mod octree;
mod resampling;
mod triangle_node;

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
use triangle_node::TriangleFacet;
pub(super) use triangle_node::TriangleNode;

/// A tree over facets, bounded by spheres and cones of normals.
#[derive(Clone, Debug)]
pub(super) struct MirrorTree {
    /// Level by level, the root first.
    nodes: Vec<Node>,
    /// The number of levels.
    depth: u32,
    /// The index of the first node of the lowest level.
    first_lowest: u32,
    /// For each facet, the numbers of the children from the root to it, from the lowest bits up.
    paths: Vec<u32>,
    /// The bounds of closed bodies.
    bodies: Vec<Aabb>,
    /// Coordinates in the tree are distances from `origin` times `scale`, a power of two; those of the facets are within
    /// `[-1, 1]`. Single precision rounds them by up to `2^-24`, so of facets smaller than that, one that shows a light may
    /// have a probability of zero.
    origin: DVec3,
    scale: f64,
    /// All instruction sets give the same bits.
    simd: SimdLevel,
}

/// What the tree is told of a facet.
#[derive(Clone, Copy, Debug)]
pub(super) struct FacetBounds {
    pub(super) bounds: Aabb,
    pub(super) normal: DVec3,
    pub(super) area: f64,
    /// The place of the closed body; `None` if the facet is not part of one.
    pub(super) body: Option<u32>,
}

/// A node of the lowest level, and the query of its facets.
#[derive(Clone, Copy, Debug)]
pub(super) struct LowestNode<'a> {
    /// Its place among the lowest nodes.
    pub(super) number: u32,
    pub(super) node: &'a Node,
    pub(super) query: &'a Query,
}

/// The importance of the facets of a lowest node, by lane; 0 for those that show no light.
pub(super) trait FacetImportance: Fn(&LowestNode<'_>) -> [f64; WIDTH] {}

impl<F: Fn(&LowestNode<'_>) -> [f64; WIDTH]> FacetImportance for F {}

/// From where a facet is chosen, and to show what.
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
    /// A tree over one or more facets, and their order in the tree.
    pub(super) fn new(triangles: &Triangles, facets: &[FacetBounds], bodies: Vec<Aabb>) -> (Self, Vec<u32>) {
        let scene = triangles.bounds();
        let of_facets = facets.iter().fold(Aabb::EMPTY, |all, facet| all.union(&facet.bounds));
        let [(origin, scale), (middle, scale_of_scene)] = [of_facets, scene].map(|bounds| {
            let (size, center) = (0.5 * bounds.extent().max_element(), bounds.center());
            (center, units_per_length(size, center, &scene))
        });
        let item = |(facet, of): (u32, &FacetBounds)| Item {
            facet,
            center_in_frame: (of.bounds.center() - middle) * scale_of_scene,
            center: (of.bounds.center() - origin) * scale,
            radius: 0.5 * of.bounds.extent().length() * scale,
            normal: of.normal,
            area: of.area * scale * scale,
            body: bit_of(of.body),
        };
        let mut items: Vec<_> = (0..).zip(facets).map(item).collect();
        let Built { nodes, depth, first_lowest, paths } = build::build(&mut items);
        let order = items.iter().map(|item| item.facet).collect();
        (Self { nodes, depth, first_lowest, paths, bodies, origin, scale, simd: SimdLevel::best() }, order)
    }

    /// The lowest nodes of a tree over triangles, in their order. `triangle` returns the facet at a place with its vertices.
    pub(super) fn triangle_nodes(
        &self,
        triangle: impl Fn(u32) -> (FacetBounds, [DVec3; 3]),
    ) -> Vec<TriangleNode> {
        let facet = |place: u32| {
            let (FacetBounds { normal, body, .. }, vertices) = triangle(place);
            let [a, b, c] = vertices.map(|vertex| (vertex - self.origin) * self.scale);
            let is_front = (b - a).cross(c - a).dot(normal) > 0.0;
            let vertices = if is_front { [a, b, c] } else { [a, c, b] };
            TriangleFacet { vertices, body: bit_of(body) }
        };
        let lowest = &self.nodes[self.first_lowest as usize..];
        let ends = lowest[1..].iter().map(|node| node.first).chain([self.paths.len() as u32]);
        let facets =
            lowest.iter().zip(ends).map(|(node, end)| (node.first..end).map(facet).collect::<Vec<_>>());
        facets.map(|facets| TriangleNode::new(&facets)).collect()
    }

    /// Where choices begin; `None` if none is ever made.
    ///
    /// The probability of any choice is `attempts` times the importance of the tree, where that is less than 1.
    #[inline(always)]
    pub(super) fn root<F: FacetImportance>(
        &self,
        at: &Viewpoint,
        attempts: f64,
        of_facets: F,
    ) -> Option<Root<F>> {
        self.simd.run(
            #[inline(always)]
            || {
                let query = self.query(at);
                let weights = self.weights_of_children(&query, 0, 1, &of_facets)?;
                let attempt_prob = (weights.total() * attempts).min(1.0);
                Some(Root { query, weights, attempt_prob, of_facets })
            },
        )
    }

    /// The [`Choice::prob`] of the facet at `place`, to the bit; `None` if [`MirrorTree::choose`] never chooses it.
    #[inline(always)]
    pub(super) fn prob<F: FacetImportance>(&self, root: &Root<F>, place: u32) -> Option<f64> {
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
    fn weights<F: FacetImportance>(&self, root: &Root<F>, index: u32, level: u32) -> Option<ChildWeights> {
        if level == 1 {
            return Some(root.weights);
        }
        self.weights_of_children(&root.query, index, level, &root.of_facets)
    }

    /// The weights of the children of a node of this level; `None` if none has any.
    #[inline(always)]
    fn weights_of_children(
        &self,
        query: &Query,
        index: u32,
        level: u32,
        of_facets: &impl FacetImportance,
    ) -> Option<ChildWeights> {
        let node = &self.nodes[index as usize];
        let importance = if level < self.depth {
            node.importance(query)
        } else {
            of_facets(&LowestNode { number: index - self.first_lowest, node, query })
        };
        let weights = ChildWeights::of_importance(importance);
        (weights.total() > 0.0).then_some(weights)
    }

    /// The index of this child of a node, or the place of this facet of a lowest node.
    #[inline(always)]
    fn child(&self, node: u32, child: usize) -> u32 {
        self.nodes[node as usize].first + child as u32
    }

    /// The number of the lowest node that has the facet at `place`, and that of its child.
    #[inline(always)]
    fn lowest_node_of(&self, place: u32) -> (u32, usize) {
        let (mut index, mut path) = (0, self.paths[place as usize]);
        for _ in 1..self.depth {
            index = self.child(index, path as usize % WIDTH);
            path >>= CHILD_BITS;
        }
        (index - self.first_lowest, path as usize)
    }

    /// The place of this facet of a lowest node.
    #[inline(always)]
    fn place(&self, lowest_node: u32, child: usize) -> u32 {
        self.child(self.first_lowest + lowest_node, child)
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
            side: at.receiver.side,
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
    /// The probability that any facet is chosen.
    attempt_prob: f64,
    of_facets: F,
}
