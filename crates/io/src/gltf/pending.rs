//! What a walk through a tree has yet to come back to, in few bytes for each level: a file can ask
//! for many.

use super::list::Indices;
use glam::DAffine3;

/// Children that are yet to be visited, and where their parents are in the world.
#[derive(Default)]
pub(super) struct Pending<'a> {
    levels: Stack<Level<'a>>,
    worlds: Stack<DAffine3>,
}

/// Children of one node.
struct Level<'a> {
    children: Indices<'a, true>,
    /// Whether their parent's transform lies on the stack; else it is that of the level below.
    has_world: bool,
}

impl<'a> Pending<'a> {
    /// Adds the children of a node that lies at `world`.
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

    /// Takes out the next child of the node that was added last, with where that node lies.
    pub(super) fn pop(&mut self) -> Option<(u32, DAffine3)> {
        let level = self.levels.last_mut()?;
        let child = level.children.next()?;
        let world = *self.worlds.last()?;
        // A level goes with its last child: a chain of nodes takes one.
        if level.children.is_empty() {
            if level.has_world {
                self.worlds.pop();
            }
            self.levels.pop();
        }
        Some((child, world))
    }
}

/// The sign of a zero counts: transforms that merely compare equal may place points differently.
fn bits(transform: &DAffine3) -> [u64; 12] {
    transform.to_cols_array().map(f64::to_bits)
}

/// A stack that grows block by block: what moves to grow takes its memory twice and three times.
struct Stack<T> {
    full: Vec<Vec<T>>,
    top: Vec<T>,
}

/// Elements in a block.
const BLOCK: usize = 256;

impl<T> Default for Stack<T> {
    fn default() -> Self {
        Self { full: Vec::new(), top: Vec::new() }
    }
}

impl<T> Stack<T> {
    fn push(&mut self, element: T) {
        if self.top.len() == BLOCK {
            self.full.push(std::mem::take(&mut self.top));
        }
        if self.top.capacity() == 0 {
            self.top.reserve_exact(BLOCK);
        }
        self.top.push(element);
    }

    fn pop(&mut self) -> Option<T> {
        let element = self.top.pop();
        // The top is empty only if all is, and stays for what comes next.
        if self.top.is_empty()
            && let Some(full) = self.full.pop()
        {
            self.top = full;
        }
        element
    }

    fn last(&self) -> Option<&T> {
        self.top.last()
    }

    fn last_mut(&mut self) -> Option<&mut T> {
        self.top.last_mut()
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
        assert_eq!((stack.full.len(), stack.last()), (3, Some(&(count - 1))));
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
        assert_eq!(pending.worlds.top.len(), 2);
        pending.push(children("[6,7]"), at(-0.0));
        pending.push(children("[]"), at(9.0));
        pending.push(children("[8]"), at(1.0));
        assert_eq!((pending.worlds.top.len(), pending.levels.top.len()), (3, 4));
        for (child, x) in [(8, 1.0), (6, -0.0), (7, -0.0), (4, -0.0), (5, -0.0), (2, 0.0), (3, 0.0)] {
            let (found, world) = pending.pop().unwrap();
            assert_eq!((found, bits(&world)), (child, bits(&at(x))));
        }
        assert!(pending.pop().is_none() && pending.worlds.last().is_none());
    }
}
