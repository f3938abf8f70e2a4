//! A k-d tree for many rays: eight cells a node, triangles by the block, searched in `f32` and
//! decided in `f64`.
//!
//! - [`subtrees`]: the cells of a binary tree; what a leaf holds is [halved](halve) until it fits
//!   into [`blocks`], and what many rays visit into smaller ones;
//! - [`collapse`]: they become the up to eight cells of a [`node`], in the scene's own [`space`];
//! - [`course`]: a ray in that space, with a bound for every error;
//! - [`step`] finds the cells of a node that a ray meets, [`filter`] the triangles of a block;
//! - a ray is searched for [`alone`]; of a [`batch`], coherent ones from one point in a [`pencil`], other
//!   coherent ones in a [`packet`], whose [`frustum`] meets nodes for all of them on its [`descent`], and
//!   others in a [`wave`] of many that take their steps in turn;
//! - [`candidates`]: what is left, a triangle a hit and mostly none otherwise, is decided, for
//!   coherent rays eight at a time ([`verdicts`]).
//!
//! All of it is written once, over the vectors of [`simd`], for the [`level`] that the machine has.

mod alone;
mod batch;
mod blocks;
mod candidates;
mod collapse;
mod course;
mod descent;
mod filter;
mod frustum;
mod goal;
mod halve;
mod leaf;
mod level;
mod node;
mod packet;
mod pencil;
mod scratch;
#[allow(unsafe_code)]
mod simd;
mod slots;
mod space;
mod step;
mod subtrees;
mod trace;
mod verdicts;
mod wave;

pub use level::SimdLevel;

use crate::search::{Any, Closest};
use crate::{Aabb, Accel, GeomError, Hit, KdOptions, KdTree, Probe, Ray, SplitRule, Traverse, Triangles};
use alone::search_alone;
use batch::search_batch;
use blocks::Blocks;
use collapse::Collapse;
use level::Token;
use node::{Child, Node};
use simd::Simd;
use space::Space;
use subtrees::Subtrees;

/// A [`KdTree`] whose nodes hold up to eight cells each, in the boxes of what these hold. Planes part
/// the scene down to cells of some hundred triangles; below, these are grouped by where they are, and
/// tested eight at a time.
///
/// Made for batches: many rays are searched for in turn, so that their waiting overlaps, and 64 in a row
/// that take nearly the same way (counted from the batch's beginning) are searched for together.
///
/// The search uses the best vector instructions of the machine it runs on; the answers are the same
/// with any.
#[derive(Clone, Debug)]
pub struct WideKdTree {
    triangles: Triangles,
    space: Space,
    nodes: Vec<Node>,
    blocks: Blocks,
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
        let (tree, mut members) = KdTree::build_with_members(triangles, options)?;
        Child::check_references(tree.references.len())?;
        let triangles = triangles.clone();
        let space = Space::new(&triangles.bounds());
        let subtrees = Subtrees::new(&tree, &mut members);
        let Collapse { nodes, blocks, .. } = Collapse::run(&triangles, &subtrees, &members, space);
        Ok(Self { triangles, space, nodes, blocks, token: Token::new(SimdLevel::Avx512) })
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

    /// The triangles of a block.
    fn listed(&self, child: u32) -> &[u32] {
        let (first, count) = Child::block(child);
        self.blocks.indices(first, count)
    }

    /// Where a child is, found without a branch, which would be mispredicted.
    #[inline(always)]
    fn address(&self, child: u32) -> *const u8 {
        let (nodes, blocks) = (self.nodes.as_ptr().cast::<u8>(), self.blocks.as_ptr());
        let (place, is_block) = ((child & Child::PLACE) as usize, Child::is_block(child) as usize);
        let (starts, sizes) = ([nodes, blocks], [size_of::<Node>(), Blocks::STRIDE]);
        starts[is_block & 1].wrapping_add(place * sizes[is_block & 1])
    }
}

/// Runs an expression compiled for the tree's level, with the vectors of that level at hand.
macro_rules! vectorized {
    ($tree:expr, |$simd:ident| $search:expr) => {
        match $tree.token {
            Token::Portable($simd) => $simd.vectorize(
                #[inline(always)]
                || $search,
            ),
            #[cfg(target_arch = "x86_64")]
            Token::Avx2($simd) => $simd.vectorize(
                #[inline(always)]
                || $search,
            ),
            #[cfg(target_arch = "x86_64")]
            Token::Avx512($simd) => $simd.vectorize(
                #[inline(always)]
                || $search,
            ),
        }
    };
}

impl Traverse for WideKdTree {
    fn closest<P: Probe>(&self, ray: &Ray, probe: &mut P) -> Option<Hit> {
        vectorized!(self, |simd| search_alone::<_, Closest, P>(simd, self, ray, probe)).hit()
    }

    fn any<P: Probe>(&self, ray: &Ray, probe: &mut P) -> bool {
        vectorized!(self, |simd| search_alone::<_, Any, P>(simd, self, ray, probe)).found()
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
        vectorized!(self, |simd| search_batch(simd, self, rays, hits, |search: Closest| search.hit()));
    }

    fn occluded_batch(&self, rays: &[Ray], occluded: &mut Vec<bool>) {
        vectorized!(self, |simd| search_batch(simd, self, rays, occluded, |search: Any| search.found()));
    }

    fn bounds(&self) -> Aabb {
        self.triangles.bounds()
    }

    fn bytes(&self) -> usize {
        self.triangles.bytes() + size_of_val(&*self.nodes) + self.blocks.bytes()
    }
}
