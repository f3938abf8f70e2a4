/// A rectangle of pixels that is one task.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Tile {
    pub(crate) x: u32,
    pub(crate) y: u32,
    pub(crate) width: u32,
    pub(crate) height: u32,
}

/// Pixels along a side: with four samples each, a wavefront of about a thousand rays.
pub(crate) const SIDE: u32 = 16;

impl Tile {
    /// All tiles of a picture, row by row.
    pub(crate) fn all(width: u32, height: u32) -> impl Iterator<Item = Tile> {
        Self::grid(width, height, SIDE)
    }

    /// A picture in squares of this side, row by row; less of them at its right and bottom.
    pub(crate) fn grid(width: u32, height: u32, side: u32) -> impl Iterator<Item = Tile> {
        let starts = move |size: u32| (0..size.div_ceil(side)).map(move |i| i * side);
        starts(height).flat_map(move |y| {
            starts(width).map(move |x| Tile {
                x,
                y,
                width: side.min(width - x),
                height: side.min(height - y),
            })
        })
    }

    /// The number of pixels.
    pub(crate) fn pixel_count(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// The tile's pixels, row by row.
    pub(crate) fn pixels(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
        let Self { x, y, width, height } = *self;
        (y..y + height).flat_map(move |row| (x..x + width).map(move |column| (column, row)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_every_pixel_once() {
        for (width, height) in [(1, 1), (16, 16), (17, 33), (1, 40), (50, 1)] {
            let mut seen = vec![0; (width * height) as usize];
            for (x, y) in Tile::all(width, height).flat_map(|tile| tile.pixels()) {
                seen[(y * width + x) as usize] += 1;
            }
            assert!(seen.iter().all(|&n| n == 1), "{width} x {height}");
        }
    }
}
