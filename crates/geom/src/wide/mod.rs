//! A wide tree for many rays: k-d planes above, an 8-wide bounding volume hierarchy below, traversed in `f32`
//! and decided in `f64`.
//!
//! - [`build`]: a k-d tree by the surface area heuristic (Wald and Havran, 2006) down to cells of some hundred
//!   triangles, which are clipped to their cells; object splits in bins below (Wald, 2007), down to leaf blocks of up to
//!   eight triangles; the binary tree is collapsed into nodes of up to eight children where the expected cost is least
//!   (Ylitie, Karras and Laine, 2017).
//! - [`tree`]: what traversal reads, which are nodes with the bounds of their children, and leaf blocks. The planes are not
//!   stored.
//! - [`trace`]: a ray alone, a packet of 64 coherent rays from a common origin, or a stream of all other rays. A
//!   conservative test in `f32` leaves few triangles, which are decided exactly (docs/numerics.md).
//! - [`simd`]: vectors of eight lanes. All of the above is written once over them, for each level of
//!   [`cpu`](crate::cpu).

mod build;
#[allow(unsafe_code)]
mod simd;
mod trace;
mod tree;

use crate::cpu::{SimdLevel, Token};
use crate::query::{AnyHit, ClosestHit};
use crate::{Aabb, Accel, GeomError, Hit, KdOptions, Probe, Ray, SplitRule, Traverse, Triangles};
use trace::{query_batch, query_one};
use tree::Tree;

/// An 8-wide bounding volume hierarchy over the cells of a k-d tree: the fastest structure here for rays, and the
/// default of the integrator.
///
/// A [`KdTree`](crate::KdTree)'s planes separate the scene into cells of some hundred triangles. Below a cell, triangles are
/// grouped by an object split, down to blocks of up to eight. Every node stores the bounds of up to eight children.
///
/// Batches are faster than single rays: many rays are in flight at once, which hides memory latency, and 64
/// coherent rays from one point, such as those of 8 x 8 pixels (counted from the start of the batch), are traversed as
/// a packet.
///
/// It uses the best vector instructions of the machine; the answers are the same with any.
#[derive(Clone, Debug)]
pub struct WideKdTree {
    tree: Tree,
    token: Token,
}

impl WideKdTree {
    /// Builds the tree by the surface area heuristic, with options that suit it.
    ///
    /// Over `n` live triangles a closed mesh takes about `200 n` bytes on one thread, beside the triangles; long
    /// triangles at random, or many that overlap, up to `1000 n` (measured). The bound that
    /// [`WideKdTree::build_with`] states holds for all.
    ///
    /// # Errors
    /// As [`WideKdTree::build_with`].
    pub fn build(triangles: &Triangles) -> Result<Self, GeomError> {
        Self::build_with(triangles, &Self::options(SplitRule::SurfaceArea))
    }

    /// Builds a tree for previews, by sliding midpoint: sooner, for searches that may take a few per cent
    /// longer (docs/performance.md).
    ///
    /// # Errors
    /// As [`WideKdTree::build_with`].
    pub fn build_quickly(triangles: &Triangles) -> Result<Self, GeomError> {
        Self::build_with(triangles, &Self::options(SplitRule::SlidingMidpoint))
    }

    /// What suits leaves that are parted further: planes only where they save a ray that meets the cell more
    /// than 400 triangles, so none in cells that have fewer than 360 (measured, docs/performance.md).
    fn options(rule: SplitRule) -> KdOptions {
        KdOptions { traversal_cost: 400.0, ..KdOptions::by_rule(rule) }
    }

    /// Builds a tree of the cells of the [`KdTree`] with these options; what its leaves hold is parted
    /// into blocks.
    ///
    /// Memory is bounded beforehand. Over `n` live triangles the tree's leaves hold at most `b = 8 n`
    /// references (see [`KdTree::build`]), and it takes at most `296 b + 576` bytes: a block of one and a
    /// node of two cells for each. Building takes at most `1100 b + 2^17` bytes beside the triangles, on up
    /// to a hundred threads: for each of `b`, two of the k-d tree's nodes, a reference, and a box in a list
    /// that may hold twice its content, 84 bytes; two subtrees, 152; a block of one, twice, 80; and a node,
    /// in a list that holds up to three times its content while it grows, 768. The rest is for the way down to
    /// a node. What comes before takes less: building the k-d tree, and parting its leaves. Blocks and nodes
    /// are fuller than that: in the smallest cells, meshes and triangles at random take 200 to 1700 `n`
    /// (measured).
    ///
    /// # Errors
    /// As [`KdTree::build`], and [`GeomError::Budget`] for a tree with more than some 134 million
    /// references.
    pub fn build_with(triangles: &Triangles, options: &KdOptions) -> Result<Self, GeomError> {
        Ok(Self { tree: build::build(triangles, options)?, token: Token::new(SimdLevel::Avx512) })
    }

    /// The same tree, searched with the instructions of `level`, or the best below it that this
    /// machine has.
    #[must_use]
    pub fn with_level(self, level: SimdLevel) -> Self {
        Self { token: Token::new(level), ..self }
    }

    /// The instructions that it is searched with.
    pub fn level(&self) -> SimdLevel {
        self.token.level()
    }
}

/// Runs an expression, compiled for the tree's level; `$simd` is the token of that level.
macro_rules! vectorized {
    ($tree:expr, |$simd:ident| $query:expr) => {
        match $tree.token {
            Token::Portable($simd) => $simd.vectorize(
                #[inline(always)]
                || $query,
            ),
            #[cfg(target_arch = "x86_64")]
            Token::Avx2($simd) => $simd.vectorize(
                #[inline(always)]
                || $query,
            ),
            #[cfg(target_arch = "x86_64")]
            Token::Avx512($simd) => $simd.vectorize(
                #[inline(always)]
                || $query,
            ),
        }
    };
}

impl Traverse for WideKdTree {
    fn closest<P: Probe>(&self, ray: &Ray, probe: &mut P) -> Option<Hit> {
        vectorized!(self, |simd| query_one::<_, ClosestHit, P>(simd, &self.tree, ray, probe)).hit()
    }

    fn any<P: Probe>(&self, ray: &Ray, probe: &mut P) -> bool {
        vectorized!(self, |simd| query_one::<_, AnyHit, P>(simd, &self.tree, ray, probe)).found()
    }
}

impl Accel for WideKdTree {
    fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.closest(ray, &mut ())
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.any(ray, &mut ())
    }

    fn intersect_batch(&self, rays: &[Ray], hits: &mut Vec<Option<Hit>>) {
        vectorized!(self, |simd| query_batch(simd, &self.tree, rays, hits, |query: ClosestHit| query.hit()));
    }

    fn occluded_batch(&self, rays: &[Ray], occluded: &mut Vec<bool>) {
        vectorized!(self, |simd| query_batch(simd, &self.tree, rays, occluded, |query: AnyHit| query
            .found()));
    }

    fn bounds(&self) -> Aabb {
        self.tree.triangles.bounds()
    }

    fn bytes(&self) -> usize {
        self.tree.bytes()
    }
}
