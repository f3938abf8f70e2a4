//! The accelerators under test. A new accelerator needs one line here.

use globillum_geom::{
    Aabb, Accel, BruteForce, Counts, GeomError, Hit, KdOptions, KdTree, Ray, SimdLevel, SplitRule, Traverse,
    Triangles, UniformGrid, WideBvh,
};
use std::fmt::Debug;

/// An accelerator whose traversal steps can be counted.
pub trait Measurable: Accel {
    /// [`Counts::closest`].
    fn count_closest(&self, ray: &Ray) -> (Option<Hit>, Counts);
    /// [`Counts::any`].
    fn count_any(&self, ray: &Ray) -> (bool, Counts);
}

impl<A: Traverse> Measurable for A {
    fn count_closest(&self, ray: &Ray) -> (Option<Hit>, Counts) {
        Counts::closest(self, ray)
    }
    fn count_any(&self, ray: &Ray) -> (bool, Counts) {
        Counts::any(self, ray)
    }
}

/// The result of a [`Builder`].
pub type Built = Result<Box<dyn Measurable>, GeomError>;

/// Builds an accelerator.
pub type Builder = fn(&Triangles) -> Built;

/// Every accelerator by name; the slow brute force comes first.
pub const ACCELERATORS: [(&str, Builder); 4] = [
    ("brute force", |t| Ok(Box::new(BruteForce::build(t)))),
    ("k-d tree", |t| Ok(Box::new(KdTree::build(t)?))),
    ("uniform grid", |t| Ok(Box::new(UniformGrid::build(t)?))),
    ("wide BVH", |t| wide(t, SimdLevel::best())),
];

/// The two of [`ACCELERATORS`] that tests render with.
pub const RENDERED: [(&str, Builder); 2] = [ACCELERATORS[3], ACCELERATORS[2]];

/// The wide BVH at lower instruction levels than the machine's best.
pub const LESSER_LEVELS: [(&str, Builder); 2] = [
    ("wide BVH, AVX2", |t| wide(t, SimdLevel::Avx2)),
    ("wide BVH, portable", |t| wide(t, SimdLevel::Portable)),
];

/// The wide BVH whose nodes are visited even if it has few triangles, at each instruction level.
pub const BY_NODES: [(&str, Builder); 3] = [
    ("wide BVH, by nodes", |t| by_nodes(WideBvh::build(t)?.with_level(SimdLevel::best()))),
    ("wide BVH, by nodes, AVX2", |t| by_nodes(WideBvh::build(t)?.with_level(SimdLevel::Avx2))),
    ("wide BVH, by nodes, portable", |t| by_nodes(WideBvh::build(t)?.with_level(SimdLevel::Portable))),
];

/// The wide BVH with split planes down to small cells, so that small scenes have planes, and by nodes. In the second, the
/// builder removes most planes again because they do not pay.
pub const SMALL_CELLS: [(&str, Builder); 2] = [
    ("wide BVH, small cells", |t| small_cells(t, SplitRule::SurfaceArea, 1.0)),
    ("wide BVH, small cells, midpoint", |t| small_cells(t, SplitRule::Midpoint, 8.0)),
];

/// The wide BVH built by a grid, by nodes.
pub const QUICK: [(&str, Builder); 1] =
    [("wide BVH, built quickly", |t| by_nodes(WideBvh::build_quickly(t)?))];

fn wide(triangles: &Triangles, level: SimdLevel) -> Built {
    Ok(Box::new(WideBvh::build(triangles)?.with_level(level)))
}

fn by_nodes(tree: WideBvh) -> Built {
    Ok(Box::new(tree.without_exhaustive_tests()))
}

/// The k-d tree by every split rule, with [`rule_options`].
pub const RULES: [(&str, Builder); 7] = [
    ("k-d tree, median of side", |t| by_rule(t, SplitRule::MedianOfSide)),
    ("k-d tree, median of spread", |t| by_rule(t, SplitRule::MedianOfSpread)),
    ("k-d tree, midpoint", |t| by_rule(t, SplitRule::Midpoint)),
    ("k-d tree, sliding midpoint", |t| by_rule(t, SplitRule::SlidingMidpoint)),
    ("k-d tree, fair", |t| by_rule(t, SplitRule::Fair)),
    ("k-d tree, sliding fair", |t| by_rule(t, SplitRule::SlidingFair)),
    ("k-d tree, surface area", |t| by_rule(t, SplitRule::SurfaceArea)),
];

