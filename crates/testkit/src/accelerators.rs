//! The accelerators under test. A new accelerator needs one line here.

use globillum_geom::{
    Accel, BruteForce, Counts, GeomError, GridOptions, Hit, KdOptions, KdTree, Ray, SimdLevel, SplitRule,
    Traverse, Triangles, UniformGrid, WideKdTree,
};

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
    ("k-d tree", |t| Ok(Box::new(KdTree::build(t, &KdOptions::default())?))),
    ("uniform grid", |t| Ok(Box::new(UniformGrid::build(t, &GridOptions::default())?))),
    ("wide tree", |t| wide(t, SimdLevel::best())),
];

/// The accelerators that tests render with.
pub const STRUCTURES: [(&str, Builder); 2] = [ACCELERATORS[3], ACCELERATORS[2]];

/// The wide tree at lower instruction levels than the machine's best.
pub const LESSER_LEVELS: [(&str, Builder); 2] = [
    ("wide tree, AVX2", |t| wide(t, SimdLevel::Avx2)),
    ("wide tree, portable", |t| wide(t, SimdLevel::Portable)),
];

/// The wide tree with split planes down to small cells, so that small scenes have planes. In the second, the
/// builder removes most planes again because they do not pay.
pub const SMALL_CELLS: [(&str, Builder); 2] = [
    ("wide tree, small cells", |t| small_cells(t, SplitRule::SurfaceArea, 1.0)),
    ("wide tree, small cells, midpoint", |t| small_cells(t, SplitRule::Midpoint, 8.0)),
];

fn wide(triangles: &Triangles, level: SimdLevel) -> Built {
    Ok(Box::new(WideKdTree::build(triangles)?.with_level(level)))
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
    ACCELERATORS.into_iter().chain(LESSER_LEVELS).chain(SMALL_CELLS).chain(RULES)
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
    Ok(Box::new(WideKdTree::build_with(triangles, &options)?))
}

fn by_rule(triangles: &Triangles, rule: SplitRule) -> Built {
    Ok(Box::new(KdTree::build(triangles, &rule_options(rule))?))
}
