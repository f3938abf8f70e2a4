use crate::checkpoint;
use globillum::integrator::Film;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// The most bytes that a task saves: a task that is to end writes them within a second, to slow disks too.
const PART_BYTES: u64 = 32_000_000;

/// How a picture is divided into tasks: ranges of passes of strips of the picture. Strips are as high as
/// [`PART_BYTES`] allows, and lower if there are too few ranges.
///
/// Ranges are as long as a power of two and begin at its multiples, as the nodes of a film do, but for the first
/// and the last: what a task renders is then one node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Division {
    /// Height of the picture.
    height: u32,
    first_pass: u32,
    /// One past the last.
    end_pass: u32,
    /// Passes of a task.
    task_passes: u32,
    /// Rows of a task.
    task_rows: u32,
}

impl Division {
    /// At least `tasks` tasks of about equal size, if a task has a pass of a row of tiles at least.
    pub(crate) fn new(width: u32, height: u32, passes: Range<u32>, tasks: u32) -> Self {
        let (first_pass, end_pass) = (passes.start, passes.end);
        let power = (passes.end - passes.start).checked_next_power_of_two().unwrap_or(1 << 31);
        let mut division = Self { height, first_pass, end_pass, task_passes: power, task_rows: height };
        division.task_rows = division.rows_that_fit(width);
        while division.tasks() < tasks && division.task_passes > 1 {
            division.task_passes /= 2;
            division.task_rows = division.rows_that_fit(width);
        }
        if division.tasks() < tasks {
            division.task_rows = division.rows_of(tasks.div_ceil(division.ranges()));
        }
        division
    }

    /// Rows of a task whose part has [`PART_BYTES`] at most, if a row of tiles has.
    fn rows_that_fit(&self, width: u32) -> u32 {
        let pixels = u64::from(width) * u64::from(self.height);
        let strips = checkpoint::most_bytes(pixels, self.task_passes).div_ceil(PART_BYTES);
        self.rows_of(strips.try_into().unwrap_or(u32::MAX))
    }

    /// Rows of a task if the picture has at least these many strips, if it can.
    fn rows_of(&self, strips: u32) -> u32 {
        let tile_rows = self.height / strips / Film::TILE_ROWS;
        if strips > 1 { tile_rows.max(1) * Film::TILE_ROWS } else { self.height }
    }

    /// Whether a file can say this.
    pub(crate) fn is_possible(&self) -> bool {
        let Self { height, first_pass, end_pass, task_passes, task_rows } = *self;
        let whole = task_rows == height || task_rows.is_multiple_of(Film::TILE_ROWS);
        let tasks = || u64::from(self.ranges()) * u64::from(self.strips());
        first_pass < end_pass
            && task_passes.is_power_of_two()
            && height > 0
            && task_rows > 0
            && whole
            && tasks() <= u64::from(u32::MAX)
    }

    /// The number of tasks.
    pub(crate) fn tasks(&self) -> u32 {
        self.ranges().saturating_mul(self.strips())
    }

    /// Strips of the picture.
    fn strips(&self) -> u32 {
        self.height.div_ceil(self.task_rows)
    }

    /// Ranges of passes.
    fn ranges(&self) -> u32 {
        self.end_pass.div_ceil(self.task_passes) - self.first_pass / self.task_passes
    }

    /// Passes and rows of a task: all strips of the first range come first, so that the whole picture is seen early.
    pub(crate) fn task(&self, index: u32) -> (Range<u32>, Range<u32>) {
        let (range, strip) = (index / self.strips(), index % self.strips());
        let first = (self.first_pass / self.task_passes + range) * self.task_passes;
        let end = self.end_pass.min(first.saturating_add(self.task_passes));
        let row = strip * self.task_rows;
        (first.max(self.first_pass)..end, row..self.height.min(row.saturating_add(self.task_rows)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(division: &Division) -> Vec<(Range<u32>, Range<u32>)> {
        (0..division.tasks()).map(|index| division.task(index)).collect()
    }

    #[test]
    fn passes_are_divided_before_rows() {
        let division = Division::new(100, 100, 0..10, 3);
        assert_eq!(all(&division), [(0..4, 0..100), (4..8, 0..100), (8..10, 0..100)]);
        let division = Division::new(100, 100, 0..2, 5);
        let strips = [0..32, 32..64, 64..96, 96..100];
        assert_eq!(
            all(&division),
            [0..1, 1..2].map(|passes| strips.clone().map(|rows| (passes.clone(), rows))).concat()
        );
    }

    /// Ranges lie in the tree of passes also behind a pilot.
    #[test]
    fn ranges_begin_at_multiples_of_their_length() {
        let division = Division::new(16, 16, 5..23, 3);
        assert_eq!(all(&division), [(5..8, 0..16), (8..16, 0..16), (16..23, 0..16)]);
    }

    /// Every pass of every row is in one task; there are enough of them, if there can be.
    #[test]
    fn tasks_cover_the_picture_once() {
        for (height, passes, tasks) in [
            (1, 0..1, 1),
            (1080, 0..256, 64),
            (1080, 0..256, 1000),
            (1080, 3..20, 4096),
            (17, 0..7, 1),
            (40, 0..3, 9),
        ] {
            let width = 1920;
            let division = Division::new(width, height, passes.clone(), tasks);
            assert!(division.is_possible());
            let rows = division.task_rows;
            let bytes = checkpoint::most_bytes(u64::from(width) * u64::from(rows), division.task_passes);
            assert!(bytes <= PART_BYTES, "{division:?}: {bytes}");
            let mut seen = vec![0; (height * passes.end) as usize];
            for (passes, rows) in all(&division) {
                assert!(!passes.is_empty() && !rows.is_empty() && rows.start % 16 == 0);
                for row in rows {
                    passes.clone().for_each(|pass| seen[(row * division.end_pass + pass) as usize] += 1);
                }
            }
            for (place, count) in seen.into_iter().enumerate() {
                assert_eq!(count, u32::from(place as u32 % passes.end >= passes.start));
            }
            let most = height.div_ceil(16) * (passes.end - passes.start);
            assert!(division.tasks() >= tasks.min(most), "{division:?}");
        }
    }
}
