//! The nodes of a scene. Nothing recurses, so a chain of nodes may have any depth.

use super::document::Document;
use super::transform;
use crate::error::Result;
use crate::scene::loading::Loading;
use crate::{IoError, Place};
use glam::DAffine3;
use gltf::json::Node;
use std::mem::replace;

/// A node and its transform to world space.
pub(super) struct Placed<'a> {
    pub(super) index: usize,
    pub(super) node: &'a Node,
    pub(super) world: &'a DAffine3,
}

/// The nodes of the default scene: the scene that the file names, else its first scene. A file without scenes
/// has one scene of all nodes.
pub(super) struct Tree<'a> {
    nodes: &'a [Node],
    /// The nodes of the scene, depth first, children in the order of the file.
    order: Vec<usize>,
    /// The transform of each node of the scene to world space.
    worlds: Vec<DAffine3>,
}

impl<'a> Tree<'a> {
    /// Checks that the nodes are a tree and that all transforms of the scene are valid.
    pub(super) fn of(document: &'a Document, loading: &Loading<'_>) -> Result<Self> {
        let nodes = &document.nodes;
        let parents = parents(nodes, loading)?;
        refuse_cycles(nodes, &parents, loading)?;
        let order = depth_first(nodes, roots(document, &parents, loading)?);
        let mut worlds = vec![DAffine3::IDENTITY; nodes.len()];
        for &index in &order {
            let domain = |message| IoError::Domain { at: loading.at(Place::Node(index)), message };
            let local = transform::local(&nodes[index]).map_err(domain)?;
            let parent = parents[index].map_or(DAffine3::IDENTITY, |parent| worlds[parent as usize]);
            let world = parent * local;
            transform::check_range(&world).map_err(domain)?;
            worlds[index] = world;
        }
        Ok(Self { nodes, order, worlds })
    }

    /// All nodes of the scene, depth first, children in the order of the file.
    pub(super) fn placed(&self) -> impl Iterator<Item = Placed<'_>> {
        let placed = |&index: &usize| Placed { index, node: &self.nodes[index], world: &self.worlds[index] };
        self.order.iter().map(placed)
    }
}

/// The indices of a node's children.
fn children(node: &Node) -> impl DoubleEndedIterator<Item = usize> {
    node.children.iter().flatten().map(|child| child.value())
}

/// The parent of each node. Every index of a child is in range, and no node has two parents.
fn parents(nodes: &[Node], loading: &Loading<'_>) -> Result<Vec<Option<u32>>> {
    let mut parents = vec![None; nodes.len()];
    for (parent, node) in (0_u32..).zip(nodes) {
        for child in children(node) {
            let at = Place::Node(parent as usize);
            let child = loading.check_index(at, child as u64, nodes.len(), "nodes")?;
            if parents[child].replace(parent).is_some() {
                return Err(IoError::NotATree { at: loading.at(Place::Node(child)) });
            }
        }
    }
    Ok(parents)
}

fn parentless(parents: &[Option<u32>]) -> Vec<usize> {
    (0..parents.len()).filter(|&node| parents[node].is_none()).collect()
}

fn refuse_cycles(nodes: &[Node], parents: &[Option<u32>], loading: &Loading<'_>) -> Result<()> {
    let mut visited = vec![false; nodes.len()];
    for node in depth_first(nodes, parentless(parents)) {
        visited[node] = true;
    }
    let Some(mut node) = visited.iter().position(|visited| !visited) else { return Ok(()) };
    // A node that no root reaches lies on a cycle or below one. Its ancestors lead there.
    while let (false, Some(parent)) = (replace(&mut visited[node], true), parents[node]) {
        node = parent as usize;
    }
    Err(IoError::Cycle { at: loading.at(Place::Node(node)) })
}

/// The nodes below `roots` and these, in the order of a walk. `roots` are distinct and have no parents.
fn depth_first(nodes: &[Node], mut roots: Vec<usize>) -> Vec<usize> {
    let mut order = Vec::with_capacity(nodes.len());
    roots.reverse();
    let mut pending = roots;
    while let Some(node) = pending.pop() {
        order.push(node);
        pending.extend(children(&nodes[node]).rev());
    }
    order
}

/// The root nodes of the scene.
fn roots(document: &Document, parents: &[Option<u32>], loading: &Loading<'_>) -> Result<Vec<usize>> {
    let scenes = &document.scenes;
    if scenes.is_empty() && document.scene.is_none() {
        return Ok(parentless(parents));
    }
    let index = document.scene.map_or(0, |scene| scene.value());
    let index = loading.check_index(Place::DefaultScene, index as u64, scenes.len(), "scenes")?;
    let mut is_root = vec![false; parents.len()];
    let mut roots = Vec::with_capacity(scenes[index].nodes.len());
    for root in &scenes[index].nodes {
        let at = Place::Scene(index);
        let root = loading.check_index(at, root.value() as u64, parents.len(), "nodes")?;
        if replace(&mut is_root[root], true) || parents[root].is_some() {
            return Err(IoError::NotATree { at: loading.at(Place::Node(root)) });
        }
        roots.push(root);
    }
    Ok(roots)
}
