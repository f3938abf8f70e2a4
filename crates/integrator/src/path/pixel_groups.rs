//! The groups of pixels that reuse each other's paths, and how their blocks are stratified.

use super::tile_bounds::{BLOCK_SIDE as SIDE, Tile};
use crate::sampler::Member;

/// The affine plane of order 4: five classes of parallel lines through the points `4 y + x`; any two
/// points lie on one line. Listed is the line of each class through 0. The others follow by adding, without
/// carry, a point of a line of another class. The first classes leap over rows and columns, since errors that rows of
/// pixels have in common are seen as streaks.
const LINES: [[u32; 4]; 5] = [[0, 6, 11, 13], [0, 7, 9, 14], [0, 5, 10, 15], [0, 1, 2, 3], [0, 4, 8, 12]];

/// Four pixels as indices into [`Tile::pixels`]; `None` for a pixel outside the tile.
pub(super) type PixelGroup = [Option<u32>; 4];

/// The part of a picture of `width` x `height` pixels that holds all groups of pixel (`x`, `y`).
pub(super) fn block_around(x: u32, y: u32, width: u32, height: u32) -> Tile {
    let start = |x: u32| x - x % SIDE;
    let length = |x: u32, end: u32| SIDE.min(end - start(x));
    Tile { x: start(x), y: start(y), width: length(x, width), height: length(y, height) }
}

/// The line through 0 by which blocks are divided in `pass`, and by what it is shifted to the others.
fn lines(pass: u32) -> ([u32; 4], [u32; 4]) {
    let class = pass as usize % LINES.len();
    (LINES[class], LINES[usize::from(class == 0)])
}

/// The pixels of a block as members of one net in `pass`, by their points: the first two of four digits are those of
/// the group, so that its samples are a net by themselves.
pub(super) fn members(pass: u32) -> [u32; 16] {
    let (line, across) = lines(pass);
    let mut members = [0; 16];
    for (number, (shift, point)) in
        (0..).zip(across.iter().flat_map(|shift| line.map(|point| (shift, point))))
    {
        members[(point ^ shift) as usize] = number;
    }
    members
}

/// Pixel (`x`, `y`) of a picture of this width as one of [`members`].
pub(super) fn member(x: u32, y: u32, width: u32, members: &[u32; 16]) -> Member {
    let net = u64::from(y / SIDE) * u64::from(width.div_ceil(SIDE)) + u64::from(x / SIDE);
    Member { net, number: members[(y % SIDE * SIDE + x % SIDE) as usize], digits: 4 }
}

/// The groups of a tile in `pass`. Each pixel is in one group; in five passes it meets each other pixel of
/// its block once.
pub(super) fn pixel_groups(tile: Tile, pass: u32) -> impl Iterator<Item = PixelGroup> {
    let Tile { width, height, .. } = tile;
    let (line, across) = lines(pass);
    let starts = |size: u32| (0..size).step_by(SIDE as usize);
    let blocks = starts(height).flat_map(move |y| starts(width).map(move |x| (x, y)));
    blocks.flat_map(move |(x, y)| {
        across.map(|shift| {
            line.map(|point| {
                let (x, y) = (x + (point ^ shift) % SIDE, y + (point ^ shift) / SIDE);
                (x < width && y < height).then_some(y * width + x)
            })
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn in_each_pass_every_pixel_is_in_one_group() {
        for (width, height) in [(1, 1), (4, 4), (16, 16), (7, 2), (3, 13)] {
            let tile = Tile { x: 32, y: 16, width, height };
            for pass in 0..5 {
                let mut pixels: Vec<u32> = pixel_groups(tile, pass).flatten().flatten().collect();
                pixels.sort_unstable();
                assert_eq!(pixels, (0..width * height).collect::<Vec<_>>(), "{width} x {height}, {pass}");
            }
        }
    }

    /// The members of a group have the first two of four digits in common, and all members other numbers.
    #[test]
    fn groups_are_parts_of_the_net() {
        let tile = Tile { x: 0, y: 0, width: 4, height: 4 };
        for pass in 0..5 {
            let numbers = members(pass);
            assert_eq!(numbers.iter().copied().collect::<BTreeSet<_>>(), (0..16).collect());
            for group in pixel_groups(tile, pass).map(|group| group.map(Option::unwrap)) {
                let parts = group.map(|pixel| numbers[pixel as usize] / 4);
                assert!(parts.iter().all(|&part| part == parts[0]), "{pass}: {group:?}");
            }
        }
    }

    #[test]
    fn in_five_passes_any_two_pixels_of_a_block_meet_once() {
        let tile = Tile { x: 0, y: 0, width: 4, height: 4 };
        let mut pairs = BTreeSet::new();
        for group in (0..5).flat_map(|pass| pixel_groups(tile, pass)).map(|group| group.map(Option::unwrap)) {
            for (i, j) in (0..4).flat_map(|i| (i + 1..4).map(move |j| (i, j))) {
                let pair = [group[i].min(group[j]), group[i].max(group[j])];
                assert!(pairs.insert(pair), "{pair:?}");
            }
        }
        assert_eq!(pairs.len(), 16 * 15 / 2);
    }
}
