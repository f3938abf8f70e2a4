//! Many rays: coherent ones together, the others in turn.

use super::WideKdTree;
use super::goal::Goal;
use super::scratch::{Scratch, WIDTH};
use super::simd::Simd;
use super::wave::search_in_turn;
use crate::Ray;

/// Searches for every ray, and hands each finished search to `report`.
#[inline(always)]
pub(super) fn search_batch<S: Simd, Q: Goal>(
    simd: S,
    tree: &WideKdTree,
    rays: &[Ray],
    mut report: impl FnMut(usize, Q),
) {
    Scratch::lend(
        #[inline(always)]
        |Scratch { traces, packet, starts }| {
            starts.clear();
            for start in (0..rays.len()).step_by(WIDTH) {
                let coherent = rays[start..].first_chunk().is_some_and(
                    #[inline(always)]
                    |set| packet.search(simd, tree, set, |i, search| report(start + i, search)),
                );
                if !coherent {
                    starts.push(start as u32);
                }
            }
            search_in_turn(simd, tree, rays, starts, traces, report);
        },
    );
}
