//! The state of one ray's traversal: its current child, and a stack of children still to be visited.

use super::deferred_decision::Candidates;
use super::ray_setup::RaySetup;
use crate::accel::query::Query;
use crate::accel::wide::simd::{LANES, Simd, SimdBase};
use crate::accel::wide::tree::MAX_LEVELS;
use crate::accel::wide::tree::node::Child;
use crate::{KdTree, Ray};

/// The stack's size: at most one node for each level, and the entry that ends the traversal.
const DEPTH: usize = 128;
const _: () = assert!((KdTree::MAX_DEPTH + MAX_LEVELS) as usize + 2 <= DEPTH);

/// The children of a node, from near to far, and where the ray enters them.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug)]
struct StackEntry {
    starts: [f32; LANES],
    children: [u32; LANES],
}

impl StackEntry {
    /// Ends every traversal.
    const END: Self = Self { starts: [0.0; LANES], children: [Child::END; LANES] };
}

/// The children of a node whose bounds a ray meets, in the order in which it visits them.
pub(super) struct MetChildren<S: Simd> {
    /// Where the ray enters the bounds of each child, those that it misses included.
    pub(super) starts: S::F,
    pub(super) children: S::I,
    /// Those that the ray meets, a bit each.
    pub(super) mask: u8,
    /// The first of these; without meaning if there are none.
    pub(super) nearest: u32,
}

/// The traversal of a ray.
#[repr(C, align(64))]
#[derive(Debug)]
pub(super) struct Traversal {
    // The first cache line holds what a node test needs: these and the first numbers of the setup.
    /// The current child: the nearest one left.
    pub(super) child: u32,
    /// Hits beyond this cannot matter.
    pub(super) limit: f32,
    pub(super) setup: RaySetup,
    pub(super) candidates: Candidates,
    /// The index of the ray.
    pub(super) ray: u32,
    /// The triangles that the ray excludes.
    pub(super) excluded: [u32; 2],
    depth: usize,
    /// The children of each entry that are still to be visited, a bit each.
    pending: [u8; DEPTH],
    entries: [StackEntry; DEPTH],
}

impl Traversal {
    pub(super) fn idle() -> Self {
        Self {
            child: Child::END,
            limit: 0.0,
            setup: RaySetup::default(),
            candidates: Candidates::default(),
            ray: 0,
            excluded: [Ray::NO_TRIANGLE; 2],
            depth: 0,
            pending: [0; DEPTH],
            entries: [StackEntry::END; DEPTH],
        }
    }

    /// Starts at the root, for `ray` of index `index`.
    #[inline(always)]
    pub(super) fn begin(&mut self, setup: RaySetup, index: u32, ray: &Ray) {
        (self.child, self.setup, self.limit) = (Child::ROOT, setup, setup.end);
        (self.ray, self.excluded) = (index, ray.excluded);
        self.clear();
    }

    /// Drops all children but the current one, and all candidates.
    #[inline(always)]
    pub(super) fn clear(&mut self) {
        self.go_to(self.child);
        self.candidates.clear();
    }

    /// Drops all children but this one.
    #[inline(always)]
    pub(super) fn go_to(&mut self, child: u32) {
        self.child = child;
        self.pending[0] = 1;
        self.depth = 1;
    }

    /// Pushes the children of a node that the ray meets.
    #[inline(always)]
    pub(super) fn push<S: Simd, Q: Query>(
        &mut self,
        MetChildren { starts, children, mask, .. }: MetChildren<S>,
    ) {
        let top = self.depth % DEPTH;
        if !Q::ANY_HIT {
            starts.store_array(&mut self.entries[top].starts);
        }
        children.store_array(&mut self.entries[top].children);
        self.pending[top] = mask;
        self.depth = top + usize::from(mask != 0);
    }

    /// Pushes the children of a node that the ray meets, and moves on to the nearest child left: as [`Traversal::push`]
    /// and [`Traversal::advance`], but faster where no other ray hides latency, since the nearest child of the node does
    /// not wait for the stack.
    #[inline(always)]
    pub(super) fn descend<S: Simd, Q: Query>(&mut self, met: MetChildren<S>) {
        if met.mask == 0 {
            self.advance();
            return;
        }
        let (nearest, mask) = (met.nearest, met.mask & (met.mask - 1));
        self.push::<S, Q>(MetChildren { mask, ..met });
        self.child = nearest;
    }

    /// Moves on to the nearest child left.
    #[inline(always)]
    pub(super) fn advance(&mut self) {
        let top = self.depth.wrapping_sub(1) % DEPTH;
        let pending = self.pending[top];
        self.child = self.entries[top].children[pending.trailing_zeros() as usize % LANES];
        let pending = pending & pending.wrapping_sub(1);
        self.pending[top] = pending;
        self.depth = top + usize::from(pending != 0);
    }

    /// Drops children that the ray enters beyond `limit`.
    #[inline(always)]
    pub(super) fn drop_beyond<S: Simd>(&mut self, simd: S) {
        let limit = simd.splat(self.limit);
        let depth = self.depth.min(DEPTH);
        self.depth = 1;
        for at in 1..depth {
            let pending = self.pending[at] & simd.le(simd.load(&self.entries[at].starts), limit);
            if pending != 0 {
                let to = self.depth % DEPTH;
                self.pending[to] = pending;
                self.entries[to] = self.entries[at];
                self.depth += 1;
            }
        }
    }
}
