//! Building: a [binary tree](binary_tree) split by the [surface area heuristic](sah) is [collapsed](collapse) where
//! the [costs of lanes](collapse_cost) are least. Its upper levels are the planes of a [k-d tree](kd_to_bvh), or are split
//! between the cells of a [grid](grid_to_bvh). Dense parts that are tiny against the whole have [trees of their
//! own](dense_parts).

mod binary_tree;
mod collapse;
mod collapse_cost;
mod dense_parts;
mod grid_to_bvh;
mod kd_to_bvh;
mod sah;

use super::tree::Tree;
use super::tree::node::Child;
use super::tree::projected_triangle::ProjectedTriangles;
use crate::accel::prim_ref::PrimRef;
use crate::{GeomError, KdOptions, KdTree, Triangles};
use binary_tree::BinaryTree;
use collapse::Collapse;
use dense_parts::dense_parts;

/// Builds the trees over the leaves of k-d trees with these options, at least one.
pub(super) fn build(triangles: &Triangles, options: &KdOptions) -> Result<Box<[Tree]>, GeomError> {
    build_parts(triangles, |part| build_by_kd_tree(part, options))
}

/// Builds the trees with the help of grids instead of k-d trees.
pub(super) fn build_quickly(triangles: &Triangles) -> Result<Box<[Tree]>, GeomError> {
    build_parts(triangles, build_by_grid)
}

/// Builds the trees of all parts. They share the triangles of the scene, so that the lists of a part's triangles are freed.
fn build_parts(
    triangles: &Triangles,
    build: impl Fn(&Triangles) -> Result<Tree, GeomError>,
) -> Result<Box<[Tree]>, GeomError> {
    let parts = dense_parts(triangles);
    parts.iter().map(|part| Ok(Tree { triangles: triangles.clone(), ..build(part)? })).collect()
}

pub(super) fn build_by_kd_tree(triangles: &Triangles, options: &KdOptions) -> Result<Tree, GeomError> {
    let (kd_tree, mut refs) = KdTree::build_with_refs(triangles, options)?;
    Child::check_references(kd_tree.references.len())?;
    let binary = BinaryTree::by_kd_tree(&kd_tree, &mut refs);
    Ok(collapse(triangles, &binary, &refs))
}

fn build_by_grid(triangles: &Triangles) -> Result<Tree, GeomError> {
    let live = triangles.live();
    Child::check_references(live.len())?;
    let mut refs: Vec<PrimRef> = live.iter().map(|&i| PrimRef::new(triangles, i)).collect();
    let binary = BinaryTree::by_grid(&triangles.bounds(), &mut refs);
    Ok(collapse(triangles, &binary, &refs))
}

/// The tree of a binary tree with these contents.
fn collapse(triangles: &Triangles, binary: &BinaryTree, refs: &[PrimRef]) -> Tree {
    let Collapse { space, nodes, leaves, .. } = Collapse::run(triangles, binary, refs);
    let projected = ProjectedTriangles::of_few(triangles, &space);
    Tree { triangles: triangles.clone(), bounds: triangles.bounds(), space, nodes, leaves, projected }
}
