//! Directions toward places where photons left mirrors (after Jensen 1995).

use super::vertex_tree::{GuideVertex, VertexTree, guide_vertex};
use crate::light::Receiver;
use glam::{DVec3, Vec3};
use globillum_geom::{Frame, PdfSolidAngle};
use globillum_material::warp::CosineHemisphere;
use rayon::prelude::*;
use std::f64::consts::FRAC_1_PI;

/// The least mean number of photons in a cell; the mean is less than twice this.
const CELL_PHOTONS: usize = 64;

/// The most photons of a cell that guide. Cells that medians divide unevenly may have more.
const MAX_PHOTONS: usize = 4 * CELL_PHOTONS;

/// The radius of a ball is the distance from its center to the place of this rank among those of the cell, by distance; that
/// of rank 0 is the center.
const RANK: usize = 2;

/// The least radius of a ball, over its distance from the receiver.
const MIN_TANGENT: f64 = 1e-3;

/// Where a path from a light has reached a diffuse surface by way of mirrors. It has no power.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Photon {
    pub(crate) vertex: GuideVertex,
    /// Where the path left the last mirror.
    pub(crate) exit: Vec3,
}

/// Balls around the places where photons left mirrors, for cells of the vertices at which they arrived. A ball of the cell is
/// chosen, each with the same probability, and then a direction toward a disc of its radius that faces the receiver.
#[derive(Clone, Debug)]
pub(crate) struct PhotonGuide {
    tree: VertexTree,
    cells: Vec<Vec<Ball>>,
}

/// A ball around the place where a photon left its mirror.
#[derive(Clone, Copy, Debug)]
struct Ball {
    center: Vec3,
    radius: f32,
}

/// The cone of directions toward the disc of a ball.
#[derive(Clone, Copy, Debug)]
struct Cone {
    /// From the apex to the center of the ball.
    axis: DVec3,
    /// The square of its length.
    length_sq: f64,
    /// The square of the sine of the angle between axis and border.
    sine_sq: f64,
}

impl PhotonGuide {
    /// The guide by these photons; `None` if they do not fill a cell.
    pub(crate) fn new(photons: &[Photon]) -> Option<Self> {
        let depth = (photons.len() / CELL_PHOTONS).checked_ilog2()?;
        let mut vertices: Vec<GuideVertex> = photons.iter().map(|photon| photon.vertex).collect();
        let tree = VertexTree::build(&mut vertices, depth);
        let mut exits = vec![Vec::new(); 1 << depth];
        for photon in photons {
            let [cell] = tree.cells(&[photon.vertex]);
            if exits[cell].len() < MAX_PHOTONS {
                exits[cell].push(photon.exit);
            }
        }
        let balls = |exits: &Vec<Vec3>| exits.iter().map(|&exit| Ball::around(exit, exits)).collect();
        Some(Self { tree, cells: exits.par_iter().map(balls).collect() })
    }

    /// The balls of the cell of a receiver.
    fn balls(&self, receiver: Receiver) -> &[Ball] {
        let [cell] = self.tree.cells(&[guide_vertex(receiver)]);
        &self.cells[cell]
    }

    /// Samples a unit direction for a receiver by numbers in `[0, 1)`: one that chooses a ball, and two for the direction.
    /// `None` if there is no ball, and if the receiver is at its center.
    pub(crate) fn sample(&self, receiver: Receiver, choice: f64, u: [f64; 2]) -> Option<DVec3> {
        let balls = self.balls(receiver);
        let ball = balls.get((choice * balls.len() as f64) as usize)?;
        Some(ball.cone(receiver.position)?.sample(u))
    }

    /// The density with which [`sample`](PhotonGuide::sample) samples this unit direction.
    pub(crate) fn pdf(&self, receiver: Receiver, direction: DVec3) -> PdfSolidAngle {
        let balls = self.balls(receiver);
        let cones = balls.iter().filter_map(|ball| ball.cone(receiver.position));
        let sum: f64 = cones.map(|cone| cone.pdf(direction).0).sum();
        PdfSolidAngle(if sum > 0.0 { sum / balls.len() as f64 } else { 0.0 })
    }
}

