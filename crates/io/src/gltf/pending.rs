//! The stack of a walk through a tree. A level takes few bytes, since a file can have a deep tree.

use super::list::Indices;
use glam::DAffine3;

/// The children to visit, and the transforms of their parents to world space.
#[derive(Default)]
pub(super) struct Pending<'a> {
    levels: Stack<Level<'a>>,
    worlds: Stack<DAffine3>,
}

/// The children of one node.
struct Level<'a> {
    children: Indices<'a, true>,
    /// Whether the parent's transform is on the stack. Otherwise it equals that of the level below.
    has_world: bool,
}

impl<'a> Pending<'a> {
    /// Adds the children of a node with the transform `world`.
    pub(super) fn push(&mut self, children: Indices<'a, true>, world: DAffine3) {
        if children.is_empty() {
            return;
        }
        let has_world = self.worlds.last().is_none_or(|below| bits(below) != bits(&world));
        if has_world {
            self.worlds.push(world);
        }
        self.levels.push(Level { children, has_world });
    }

    /// Removes the next child of the last node, and returns it with the transform of that node.
    pub(super) fn pop(&mut self) -> Option<(u32, DAffine3)> {
        let level = self.levels.last_mut()?;
        let child = level.children.next()?;
        let world = *self.worlds.last()?;
        // A level is removed with its last child, so a chain of nodes takes one level.
        if level.children.is_empty() {
            if level.has_world {
                self.worlds.pop();
            }
            self.levels.pop();
        }
        Some((child, world))
    }
}

/// Compared by bits, since transforms that differ in the sign of a zero may place points differently.
fn bits(transform: &DAffine3) -> [u64; 12] {
    transform.to_cols_array().map(f64::to_bits)
}

/// A stack that grows by blocks. A growing vector would take up to three times the memory of its content.
/// Only the last block may be empty, and only if it is the only one.
struct Stack<T>(Vec<Vec<T>>);

/// Elements in a block.
const BLOCK: usize = 256;

impl<T> Default for Stack<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<T> Stack<T> {
    fn push(&mut self, element: T) {
        match self.0.last_mut() {
            Some(top) if top.len() < BLOCK => top.push(element),
            _ => {
                let mut top = Vec::with_capacity(BLOCK);
                top.push(element);
                self.0.push(top);
            }
        }
    }

    fn pop(&mut self) -> Option<T> {
        let element = self.0.last_mut()?.pop();
        // The first block stays for the nodes to come.
        if self.0.len() > 1 {
            self.0.pop_if(|top| top.is_empty());
        }
        element
    }

    fn last(&self) -> Option<&T> {
        self.0.last()?.last()
    }

    fn last_mut(&mut self) -> Option<&mut T> {
        self.0.last_mut()?.last_mut()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn a_stack_of_many_blocks_gives_back_what_it_took() {
        let mut stack = Stack::default();
        let count = 3 * BLOCK + 1;
        (0..count).for_each(|i| stack.push(i));
        assert_eq!((stack.0.len(), stack.last()), (4, Some(&(count - 1))));
        assert!((0..count).rev().all(|i| stack.pop() == Some(i)));
        assert_eq!((stack.pop(), stack.last()), (None, None));
    }

    #[test]
    fn children_come_in_order_with_their_parents_transform() {
        let children = |text| serde_json::from_str(text).unwrap();
        let at = |x| DAffine3::from_translation(DVec3::X * x);
        let mut pending = Pending::default();
        pending.push(children("[1,2,3]"), at(0.0));
        assert_eq!(pending.pop(), Some((1, at(0.0))));
        // Equal, but of another sign.
        pending.push(children("[4,5]"), at(-0.0));
        assert_eq!(pending.worlds.0[0].len(), 2);
        pending.push(children("[6,7]"), at(-0.0));
        pending.push(children("[]"), at(9.0));
        pending.push(children("[8]"), at(1.0));
        assert_eq!((pending.worlds.0[0].len(), pending.levels.0[0].len()), (3, 4));
        for (child, x) in [(8, 1.0), (6, -0.0), (7, -0.0), (4, -0.0), (5, -0.0), (2, 0.0), (3, 0.0)] {
            let (found, world) = pending.pop().unwrap();
            assert_eq!((found, bits(&world)), (child, bits(&at(x))));
        }
        assert!(pending.pop().is_none() && pending.worlds.last().is_none());
    }
}
