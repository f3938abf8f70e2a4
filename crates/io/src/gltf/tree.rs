//! The nodes of a scene: no recursion, so that a chain of any depth can be walked.

use super::document::Document;
use super::transform;
use crate::loading::Loading;
use crate::{IoError, Place};
use glam::DAffine3;

/// A node that holds something, and where in the world it is.
pub(super) struct Placed {
    pub(super) node: usize,
    pub(super) world: DAffine3,
}

/// The nodes of the default scene that hold a mesh or a camera, depth first in the file's order.
///
/// The default scene is the one that the file names, else its first; without scenes it is all
/// nodes.
pub(super) fn walk(document: &Document<'_>, loading: &Loading<'_>) -> Result<Vec<Placed>, IoError> {
    let parents = parents(document, loading)?;
    refuse_cycles(&parents, loading)?;
    let mut placed = Vec::new();
    let mut pending: Vec<_> =
        roots(document, &parents, loading)?.into_iter().map(|r| (r, DAffine3::IDENTITY)).collect();
    pending.reverse();
    while let Some((index, parent)) = pending.pop() {
        let node = &document.nodes[index];
        let at = loading.at(Place::Node(index));
        let world = parent * transform::local(node, &at)?;
        transform::check_range(&world, &at)?;
        if node.mesh.is_some() || node.camera.is_some() {
            placed.push(Placed { node: index, world });
        }
        pending.extend(node.children.iter().rev().map(|&child| (child as usize, world)));
    }
    Ok(placed)
}

/// Each node's parent.
fn parents(document: &Document<'_>, loading: &Loading<'_>) -> Result<Vec<Option<u32>>, IoError> {
    let mut parents = vec![None; document.nodes.len()];
    for (parent, node) in document.nodes.iter().enumerate() {
        for &child in &node.children {
            let slot = existing(&mut parents, child, Place::Node(parent), loading)?;
            if slot.replace(parent as u32).is_some() {
                return Err(IoError::NotATree { at: loading.at(Place::Node(child as usize)) });
            }
        }
    }
    Ok(parents)
}

/// Follows every chain of parents up to its root, or to where another chain has been.
fn refuse_cycles(parents: &[Option<u32>], loading: &Loading<'_>) -> Result<(), IoError> {
    // By which chain, numbered from 1, a node was first met.
    let mut met = vec![0; parents.len()];
    for (start, chain) in (0..parents.len()).zip(1_u32..) {
        let mut next = Some(start);
        while let Some(node) = next {
            match met[node] {
                0 => met[node] = chain,
                earlier if earlier == chain => {
                    return Err(IoError::Cycle { at: loading.at(Place::Node(node)) });
                }
                _ => break,
            }
            next = parents[node].map(|parent| parent as usize);
        }
    }
    Ok(())
}

fn roots(
    document: &Document<'_>,
    parents: &[Option<u32>],
    loading: &Loading<'_>,
) -> Result<Vec<usize>, IoError> {
    let scenes = &document.scenes;
    if scenes.is_empty() && document.scene.is_none() {
        return Ok((0..parents.len()).filter(|&node| parents[node].is_none()).collect());
    }
    let index = document.scene.unwrap_or(0);
    let count = scenes.len();
    let scene = scenes.get(index as usize).ok_or_else(|| IoError::Index {
        at: loading.at(Place::File),
        index: index.into(),
        count,
        what: "scenes",
    })?;
    let mut is_root = vec![false; parents.len()];
    for &root in &scene.nodes {
        let seen = existing(&mut is_root, root, Place::Scene(index as usize), loading)?;
        if std::mem::replace(seen, true) || parents[root as usize].is_some() {
            return Err(IoError::NotATree { at: loading.at(Place::Node(root as usize)) });
        }
    }
    Ok(scene.nodes.iter().map(|&root| root as usize).collect())
}

/// What belongs to node `index`, which `place` refers to.
fn existing<'a, T>(
    of_nodes: &'a mut [T],
    index: u32,
    place: Place,
    loading: &Loading<'_>,
) -> Result<&'a mut T, IoError> {
    let count = of_nodes.len();
    of_nodes.get_mut(index as usize).ok_or_else(|| IoError::Index {
        at: loading.at(place),
        index: index.into(),
        count,
        what: "nodes",
    })
}