/// All accelerators and variants.
pub fn all() -> impl Iterator<Item = (&'static str, Builder)> {
    ACCELERATORS.into_iter().chain(LESSER_LEVELS).chain(BY_NODES).chain(SMALL_CELLS).chain(QUICK).chain(RULES)
}

/// [`all`] of them in one: comparing its answers with an oracle's compares those of each, and asks the oracle
/// only once.
///
/// A query panics and names the accelerator whose answer differs from that of brute force in any bit.
#[derive(Debug)]
pub struct Unanimous {
    triangles: Triangles,
    accelerators: Vec<(&'static str, Box<dyn Measurable>)>,
}

impl Unanimous {
    /// Builds all accelerators.
    ///
    /// # Errors
    /// The first error of building one.
    pub fn build(triangles: &Triangles) -> Result<Self, GeomError> {
        let accelerators = all().map(|(name, build)| Ok((name, build(triangles)?)));
        Ok(Self { accelerators: accelerators.collect::<Result<_, _>>()?, triangles: triangles.clone() })
    }

    /// The common `answer` to the query `asked`; two answers with the same `bits` are equal.
    fn answer<T: Debug, B: PartialEq>(
        &self,
        asked: &dyn Debug,
        answer: impl Fn(&dyn Accel) -> T,
        bits: impl Fn(&T) -> B,
    ) -> T {
        let mut answers = self.accelerators.iter().map(|(name, accel)| (name, answer(accel)));
        let (_, first) = answers.next().expect("there are accelerators");
        for (name, other) in answers {
            let agrees = bits(&other) == bits(&first);
            assert!(agrees, "{name}: {other:?}, not {first:?}; {asked:?}; {:?}", self.triangles.as_slice());
        }
        first
    }
}

fn bits(hit: &Option<Hit>) -> Option<([u64; 3], u32)> {
    hit.map(|h| ([h.t, h.u, h.v].map(f64::to_bits), h.triangle))
}

impl Accel for Unanimous {
    fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.answer(ray, |accel| accel.intersect(ray), bits)
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.answer(ray, |accel| accel.occluded(ray), bool::clone)
    }

    fn intersect_batch(&self, rays: &[Ray], hits: &mut Vec<Option<Hit>>) {
        let batch = |accel: &dyn Accel| {
            let mut hits = Vec::new();
            accel.intersect_batch(rays, &mut hits);
            hits
        };
        *hits = self.answer(&rays, batch, |hits| hits.iter().map(bits).collect::<Vec<_>>());
    }

    fn occluded_batch(&self, rays: &[Ray], occluded: &mut Vec<bool>) {
        let batch = |accel: &dyn Accel| {
            let mut occluded = Vec::new();
            accel.occluded_batch(rays, &mut occluded);
            occluded
        };
        *occluded = self.answer(&rays, batch, Vec::clone);
    }

    fn bounds(&self) -> Aabb {
        self.triangles.bounds()
    }

    fn bytes(&self) -> usize {
        self.accelerators.iter().map(|(_, accel)| accel.bytes()).sum()
    }
}

/// The options for comparing split rules: one plane of lookahead. Without it the simple rules stop where one
/// plane cuts through all triangles.
pub fn rule_options(rule: SplitRule) -> KdOptions {
    let mut options = KdOptions::by_rule(rule);
    options.lookahead = 1;
    options
}

fn small_cells(triangles: &Triangles, rule: SplitRule, traversal_cost: f64) -> Built {
    let mut options = KdOptions::by_rule(rule);
    (options.leaf_size, options.lookahead, options.traversal_cost) = (4, 3, traversal_cost);
    by_nodes(WideBvh::build_with(triangles, &options)?)
}

fn by_rule(triangles: &Triangles, rule: SplitRule) -> Built {
    Ok(Box::new(KdTree::build_with(triangles, &rule_options(rule))?))
}
