use super::child_weights::{ChildWeights, WIDTH};
use super::cluster::Cluster;
use super::frame::TreeFrame;
use crate::light::receiver::Receiver;
use glam::DVec3;

/// A number for each child. Single precision is enough for bounds that only guide sampling.
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
    centre: [Lanes; 3],
    radius: Lanes,
    axis: [Lanes; 3],
    cos_tilt: Lanes,
    sin_tilt: Lanes,
    cos_spread: Lanes,
    /// -1 for a cluster that emits on both sides, else 1.
    fold: Lanes,
    /// 0 where there is no child.
    intensity: [f64; WIDTH],
    children: [Child; WIDTH],
    /// The number of children.
    count: f64,
}

impl Node {
    /// The smallest radius that counts, and so the smallest distance: its square is a normal number.
    const LEAST_RADIUS: f64 = 1e-15;

    /// A node of one to `WIDTH` children.
    pub(super) fn new(children: &[(Child, Cluster)], frame: &TreeFrame) -> Self {
        let of_children = |value: &dyn Fn(&Cluster) -> f64| -> [f64; WIDTH] {
            std::array::from_fn(|lane| children.get(lane).map_or(0.0, |(_, cluster)| value(cluster)))
        };
        let lanes = |value: &dyn Fn(&Cluster) -> f64| of_children(value).map(|x| x as f32);
        let vectors =
            |value: &dyn Fn(&Cluster) -> DVec3| [0, 1, 2].map(|k| lanes(&|cluster| value(cluster)[k]));
        let first = children[0].0;
        Self {
            centre: vectors(&|cluster| frame.position(cluster.centre())),
            radius: lanes(&|cluster| frame.length(cluster.radius()).max(Self::LEAST_RADIUS)),
            axis: vectors(&|cluster| cluster.axis),
            cos_tilt: lanes(&|cluster| libm::cos(cluster.tilt)),
            sin_tilt: lanes(&|cluster| libm::sin(cluster.tilt)),
            cos_spread: lanes(&|cluster| libm::cos(cluster.spread)),
            fold: lanes(&|cluster| if cluster.both_sides { -1.0 } else { 1.0 }),
            intensity: of_children(&|cluster| frame.intensity(cluster.intensity)),
            children: std::array::from_fn(|lane| children.get(lane).map_or(first, |(child, _)| *child)),
            count: children.len() as f64,
        }
    }

    #[inline(always)]
    pub(super) fn child(&self, lane: usize) -> Child {
        self.children[lane]
    }

    /// The weights of the children for the receiver, in the tree's frame.
    #[inline(always)]
    pub(super) fn weights(&self, receiver: &Receiver) -> ChildWeights {
        ChildWeights::new(self.importance(receiver), self.count)
    }

    /// The importance of each child: the irradiance from it, about, if it is visible (Conty Estevez and Kulla 2018,
    /// equation 3).
    #[inline(always)]
    pub(super) fn importance(&self, &Receiver { position, side }: &Receiver) -> [f64; WIDTH] {
        let mut importances = [0.0; WIDTH];
        // A plain loop, which the compiler vectorizes.
        for (i, importance) in importances.iter_mut().enumerate() {
            let x = (position.x - f64::from(self.centre[0][i])) as f32;
            let y = (position.y - f64::from(self.centre[1][i])) as f32;
            let z = (position.z - f64::from(self.centre[2][i])) as f32;
            let radius = self.radius[i];
            let radius_sq = radius * radius;
            let to_centre_sq = x * x + y * y + z * z;
            let is_within = to_centre_sq <= radius_sq;
            let per_distance_sq = 1.0 / to_centre_sq.max(radius_sq);
            let per_distance = per_distance_sq.sqrt();
            // The cosine between the axis and the direction to the receiver.
            let along = x * self.axis[0][i] + y * self.axis[1][i] + z * self.axis[2][i];
            let cos = along.max(self.fold[i] * along) * per_distance;
            let sin = (1.0 - cos * cos).max(0.0).sqrt();
            let (cos, sin) = subtract((cos, sin), (self.cos_tilt[i], self.sin_tilt[i]));
            // Half of the angle that the sphere around the box subtends: all directions within the sphere.
            let sin_size_sq = radius_sq * per_distance_sq;
            let cos_size = if is_within { -1.0 } else { (1.0 - sin_size_sq).max(0.0).sqrt() };
            let sin_size = if is_within { 0.0 } else { radius * per_distance };
            let (cos, _) = subtract((cos, sin), (cos_size, sin_size));
            let cos = if cos > self.cos_spread[i] { cos.max(0.0) } else { 0.0 };
            // The cosine at the receiver.
            let cos_in = -(x * side.x + y * side.y + z * side.z) * per_distance;
            let sin_in = (1.0 - cos_in * cos_in).max(0.0).sqrt();
            let (cos_in, _) = subtract((cos_in, sin_in), (cos_size, sin_size));
            let cos = cos * cos_in.max(0.0);
            // The mean of `1 / d^2` over the ball, about: 3 / r^2 in its centre, 1.5 / r^2 at its surface.
            let within = 3.0 - 1.5 * (to_centre_sq * per_distance_sq);
            let beyond = 1.0 + 0.5 * sin_size_sq * sin_size_sq;
            let shape = if is_within { within } else { beyond };
            *importance = self.intensity[i] * f64::from(cos * shape * per_distance_sq);
        }
        importances
    }
}

/// Cosine and sine of the difference of two angles within `[0, pi]`, or of 0 if the second is larger.
#[inline(always)]
pub(super) fn subtract((cos_a, sin_a): (f32, f32), (cos_b, sin_b): (f32, f32)) -> (f32, f32) {
    let (cos, sin) = (cos_a * cos_b + sin_a * sin_b, sin_a * cos_b - cos_a * sin_b);
    if cos_a > cos_b { (1.0, 0.0) } else { (cos, sin) }
}
