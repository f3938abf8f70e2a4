//! Statistics of the k-d trees of all split rules.

use super::structures::{Structures, name};
use crate::table::table;
use anyhow::Result;
use globillum::geom::{KdTree, SplitRule, Triangles};
use std::io::Write;

/// Writes a table with a row for each split rule.
pub(crate) fn write(out: &mut impl Write, triangles: &Triangles, structures: &Structures) -> Result<()> {
    let mut table = table(&[
        "rule",
        "depth",
        "nodes",
        "leaves",
        "empty",
        "refs/tri",
        "empty volume",
        "aspect",
        "expected visits",
        "expected tests",
        "expected cost",
    ]);
    for rule in SplitRule::ALL {
        let options = structures.kd(rule);
        let stats = KdTree::build_with(triangles, &options)?.stats();
        table.add_row([
            name(rule).to_owned(),
            stats.depth.to_string(),
            stats.nodes.to_string(),
            stats.leaves.to_string(),
            stats.empty_leaves.to_string(),
            format!("{:.2}", stats.references_per_triangle),
            format!("{:.1} %", 100.0 * stats.empty_volume),
            format!("{:.1}", stats.aspect),
            format!("{:.1}", stats.expected_visits),
            format!("{:.1}", stats.expected_tests),
            format!("{:.1}", stats.expected_cost(options.traversal_cost)),
        ]);
    }
    Ok(writeln!(out, "{table}\n")?)
}
