use std::ops::Range;

/// A rectangle of pixels: a picture or a part of one, such as a tile, which one thread renders. Where a caller says so,
/// its units are blocks or tiles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct PixelRect {
    pub(crate) x: u32,
    pub(crate) y: u32,
    pub(crate) width: u32,
    pub(crate) height: u32,
}

/// Pixels along each side of a square, which is the usual tile. With four samples of each, a wavefront has 1,024 paths.
pub(crate) const SQUARE_SIDE: u32 = 16;

/// Pixels along each side of the blocks whose means are observed.
pub(crate) const BLOCK_SIDE: u32 = 4;

impl PixelRect {
    /// All pixels of a picture of this size.
    pub(crate) fn whole([width, height]: [u32; 2]) -> PixelRect {
        PixelRect { x: 0, y: 0, width, height }
    }

    /// These columns and rows.
    ///
    /// # Panics
    /// If a range begins after its end, or they are not all within a picture of this size.
    pub(crate) fn of_ranges(columns: Range<u32>, rows: Range<u32>, [width, height]: [u32; 2]) -> PixelRect {
        let is_within = |range: &Range<u32>, end| range.start <= range.end && range.end <= end;
        assert!(is_within(&columns, width) && is_within(&rows, height), "a crop lies within the picture");
        let [(x, width), (y, height)] = [columns, rows].map(|range| (range.start, range.end - range.start));
        PixelRect { x, y, width, height }
    }

    /// The tiles of `window`, a rectangle of pixels, row by row: squares, of which parts may lie outside. Where the window
    /// has half of [`SQUARE_SIDE`] columns or less, a tile is several squares above each other, with at most
    /// `SQUARE_SIDE * SQUARE_SIDE` pixels in all.
    pub(crate) fn tiles(window: PixelRect) -> impl Iterator<Item = PixelRect> {
        let height = SQUARE_SIDE * (SQUARE_SIDE / window.width.clamp(1, SQUARE_SIDE));
        let tiles = Self::grid([window.width, window.height], [SQUARE_SIDE, height]);
        tiles.map(move |tile| PixelRect { x: window.x + tile.x, y: window.y + tile.y, ..tile })
    }

    /// The square of [`SQUARE_SIDE`] x [`SQUARE_SIDE`] pixels that holds pixel (`x`, `y`), within a picture of this size.
    pub(crate) fn square_around((x, y): (u32, u32), [width, height]: [u32; 2]) -> PixelRect {
        let start = |x: u32| x - x % SQUARE_SIDE;
        let length = |x: u32, end: u32| SQUARE_SIDE.min(end - start(x));
        PixelRect { x: start(x), y: start(y), width: length(x, width), height: length(y, height) }
    }

    /// Divides a picture of this size into rectangles of the size `of`, row by row. Those at the right and the bottom may be
    /// smaller.
    pub(crate) fn grid(size: [u32; 2], of: [u32; 2]) -> impl Iterator<Item = PixelRect> {
        let starts = move |axis: usize| (0..size[axis].div_ceil(of[axis])).map(move |i| i * of[axis]);
        let length = move |axis: usize, start: u32| of[axis].min(size[axis] - start);
        starts(1).flat_map(move |y| {
            starts(0).map(move |x| PixelRect { x, y, width: length(0, x), height: length(1, y) })
        })
    }

    /// The rectangle in units of the blocks of `window`, counted from the upper left corner of that. It begins with a block.
    pub(crate) fn blocks_in(&self, window: &PixelRect) -> PixelRect {
        PixelRect {
            x: (self.x - window.x) / BLOCK_SIDE,
            y: (self.y - window.y) / BLOCK_SIDE,
            width: self.width.div_ceil(BLOCK_SIDE),
            height: self.height.div_ceil(BLOCK_SIDE),
        }
    }

    /// The blocks of the picture of which it has a pixel, as a rectangle of blocks.
    pub(crate) fn touched_blocks(&self) -> PixelRect {
        let length = |start: u32, length: u32| match length {
            0 => 0,
            _ => (start + length).div_ceil(BLOCK_SIDE) - start / BLOCK_SIDE,
        };
        PixelRect {
            x: self.x / BLOCK_SIDE,
            y: self.y / BLOCK_SIDE,
            width: length(self.x, self.width),
            height: length(self.y, self.height),
        }
    }

    /// The upper left corner of up to `side` x `side` pixels.
    pub(crate) fn corner(&self, side: u32) -> PixelRect {
        PixelRect { width: self.width.min(side), height: self.height.min(side), ..*self }
    }

