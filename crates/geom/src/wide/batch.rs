//! Many rays: coherent ones together, the others in turn.

use super::WideKdTree;
use super::goal::Goal;
use super::scratch::{Scratch, WIDTH};
use super::simd::Simd;
use super::wave::search_in_turn;
use crate::Ray;

/// Searches for every ray; `answer` says what of a finished search goes to `answers`, at the ray's place.
#[inline(always)]
pub(super) fn search_batch<S: Simd, Q: Goal, T: Clone + Default>(
    simd: S,
    tree: &WideKdTree,
    rays: &[Ray],
    answers: &mut Vec<T>,
    answer: impl Fn(Q) -> T,
) {
    answers.clear();
    answers.reserve(rays.len());
    Scratch::lend(
        #[inline(always)]
        |Scratch { traces, pencil, packet, starts }| {
            starts.clear();
            for start in (0..rays.len()).step_by(WIDTH) {
                // Little by little, so that what is written twice is still at hand the second time.
                answers.resize(rays.len().min(start + WIDTH), T::default());
                let coherent = rays[start..].first_chunk().is_some_and(
                    #[inline(always)]
                    |set| {
                        let mut report = |i: usize, search| {
                            answers[start + i] = answer(search);
                            // The next rays are needed soon, and not at hand yet.
                            simd.prefetch(rays.as_ptr().wrapping_add(start + WIDTH + i));
                        };
                        pencil.search(simd, tree, set, &mut report)
                            || packet.search(simd, tree, set, &mut report)
                    },
                );
                if !coherent {
                    starts.push(start as u32);
                }
            }
            search_in_turn(simd, tree, rays, starts, traces, |i, search| answers[i] = answer(search));
        },
    );
}
