//! Building: a [binary tree](kd_to_bvh) split by the [surface area heuristic](sah) is [collapsed](collapse) where
//! the [costs of lanes](collapse_cost) are least.

mod collapse;
mod collapse_cost;
mod kd_to_bvh;
mod sah;

use super::tree::Tree;
use super::tree::node::Child;
use super::tree::normalize::NormalizedSpace;
use crate::{GeomError, KdOptions, KdTree, Triangles};
use collapse::Collapse;
use kd_to_bvh::BinaryTree;

/// Builds the tree over the leaves of the k-d tree with these options.
pub(super) fn build(triangles: &Triangles, options: &KdOptions) -> Result<Tree, GeomError> {
    let (kd_tree, mut members) = KdTree::build_with_members(triangles, options)?;
    Child::check_references(kd_tree.references.len())?;
    let triangles = triangles.clone();
    let space = NormalizedSpace::new(&triangles.bounds());
    let binary = BinaryTree::new(&kd_tree, &mut members);
    let Collapse { nodes, leaves, .. } = Collapse::run(&triangles, &binary, &members, space);
    Ok(Tree { triangles, space, nodes, leaves })
}
