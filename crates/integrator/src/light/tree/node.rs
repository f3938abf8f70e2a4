use super::cluster::Cluster;
use glam::DVec3;

/// The number of children of a node.
pub(super) const WIDTH: usize = 8;

/// The bits of a lane in a path.
pub(super) const LANE_BITS: u32 = WIDTH.trailing_zeros();

/// A number for each child.
pub(super) type Lanes = [f64; WIDTH];

/// The same in single precision, which is enough for bounds that only guide sampling.
type Lanes32 = [f32; WIDTH];

/// A child of a node.
#[derive(Clone, Copy, Debug)]
pub(super) enum Child {
    /// The index of a node.
    Node(u32),
    /// The index of a light.
    Light(u32),
}

/// A node of the light tree: the clusters of its children, by component.
#[derive(Clone, Debug)]
pub(super) struct Node {
    centre: [Lanes32; 3],
    radius: Lanes32,
    axis: [Lanes32; 3],
    cos_tilt: Lanes32,
    sin_tilt: Lanes32,
    cos_spread: Lanes32,
    /// -1 for a cluster that emits on both sides, else 1.
    fold: Lanes32,
    /// The least probability of each child; 0 where there is none.
    least_prob: Lanes,
    intensity: Lanes,
    children: [Child; WIDTH],
    last: u32,
}

impl Node {
    /// Every child has at least this probability divided by their number, whatever its importance.
    const UNIFORM_SHARE: f64 = 1.0 / 1024.0;

    /// The smallest squared distance that counts, below that of any two coordinates.
    const LEAST_DISTANCE_SQ: f64 = 1e-90;

    /// A node of one to `WIDTH` children.
    pub(super) fn new(children: &[(Child, Cluster)]) -> Self {
        let wide_lanes = |value: &dyn Fn(&Cluster) -> f64| -> Lanes {
            std::array::from_fn(|lane| children.get(lane).map_or(0.0, |(_, cluster)| value(cluster)))
        };
        let lanes = |value: &dyn Fn(&Cluster) -> f64| wide_lanes(value).map(|x| x as f32);
        let vectors =
            |value: &dyn Fn(&Cluster) -> DVec3| [0, 1, 2].map(|k| lanes(&|cluster| value(cluster)[k]));
        let (first, count) = (children[0].0, children.len() as f64);
        Self {
            centre: vectors(&Cluster::centre),
            radius: lanes(&|cluster| cluster.radius()),
            axis: vectors(&|cluster| cluster.axis),
            cos_tilt: lanes(&|cluster| libm::cos(cluster.tilt)),
            sin_tilt: lanes(&|cluster| libm::sin(cluster.tilt)),
            cos_spread: lanes(&|cluster| libm::cos(cluster.spread)),
            fold: lanes(&|cluster| if cluster.both_sides { -1.0 } else { 1.0 }),
            least_prob: wide_lanes(&|_| Self::UNIFORM_SHARE / count),
            intensity: wide_lanes(&|cluster| cluster.intensity),
            children: std::array::from_fn(|lane| children.get(lane).map_or(first, |(child, _)| *child)),
            last: children.len() as u32 - 1,
        }
    }

    /// The lane for `u` in `[0, 1)`, with the number in `[0, 1)` that is left for the choice below it.
    #[inline(always)]
    pub(super) fn choose(&self, probs: &Lanes, u: f64) -> (usize, f64) {
        let mut ends = *probs;
        for i in 1..WIDTH {
            ends[i] += ends[i - 1];
        }
        let below: u32 = ends.iter().map(|end| u32::from(*end <= u)).sum();
        // The sum may round to less than `u`.
        let lane = below.min(self.last) as usize;
        let start = if lane > 0 { ends[lane - 1] } else { 0.0 };
        (lane, ((u - start) / probs[lane]).clamp(0.0, 1.0_f64.next_down()))
    }

