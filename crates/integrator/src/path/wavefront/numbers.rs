//! The random numbers of many paths, drawn side by side.

use crate::path::path_state::Path;
use crate::sampler::{BounceNumbers, Numbers};
use globillum_geom::SimdLevel;

/// How many paths' random numbers are computed at once.
const NUMBERS_AT_ONCE: usize = 8;

/// Fills `drawn` with the numbers of each path for a bounce, with one for roulette if `with_roulette`.
pub(super) fn draw_bounce_numbers(
    simd: SimdLevel,
    paths: &[Path],
    bounce: u32,
    with_roulette: bool,
    drawn: &mut Vec<BounceNumbers>,
) {
    draw_numbers(
        simd,
        paths,
        drawn,
        #[inline(always)]
        |samples| BounceNumbers::draw(samples, bounce, with_roulette),
    );
}

/// Fills `drawn` with what `draw` returns for the random numbers of each path.
pub(super) fn draw_numbers<T: Copy>(
    simd: SimdLevel,
    paths: &[Path],
    drawn: &mut Vec<T>,
    draw: impl Fn(&[Numbers; NUMBERS_AT_ONCE]) -> [T; NUMBERS_AT_ONCE],
) {
    drawn.clear();
    simd.run(
        #[inline(always)]
        || {
            for chunk in paths.chunks(NUMBERS_AT_ONCE) {
                let mut samples = [chunk[0].numbers; NUMBERS_AT_ONCE];
                for (sample, path) in samples.iter_mut().zip(chunk) {
                    *sample = path.numbers;
                }
                drawn.extend_from_slice(&draw(&samples)[..chunk.len()]);
            }
        },
    );
}
