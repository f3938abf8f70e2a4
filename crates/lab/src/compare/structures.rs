//! The compared structures and their common options.

use super::measure::Contender;
use clap::Args;
use globillum::geom::{
    BruteForce, GridOptions, KdOptions, KdTree, SplitRule, Triangles, UniformGrid, WideBvh,
};
use globillum_testkit::accelerators::{Built, rule_options};

/// Options of the structures.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct Structures {
    /// Largest number of triangles of a cell that is not split
    #[arg(long, default_value_t = KdOptions::default().leaf_size)]
    leaf_size: u32,
    /// Cost of visiting an inner node, in units of deciding one triangle
    #[arg(long, default_value_t = KdOptions::default().traversal_cost)]
    traversal_cost: f64,
    /// Consecutive split planes that need not lower the cost by themselves, in the comparison of split rules
    #[arg(long, default_value_t = 1)]
    lookahead: u32,
    /// Bound of the fair rules on a cell's longest side over its shortest
    #[arg(long, default_value_t = KdOptions::default().max_aspect)]
    max_aspect: f64,
    /// Cells of the grid per triangle
    #[arg(long, default_value_t = GridOptions::default().density)]
    density: f64,
    /// Cells of the grid along each axis; overrides --density
    #[arg(long, value_name = "X,Y,Z", value_parser = resolution)]
    resolution: Option<[u32; 3]>,
    /// Also measure brute force, which is slow
    #[arg(long)]
    brute: bool,
}

impl Structures {
    /// The name and builder of each structure.
    pub(crate) fn contenders(self) -> Vec<Contender> {
        let mut all: Vec<Contender> = Vec::new();
        if self.brute {
            all.push(("brute force".to_owned(), Box::new(|t| Ok(Box::new(BruteForce::build(t))))));
        }
        let grid = self.grid();
        all.push((
            "uniform grid".to_owned(),
            Box::new(move |t| Ok(Box::new(UniformGrid::build_with(t, &grid)?))),
        ));
        let usual = self.usual_kd();
        all.push(("k-d tree".to_owned(), kd(usual)));
        all.push(("wide BVH".to_owned(), Box::new(|t| Ok(Box::new(WideBvh::build(t)?)))));
        all.extend(SplitRule::ALL.map(|rule| (format!("k-d tree, {}", name(rule)), kd(self.kd(rule)))));
        all
    }

    /// The options of the default tree.
    pub(crate) fn usual_kd(self) -> KdOptions {
        let mut options = self.kd(SplitRule::default());
        options.lookahead = KdOptions::default().lookahead;
        options
    }

    /// The options for comparing split rules.
    pub(crate) fn kd(self, rule: SplitRule) -> KdOptions {
        let mut options = rule_options(rule);
        options.leaf_size = self.leaf_size;
        options.traversal_cost = self.traversal_cost;
        options.lookahead = self.lookahead;
        options.max_aspect = self.max_aspect;
        options
    }

    pub(crate) fn grid(self) -> GridOptions {
        let mut options = GridOptions::default();
        options.density = self.density;
        options.resolution = self.resolution;
        options
    }
}

fn kd(options: KdOptions) -> Box<dyn Fn(&Triangles) -> Built> {
    Box::new(move |triangles| Ok(Box::new(KdTree::build_with(triangles, &options)?)))
}

/// The rule in words.
pub(crate) fn name(rule: SplitRule) -> &'static str {
    match rule {
        SplitRule::MedianOfSide => "median of side",
        SplitRule::MedianOfSpread => "median of spread",
        SplitRule::Midpoint => "midpoint",
        SplitRule::SlidingMidpoint => "sliding midpoint",
        SplitRule::Fair => "fair",
        SplitRule::SlidingFair => "sliding fair",
        SplitRule::SurfaceArea => "surface area",
        _ => "unknown rule",
    }
}

fn resolution(text: &str) -> Result<[u32; 3], String> {
    let numbers: Result<Vec<u32>, _> = text.split(',').map(str::parse).collect();
    let numbers = numbers.map_err(|error| error.to_string())?;
    numbers.try_into().map_err(|_| "expected three numbers separated by commas".to_owned())
}
