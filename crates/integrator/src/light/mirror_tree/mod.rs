//! The mirror tree: a hierarchy of bounds of facets, in which one is chosen by what it may show to a point.

mod bounds;
mod build;
mod calibration;
mod node;

use super::light_bounds::LightBounds;
use super::receiver::Receiver;
use bounds::Item;
use build::Built;
use glam::DVec3;
use globillum_geom::{Aabb, SimdLevel, Triangles};
use node::{LANE_BITS, Lanes, Node, Query, WIDTH};

/// A tree over facets, bounded by spheres and cones of normals.
#[derive(Clone, Debug)]
pub(super) struct MirrorTree {
    /// Level by level, the root first.
    nodes: Vec<Node>,
    /// The number of levels.
    depth: u32,
    /// For each facet, the lanes from the root to it, from the lowest bits up.
    paths: Vec<u32>,
    /// The bounds of closed bodies.
    bodies: Vec<Aabb>,
    /// Coordinates in the tree are distances from `origin` times `scale`, a power of two; in the scene they are
    /// within `[-1, 1]`.
    origin: DVec3,
    scale: f64,
    /// All levels give the same bits.
    level: SimdLevel,
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

/// From where a facet is chosen, and to show what.
#[derive(Clone, Copy, Debug)]
pub(super) struct Viewpoint {
    pub(super) receiver: Receiver,
    pub(super) lights: LightBounds,
}

/// The bit of mirrors that are in no body.
const OPEN: u32 = 1 << 31;

impl MirrorTree {
    /// A tree over one or more facets, and their order in the tree.
    pub(super) fn new(triangles: &Triangles, facets: &[FacetBounds], bodies: Vec<Aabb>) -> (Self, Vec<u32>) {
        let Aabb { min, max } = triangles.bounds();
        let (min, max) = (min.as_dvec3(), max.as_dvec3());
        let origin = 0.5 * (min + max);
        let (_, exponent) = libm::frexp(0.5 * (max - min).max_element());
        let scale = libm::ldexp(1.0, -exponent);
        let item = |(facet, of): (u32, &FacetBounds)| {
            let (min, max) = (of.bounds.min.as_dvec3(), of.bounds.max.as_dvec3());
            Item {
                facet,
                centre: (0.5 * (min + max) - origin) * scale,
                radius: 0.5 * min.distance(max) * scale,
                normal: of.normal,
                area: of.area * scale * scale,
                body: of.body.map_or(OPEN, |body| 1 << body),
            }
        };
        let mut items: Vec<_> = (0..).zip(facets).map(item).collect();
        let Built { nodes, depth, paths } = build::build(&mut items);
        let order = items.iter().map(|item| item.facet).collect();
        (Self { nodes, depth, paths, bodies, origin, scale, level: SimdLevel::best() }, order)
    }

    /// Where choices among the facets for which `shows` holds begin; `None` if none is ever chosen.
    ///
    /// The probability of any choice is `attempts` times the solid angle, about, that shows lights, where that is less
    /// than 1.
    #[inline(always)]
    pub(super) fn root(&self, at: &Viewpoint, attempts: f64, shows: impl Fn(u32) -> bool) -> Option<Root> {
        self.level.run(
            #[inline(always)]
            || {
                let query = self.query(at);
                let weights = self.weights(&query, 0, 1, shows)?;
                let attempt_prob = (weights.total() * attempts).min(1.0);
                Some(Root { query, weights, attempt_prob })
            },
        )
    }

    /// Chooses one of the facets for which `shows` holds by `draw`, which returns the same number in `[0, 1)` each time:
    /// its place, and the probability of the choice, above zero. `None` if none is chosen.
    #[inline(always)]
    pub(super) fn choose(
        &self,
        root: &Root,
        draw: impl Fn() -> f64,
        shows: impl Fn(u32) -> bool,
    ) -> Option<(u32, f64)> {
        self.level.run(
            #[inline(always)]
            || self.descend(root, Guide::Number(None, draw), shows),
        )
    }

    /// The probability with which [`MirrorTree::choose`] chooses the facet at `place`, to the bit; `None` if it never
    /// does.
    #[inline(always)]
    pub(super) fn prob(&self, root: &Root, place: u32, shows: impl Fn(u32) -> bool) -> Option<f64> {
        let path: Guide<fn() -> f64> = Guide::Path(self.paths[place as usize]);
        let found = self.level.run(
            #[inline(always)]
            || self.descend(root, path, shows),
        );
        found.map(|(_, prob)| prob)
    }

