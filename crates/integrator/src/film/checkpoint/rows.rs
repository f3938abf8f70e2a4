//! A row of tiles as bytes: for each node how its halves differ, then for each pixel the sum of three components
//! and, if there are several observations, their spread, and then that of each block of 4 x 4 pixels; then a checksum.

use super::bytes::{ByteReader, sealed, unsealed};
use crate::CheckpointError;
use crate::film::dispersion::{Blocks, Halves};
use crate::film::pass_node::{PassNode, PassNodeHeader};
use crate::film::{Film, Moments};
use globillum_material::Rgb;

/// Bytes of three numbers.
const TRIPLE_BYTES: u64 = 24;

/// The bytes of a film of one row of tiles with these nodes.
pub(super) fn length(rows: &Film, nodes: &[PassNodeHeader]) -> u64 {
    let pixels = rows.pixel_count() as u64;
    let blocks = Blocks::of_means(rows.width()).count(rows.pixel_count()) as u64;
    let triples = |node| 1 + pixels + if has_spread(node) { pixels + blocks } else { 0 };
    TRIPLE_BYTES * nodes.iter().map(triples).sum::<u64>() + 8
}

/// One observation does not spread.
fn has_spread(node: &PassNodeHeader) -> bool {
    node.tally.observations > 1
}

/// Row `index` of the rows of tiles of `film`.
pub(super) fn to_bytes(film: &Film, index: usize, seed: u64) -> Vec<u8> {
    let mut bytes = Vec::new();
    let means = Blocks::of_means(film.width());
    for node in film.nodes() {
        let Halves { spread, squared, fourths } = node.halves[index];
        bytes.extend([spread, squared, fourths].into_iter().flat_map(f64::to_le_bytes));
        let Some(pixels) = means.tile_rows(&node.pixels).nth(index) else { continue };
        for Moments { sum, spread } in pixels {
            bytes.extend(sum.to_array().into_iter().flat_map(f64::to_le_bytes));
            if has_spread(&node.header) {
                bytes.extend(spread.to_array().into_iter().flat_map(f64::to_le_bytes));
            }
        }
        if has_spread(&node.header) {
            let blocks = means.of_tile_row(&node.blocks, index).iter();
            bytes.extend(blocks.flat_map(|spread| spread.to_array()).flat_map(f64::to_le_bytes));
        }
    }
    sealed(seed, bytes).0
}

/// Adds `nodes` to `rows`, a film of one row of tiles without passes, from `bytes` of the right length.
pub(super) fn from_bytes(
    mut rows: Film,
    nodes: &[PassNodeHeader],
    bytes: &[u8],
    seed: u64,
) -> Result<Film, CheckpointError> {
    let (content, _) = unsealed(seed, bytes)?;
    let mut numbers = ByteReader(content);
    for &header in nodes {
        let halves = Halves { spread: numbers.f64()?, squared: numbers.f64()?, fourths: numbers.f64()? };
        if !halves.are_possible() {
            return Err(CheckpointError::Malformed("dispersion"));
        }
        let mut pixels = Vec::with_capacity(rows.pixel_count());
        for _ in 0..rows.pixel_count() {
            let sum = numbers.rgb()?;
            let spread = if has_spread(&header) { numbers.rgb()? } else { Rgb::BLACK };
            let moments = Moments { sum, spread };
            if !moments.are_possible() {
                return Err(CheckpointError::Malformed("radiance"));
            }
            pixels.push(moments);
        }
        let mut blocks = vec![Rgb::BLACK; Blocks::of_means(rows.width()).count(pixels.len())];
        if has_spread(&header) {
            for spread in &mut blocks {
                *spread = numbers.rgb()?;
                if !(Moments { sum: Rgb::BLACK, spread: *spread }).are_possible() {
                    return Err(CheckpointError::Malformed("radiance"));
                }
            }
        }
        rows.insert(PassNode { header, pixels, blocks, halves: vec![halves] });
    }
    Ok(rows)
}
