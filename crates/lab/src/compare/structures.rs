//! What is compared, and the options that all of it shares.

use super::measure::Contender;
use clap::Args;
use globillum::geom::{
    BruteForce, GridOptions, KdOptions, KdTree, SplitRule, Triangles, UniformGrid, WideKdTree,
};
use globillum_testkit::accelerators::{Built, rule_options};

/// Options of the structures.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct Structures {
    /// Leave a cell whole that holds so few triangles
    #[arg(long, default_value_t = KdOptions::default().leaf_size)]
    leaf_size: u32,
    /// Cost of visiting an inner node, in units of deciding one triangle
    #[arg(long, default_value_t = KdOptions::default().traversal_cost)]
    traversal_cost: f64,
    /// Planes in a row that need not pay by themselves, where rules are compared
    #[arg(long, default_value_t = 1)]
    lookahead: u32,
    /// The fair rules' bound on a cell's longest side over its shortest
    #[arg(long, default_value_t = KdOptions::default().max_aspect)]
    max_aspect: f64,
    /// The grid's cells for each triangle
    #[arg(long, default_value_t = GridOptions::default().density)]
    density: f64,
    /// The grid's cells along each axis, instead
    #[arg(long, value_name = "X,Y,Z", value_parser = resolution)]
    resolution: Option<[u32; 3]>,
    /// Also test every triangle for every ray, which is slow
    #[arg(long)]
    brute: bool,
}

impl Structures {
    /// The name of each structure, and how it is built.
    pub(crate) fn contenders(self) -> Vec<Contender> {
        let mut all: Vec<Contender> = Vec::new();
        if self.brute {
            all.push(("brute force".to_owned(), Box::new(|t| Ok(Box::new(BruteForce::build(t))))));
        }
        let grid = self.grid();
        all.push(("uniform grid".to_owned(), Box::new(move |t| Ok(Box::new(UniformGrid::build(t, &grid)?)))));
        let usual = self.usual_kd();
        all.push(("k-d tree".to_owned(), kd(usual)));
        all.push(("wide tree".to_owned(), Box::new(|t| Ok(Box::new(WideKdTree::build(t)?)))));
        all.extend(SplitRule::ALL.map(|rule| (format!("k-d tree, {}", name(rule)), kd(self.kd(rule)))));
        all
    }

    /// The options of a tree as it is by default.
    pub(crate) fn usual_kd(self) -> KdOptions {
        let mut options = self.kd(SplitRule::default());
        options.lookahead = KdOptions::default().lookahead;
        options
    }

    /// The options under which rules are compared.
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
    Box::new(move |triangles| Ok(Box::new(KdTree::build(triangles, &options)?)))
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
        _ => "another rule",
    }
}

fn resolution(text: &str) -> Result<[u32; 3], String> {
    let numbers: Result<Vec<u32>, _> = text.split(',').map(str::parse).collect();
    let numbers = numbers.map_err(|error| error.to_string())?;
    numbers.try_into().map_err(|_| "three numbers with commas between them are needed".to_owned())
}
