use crate::pixel_rect::{PixelRect, SQUARE_SIDE};
use std::ops::Range;

/// The samples that a wavefront traces: the same ones of each pixel of a tile. They are numbered pixel by pixel, in the order
/// of [`PixelRect::pixels`].
#[derive(Clone, Debug, Default)]
pub(super) struct TileSamples {
    pub(super) tile: PixelRect,
    /// The indices of the samples in each pixel.
    pub(super) in_pixel: Range<u32>,
}

impl TileSamples {
    /// How many samples there are.
    pub(super) fn count(&self) -> usize {
        self.tile.pixel_count() * self.in_pixel.len()
    }

    /// The samples of the pixel of this index.
    pub(super) fn of_pixel(&self, pixel: u32) -> Range<u32> {
        let count = self.in_pixel.len() as u32;
        pixel * count..(pixel + 1) * count
    }

    /// The samples of one index in the pixels of a square of 16 x 16: the square that holds `sample`, which is one of them.
    pub(super) fn of_square(&self, sample: u32) -> impl Iterator<Item = u32> + Clone + use<> {
        let (tile, count) = (self.tile, self.in_pixel.len() as u32);
        let (pixel, index) = (sample / count, sample % count);
        let place = (pixel % tile.width, pixel / tile.width);
        let square = PixelRect::square_around(place, [tile.width, tile.height]);
        square.pixels().map(move |(x, y)| (y * tile.width + x) * count + index)
    }

    /// The samples of each square, by their index in the pixel.
    pub(super) fn by_square(&self) -> impl Iterator<Item = impl Iterator<Item = u32> + Clone + use<>> {
        let firsts = (0..self.count()).step_by(self.per_square());
        let of_pixel = 0..self.in_pixel.len();
        firsts.flat_map(move |first| of_pixel.clone().map(move |i| self.of_square((first + i) as u32)))
    }

    /// How many samples a square has. They follow each other, since squares of a tile lie above each other.
    pub(super) fn per_square(&self) -> usize {
        (SQUARE_SIDE * self.tile.width) as usize * self.in_pixel.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_divide_all_samples() {
        for (width, height) in [(1, 256), (5, 40), (16, 16), (13, 7)] {
            let samples = TileSamples { tile: PixelRect { x: 16, y: 32, width, height }, in_pixel: 8..12 };
            let mut all: Vec<u32> = samples.by_square().flatten().collect();
            all.sort_unstable();
            assert!(all.into_iter().eq(0..samples.count() as u32), "{width} x {height}");
            for square in samples.by_square() {
                let place = |sample: u32| (sample as usize / samples.per_square(), sample % 4);
                let first = square.clone().next().unwrap();
                assert!(square.clone().all(|sample| place(sample) == place(first)));
                assert!(square.clone().all(|sample| samples.of_square(sample).eq(square.clone())));
            }
        }
    }
}
