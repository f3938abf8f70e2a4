//! Single-ray traversal.

use super::leaf_test::{record, test_leaf};
use super::node_test::test_node;
use super::ray_setup::RaySetups;
use super::traversal_state::Traversal;
use crate::query::Query;
use crate::wide::simd::Simd;
use crate::wide::tree::Tree;
use crate::wide::tree::node::Child;
use crate::{Probe, Ray};

/// Answers the query of one ray, and tells `probe` what is done for it.
#[inline(always)]
pub(super) fn query_single<S: Simd, Q: Query, P: Probe>(
    simd: S,
    tree: &Tree,
    ray: &Ray,
    traversal: &mut Traversal,
    probe: &mut P,
) -> Q {
    let mut query = Q::new(ray);
    let mut setups = RaySetups::idle();
    let Ray { origin: o, direction: d, t_min, t_max } = *ray;
    let columns = [o.x, o.y, o.z, d.x, d.y, d.z, t_min, t_max].map(|x| [x]);
    setups.set(&columns, &tree.triangles.bounds(), &tree.space);
    let Some(setup) = setups.get(0) else { return query };
    traversal.begin(setup, 0);
    while Child::is_end(traversal.child) == 0 {
        if Child::is_block(traversal.child) == 0 {
            probe.visit();
            test_node::<S, Q>(simd, &tree.nodes, traversal);
            traversal.advance();
            continue;
        }
        probe.open();
        tree.listed(traversal.child).iter().for_each(|&index| probe.test(index));
        let hits = test_leaf(simd, tree, traversal);
        if hits.any() {
            record(simd, tree, ray, &hits, traversal, &mut query);
        }
        traversal.advance();
    }
    traversal.candidates.decide(traversal.t_end, ray, &tree.triangles, &mut query);
    query
}
