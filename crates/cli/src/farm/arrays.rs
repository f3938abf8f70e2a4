/// Tasks, in ascending order, as arrays of a scheduler that takes indices below `size`: for each array, what is to be added
/// to its indices, and these as schedulers write them, such as `3,7,9-12`.
pub(crate) fn arrays(tasks: &[u32], size: u32) -> Vec<(u32, String)> {
    let array = |tasks: &[u32]| {
        let offset = tasks[0] / size * size;
        let indices: Vec<u32> = tasks.iter().map(|task| task - offset).collect();
        (offset, ranges(&indices).join(","))
    };
    tasks.chunk_by(|a, b| a / size == b / size).map(array).collect()
}

/// Numbers in ascending order, neighbours as a range.
fn ranges(numbers: &[u32]) -> Vec<String> {
    let range = |range: &[u32]| match range {
        [first, .., last] => format!("{first}-{last}"),
        numbers => numbers[0].to_string(),
    };
    numbers.chunk_by(|a, b| a + 1 == *b).map(range).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_are_ranges() {
        assert_eq!(arrays(&[3, 7, 9, 10, 11, 12], 1001), [(0, "3,7,9-12".into())]);
        assert_eq!(arrays(&[0], 1001), [(0, "0".into())]);
        assert_eq!(arrays(&[], 1001), []);
    }

    #[test]
    fn indices_that_a_scheduler_refuses_are_split() {
        let tasks: Vec<u32> = (0..2500).collect();
        let expected = [(0, "0-1000".into()), (1001, "0-1000".into()), (2002, "0-497".into())];
        assert_eq!(arrays(&tasks, 1001), expected);
        assert_eq!(
            arrays(&[1000, 1001, 2003], 1001),
            [(0, "1000".into()), (1001, "0".into()), (2002, "1".into())]
        );
    }
}
