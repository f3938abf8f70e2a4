//! The groups of pixels that reuse each other's paths, and how their samples are stratified.

use crate::pixel_rect::{BLOCK_SIDE, PixelRect, SQUARE_SIDE};
use crate::sampler::Member;

/// Blocks of a square of 16 x 16 pixels, and pixels of a block and of a group.
const COUNT: usize = 16;

/// A pixel of each block of a square, as indices into [`PixelRect::pixels`]; `None` for a pixel outside the tile.
pub(super) type PixelGroup = [Option<u32>; COUNT];

/// A square is 4 x 4 blocks, and holds whole groups. A tile is one, or several above each other.
const _: () = assert!(SQUARE_SIDE == BLOCK_SIDE * BLOCK_SIDE && (BLOCK_SIDE * BLOCK_SIDE) as usize == COUNT);

/// The power of `a` in pass 0. With it the pixels of a group are a (0, 4, 2)-net: no two are in one row or column.
const FIRST_POWER: u32 = 6;
/// The number of different powers of `a`.
const POWERS: u32 = 15;

/// An element of the field of sixteen elements times `a^power`, where `a^4 = a + 1`. Its binary digits are the
/// coefficients of a polynomial in `a`.
fn times_power(element: u32, power: u32) -> u32 {
    (0..power).fold(element, |x, _| (x << 1) ^ ((x >> 3) * 0b1_0011))
}

/// The power of `a` by which a pass multiplies pixels.
fn power(pass: u32) -> u32 {
    (pass % POWERS + FIRST_POWER) % POWERS
}

/// The number of a pixel or block among the 4 x 4 of a block or square, row by row.
fn index(x: u32, y: u32) -> u32 {
    y % BLOCK_SIDE * BLOCK_SIDE + x % BLOCK_SIDE
}

/// The squares' pixels in one pass, as members of groups and of nets.
///
/// The blocks of a square and the pixels of a block are numbered by the elements of the field of sixteen elements. Pixel
/// `p` of block `b` belongs to group `a^k p + b`; `k` is different in each of fifteen successive passes. A group
/// therefore has one pixel of each block. Two pixels of different blocks, and of different places in their blocks, belong
/// to one group in exactly one of the fifteen passes.
#[derive(Clone, Copy, Debug)]
pub(in crate::path) struct Groups {
    power: u32,
}

impl Groups {
    pub(in crate::path) fn of_pass(pass: u32) -> Self {
        Self { power: power(pass) }
    }

    /// Pixel (`x`, `y`) of a picture of this width, as a member of the net of its square. The first half of its digits is
    /// the number of its group, the sum of both halves that of its block.
    pub(in crate::path) fn member(self, x: u32, y: u32, width: u32) -> Member {
        let block = index(x / BLOCK_SIDE, y / BLOCK_SIDE);
        let place = times_power(index(x, y), self.power);
        let group = place ^ block;
        let square =
            u64::from(y / SQUARE_SIDE) * u64::from(width.div_ceil(SQUARE_SIDE)) + u64::from(x / SQUARE_SIDE);
        Member { net: square, number: group * COUNT as u32 + place, digits: 8 }
    }

    /// The groups of a tile. Each pixel is in one.
    pub(super) fn of_tile(self, tile: PixelRect) -> impl Iterator<Item = PixelGroup> {
        let pixels: [u32; COUNT] =
            std::array::from_fn(|place| times_power(place as u32, POWERS - self.power));
        PixelRect::grid([tile.width, tile.height], [SQUARE_SIDE; 2]).flat_map(move |square| {
            (0..COUNT).map(move |group| {
                std::array::from_fn(|block| {
                    let (pixel, block) = (pixels[group ^ block], block as u32);
                    let x = square.x + block % BLOCK_SIDE * BLOCK_SIDE + pixel % BLOCK_SIDE;
                    let y = square.y + block / BLOCK_SIDE * BLOCK_SIDE + pixel / BLOCK_SIDE;
                    (x < tile.width && y < tile.height).then_some(y * tile.width + x)
                })
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    const SQUARE: PixelRect = PixelRect { x: 0, y: 0, width: 16, height: 16 };

    /// The groups of a whole square.
    fn groups(pass: u32) -> impl Iterator<Item = [u32; COUNT]> {
        Groups::of_pass(pass).of_tile(SQUARE).map(|group| group.map(Option::unwrap))
    }

    #[test]
    fn in_each_pass_every_pixel_is_in_one_group() {
        for (width, height) in [(1, 1), (4, 4), (16, 16), (7, 2), (3, 45), (16, 32)] {
            let tile = PixelRect { x: 32, y: 16, width, height };
            for pass in 0..POWERS {
                let of_tile = Groups::of_pass(pass).of_tile(tile);
                let mut pixels: Vec<u32> = of_tile.flatten().flatten().collect();
                pixels.sort_unstable();
                assert_eq!(pixels, (0..width * height).collect::<Vec<_>>(), "{width} x {height}, {pass}");
            }
        }
    }

    #[test]
    fn a_group_has_a_pixel_of_each_block() {
        for group in (0..POWERS).flat_map(groups) {
            let blocks: BTreeSet<_> =
                group.iter().map(|&pixel| SQUARE.pixel(pixel)).map(|(x, y)| (x / 4, y / 4)).collect();
            assert_eq!(blocks.len(), COUNT, "{group:?}");
        }
    }

    #[test]
    fn in_the_first_pass_each_elementary_interval_holds_a_pixel_of_a_group() {
        for group in groups(0) {
            for [width, height] in [[1, 16], [2, 8], [4, 4], [8, 2], [16, 1]] {
                let of_pixel = |&pixel: &u32| (SQUARE.pixel(pixel).0 / width, SQUARE.pixel(pixel).1 / height);
                assert_eq!(group.iter().map(of_pixel).collect::<BTreeSet<_>>().len(), COUNT, "{group:?}");
            }
        }
    }

    /// All members of a square have other numbers. Those of a group have the first half in common, those of a block the
    /// sum of both.
    #[test]
    fn groups_and_blocks_are_parts_of_a_net() {
        for pass in 0..POWERS {
            let member = |pixel: u32| {
                let (x, y) = SQUARE.pixel(pixel);
                Groups::of_pass(pass).member(x + 32, y + 16, 70)
            };
            let all: BTreeSet<_> = (0..256).map(|pixel| member(pixel).number).collect();
            assert_eq!(all, (0..256).collect());
            for group in groups(pass) {
                let numbers = group.map(|pixel| member(pixel).number);
                assert!(numbers.iter().all(|number| number / 16 == numbers[0] / 16), "{pass}: {numbers:?}");
            }
            for pixel in 0..256 {
                let (number, (x, y)) = (member(pixel).number, SQUARE.pixel(pixel));
                assert_eq!(
                    (number / 16) ^ (number % 16),
                    index(x / BLOCK_SIDE, y / BLOCK_SIDE),
                    "{pass}: {pixel}"
                );
                assert_eq!(member(pixel).net, member(0).net);
            }
        }
    }

    #[test]
    fn in_fifteen_passes_two_pixels_meet_once_at_most() {
        let mut pairs = BTreeSet::new();
        for group in (0..POWERS).flat_map(groups) {
            for (i, j) in (0..COUNT).flat_map(|i| (i + 1..COUNT).map(move |j| (i, j))) {
                let pair = [group[i].min(group[j]), group[i].max(group[j])];
                assert!(pairs.insert(pair), "{pair:?}");
            }
        }
        assert_eq!(pairs.len(), 15 * 16 * 120);
    }
}
