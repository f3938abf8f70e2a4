//! A bounding volume hierarchy of eight children for each node, for many rays: traversed in `f32` and decided in `f64`.
//!
//! - [`build`]: one tree, and others for dense parts that are tiny against the whole. Each is a k-d tree by the surface
//!   area heuristic (Wald and Havran, 2006) down to cells of a few hundred triangles, which are clipped to their cells
//!   (Havran and Bittner, 2002); below, object splits in bins (Wald, 2007) down to leaf blocks of up to eight triangles; or
//!   object splits throughout, first between the cells of a grid. The binary tree is collapsed into nodes of up to eight
//!   children at the least expected cost (Ylitie, Karras and Laine, 2017).
//! - [`tree`]: what traversal reads, which are nodes with the bounds of their children, and leaf blocks. The planes
//!   themselves are not kept.
//! - [`trace`]: a ray alone, a packet of 64 coherent rays (from a common origin for any query, from anywhere for any hit),
//!   or a stream of all other rays. In small trees, only packets from a common origin visit nodes; for other rays of a
//!   batch triangles are tested one by one, eight rays at a time. A conservative test in `f32` leaves few triangles, which
//!   are decided exactly (docs/numerics.md).
//! - [`simd`]: vectors of eight lanes. All of the above is written once over them, for each level of
//!   [`cpu`](crate::cpu).

mod build;
mod simd;
mod trace;
mod tree;

use crate::accel::by_query::accel_by_query;
use crate::accel::query::{AnyHit, ClosestHit, Query};
use crate::cpu::{SimdLevel, Token, vectorized};
use crate::{Accel, GeomError, Hit, KdOptions, QueryCounter, Ray, Traverse, Triangles};
use simd::PACKET;
use std::fmt;
use trace::{Scratch, query_one, query_others, query_others_exhaustively, query_packets};
use tree::Tree;

/// The most rays of a batch that are traversed together: traversal numbers them in 32 bits.
const MAX_RAYS: usize = 1 << 31;
/// The same if there are several trees, which bounds the memory for the rays that are left for the next one.
const MAX_RAYS_OF_SEVERAL: usize = 1 << 10;
const _: () = {
    let are_whole_packets = MAX_RAYS.is_multiple_of(PACKET) && MAX_RAYS_OF_SEVERAL.is_multiple_of(PACKET);
    assert!(are_whole_packets, "packets are counted from the start of the batch");
};

/// A wide bounding volume hierarchy, the fastest structure of this crate. Every node stores the bounds of up to eight
/// children.
///
/// [`WideBvh::build`] separates the scene into cells of a few hundred triangles by the planes of a [`KdTree`];
/// [`WideBvh::build_quickly`] sorts the triangles into the cells of a grid. Within a cell, object splits group the triangles
/// into leaf blocks of up to eight.
///
/// Batches are faster than single rays. Many rays are in flight at once, which hides memory latency; and 64 coherent rays
/// in a row are traversed as a packet: rays from one point that exclude no triangle, such as those of 8 x 8 pixels, and for
/// any-hit queries in trees of more than 96 triangles other rays as well, such as those from there to one light. Packets
/// are counted from the start of the batch. In trees of at most 96 triangles other rays of a batch visit no nodes:
/// triangles are tested one by one, eight rays at a time. Any-hit queries leave out those that the bounds of the eight
/// segments do not overlap.
///
/// A dense part that is tiny against the whole scene, such as a mesh beside a sun made of triangles (a *teapot in a
/// stadium*), has a tree of its own (docs/accelerators.md).
///
/// The tree is traversed with the best vector instructions of the machine; the answers are the same with any.
///
/// [`KdTree`]: crate::KdTree
#[derive(Clone)]
pub struct WideBvh {
    triangles: Triangles,
    /// One for each [dense part](build), after those of the parts within it, and last that of the rest.
    trees: Box<[Tree]>,
    token: Token,
}

impl WideBvh {
    /// Builds the tree by the surface area heuristic, with [`WideBvh::default_options`].
    ///
    /// Over `n` live triangles a closed mesh takes about `200 n` bytes on one thread, beside the triangles; long
    /// triangles at random, or many that overlap, up to `1000 n` (measured). The bound that
    /// [`WideBvh::build_with`] states holds for all.
    ///
    /// # Errors
    /// As [`WideBvh::build_with`].
    pub fn build(triangles: &Triangles) -> Result<Self, GeomError> {
        Self::build_with(triangles, &Self::default_options())
    }

