//! The groups of pixels that reuse each other's paths.

use super::tile_bounds::Tile;

/// Pixels along each side of the blocks that are divided into groups.
pub(crate) const SIDE: u32 = 4;

/// The affine plane of order 4: five classes of parallel lines through the points `4 y + x`; any two
/// points lie on one line. Listed is the line of each class through 0. The others follow by adding, without
/// carry, a point of a line of another class.
const LINES: [[u32; 4]; 5] = [[0, 1, 2, 3], [0, 4, 8, 12], [0, 5, 10, 15], [0, 6, 11, 13], [0, 7, 9, 14]];

/// Four pixels as indices into [`Tile::pixels`]; `None` for a pixel outside the tile.
pub(super) type PixelGroup = [Option<u32>; 4];

/// The part of a picture of `width` x `height` pixels that holds all groups of pixel (`x`, `y`).
pub(super) fn block_around(x: u32, y: u32, width: u32, height: u32) -> Tile {
    let start = |x: u32| x - x % SIDE;
    let length = |x: u32, end: u32| SIDE.min(end - start(x));
    Tile { x: start(x), y: start(y), width: length(x, width), height: length(y, height) }
}

/// The groups of a tile in `pass`. Each pixel is in one group; in five passes it meets each other pixel of
/// its block once.
pub(super) fn pixel_groups(tile: Tile, pass: u32) -> impl Iterator<Item = PixelGroup> {
    let Tile { width, height, .. } = tile;
    let class = pass as usize % LINES.len();
    let (line, across) = (LINES[class], LINES[usize::from(class == 0)]);
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
