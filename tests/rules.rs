//! Compares the split rules: the surface area heuristic gives the lowest expected cost.
#![allow(clippy::print_stderr, reason = "reports skipped tests")]

use globillum::geom::{KdOptions, KdStats, KdTree, SplitRule, Triangle, Triangles};
use globillum_testkit::accelerators::rule_options;
use globillum_testkit::shapes;

fn stats(triangles: &Triangles, options: &KdOptions) -> KdStats {
    KdTree::build_with(triangles, options).expect("options in range").stats()
}

/// Asserts that the surface area heuristic has the fewest expected visits and the fewest expected tests of
/// all rules, and with the default options the lowest expected cost of all trees.
fn assert_surface_area_is_best(name: &str, mesh: &[Triangle]) {
    let triangles = Triangles::new(mesh.to_vec()).expect("the mesh is good");
    let best = stats(&triangles, &rule_options(SplitRule::SurfaceArea));
    let default = KdOptions::default();
    let default_cost = stats(&triangles, &default).expected_cost(default.traversal_cost);
    for rule in SplitRule::ALL.into_iter().filter(|&rule| rule != SplitRule::SurfaceArea) {
        let other = stats(&triangles, &rule_options(rule));
        assert!(best.expected_visits < other.expected_visits, "{name}, {rule:?}: {best:?}, {other:?}");
        assert!(best.expected_tests < other.expected_tests, "{name}, {rule:?}: {best:?}, {other:?}");
        assert!(default_cost < other.expected_cost(default.traversal_cost), "{name}, {rule:?}");
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