    /// Builds a tree in a fifth to a third of the time of [`WideBvh::build`], without k-d planes: triangles are sorted into
    /// the cells of a uniform grid, and upper levels are split between cells. Queries take at most about a tenth longer
    /// (docs/performance.md).
    ///
    /// Over `n` live triangles a closed mesh takes about `140 n` bytes on one thread, beside the triangles (measured).
    /// The bounds that [`WideBvh::build_with`] states hold.
    ///
    /// # Errors
    /// [`GeomError::Budget`] for more than about 134 million triangles in one tree.
    pub fn build_quickly(triangles: &Triangles) -> Result<Self, GeomError> {
        Ok(Self::of(triangles, build::build_quickly(triangles)?))
    }

    /// The options of [`WideBvh::build`], for leaves that are split further: those of [`KdOptions::default`], with a
    /// [`traversal_cost`](KdOptions::traversal_cost) of 400 (measured, docs/performance.md). A cell of `n`
    /// triangles is divided only where a ray that meets it would test fewer than `n - 400` of them, or fewer than
    /// `n / 0.9 - 400` if the plane cuts off empty space.
    pub fn default_options() -> KdOptions {
        KdOptions { traversal_cost: 400.0, ..KdOptions::default() }
    }

    /// Builds a tree over the leaves of the [`KdTree`](crate::KdTree) with these options.
    ///
    /// [`WideBvh::default_options`] suit it. Those of a k-d tree, [`KdOptions::default`], divide cells down to a few
    /// triangles, which takes more time and memory.
    ///
    /// ```
    /// use globillum_geom::{SplitRule, Triangles, WideBvh};
    ///
    /// # let triangles = Triangles::new(Vec::new())?;
    /// let mut options = WideBvh::default_options();
    /// options.rule = SplitRule::SlidingMidpoint;
    /// let tree = WideBvh::build_with(&triangles, &options)?;
    /// # Ok::<(), globillum_geom::GeomError>(())
    /// ```
    ///
    /// Memory is bounded beforehand. Over `n` live triangles the k-d tree's leaves hold at most `b = 8 n` references (see
    /// [`KdTree::build_with`](crate::KdTree::build_with)), and this tree takes at most `296 b + 68 n + 2048` bytes: for
    /// each reference, a leaf block of one and a node of two children; 44 for each triangle of a tree of at most 96, and
    /// 192 for each eight of them that are projected along one axis; and 2048 more for each dense part. Building takes at
    /// most `1100 b + 2^17` bytes beside the triangles, on up to a hundred threads. For each reference these are two nodes
    /// of the k-d tree, a reference, and a box in a list with room for twice its length, 84 bytes; two binary nodes, 152; a
    /// leaf block of one, twice, 80; and a node, in a list with room for three times its length while it grows, 768. The
    /// rest is for the recursion. Earlier steps, which build the k-d tree and split its leaves, take less. In practice
    /// blocks and nodes are fuller: in the smallest cells, meshes and random triangles take 200 to 1700 `n` bytes
    /// (measured).
    ///
    /// # Errors
    /// As [`KdTree::build_with`](crate::KdTree::build_with), and [`GeomError::Budget`] for more than about 134 million
    /// references in one tree.
    pub fn build_with(triangles: &Triangles, options: &KdOptions) -> Result<Self, GeomError> {
        Ok(Self::of(triangles, build::build(triangles, options)?))
    }

    fn of(triangles: &Triangles, trees: Box<[Tree]>) -> Self {
        Self { triangles: triangles.clone(), trees, token: Token::new(SimdLevel::Avx512) }
    }

    /// The same tree, traversed with the instructions of `level`, or of the best level below it that this
    /// machine has.
    #[must_use]
    pub fn with_level(self, level: SimdLevel) -> Self {
        Self { token: Token::new(level), ..self }
    }

    /// The same tree, whose batches visit nodes even if it has few triangles. Tests compare both.
    #[cfg(feature = "conformance")]
    #[must_use]
    pub fn without_exhaustive_tests(mut self) -> Self {
        self.trees.iter_mut().for_each(Tree::always_visit_nodes);
        self
    }

    /// The instructions that it is traversed with.
    pub fn level(&self) -> SimdLevel {
        self.token.level()
    }
}