    #[inline(always)]
    pub(super) fn child(&self, lane: usize) -> Child {
        self.children[lane]
    }

    /// The importance of each child for the point `from`: the irradiance from it, about, if it is visible
    /// and faces the surface (Conty Estevez and Kulla 2018, equation 3, without the cosine at the surface).
    #[inline(always)]
    pub(super) fn importance(&self, from: DVec3) -> Lanes {
        let mut all = [0.0; WIDTH];
        // A plain loop, which the compiler vectorizes.
        for (i, importance) in all.iter_mut().enumerate() {
            let x = from.x - f64::from(self.centre[0][i]);
            let y = from.y - f64::from(self.centre[1][i]);
            let z = from.z - f64::from(self.centre[2][i]);
            let radius = f64::from(self.radius[i]);
            let radius_sq = (radius * radius).max(Self::LEAST_DISTANCE_SQ);
            let to_centre_sq = x * x + y * y + z * z;
            let distance_sq = to_centre_sq.max(radius_sq);
            // The cosine between the axis and the direction to `from`.
            let [axis_x, axis_y, axis_z] =
                [f64::from(self.axis[0][i]), f64::from(self.axis[1][i]), f64::from(self.axis[2][i])];
            let along = x * axis_x + y * axis_y + z * axis_z;
            let cos = along.max(f64::from(self.fold[i]) * along) / distance_sq.sqrt();
            let sin = (1.0 - cos * cos).max(0.0).sqrt();
            let (cos, sin) = subtract((cos, sin), (self.cos_tilt[i].into(), self.sin_tilt[i].into()));
            // Half of the angle that the sphere around the box subtends: all directions within the sphere.
            let sin_size_sq = radius_sq / distance_sq;
            let is_within = to_centre_sq <= radius_sq;
            let cos_size = if is_within { -1.0 } else { (1.0 - sin_size_sq).sqrt() };
            let sin_size = if is_within { 0.0 } else { sin_size_sq.sqrt() };
            let (cos, _) = subtract((cos, sin), (cos_size, sin_size));
            let cos = if cos > f64::from(self.cos_spread[i]) { cos.max(0.0) } else { 0.0 };
            // The mean of `1 / d^2` over the ball, about: 3 / r^2 in its centre, 1.5 / r^2 at its surface.
            let within = 3.0 - 1.5 * (to_centre_sq / radius_sq);
            let beyond = 1.0 + 0.5 * sin_size_sq * sin_size_sq;
            *importance = self.intensity[i] * cos * (if is_within { within } else { beyond }) / distance_sq;
        }
        all
    }

    /// The probability of each child, proportional to `importance` but for a uniform share.
    #[inline(always)]
    pub(super) fn probs(&self, importance: &Lanes) -> Lanes {
        let total = sum(importance);
        let scale = (1.0 - Self::UNIFORM_SHARE) / total;
        // Without any importance the uniform share is all.
        let (scale, uniform) = if total > 0.0 { (scale, 1.0) } else { (0.0, 1.0 / Self::UNIFORM_SHARE) };
        let mut probs = *importance;
        for (prob, least) in probs.iter_mut().zip(&self.least_prob) {
            *prob = *prob * scale + least * uniform;
        }
        probs
    }
}

/// The sum in a fixed order.
#[inline(always)]
pub(super) fn sum([a, b, c, d, e, f, g, h]: &Lanes) -> f64 {
    ((a + b) + (c + d)) + ((e + f) + (g + h))
}

/// Cosine and sine of the difference of two angles within `[0, pi]`, or of 0 if the second is larger.
#[inline(always)]
fn subtract((cos_a, sin_a): (f64, f64), (cos_b, sin_b): (f64, f64)) -> (f64, f64) {
    let (cos, sin) = (cos_a * cos_b + sin_a * sin_b, sin_a * cos_b - cos_a * sin_b);
    if cos_a > cos_b { (1.0, 0.0) } else { (cos, sin) }
}
