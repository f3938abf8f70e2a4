use super::frame::TreeFrame;
use super::light_moments::{LightMoments, twice_positive_part};
use crate::light::child_weights::{ChildWeights, WIDTH, child_of, lane_of};
use crate::light::receiver::Receiver;
use glam::DVec3;

/// A number for each child, by lane. Single precision is enough for what only guides sampling, but not for positions, of
/// which small differences count.
type Lanes = [f32; WIDTH];

/// A child of a node.
#[derive(Clone, Copy, Debug)]
pub(super) enum Child {
    /// The index of a node.
    Node(u32),
    /// The index of a light.
    Light(u32),
}

/// A node of the light tree: the clusters of its children, by component, in the tree's frame.
#[derive(Clone, Debug)]
pub(super) struct Node {
    /// In double precision: single precision would move a lamp by kilometres in the frame of a lamp and a sun.
    center: [[f64; WIDTH]; 3],
    variance: [Lanes; 3],
    normal: [Lanes; 3],
    /// Along one axis, taken for the same along all.
    normal_variance: Lanes,
    variance_along_normal: Lanes,
    /// The square of [`LightMoments::limit`], with its sign, less some slack.
    limit: Lanes,
    /// 1 for a child that emits on both sides, else 0.
    both_sides: Lanes,
    /// By lane; 0 where there is no child.
    intensity: [f64; WIDTH],
    /// By number, not by lane.
    children: [Child; WIDTH],
    /// The number of children.
    count: f64,
}

impl Node {
    /// Added to the squared distance, which is then above 0 and has an inverse.
    const MIN_DISTANCE_SQ: f32 = 1e-30;

    /// The share of the variance of positions that is added to the squared distance, so that importances have a bound. With a
    /// third, variance is 1.11 times as large with 300 small lights behind partitions (the scene *corridor* of
    /// docs/estimators.md), and 0.96 times with strips of lights close to walls.
    const SOFTENING: f32 = 1.0 / 12.0;

    /// Rounding to single precision moves squared cosines by less.
    const LIMIT_SLACK: f64 = 2e-6;

    /// A node of one to `WIDTH` children.
    pub(super) fn new(children: &[(Child, LightMoments)], frame: &TreeFrame) -> Self {
        let of_children = |value: &dyn Fn(&LightMoments) -> f64| -> [f64; WIDTH] {
            std::array::from_fn(|lane| {
                children.get(child_of(lane)).map_or(0.0, |(_, moments)| value(moments))
            })
        };
        let lanes = |value: &dyn Fn(&LightMoments) -> f64| of_children(value).map(|x| x as f32);
        let vectors =
            |value: &dyn Fn(&LightMoments) -> DVec3| [0, 1, 2].map(|k| lanes(&|moments| value(moments)[k]));
        let center = |k: usize| of_children(&|moments| frame.position(moments.center)[k]);
        let first = children[0].0;
        Self {
            center: [0, 1, 2].map(center),
            variance: vectors(&|moments| frame.variance(moments.variance)),
            normal: vectors(&|moments| moments.normal),
            normal_variance: lanes(&|moments| moments.normal_variance / 3.0),
            variance_along_normal: lanes(&|moments| {
                (moments.normal * moments.normal).dot(frame.variance(moments.variance))
            }),
            limit: lanes(&|moments| moments.limit * moments.limit.abs() - Self::LIMIT_SLACK),
            both_sides: lanes(&|moments| f64::from(u8::from(moments.both_sides))),
            intensity: of_children(&|moments| frame.intensity(moments.intensity)),
            children: std::array::from_fn(|number| children.get(number).map_or(first, |(child, _)| *child)),
            count: children.len() as f64,
        }
    }

    /// The number of children.
    pub(super) fn count(&self) -> usize {
        self.count as usize
    }

    /// Multiplies the importance of a child by `factor`, everywhere.
    pub(super) fn scale(&mut self, child: usize, factor: f64) {
        self.intensity[lane_of(child)] *= factor;
    }

    #[inline(always)]
    pub(super) fn child(&self, number: usize) -> Child {
        self.children[number]
    }

    /// The weights of the children for the receiver, in the tree's frame.
    #[inline(always)]
    pub(super) fn weights(&self, receiver: &Receiver) -> ChildWeights {
        ChildWeights::with_uniform_share(self.importance(receiver), self.count)
    }

    /// The importance of each child, by lane: the irradiance from it, about, if it is visible. The mean of a product of
    /// both cosines and the inverse squared distance is taken for a product of means.
    #[inline(always)]
    pub(super) fn importance(&self, &Receiver { position, normal }: &Receiver) -> [f64; WIDTH] {
        let normal_sq = normal * normal;
        let mut importances = [0.0; WIDTH];
        // A plain loop, which the compiler vectorizes.
        for (i, importance) in importances.iter_mut().enumerate() {
            let x = (position.x - self.center[0][i]) as f32;
            let y = (position.y - self.center[1][i]) as f32;
            let z = (position.z - self.center[2][i]) as f32;
            let [vx, vy, vz] = [self.variance[0][i], self.variance[1][i], self.variance[2][i]];
            let distance_sq = x * x + y * y + z * z;
            // The cosines, times twice the distance.
            let height = -(x * normal.x + y * normal.y + z * normal.z);
            let received =
                twice_positive_part(height, vx * normal_sq.x + vy * normal_sq.y + vz * normal_sq.z);
            let along = x * self.normal[0][i] + y * self.normal[1][i] + z * self.normal[2][i];
            let variance = self.normal_variance[i] * distance_sq + self.variance_along_normal[i];
            let emitted = twice_positive_part(along, variance)
                + self.both_sides[i] * twice_positive_part(-along, variance);
            let emits = along * along.abs() >= self.limit[i] * distance_sq;
            let emitted = if emits { emitted } else { 0.0 };
            let per_distance_sq =
                1.0 / (distance_sq + Self::SOFTENING * (vx + vy + vz) + Self::MIN_DISTANCE_SQ);
            let irradiance = 0.25 * (received * per_distance_sq) * (emitted * per_distance_sq);
            *importance = self.intensity[i] * f64::from(irradiance);
        }
        importances
    }
}