impl WideBvh {
    /// Answers the query of one ray in one tree after another, and tells `counter` what is done for it.
    fn query_one<Q: Query, C: QueryCounter>(&self, ray: &Ray, counter: &mut C) -> Q::Answer {
        let query_tree = |tree: &Tree, ray: &Ray, counter: &mut C| {
            vectorized!(self.token, |simd| query_one::<_, Q, C>(simd, tree, ray, counter)).answer()
        };
        let answer = query_tree(&self.trees[0], ray, counter);
        self.trees[1..].iter().fold(answer, |answer, tree| {
            Q::merge(answer, query_tree(tree, &Q::remaining(ray, answer), counter))
        })
    }

    /// Answers the query of every ray.
    fn query_batch<Q: Query>(&self, rays: &[Ray], answers: &mut Vec<Q::Answer>) {
        answers.clear();
        let (most, added) = match self.trees.len() {
            1 => (MAX_RAYS, 0),
            _ => (MAX_RAYS_OF_SEVERAL, rays.len().min(MAX_RAYS_OF_SEVERAL)),
        };
        answers.reserve(rays.len() + added);
        self.query_chunks::<Q>(rays.chunks(most), answers);
    }

    /// Adds the answers to the queries of all rays, those of a chunk in one tree after another.
    fn query_chunks<'a, Q: Query>(
        &self,
        chunks: impl Iterator<Item = &'a [Ray]>,
        answers: &mut Vec<Q::Answer>,
    ) {
        Scratch::lend(|scratch| {
            for rays in chunks {
                let first = answers.len();
                self.query_tree::<Q>(&self.trees[0], rays, scratch, answers);
                for tree in &self.trees[1..] {
                    let mut remaining = std::mem::take(&mut scratch.remaining);
                    remaining.clear();
                    let answered = rays.iter().zip(&answers[first..]);
                    remaining.extend(answered.map(|(ray, &answer)| Q::remaining(ray, answer)));
                    self.query_tree::<Q>(tree, &remaining, scratch, answers);
                    scratch.remaining = remaining;
                    let (before, added) = answers[first..].split_at_mut(rays.len());
                    before.iter_mut().zip(added).for_each(|(a, b)| *a = Q::merge(*a, *b));
                    answers.truncate(first + rays.len());
                }
            }
        });
    }

    /// Adds the answers to the queries of all rays in one tree. Packets, the stream and exhaustive tests are compiled apart:
    /// together they are slower.
    fn query_tree<Q: Query>(
        &self,
        tree: &Tree,
        rays: &[Ray],
        scratch: &mut Scratch,
        answers: &mut Vec<Q::Answer>,
    ) {
        let first = answers.len();
        vectorized!(self.token, |simd| query_packets::<_, Q>(simd, tree, rays, scratch, answers));
        let answers = &mut answers[first..];
        if tree.tests_exhaustively() {
            vectorized!(self.token, |simd| query_others_exhaustively::<_, Q>(
                simd, tree, rays, scratch, answers
            ));
        } else {
            vectorized!(self.token, |simd| query_others::<_, Q>(simd, tree, rays, scratch, answers));
        }
    }
}

impl Traverse for WideBvh {
    fn closest<C: QueryCounter>(&self, ray: &Ray, counter: &mut C) -> Option<Hit> {
        self.query_one::<ClosestHit, C>(ray, counter)
    }

    fn any<C: QueryCounter>(&self, ray: &Ray, counter: &mut C) -> bool {
        self.query_one::<AnyHit, C>(ray, counter)
    }
}

impl Accel for WideBvh {
    accel_by_query!();

    fn intersect_batch(&self, rays: &[Ray], hits: &mut Vec<Option<Hit>>) {
        self.query_batch::<ClosestHit>(rays, hits);
    }

    fn occluded_batch(&self, rays: &[Ray], occluded: &mut Vec<bool>) {
        self.query_batch::<AnyHit>(rays, occluded);
    }

    fn bytes(&self) -> usize {
        self.triangles.bytes() + size_of_val(&*self.trees) + self.trees.iter().map(Tree::bytes).sum::<usize>()
    }
}

/// Counts, not the nodes.
impl fmt::Debug for WideBvh {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("WideBvh")
            .field("triangles", &self.triangles.len())
            .field("trees", &self.trees.len())
            .field("nodes", &self.trees.iter().map(|tree| tree.nodes.len()).sum::<usize>())
            .field("level", &self.level())
            .field("bytes", &self.bytes())
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conformance::shapes::{icosphere, statue};
    use crate::conformance::{Seeded, Source};
    use crate::{BruteForce, Triangle};
    use glam::{DVec3, Vec3};

