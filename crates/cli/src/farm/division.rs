use globillum::integrator::Film;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// How a picture is divided into tasks: ranges of passes, and if they are too few, strips of the picture.
///
/// Ranges are as long as a power of two and begin at its multiples, as the blocks of a film do, but for the first
/// and the last: what a task renders is then one block.
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
    pub(crate) fn new(height: u32, passes: Range<u32>, tasks: u32) -> Self {
        let (first_pass, end_pass) = (passes.start, passes.end);
        let power = (passes.end - passes.start).checked_next_power_of_two().unwrap_or(1 << 31);
        let mut division = Self { height, first_pass, end_pass, task_passes: power, task_rows: height };
        while division.ranges() < tasks && division.task_passes > 1 {
            division.task_passes /= 2;
        }
        let strips = tasks.div_ceil(division.ranges());
        if strips > 1 {
            let tile_rows = height / strips / Film::TILE_ROWS;
            division.task_rows = tile_rows.max(1) * Film::TILE_ROWS;
        }
        division
    }

    /// Whether a file can say this.
    pub(crate) fn is_possible(&self) -> bool {
        let Self { height, first_pass, end_pass, task_passes, task_rows } = *self;
        let whole = task_rows == height || task_rows.is_multiple_of(Film::TILE_ROWS);
        let tasks = || u64::from(self.ranges()) * u64::from(height.div_ceil(task_rows));
        first_pass < end_pass
            && task_passes.is_power_of_two()
            && height > 0
            && task_rows > 0
            && whole
            && tasks() <= u64::from(u32::MAX)
    }

    /// The number of tasks.
    pub(crate) fn tasks(&self) -> u32 {
        self.ranges() * self.height.div_ceil(self.task_rows)
    }

    /// Ranges of passes.
    fn ranges(&self) -> u32 {
        self.end_pass.div_ceil(self.task_passes) - self.first_pass / self.task_passes
    }

    /// Passes and rows of a task: all ranges of the first strip come first.
    pub(crate) fn task(&self, index: u32) -> (Range<u32>, Range<u32>) {
        let (strip, range) = (index / self.ranges(), index % self.ranges());
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
        let division = Division::new(100, 0..10, 3);
        assert_eq!(all(&division), [(0..4, 0..100), (4..8, 0..100), (8..10, 0..100)]);
        let division = Division::new(100, 0..2, 5);
        let strips = [0..32, 32..64, 64..96, 96..100];
        assert_eq!(all(&division), strips.map(|rows| [(0..1, rows.clone()), (1..2, rows)]).concat());
    }

    /// Ranges lie in the tree of passes also behind a pilot.
    #[test]
    fn ranges_begin_at_multiples_of_their_length() {
        let division = Division::new(16, 5..23, 3);
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
            let division = Division::new(height, passes.clone(), tasks);
            assert!(division.is_possible());
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