    /// The number of pixels.
    pub(crate) fn pixel_count(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// The rectangle and the pixels around it, in a picture of this size.
    pub(crate) fn grown(&self, [width, height]: [u32; 2]) -> PixelRect {
        let (x, y) = (self.x.saturating_sub(1), self.y.saturating_sub(1));
        let end = |start: u32, length: u32, size: u32| size.min(start + length + 1);
        PixelRect {
            x,
            y,
            width: end(self.x, self.width, width) - x,
            height: end(self.y, self.height, height) - y,
        }
    }

    /// Pixel (`x`, `y`) and those around it, in a picture of this size, row by row.
    pub(crate) fn pixels_near((x, y): (u32, u32), size: [u32; 2]) -> impl Iterator<Item = (u32, u32)> {
        PixelRect { x, y, width: 1, height: 1 }.grown(size).pixels()
    }

    /// Pixel `index` of [`pixels`](PixelRect::pixels).
    pub(crate) fn pixel(&self, index: u32) -> (u32, u32) {
        (self.x + index % self.width, self.y + index / self.width)
    }

    /// The place of a pixel, which lies within, among all of them.
    pub(crate) fn index(&self, x: u32, y: u32) -> usize {
        (y - self.y) as usize * self.width as usize + (x - self.x) as usize
    }

    /// Its pixels, row by row.
    pub(crate) fn pixels(&self) -> impl Iterator<Item = (u32, u32)> + Clone + use<> {
        let Self { x, y, width, height } = *self;
        (y..y + height).flat_map(move |row| (x..x + width).map(move |column| (column, row)))
    }

    /// Where its pixels are, row by row, in a picture of this width.
    pub(crate) fn places(&self, width: u32) -> impl Iterator<Item = usize> + use<> {
        self.pixels().map(move |(x, y)| y as usize * width as usize + x as usize)
    }

    /// Its pixels of a picture of this width, row by row.
    pub(crate) fn cut<T: Copy>(&self, picture: &[T], width: u32) -> Vec<T> {
        self.places(width).map(|place| picture[place]).collect()
    }

    /// Replaces its pixels of a picture of this width by `pixels`, row by row.
    pub(crate) fn paste<T: Copy>(&self, pixels: &[T], picture: &mut [T], width: u32) {
        self.places(width).zip(pixels).for_each(|(place, &pixel)| picture[place] = pixel);
    }

    /// Its pixels, block by block, so that neighbours follow each other.
    pub(crate) fn pixels_by_block(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
        let Self { x, y, width, height } = *self;
        let blocks = Self::grid([width, height], [BLOCK_SIDE; 2]);
        blocks.flat_map(|block| block.pixels()).map(move |(column, row)| (x + column, y + row))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_every_pixel_once() {
        for (width, height) in [(1, 1), (16, 16), (17, 33), (1, 400), (7, 100), (50, 1)] {
            let mut seen = vec![0; (width * height) as usize];
            for rows in [0..16.min(height), 16.min(height)..height] {
                let window = PixelRect { x: 0, y: rows.start, width, height: rows.len() as u32 };
                for (x, y) in PixelRect::tiles(window).flat_map(|tile| tile.pixels()) {
                    seen[(y * width + x) as usize] += 1;
                }
            }
            assert!(seen.iter().all(|&n| n == 1), "{width} x {height}");
        }
    }

    #[test]
    fn blocks_have_the_same_pixels_as_rows() {
        for (width, height) in [(1, 1), (16, 16), (7, 9), (3, 20)] {
            let tile = PixelRect { x: 5, y: 2, width, height };
            let mut by_block: Vec<_> = tile.pixels_by_block().map(|(x, y)| (y, x)).collect();
            by_block.sort_unstable();
            assert!(by_block.into_iter().eq(tile.pixels().map(|(x, y)| (y, x))), "{width} x {height}");
        }
        let first: Vec<_> =
            PixelRect { x: 5, y: 2, width: 9, height: 9 }.pixels_by_block().take(16).collect();
        assert!(first.into_iter().eq(PixelRect { x: 5, y: 2, width: 4, height: 4 }.pixels()));
    }

    #[test]
    fn tiles_have_no_more_pixels_than_a_square_and_not_many_less() {
        for (width, height) in [(1, 256), (3, 80), (8, 32), (9, 16), (16, 16), (40, 16)] {
            let tile = PixelRect::tiles(PixelRect { x: 4, y: 8, width, height: 1000 }).next().unwrap();
            assert_eq!(tile, PixelRect { x: 4, y: 8, width: width.min(16), height });
        }
    }
}