    #[test]
    fn a_batch_in_parts_has_the_answers_of_the_whole() {
        let triangles = Triangles::new(icosphere(3).triangles()).expect("a valid mesh");
        let tree = WideBvh::build(&triangles).expect("the tree can be built");
        let mut source = Seeded::new(0);
        let mut signed = || DVec3::new(source.signed(), source.signed(), source.signed());
        // Packets and single rays.
        let mut ray = |i: usize| {
            let is_coherent = i % (4 * PACKET) < 2 * PACKET;
            let [origin, target] = if is_coherent {
                [3.0 * DVec3::Z, DVec3::X + 0.1 * signed()]
            } else {
                [2.0 * signed(), signed()]
            };
            Ray::new(origin, target - origin)
        };
        let rays: Vec<Ray> = (0..1000).map(&mut ray).collect();
        let (mut whole, mut in_parts) = (Vec::new(), Vec::new());
        tree.intersect_batch(&rays, &mut whole);
        tree.query_chunks::<ClosestHit>(rays.chunks(3 * PACKET), &mut in_parts);
        assert!(whole.iter().any(Option::is_some) && whole.iter().any(Option::is_none));
        assert_eq!(in_parts, whole);
    }

    #[test]
    fn any_number_of_threads_builds_the_same_tree() {
        let triangles = Triangles::new(statue(20_000).triangles()).expect("a valid mesh");
        for build in [WideBvh::build, WideBvh::build_quickly] {
            let tree = |threads: usize| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
                let built = pool.install(|| build(&triangles)).expect("the tree can be built");
                format!("{:?}", built.trees)
            };
            let one = tree(1);
            assert!(one.len() > 1_000_000);
            assert!([2, 5].into_iter().all(|threads| one == tree(threads)));
        }
    }

    /// Triangles one behind the other, all of which a ray through their middle hits.
    fn stack(count: usize) -> Triangles {
        let at = |i: usize| Vec3::Z * i as f32;
        let triangle = |i| Triangle::new(at(i) - Vec3::ONE, at(i) + 2.0 * Vec3::X, at(i) + 2.0 * Vec3::Y);
        Triangles::new((0..count).map(triangle).collect()).expect("valid triangles")
    }

    /// As many possible hits as there can be, and more candidates than are kept.
    #[test]
    fn rays_may_hit_all_triangles() {
        let triangles = stack(96);
        let (tree, brute) = (WideBvh::build(&triangles).unwrap(), BruteForce::build(&triangles));
        let by_nodes = tree.clone().without_exhaustive_tests();
        let mut source = Seeded::new(3);
        let rays: Vec<Ray> = (0..77)
            .map(|i| {
                let aside = 0.3 * DVec3::new(source.signed(), source.signed(), 0.0);
                // From the front, from behind, and, beyond all precision, from afar.
                let origin = aside + DVec3::Z * [-3.0, 200.0, -1e16][i % 3];
                Ray::new(origin, DVec3::Z * if i % 3 == 1 { -1.0 } else { 1.0 })
                    .excluding([source.below(4) as u32, 95])
            })
            .collect();
        let (mut hits, mut of_nodes) = (Vec::new(), Vec::new());
        tree.intersect_batch(&rays, &mut hits);
        by_nodes.intersect_batch(&rays, &mut of_nodes);
        let expected: Vec<_> = rays.iter().map(|ray| brute.intersect(ray)).collect();
        assert!(expected.iter().all(Option::is_some));
        assert!(hits == expected && of_nodes == expected);
    }

    /// The nearer of two certain hits may have the larger lower bound, if the plane of the other is seen at a flat angle.
    #[test]
    fn a_hit_within_the_error_of_another_is_kept() {
        let across = |z: f32, slope: f32| {
            let at = |x: f32, y: f32| Vec3::new(x, y, z + slope * x);
            Triangle::new(at(-1.0, -1.0), at(2.0, -1.0), at(-1.0, 2.0))
        };
        let triangles = Triangles::new(vec![across(0.0, 1.7), across(1e-6, 0.0)]).expect("valid triangles");
        let tree = WideBvh::build(&triangles).expect("the tree can be built");
        let mut hits = Vec::new();
        let rays = [Ray::new(DVec3::new(1e-9, 0.1, 3.0), -DVec3::Z); 8];
        tree.intersect_batch(&rays, &mut hits);
        assert_eq!(hits, [BruteForce::build(&triangles).intersect(&rays[0]); 8]);
        assert_eq!(hits[0].expect("a hit").triangle, 1);
    }
}