    /// The facet to which `guide` leads.
    #[inline(always)]
    fn descend(
        &self,
        root: &Root,
        mut guide: Guide<impl Fn() -> f64>,
        shows: impl Fn(u32) -> bool,
    ) -> Option<(u32, f64)> {
        let Root { query, mut weights, attempt_prob: mut prob } = *root;
        if !guide.attempts(prob) {
            return None;
        }
        let mut index = 0;
        for level in 1..=self.depth {
            if level > 1 {
                weights = self.weights(&query, index, level, &shows)?;
            }
            let lane = guide.lane(&weights);
            prob *= f64::from(weights.of_lanes[lane]) / weights.total();
            index = self.nodes[index as usize].first + lane as u32;
        }
        (prob > 0.0).then_some((index, prob))
    }

    /// The weights of the children of a node of this level; `None` if none has any.
    #[inline(always)]
    fn weights(&self, query: &Query, index: u32, level: u32, shows: impl Fn(u32) -> bool) -> Option<Weights> {
        let node = &self.nodes[index as usize];
        let mut importance = node.importance(query);
        if level == self.depth {
            for (place, importance) in (node.first..).zip(&mut importance) {
                if *importance > 0.0 && !shows(place) {
                    *importance = 0.0;
                }
            }
        }
        let weights = Weights { ends: sums(&importance), of_lanes: importance };
        (weights.total() > 0.0).then_some(weights)
    }

    /// Whether `from` is outside of this body.
    pub(super) fn is_outside(&self, body: u32, from: DVec3) -> bool {
        let Aabb { min, max } = self.bodies[body as usize];
        !(from.cmpge(min.as_dvec3()).all() && from.cmple(max.as_dvec3()).all())
    }

    #[inline(always)]
    fn query(&self, at: &Viewpoint) -> Query {
        let place = |position: DVec3| ((position - self.origin) * self.scale).as_vec3();
        let within = |body: u32| u32::from(!self.is_outside(body, at.receiver.position)) << body;
        Query {
            from: place(at.receiver.position),
            side: at.receiver.side,
            lights: place(at.lights.centre),
            lights_half_extents: (at.lights.half_extents * self.scale).as_vec3(),
            lights_radius: (at.lights.radius * self.scale) as f32,
            around: (0..self.bodies.len() as u32).fold(OPEN, |all, body| all | within(body)),
        }
    }
}

/// The root of a tree as it is seen from a shading point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Root {
    query: Query,
    weights: Weights,
    /// The probability that any facet is chosen.
    attempt_prob: f64,
}

/// To what each child of a node is chosen in proportion.
#[derive(Clone, Copy, Debug)]
struct Weights {
    of_lanes: Lanes,
    /// The sums of the weights up to each lane.
    ends: [f64; WIDTH],
}

impl Weights {
    #[inline(always)]
    fn total(&self) -> f64 {
        self.ends[WIDTH - 1]
    }
}

/// What leads from the root to a facet.
#[derive(Clone, Copy, Debug)]
enum Guide<F> {
    /// A number in `[0, 1)`, drawn where it is needed first: what the levels above leave of it is uniform again.
    Number(Option<f64>, F),
    /// The lanes, from the lowest bits up.
    Path(u32),
}

impl<F: Fn() -> f64> Guide<F> {
    /// Whether a facet is chosen at all, which has the probability `prob`.
    #[inline(always)]
    fn attempts(&mut self, prob: f64) -> bool {
        let Self::Number(number, draw) = self else { return true };
        if prob == 1.0 {
            return true;
        }
        let u = draw();
        *number = Some((u / prob).min(1.0_f64.next_down()));
        u < prob
    }

    /// The lane to descend to, with a probability proportional to its weight.
    #[inline(always)]
    fn lane(&mut self, Weights { of_lanes, ends }: &Weights) -> usize {
        match self {
            Self::Number(number, draw) => {
                let total = ends[WIDTH - 1];
                let last = last(of_lanes);
                if f64::from(of_lanes[last]) == total {
                    return last;
                }
                let u = number.unwrap_or_else(draw);
                let below: usize = ends.iter().map(|end| usize::from(*end <= u * total)).sum();
                // The product may round to the last sum, which also those of empty lanes are.
                let lane = below.min(last);
                let weight = f64::from(of_lanes[lane]);
                let rest = 1.0 - (ends[lane] - u * total) / weight;
                *number = Some(rest.clamp(0.0, 1.0_f64.next_down()));
                lane
            }
            Self::Path(path) => {
                let lane = *path as usize % WIDTH;
                *path >>= LANE_BITS;
                lane
            }
        }
    }
}

/// The last lane that has a weight; the first if none has.
fn last(weights: &Lanes) -> usize {
    weights.iter().rposition(|&weight| weight > 0.0).unwrap_or(0)
}

/// The sums of the weights up to each lane.
#[inline(always)]
fn sums(weights: &Lanes) -> [f64; WIDTH] {
    let mut sums = weights.map(f64::from);
    for lane in 1..WIDTH {
        sums[lane] += sums[lane - 1];
    }
    sums
}
