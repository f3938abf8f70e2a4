//! The splitting rules beside each other: what the surface area heuristic promises.
#![allow(clippy::print_stderr, reason = "a skipped test says so")]

use globillum::geom::{KdOptions, KdStats, KdTree, SplitRule, Triangle, Triangles};
use globillum_testkit::accelerators::rule_options;
use globillum_testkit::shapes;

fn stats(triangles: &Triangles, options: &KdOptions) -> KdStats {
    KdTree::build(triangles, options).expect("options in range").stats()
}

/// On scanned and curved meshes the surface area heuristic needs the fewest visits and the fewest
/// tests of all rules, and with its usual options the least cost of all trees.
fn assert_surface_area_is_best(name: &str, mesh: &[Triangle]) {
    let triangles = Triangles::new(mesh.to_vec()).expect("the mesh is good");
    let best = stats(&triangles, &rule_options(SplitRule::SurfaceArea));
    let usual = KdOptions::default();
    let usual_cost = stats(&triangles, &usual).expected_cost(usual.traversal_cost);
    for rule in SplitRule::ALL.into_iter().filter(|&rule| rule != SplitRule::SurfaceArea) {
        let other = stats(&triangles, &rule_options(rule));
        assert!(best.expected_visits < other.expected_visits, "{name}, {rule:?}: {best:?}, {other:?}");
        assert!(best.expected_tests < other.expected_tests, "{name}, {rule:?}: {best:?}, {other:?}");
        assert!(usual_cost < other.expected_cost(usual.traversal_cost), "{name}, {rule:?}");
    }
}

#[test]
fn the_surface_area_heuristic_is_best_on_a_statue() {
    assert_surface_area_is_best("statue", &shapes::statue(20_000).triangles());
}

#[test]
fn the_surface_area_heuristic_is_best_on_scanned_meshes() {
    for (name, mesh) in crate::scans::scans() {
        assert_surface_area_is_best(name, &mesh);
    }
}
