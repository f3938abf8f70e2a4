//! Building: a [binary tree](binary_tree) split by the [surface area heuristic](sah) is [collapsed](collapse) where
//! the [costs of lanes](collapse_cost) are least. Its upper levels are the planes of a [k-d tree](kd_to_bvh), or are split
//! between the cells of a [grid](grid_to_bvh).

mod binary_tree;
mod collapse;
mod collapse_cost;
mod grid_to_bvh;
mod kd_to_bvh;
mod sah;

use super::tree::Tree;
use super::tree::node::Child;
use crate::prim_ref::PrimRef;
use crate::{GeomError, KdOptions, KdTree, Triangles};
use binary_tree::BinaryTree;
use collapse::Collapse;

/// Builds the tree over the leaves of the k-d tree with these options.
pub(super) fn build(triangles: &Triangles, options: &KdOptions) -> Result<Tree, GeomError> {
    let (kd_tree, mut refs) = KdTree::build_with_refs(triangles, options)?;
    Child::check_references(kd_tree.references.len())?;
    let binary = BinaryTree::by_kd_tree(&kd_tree, &mut refs);
    Ok(collapse(triangles, &binary, &refs))
}

/// Builds the tree with the help of a grid instead of a k-d tree.
pub(super) fn build_by_grid(triangles: &Triangles) -> Result<Tree, GeomError> {
    let live = triangles.live();
    Child::check_references(live.len())?;
    let mut refs: Vec<PrimRef> = live.iter().map(|&i| PrimRef::new(triangles, i)).collect();
    let binary = BinaryTree::by_grid(&triangles.bounds(), &mut refs);
    Ok(collapse(triangles, &binary, &refs))
}

/// The tree of a binary tree with these contents.
fn collapse(triangles: &Triangles, binary: &BinaryTree, refs: &[PrimRef]) -> Tree {
    let triangles = triangles.clone();
    let Collapse { space, nodes, leaves, .. } = Collapse::run(&triangles, binary, refs);
    Tree { triangles, space, nodes, leaves }
}
