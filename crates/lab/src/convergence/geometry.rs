//! Speed and error of ray-triangle tests, and the radiance of furnaces of extreme sizes and positions.

use super::furnace::{Loss, loss};
use super::plan::Plan;
use crate::accuracy::intersectors::{Intersector, MoellerTrumbore, Woop};
use crate::accuracy::measure::{Errors, errors, leaks, sliver_misses, time};
use globillum::geom::conformance::Target;
use globillum::geom::decide::Shear;
use globillum::glam::DVec3;
use globillum_testkit::accelerators::RENDERED;
use globillum_testkit::aimed::Ball;
use globillum_testkit::precision::Precision;
use indicatif::ProgressBar;

/// The measurements of a ray-triangle test.
pub(crate) struct Decision {
    pub(crate) name: &'static str,
    /// Median and fastest nanoseconds per test.
    pub(crate) nanoseconds: [f64; 2],
    /// Errors of `t`, in ulps of the test's own precision.
    pub(crate) ulps: Errors,
    /// One ulp of 1 in that precision.
    pub(crate) ulp: f64,
    /// Rays per million that leave a closed mesh, aimed from inside at its edges and at its vertices.
    pub(crate) leaks: [f64; 2],
    /// Percentage of missed slivers, 1e-8 wide.
    pub(crate) slivers: f64,
}

/// A furnace of radiance 5 with a size and position.
pub(crate) struct Furnace {
    pub(crate) half: f64,
    /// The center's coordinate on each axis.
    pub(crate) offset: f64,
    pub(crate) loss: Loss,
    /// The radiance that Mitsuba 3.9.1 renders (variant `scalar_rgb`, its own path integrator), where it was
    /// measured.
    pub(crate) mitsuba: Option<f64>,
}

/// All measurements of this module.
pub(crate) struct Geometry {
    pub(crate) decisions: [Decision; 3],
    pub(crate) sizes: Vec<Furnace>,
    pub(crate) offsets: Vec<Furnace>,
}

const SIZES: [(f64, Option<f64>); 9] = [
    (1e-12, None),
    (1e-6, None),
    (1e-4, Some(3.804)),
    (1e-3, Some(4.928)),
    (1.0, Some(5.005)),
    (1e3, None),
    (1e4, Some(5.005)),
    (1e6, None),
    (1e12, None),
];

const OFFSETS: [(f64, Option<f64>); 8] = [
    (0.0, Some(5.005)),
    (1.0, None),
    (1e1, None),
    (1e2, None),
    (1e3, None),
    (1e4, Some(3.803)),
    (1e5, Some(1.063)),
    (1e6, Some(1.071)),
];

impl Geometry {
    /// The number of steps by which [`Geometry::measure`] advances the progress bar.
    pub(crate) const STEPS: usize = 3 + SIZES.len() + OFFSETS.len();

    /// Measures everything.
    pub(crate) fn measure(plan: &Plan, bar: &ProgressBar) -> Self {
        bar.set_message("ray-triangle tests");
        let decisions = [
            decision::<MoellerTrumbore>(plan, bar),
            decision::<Woop>(plan, bar),
            decision::<Shear>(plan, bar),
        ];
        bar.set_message("furnaces");
        let furnace = |half, offset, mitsuba| {
            let loss = loss(RENDERED[0].1, half, DVec3::splat(offset), 2 * plan.side);
            bar.inc(1);
            Furnace { half, offset, loss, mitsuba }
        };
        Self {
            decisions,
            sizes: SIZES.map(|(half, mitsuba)| furnace(half, 0.0, mitsuba)).into(),
            offsets: OFFSETS.map(|(offset, mitsuba)| furnace(1.0, offset, mitsuba)).into(),
        }
    }
}

fn decision<I: Intersector>(plan: &Plan, bar: &ProgressBar) -> Decision {
    let timing = time::<I>(plan.seed);
    let [ulps, _] = errors::<I>(plan.seed, plan.rays);
    let ball = Ball::new(DVec3::ZERO, 1.0);
    let per_million = |count: u32| f64::from(count) * 1e6 / f64::from(plan.rays);
    let leaks = [Target::Edges, Target::Vertices]
        .map(|target| per_million(leaks::<I>(&ball, target, plan.seed, plan.rays)));
    let slivers = sliver_misses::<I>(1e-8, plan.seed, plan.rays);
    bar.inc(1);
    Decision {
        name: I::NAME,
        nanoseconds: [timing.median_ns, timing.fastest_ns],
        ulps,
        ulp: match I::PRECISION {
            Precision::Single => f32::EPSILON.into(),
            Precision::Double => f64::EPSILON,
        },
        leaks,
        slivers: 100.0 * f64::from(slivers.all) / f64::from(plan.rays),
    }
}
