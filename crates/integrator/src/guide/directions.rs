use glam::DVec3;
use std::f64::consts::SQRT_2;

/// Rings around the normal.
const RINGS: usize = 4;
/// Sectors of a ring.
const SECTORS: usize = 16;
/// Bins of equal probability by the cosine.
pub(crate) const BINS: usize = RINGS * SECTORS;

/// Probabilities are multiples of one over this.
const ONE: u32 = 1 << 16;

/// A distribution of directions on the upper hemisphere, whose ratio to cosine sampling is constant in each bin. Bins
/// are rectangles of the unit square that cosine sampling maps to directions
/// ([`CosineHemisphere`](globillum_material::warp::CosineHemisphere)).
#[derive(Clone, Debug)]
pub(crate) struct Directions {
    /// For each ring, the probability of those before.
    rings: [u16; RINGS],
    /// For each ring, and each sector of it, the probability of the sectors before.
    sectors: [[u16; SECTORS]; RINGS],
}

impl Directions {
    /// The distribution whose ratio to cosine sampling is proportional to `ratios`, bin by bin, of which none is below
    /// 1/1000 of their mean.
    pub(super) fn new(ratios: &[f64; BINS]) -> Self {
        let (rings, _) = ratios.as_chunks::<SECTORS>();
        let sums: [f64; RINGS] = std::array::from_fn(|ring| rings[ring].iter().sum());
        Self { rings: starts(&sums), sectors: std::array::from_fn(|ring| starts(&rings[ring])) }
    }

    /// Maps `u`, uniform in the unit square, to the point there whose direction is distributed like this. Returns it
    /// with its [ratio](Directions::ratio).
    #[inline(always)]
    pub(crate) fn warp(&self, u: [f64; 2]) -> ([f64; 2], f64) {
        let ring = invert(&self.rings, u[0]);
        let sector = invert(&self.sectors[ring.index], u[1]);
        ([ring.point, sector.point], ring.density * sector.density)
    }

    /// The density in direction `w` of the upper hemisphere, local frame, over that of cosine sampling.
    #[inline(always)]
    pub(crate) fn ratio(&self, w: DVec3) -> f64 {
        let (ring, sector) = (bin_of(w) / SECTORS, bin_of(w) % SECTORS);
        let of = |starts: &[u16], index| f64::from(interval(starts, index).1) * starts.len() as f64;
        of(&self.rings, ring) * of(&self.sectors[ring], sector) / (f64::from(ONE) * f64::from(ONE))
    }
}

/// The bin of direction `w` of the upper hemisphere, of any length, local frame.
#[inline(always)]
pub(crate) fn bin_of(w: DVec3) -> usize {
    let across = w.x * w.x + w.y * w.y;
    let ring = (across / (across + w.z * w.z) * RINGS as f64) as usize;
    // The quadrant, and the direction turned into the first one; without branches, which nobody could predict.
    let is_lower = w.y <= 0.0;
    let is_odd = (w.x > 0.0) == is_lower;
    let quadrant = 2 * usize::from(is_lower) + usize::from(is_odd);
    let [x, y] = if is_odd { [w.y.abs(), w.x.abs()] } else { [w.x.abs(), w.y.abs()] };
    // The tangents between the sectors of a quadrant: those of 22.5, 45 and 67.5 degrees.
    let sector: usize = [SQRT_2 - 1.0, 1.0, SQRT_2 + 1.0].iter().map(|t| usize::from(y > t * x)).sum();
    ring.min(RINGS - 1) * SECTORS + SECTORS / 4 * quadrant + sector
}

/// For each weight, the probability of those before.
fn starts<const N: usize>(weights: &[f64; N]) -> [u16; N] {
    let total: f64 = weights.iter().sum();
    let mut sum = 0.0;
    weights.map(|weight| {
        let start = sum / total * f64::from(ONE);
        sum += weight;
        start as u16
    })
}

/// Where the probability of an entry starts, and its length.
#[inline(always)]
fn interval(starts: &[u16], index: usize) -> (u32, u32) {
    let start = u32::from(starts[index]);
    let end = starts.get(index + 1).map_or(ONE, |&end| u32::from(end));
    (start, end - start)
}

/// A sample of the distribution in `[0, 1)` that entries of equal length divide.
struct Inverse {
    /// The entry that it is in.
    index: usize,
    point: f64,
    density: f64,
}

/// The sample to which `u` in `[0, 1)` leads.
#[inline(always)]
fn invert<const N: usize>(starts: &[u16; N], u: f64) -> Inverse {
    let scaled = u * f64::from(ONE);
    let whole = scaled as u16;
    let index = starts.iter().map(|&start| usize::from(start <= whole)).sum::<usize>() - 1;
    let (start, length) = interval(starts, index);
    let within = (scaled - f64::from(start)) / f64::from(length);
    let point = (index as f64 + within) / N as f64;
    // The last one below 1, if rounding gives 1.
    let point = point.min(1.0 - f64::EPSILON / 2.0);
    Inverse { index, point, density: f64::from(length) * (N as f64 / f64::from(ONE)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Stream;
    use globillum_material::warp::CosineHemisphere;

    /// Ratios between 1/2 and 40, of which a few are large.
    fn example() -> Directions {
        let stream = Stream::new(1, 2, 3);
        Directions::new(&std::array::from_fn(|bin| 0.5 + 40.0 * stream.uniform(bin as u32).powi(8)))
    }

    /// `N x N` points of the unit square, one in each square of a grid.
    fn points<const N: u32>() -> impl Iterator<Item = [f64; 2]> {
        let stream = Stream::new(4, 5, 6);
        (0..N * N).map(move |i| {
            let [dx, dy] = stream.uniform_pair(2 * i);
            [(f64::from(i % N) + dx) / f64::from(N), (f64::from(i / N) + dy) / f64::from(N)]
        })
    }

    #[test]
    fn bins_are_those_of_the_unit_square() {
        for u in points::<300>() {
            let [ring, sector] = [(u[0] * RINGS as f64) as usize, (u[1] * SECTORS as f64) as usize];
            assert_eq!(bin_of(3.0 * CosineHemisphere::sample(u)), ring * SECTORS + sector, "{u:?}");
        }
    }

    /// Of `N x N` points, as many fall into a bin as its density says, but for those of squares on its border.
    #[test]
    fn warped_points_have_the_density_of_their_bins() {
        const N: u32 = 1000;
        let directions = example();
        let mut counts = [0.0; BINS];
        for u in points::<N>() {
            let (warped, ratio) = directions.warp(u);
            assert!(warped.iter().all(|x| (0.0..1.0).contains(x)));
            let w = CosineHemisphere::sample(warped);
            assert_eq!(ratio, directions.ratio(w), "{u:?}");
            counts[bin_of(w)] += 1.0 / f64::from(N * N);
        }
        for (bin, count) in counts.into_iter().enumerate() {
            let u = [bin / SECTORS, bin % SECTORS].map(|i| i as f64 + 0.5);
            let center = CosineHemisphere::sample([u[0] / RINGS as f64, u[1] / SECTORS as f64]);
            let expected = directions.ratio(center) / BINS as f64;
            assert!((count - expected).abs() < 4.0 / f64::from(N), "{bin}: {count} for {expected}");
        }
    }

    #[test]
    fn points_stay_below_one() {
        let directions = example();
        for u in [0.0, 1.0 - f64::EPSILON / 2.0] {
            let ([x, y], ratio) = directions.warp([u, u]);
            assert!((0.0..1.0).contains(&x) && (0.0..1.0).contains(&y) && ratio > 0.0);
        }
    }
}