impl Ball {
    /// The ball around one of the places `all`.
    fn around(center: Vec3, all: &[Vec3]) -> Self {
        let distance_sq = |other: &Vec3| (other.as_dvec3() - center.as_dvec3()).length_squared();
        let mut squares: Vec<f64> = all.iter().map(distance_sq).collect();
        let rank = RANK.min(squares.len() - 1);
        let (_, square, _) = squares.select_nth_unstable_by(rank, f64::total_cmp);
        Self { center, radius: square.sqrt() as f32 }
    }

    /// The cone of directions toward its disc from `apex`; `None` if that is its center.
    #[inline(always)]
    fn cone(&self, apex: DVec3) -> Option<Cone> {
        let axis = self.center.as_dvec3() - apex;
        let length_sq = axis.length_squared();
        let radius_sq = f64::from(self.radius).powi(2).max(MIN_TANGENT * MIN_TANGENT * length_sq);
        (length_sq > 0.0).then(|| Cone { axis, length_sq, sine_sq: radius_sq / (length_sq + radius_sq) })
    }
}

impl Cone {
    /// Samples a unit direction in proportion to its cosine to the axis.
    fn sample(&self, [u, v]: [f64; 2]) -> DVec3 {
        let axis = self.axis / self.length_sq.sqrt();
        Frame::around(axis).to_world(CosineHemisphere::sample([u * self.sine_sq, v]))
    }

