//! The nodes of a scene. The walk does not recurse, so a chain of nodes may have any depth. Only the parent
//! of each node stays in memory.

use super::document::Document;
use super::json::Node;
use super::list::Indices;
use super::pending::Pending;
use super::transform;
use crate::error::Result;
use crate::loading::Loading;
use crate::{IoError, Place};
use glam::DAffine3;
use std::num::NonZeroU32;

/// A node and its transform to world space.
pub(super) struct Placed<'a> {
    pub(super) index: usize,
    pub(super) node: Node<'a, true>,
    pub(super) world: DAffine3,
}

/// The nodes of the default scene: the scene that the file names, else its first scene. A file without scenes
/// has one scene of all nodes.
pub(super) struct Tree<'a> {
    document: &'a Document<'a>,
    parents: Parents,
    /// The root nodes of the scene; `None` for all nodes without a parent.
    roots: Option<Indices<'a, true>>,
    /// Whether a node of the scene has a camera.
    pub(super) has_cameras: bool,
}

impl<'a> Tree<'a> {
    /// Checks that the nodes are a tree and that all transforms are valid.
    pub(super) fn of(document: &'a Document<'a>, loading: &mut Loading<'_>) -> Result<Self> {
        let parents = Parents::of(document, loading)?;
        parents.refuse_cycles(loading)?;
        let roots = roots(document, &parents, loading)?;
        let mut tree = Self { document, parents, roots, has_cameras: false };
        let mut has_cameras = false;
        tree.walk(loading, |placed, _| {
            has_cameras |= placed.node.camera.is_some();
            Ok(())
        })?;
        tree.has_cameras = has_cameras;
        Ok(tree)
    }

    /// Visits all nodes depth first, children in the order of the file.
    pub(super) fn walk<'l>(
        &self,
        loading: &mut Loading<'l>,
        mut visit: impl FnMut(&Placed<'a>, &mut Loading<'l>) -> Result<()>,
    ) -> Result<()> {
        let mut pending = Pending::default();
        for root in self.roots() {
            let mut next = Some((root, DAffine3::IDENTITY));
            while let Some((index, parent)) = next {
                let index = index as usize;
                let Some(node) = self.document.nodes.get(index) else { break };
                let domain = |message| IoError::Domain { at: loading.at(Place::Node(index)), message };
                let world = parent * transform::local(&node).map_err(domain)?;
                transform::check_range(&world).map_err(domain)?;
                let placed = Placed { index, node, world };
                visit(&placed, loading)?;
                pending.push(placed.node.children, world);
                next = pending.pop();
            }
        }
        Ok(())
    }

    fn roots(&self) -> impl Iterator<Item = u32> {
        let all = self.roots.is_none().then(|| (0_u32..).zip(&self.parents.0));
        let parentless = all.into_iter().flatten().filter(|(_, parent)| parent.is_none());
        self.roots.iter().flat_map(Indices::clone).chain(parentless.map(|(root, _)| root))
    }
}

/// The index of each node's parent plus 1, in four bytes.
struct Parents(Vec<Option<NonZeroU32>>);

impl Parents {
    fn of(document: &Document<'_>, loading: &Loading<'_>) -> Result<Self> {
        let mut parents = Self(vec![None; document.nodes.len()]);
        for ((index, node), number) in document.nodes.iter().enumerate().zip(1..) {
            for child in node.children {
                let at = Place::Node(index);
                let child = loading.check_index(at, child.into(), parents.0.len(), "nodes")?;
                if std::mem::replace(&mut parents.0[child], NonZeroU32::new(number)).is_some() {
                    return Err(IoError::NotATree { at: loading.at(Place::Node(child)) });
                }
            }
        }
        Ok(parents)
    }

    /// `node` and its ancestors. Infinite if the node is its own ancestor.
    fn chain(&self, node: usize) -> impl Iterator<Item = usize> {
        std::iter::successors(Some(node), |&node| self.0[node].map(|parent| parent.get() as usize - 1))
    }

    /// Follows every chain of parents to its root or to a node of an earlier chain.
    fn refuse_cycles(&self, loading: &Loading<'_>) -> Result<()> {
        let mut visited = Flags::new(self.0.len());
        for start in 0..self.0.len() {
            let length = self.chain(start).take_while(|&node| !visited.replace(node)).count();
            // The chain is a cycle if it ends at one of its own nodes.
            let end = self.chain(start).nth(length);
            if let Some(node) = end.filter(|&end| self.chain(start).take(length).any(|node| node == end)) {
                return Err(IoError::Cycle { at: loading.at(Place::Node(node)) });
            }
        }
        Ok(())
    }
}

fn roots<'a>(
    document: &'a Document<'a>,
    parents: &Parents,
    loading: &Loading<'_>,
) -> Result<Option<Indices<'a, true>>> {
    let scenes = &document.scenes;
    if scenes.len() == 0 && document.scene.is_none() {
        return Ok(None);
    }
    let index = document.scene.unwrap_or(0);
    let index = loading.check_index(Place::File, index.into(), scenes.len(), "scenes")?;
    let Some(scene) = scenes.get(index) else { return Ok(None) };
    let mut is_root = Flags::new(parents.0.len());
    for root in scene.nodes.clone() {
        let root = loading.check_index(Place::Scene(index), root.into(), parents.0.len(), "nodes")?;
        if is_root.replace(root) || parents.0[root].is_some() {
            return Err(IoError::NotATree { at: loading.at(Place::Node(root)) });
        }
    }
    Ok(Some(scene.nodes))
}

/// A bit for each node.
struct Flags(Vec<u64>);

impl Flags {
    fn new(count: usize) -> Self {
        Self(vec![0; count.div_ceil(64)])
    }

    /// Sets a node's bit and returns its previous value.
    fn replace(&mut self, node: usize) -> bool {
        let (word, bit) = (&mut self.0[node / 64], 1 << (node % 64));
        let before = *word & bit != 0;
        *word |= bit;
        before
    }
}
