use std::fmt;

/// Tasks as arrays of a scheduler that does not take every index.
pub(crate) struct Arrays {
    /// What is to be added to the indices of each array, and its indices.
    arrays: Vec<(u32, Vec<u32>)>,
}

impl Arrays {
    /// Tasks in ascending order, in arrays of indices below `size`.
    pub(crate) fn new(tasks: &[u32], size: u32) -> Self {
        let arrays = tasks.chunk_by(|a, b| a / size == b / size).map(|chunk| {
            let offset = chunk[0] / size * size;
            (offset, chunk.iter().map(|task| task - offset).collect())
        });
        Self { arrays: arrays.collect() }
    }

    /// The offset of each array, and its indices as schedulers write them: `3,7,9-12`.
    pub(crate) fn expressions(&self) -> impl Iterator<Item = (u32, String)> {
        self.arrays.iter().map(|(offset, indices)| (*offset, Ranges(indices).to_string()))
    }
}

struct Ranges<'a>(&'a [u32]);

impl fmt::Display for Ranges<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, range) in self.0.chunk_by(|a, b| a + 1 == *b).enumerate() {
            let comma = if i > 0 { "," } else { "" };
            match range {
                [one] => write!(f, "{comma}{one}")?,
                [first, .., last] => write!(f, "{comma}{first}-{last}")?,
                [] => {}
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn expressions(tasks: &[u32], size: u32) -> Vec<(u32, String)> {
        Arrays::new(tasks, size).expressions().collect()
    }

    #[test]
    fn neighbours_are_ranges() {
        assert_eq!(expressions(&[3, 7, 9, 10, 11, 12], 1001), [(0, "3,7,9-12".into())]);
        assert_eq!(expressions(&[0], 1001), [(0, "0".into())]);
        assert_eq!(expressions(&[], 1001), []);
    }

    #[test]
    fn indices_that_a_scheduler_refuses_are_split() {
        let tasks: Vec<u32> = (0..2500).collect();
        let expected = [(0, "0-1000".into()), (1001, "0-1000".into()), (2002, "0-497".into())];
        assert_eq!(expressions(&tasks, 1001), expected);
        assert_eq!(
            expressions(&[1000, 1001, 2003], 1001),
            [(0, "1000".into()), (1001, "0".into()), (2002, "1".into())]
        );
    }
}