    /// The density of [`sample`](Cone::sample).
    #[inline(always)]
    fn pdf(&self, direction: DVec3) -> PdfSolidAngle {
        let along = self.axis.dot(direction);
        let is_inside = along > 0.0 && along * along >= (1.0 - self.sine_sq) * self.length_sq;
        let pdf = || FRAC_1_PI * along / (self.length_sq.sqrt() * self.sine_sq);
        PdfSolidAngle(if is_inside { pdf() } else { 0.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Stream;

    /// Photons on a square floor of side 1, from places above it.
    fn photons(count: u32) -> Vec<Photon> {
        let photon = |i| {
            let stream = Stream::new(1, 2, i);
            let [x, y] = stream.uniform_pair(0);
            let exit = DVec3::new(stream.uniform(2) - 0.5, stream.uniform(3), 0.3 + stream.uniform(4));
            Photon {
                vertex: guide_vertex(Receiver { position: DVec3::new(x, y, 0.0), normal: Vec3::Z }),
                exit: exit.as_vec3(),
            }
        };
        (0..count).map(photon).collect()
    }

    fn receiver(x: f64, y: f64) -> Receiver {
        Receiver { position: DVec3::new(x, y, 0.0), normal: Vec3::Z }
    }

    /// Directions fill bins of equal solid angle as often as the density says. Chi-square exceeds the limit with a
    /// probability of 1e-6 or less, by the normal approximation of Wilson and Hilferty (1931).
    #[test]
    fn directions_have_their_density() {
        const BINS: usize = 24;
        const STEPS: usize = 32;
        let guide = PhotonGuide::new(&photons(600)).unwrap();
        let (receiver, samples) = (receiver(0.3, 0.6), 100_000);
        let mut counts = [[0.0; BINS]; BINS];
        for i in 0..samples {
            let stream = Stream::new(3, 4, i);
            let direction = guide.sample(receiver, stream.uniform(0), stream.uniform_pair(1)).unwrap();
            assert!((direction.length() - 1.0).abs() < 1e-12);
            let [a, b] =
                [0.5 + 0.5 * direction.z, 0.5 + direction.y.atan2(direction.x) / std::f64::consts::TAU];
            let bin = |at: f64| ((at * BINS as f64) as usize).min(BINS - 1);
            counts[bin(a)][bin(b)] += 1.0;
        }
        let middle = |i: usize| (i as f64 + 0.5) / (BINS * STEPS) as f64;
        let density = |i: usize, j: usize| {
            let (z, turn) = (2.0 * middle(i) - 1.0, middle(j) - 0.5);
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * turn);
            let radius = (1.0 - z * z).sqrt();
            guide.pdf(receiver, DVec3::new(radius * cos, radius * sin, z)).0
        };
        let (mut chi_sq, mut freedom, mut all) = (0.0, -1.0, 0.0);
        for (a, b) in (0..BINS).flat_map(|a| (0..BINS).map(move |b| (a, b))) {
            let steps = (0..STEPS).flat_map(|i| (0..STEPS).map(move |j| (a * STEPS + i, b * STEPS + j)));
            let mean = steps.map(|(i, j)| density(i, j)).sum::<f64>() / (STEPS * STEPS) as f64;
            let expected = f64::from(samples) * mean * 4.0 * std::f64::consts::PI / (BINS * BINS) as f64;
            all += expected;
            if expected > 50.0 {
                chi_sq += (counts[a][b] - expected).powi(2) / expected;
                freedom += 1.0;
            }
        }
        assert!((all / f64::from(samples) - 1.0).abs() < 0.01, "{all}");
        assert!(freedom > 100.0, "{freedom}");
        let spread = 2.0 / (9.0 * freedom);
        let z = ((chi_sq / freedom).cbrt() - (1.0 - spread)) / f64::sqrt(spread);
        assert!(z < 4.75, "{chi_sq}, {freedom}");
    }

    /// A cell's directions lead to where its own photons came from.
    #[test]
    fn cells_have_photons_of_their_own() {
        let photon = |i: u32| {
            let x = f64::from(i % 2) * 10.0 + f64::from(i) * 1e-4;
            let vertex =
                guide_vertex(Receiver { position: DVec3::new(x, f64::from(i % 7), 0.0), normal: Vec3::Z });
            Photon { vertex, exit: Vec3::new(x as f32, 3.0, 20.0) }
        };
        let guide = PhotonGuide::new(&(0..128).map(photon).collect::<Vec<_>>()).unwrap();
        for (x, u) in [(0.005, 0.1), (10.005, 0.9)] {
            let receiver = receiver(x, 3.0);
            let direction = guide.sample(receiver, u, [0.5, 0.5]).unwrap();
            assert!(direction.z > 0.99, "{direction}");
            assert!(guide.pdf(receiver, direction).0 > 1.0);
            assert_eq!(guide.pdf(receiver, -direction).0, 0.0);
        }
    }

    #[test]
    fn few_photons_are_no_guide_and_equal_ones_are_one() {
        assert!(PhotonGuide::new(&[]).is_none());
        assert!(PhotonGuide::new(&photons(CELL_PHOTONS as u32 - 1)).is_none());
        let guide = PhotonGuide::new(&[photons(1)[0]; 2000]).unwrap();
        let exit = photons(1)[0].exit.as_dvec3();
        let direction = guide.sample(receiver(0.5, 0.5), 0.9, [0.99, 0.3]).unwrap();
        let sine = direction.cross((exit - receiver(0.5, 0.5).position).normalize()).length();
        assert!(sine < 1.01 * MIN_TANGENT, "{sine}");
        assert!(guide.pdf(receiver(0.5, 0.5), direction).0.is_finite());
        let there = Receiver { position: exit, normal: Vec3::Z };
        assert_eq!(guide.sample(there, 0.5, [0.5, 0.5]), None);
        assert_eq!(guide.pdf(there, DVec3::Z).0, 0.0);
    }

    /// The unit of length does not matter.
    #[test]
    fn scenes_of_any_size_have_the_same_directions() {
        let of_scale = |scale: f32| {
            let scaled = |photon: Photon| {
                let mut vertex = photon.vertex;
                vertex[..3].iter_mut().for_each(|x| *x *= scale);
                Photon { vertex, exit: photon.exit * scale }
            };
            let guide = PhotonGuide::new(&photons(600).into_iter().map(scaled).collect::<Vec<_>>()).unwrap();
            let at = receiver(0.3, 0.6);
            let at = Receiver { position: at.position * f64::from(scale), ..at };
            let direction = guide.sample(at, 0.4, [0.3, 0.8]).unwrap();
            (direction, guide.pdf(at, direction).0)
        };
        let (direction, pdf) = of_scale(1.0);
        for scale in [2.0_f32.powi(-100), 2.0_f32.powi(100)] {
            let (scaled, scaled_pdf) = of_scale(scale);
            assert!((scaled - direction).length() < 1e-5 && (scaled_pdf / pdf - 1.0).abs() < 1e-4);
        }
    }
}
