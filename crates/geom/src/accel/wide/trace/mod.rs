//! Traversal, and the dispatch between its kinds: single rays, coherent rays from a [common origin](common_origin_packet)
//! as a packet, other coherent rays of any-hit queries as a [general packet](general_packet), and all other rays as a
//! [stream]. In small trees there are neither general packets nor streams, but
//! [tests of triangles without nodes](exhaustive).
//!
//! Single rays, streams and general packets share their setup, the tests of children and the state of a ray. Packets from a
//! common origin have tests of their own. All share the types of the [conservative triangle test](prefilter) and the
//! [exact decision](deferred_decision).

mod child_test;
mod common_origin_packet;
mod deferred_decision;
mod exhaustive;
mod general_packet;
mod prefilter;
mod ray_setup;
mod stream;
mod traversal_state;

use super::simd::{Aligned, PACKET, Simd, ray_numbers};
use super::tree::Tree;
use crate::accel::query::Query;
use crate::{QueryCounter, Ray};
use child_test::visit_all;
use common_origin_packet::CommonOriginScratch;
use exhaustive::ExhaustiveScratch;
use general_packet::GeneralPacketScratch;
use prefetch_index::prefetch_index;
use ray_setup::RaySetups;
use std::cell::Cell;
use stream::query_stream;
use traversal_state::Traversal;

/// Single-ray traversal: answers the query of one ray, and tells `counter` what is done for it.
#[inline(always)]
pub(super) fn query_one<S: Simd, Q: Query, C: QueryCounter>(
    simd: S,
    tree: &Tree,
    ray: &Ray,
    counter: &mut C,
) -> Q {
    let mut query = Q::new(ray);
    let mut setups = RaySetups::idle();
    let columns = Aligned(ray_numbers(ray).map(|x| [x]));
    setups.set(&columns, &tree.bounds, &tree.space);
    let Some(setup) = setups.get(0) else { return query };
    Scratch::lend(
        #[inline(always)]
        |scratch| {
            let traversal = &mut scratch.traversals[0];
            traversal.begin(setup, 0, ray);
            visit_all(simd, tree, ray, traversal, &mut query, counter);
            traversal.candidates.decide(traversal.limit, ray, &tree.triangles, &mut query);
        },
    );
    query
}

/// Answers the queries of coherent rays, a packet at a time, and leaves the other rays to [`query_others`] or
/// [`query_others_exhaustively`]. Adds an answer for each ray to `answers`, in the rays' order.
///
/// There are at most [`MAX_RAYS`](super::MAX_RAYS) rays.
#[inline(always)]
pub(super) fn query_packets<S: Simd, Q: Query>(
    simd: S,
    tree: &Tree,
    rays: &[Ray],
    Scratch { traversals, common_origin, general, set_starts, .. }: &mut Scratch,
    answers: &mut Vec<Q::Answer>,
) {
    let first = answers.len();
    set_starts.clear();
    for start in (0..rays.len()).step_by(PACKET) {
        // Packet by packet, so that answers are in the cache when they are overwritten.
        answers.resize(first + rays.len().min(start + PACKET), Q::Answer::default());
        let mut report = |i, query: Q| {
            answers[first + start + i] = query.answer();
            // The rays of the next packet, which are needed soon.
            prefetch_index(rays, start + PACKET + i);
        };
        let is_packet = rays[start..].first_chunk().is_some_and(
            #[inline(always)]
            |set| {
                common_origin.query(simd, tree, set, &mut report)
                    || Q::ANY_HIT
                        && !tree.tests_exhaustively()
                        && general.query(simd, tree, set, traversals, &mut report)
            },
        );
        if !is_packet {
            set_starts.push(start as u32);
        }
    }
}

/// Answers the queries that [`query_packets`] has left; `answers` are those of these rays.
#[inline(always)]
pub(super) fn query_others<S: Simd, Q: Query>(
    simd: S,
    tree: &Tree,
    rays: &[Ray],
    Scratch { traversals, set_starts, .. }: &mut Scratch,
    answers: &mut [Q::Answer],
) {
    query_stream(simd, tree, rays, set_starts, traversals, |i, query: Q| answers[i] = query.answer());
}

/// [`query_others`] for a [small tree](Tree::tests_exhaustively), of which all triangles are tested.
#[inline(always)]
pub(super) fn query_others_exhaustively<S: Simd, Q: Query>(
    simd: S,
    tree: &Tree,
    rays: &[Ray],
    Scratch { exhaustive, set_starts, .. }: &mut Scratch,
    answers: &mut [Q::Answer],
) {
    exhaustive.query(simd, tree, rays, set_starts, |i, query: Q| answers[i] = query.answer());
}

/// The memory that traversals work in, about 0.7 megabytes. Each thread that queries keeps one until it ends, so that later
/// queries do not allocate; it holds nothing between queries.
#[derive(Debug)]
pub(super) struct Scratch {
    /// One for each ray of a packet, of which streams use the first; on the heap, since they are large.
    traversals: Box<[Traversal; PACKET]>,
    common_origin: CommonOriginScratch,
    general: GeneralPacketScratch,
    /// Where in a batch the sets of rays start that are no packets, [`PACKET`] from each.
    set_starts: Vec<u32>,
    exhaustive: ExhaustiveScratch,
    /// The rays of a batch for the next of several trees.
    pub(super) remaining: Vec<Ray>,
}

thread_local! {
    static SCRATCH: Cell<Option<Box<Scratch>>> = const { Cell::new(None) };
}

impl Scratch {
    /// Lends this thread's to `work`.
    #[inline(always)]
    pub(super) fn lend<T>(work: impl FnOnce(&mut Self) -> T) -> T {
        // A query may come from the destructor of another of the thread's values, after that of this one.
        let kept = SCRATCH.try_with(Cell::take).ok().flatten();
        let mut scratch = kept.unwrap_or_else(Self::idle);
        let result = work(&mut scratch);
        let _ = SCRATCH.try_with(|kept| kept.set(Some(scratch)));
        result
    }

    #[cold]
    fn idle() -> Box<Self> {
        let traversals: Vec<Traversal> = (0..PACKET).map(|_| Traversal::idle()).collect();
        // A vector, since an array of half a megabyte would be built on the stack. The conversion cannot fail:
        // the vector has PACKET elements by construction.
        let traversals = traversals.into_boxed_slice().try_into().expect("as many as were made");
        Box::new(Self {
            traversals,
            common_origin: CommonOriginScratch::idle(),
            general: GeneralPacketScratch::idle(),
            set_starts: Vec::new(),
            exhaustive: ExhaustiveScratch::idle(),
            remaining: Vec::new(),
        })
    }
}
