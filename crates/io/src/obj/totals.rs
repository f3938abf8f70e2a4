use super::source::Source;
use crate::Limits;

/// The size of a file's content, counted before memory is allocated for it. A vector that grows takes up to
/// three times the memory of its content.
#[derive(Default)]
pub(super) struct Totals {
    pub(super) vertices: usize,
    /// Triangles of all faces, with degenerate ones, clamped to the limit.
    pub(super) triangles: usize,
    /// Corners of the largest polygon, clamped to the limit.
    pub(super) corners: usize,
}

impl Totals {
    pub(super) fn of(source: &Source, limits: &Limits) -> Self {
        let mut totals = Self::default();
        source.lines().for_each(|line| totals.count(line.trim_ascii_start()));
        let allowed = |count: usize, limit: u64| (count as u64).min(limit) as usize;
        totals.triangles = allowed(totals.triangles, limits.triangles);
        totals.corners = allowed(totals.corners, limits.polygon_corners);
        totals
    }

    /// Counts the content of a line without leading blanks, faster than by parsing it.
    fn count(&mut self, line: &str) {
        match line.as_bytes() {
            // The shortest valid line is `v 0 0 0`.
            [b'v', b' ' | b'\t', _, _, _, _, _, ..] => self.vertices += 1,
            [b'f', b' ' | b'\t', ..] => {
                let corners = words(&line[1..]);
                self.triangles += corners.saturating_sub(2);
                self.corners = self.corners.max(corners);
            }
            _ => {}
        }
    }
}

/// The number of words after blanks, up to a comment.
fn words(arguments: &str) -> usize {
    let (mut count, mut has_comment) = (0, false);
    for pair in arguments.as_bytes().windows(2) {
        count += usize::from(pair[0].is_ascii_whitespace() & !pair[1].is_ascii_whitespace());
        has_comment |= pair[1] == b'#';
    }
    if has_comment {
        return arguments.split_ascii_whitespace().take_while(|word| !word.starts_with('#')).count();
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_those_that_are_read() {
        for (arguments, count) in [
            ("", 0),
            (" ", 0),
            (" 1", 1),
            ("  1/2/3\t2 \r", 2),
            (" 1 2 3#4 5 ", 4),
            (" 1 2 #3 4", 2),
            (" # 1 2 3", 0),
        ] {
            assert_eq!(words(arguments), count, "{arguments:?}");
        }
    }
}
