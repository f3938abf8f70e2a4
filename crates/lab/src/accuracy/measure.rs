//! Time and error of an intersector, the error against exact arithmetic.

use super::intersectors::Intersector;
use crate::timing::timed;
use globillum::geom::Triangle;
use globillum::geom::conformance::Target;
use globillum_exact::{self as exact, Crossing};
use globillum_testkit::aimed::{Aimed, Ball, ordinary, sliver};
use std::hint::black_box;

/// Mean and maximum of a set of errors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Errors {
    /// The mean.
    pub(crate) mean: f64,
    /// The largest.
    pub(crate) max: f64,
}

impl FromIterator<f64> for Errors {
    fn from_iter<I: IntoIterator<Item = f64>>(errors: I) -> Self {
        let (mut count, mut sum, mut max) = (0.0, 0.0, 0.0_f64);
        for error in errors {
            count += 1.0;
            sum += error;
            max = max.max(error);
        }
        Self { mean: sum / count, max }
    }
}

/// Errors of `t` and of the hit point over `count` [ordinary] cases, in ulps of the intersector's
/// own precision.
///
/// The error of `t` is in ulps of the exact `t`. The hit point is `origin + t * direction` computed in the
/// intersector's precision. Its error is that of the worst coordinate, in ulps of the largest coordinate, in
/// magnitude, of the ray's origin and the exact point.
pub(crate) fn errors<I: Intersector>(seed: u64, count: u32) -> [Errors; 2] {
    let cases = (0..count).filter_map(|index| errors_of::<I>(&ordinary(seed, index)));
    let (t, point): (Vec<f64>, Vec<f64>) = cases.unzip();
    [t, point].map(Errors::from_iter)
}

/// The errors of `t` and of the hit point of one case; `None` if there is no hit.
fn errors_of<I: Intersector>(case: &Aimed) -> Option<(f64, f64)> {
    let ray = &case.ray;
    let t = I::prepare(ray)?.intersect(&case.triangle)?.t;
    let exact = Crossing::with_plane(ray, &case.triangle)?;
    let t_error = exact::error(t, &exact.t) / I::PRECISION.ulp(exact::rounded(&exact.t));

    let (computed, point) = (I::PRECISION.point(ray, t).to_array(), exact.point(ray));
    let reach = point.iter().map(|x| exact::rounded(x).abs()).fold(ray.origin.abs().max_element(), f64::max);
    let worst = computed.iter().zip(&point).map(|(&c, p)| exact::error(c, p)).fold(0.0, f64::max);
    Some((t_error, worst / I::PRECISION.ulp(reach)))
}

/// Counts of rays that miss the sliver they are aimed at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Misses {
    /// Rays that hit nothing.
    pub(crate) all: u32,
    /// Rays that meet their sliver in exact arithmetic. The others pass it because they are rounded to the
    /// intersector's precision.
    pub(crate) meeting: u32,
    /// Rays that meet their sliver in exact arithmetic and hit nothing.
    pub(crate) wrong: u32,
}

/// Misses among `count` rays aimed at the centroids of [slivers](sliver) of this width.
pub(crate) fn sliver_misses<I: Intersector>(width: f64, seed: u64, count: u32) -> Misses {
    (0..count).map(|index| sliver(width, seed, index)).fold(Misses::default(), |misses, case| {
        let ray = I::prepare(&case.ray);
        let missed = ray.and_then(|ray| ray.intersect(&case.triangle)).is_none();
        let meets = exact::intersect(&I::PRECISION.round(&case.ray), &case.triangle).is_some();
        Misses {
            all: misses.all + u32::from(missed),
            meeting: misses.meeting + u32::from(meets),
            wrong: misses.wrong + u32::from(meets && missed),
        }
    })
}

/// The number of rays that hit nothing, of `count` rays aimed from inside `ball` at its edges or vertices.
pub(crate) fn leaks<I: Intersector>(ball: &Ball, target: Target, seed: u64, count: u32) -> u32 {
    let escapes = |index: &u32| {
        let Some(ray) = I::prepare(&ball.ray_at(target, seed, *index)) else { return true };
        !ball.triangles.iter().any(|triangle| ray.intersect(triangle).is_some_and(|hit| hit.t > 0.0))
    };
    (0..count).filter(escapes).count() as u32
}

/// Time per test.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Timing {
    /// Median over the runs, in nanoseconds.
    pub(crate) median_ns: f64,
    /// The fastest run, in nanoseconds; other load on the machine affects it least.
    pub(crate) fastest_ns: f64,
    /// Fraction of the tests that hit.
    pub(crate) hit_rate: f64,
}

/// Triangles of the timed leaf.
const LEAF_LEN: u32 = 64;
/// Rays of a run, prepared in advance.
const TIMED_RAYS: u32 = 4096;
/// Number of runs, of about five milliseconds each.
const RUNS: usize = 101;

/// Times the test alone, without the precomputation per ray: the closest hit of each ray among the triangles of
/// one leaf. The share of tests that hit is about that in the leaves of a k-d tree.
pub(crate) fn time<I: Intersector>(seed: u64) -> Timing {
    let leaf: Vec<Triangle> = (0..LEAF_LEN).map(|i| ordinary(seed, i).triangle).collect();
    let rays: Vec<I> =
        (0..TIMED_RAYS).filter_map(|i| I::prepare(&ordinary(seed, LEAF_LEN + i).ray)).collect();
    let tests = (leaf.len() * rays.len()) as f64;
    let hits = rays.iter().flat_map(|ray| leaf.iter().filter_map(|triangle| ray.intersect(triangle))).count();

    let mut runs: Vec<f64> = (0..RUNS).map(|_| timed(|| closest(&rays, &leaf)).1 * 1e9 / tests).collect();
    runs.sort_by(f64::total_cmp);
    Timing { median_ns: runs[RUNS / 2], fastest_ns: runs[0], hit_rate: hits as f64 / tests }
}

fn closest<I: Intersector>(rays: &[I], leaf: &[Triangle]) {
    for ray in black_box(rays) {
        let ts = black_box(leaf).iter().filter_map(|triangle| ray.intersect(triangle)).map(|hit| hit.t);
        black_box(ts.filter(|&t| t > 0.0).fold(f64::INFINITY, f64::min));
    }
}
