use std::ops::Range;

/// Columns and rows of a picture.
#[derive(Clone, Debug)]
pub(crate) struct Window {
    /// Width of the picture.
    width: u32,
    pub(crate) columns: Range<u32>,
    pub(crate) rows: Range<u32>,
}

impl Window {
    /// # Panics
    /// If a range begins after its end, or they are not all within a picture of this width and height.
    pub(crate) fn new(columns: Range<u32>, rows: Range<u32>, [width, height]: [u32; 2]) -> Self {
        let is_within = |range: &Range<u32>, end| range.start <= range.end && range.end <= end;
        assert!(is_within(&columns, width) && is_within(&rows, height), "a crop lies within the picture");
        Self { width, columns, rows }
    }

    /// Width and height.
    pub(crate) fn size(&self) -> [u32; 2] {
        [&self.columns, &self.rows].map(|range| range.end - range.start)
    }

    /// The window's pixels of those of the picture, row by row.
    pub(crate) fn cut<T: Copy>(&self, picture: &[T]) -> Vec<T> {
        self.lines().flat_map(|line| &picture[line]).copied().collect()
    }

    /// Replaces the window's pixels of the picture by `pixels`, row by row.
    pub(crate) fn paste<T: Copy>(&self, pixels: &[T], picture: &mut [T]) {
        let width = self.columns.len();
        for (y, line) in self.lines().enumerate() {
            picture[line].copy_from_slice(&pixels[y * width..][..width]);
        }
    }

    /// Each block with a pixel in the window, as a pixel of a picture of blocks of `side` x `side` pixels.
    pub(crate) fn blocks(&self, side: u32) -> Self {
        let all = |range: &Range<u32>| range.start / side..range.end.div_ceil(side);
        let blocks = |range: &Range<u32>| if range.is_empty() { 0..0 } else { all(range) };
        Self { width: self.width.div_ceil(side), columns: blocks(&self.columns), rows: blocks(&self.rows) }
    }

    /// The pixels of each row.
    fn lines(&self) -> impl Iterator<Item = Range<usize>> {
        let first = |y: u32| y as usize * self.width as usize;
        let columns = self.columns.start as usize..self.columns.end as usize;
        self.rows.clone().map(move |y| first(y) + columns.start..first(y) + columns.end)
    }
}
