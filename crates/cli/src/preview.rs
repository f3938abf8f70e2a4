//! Pictures of a render that is not finished, for viewers that load a file again when it changes.

use crate::console;
use crate::flags::PictureOutput;
use crate::output::STDOUT;
use globillum::integrator::Picture;
use globillum::io::{AtomicFile, IoError, PictureData, PictureFile};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The time before the first preview.
const FIRST: Duration = Duration::from_secs(1);
/// By how much the time from the start grows from one preview to the next.
const GROWTH: f64 = 1.25;
/// The share of the time that goes to previews is one in this many.
const SHARE: u32 = 20;

/// Replaces the picture's files again and again while it is rendered.
pub(crate) struct Preview<'a> {
    paths: Vec<PathBuf>,
    exposure: f64,
    /// What is written of a picture.
    data_of: Box<dyn Fn(&Picture) -> PictureData + Send + 'a>,
    start: Instant,
    /// When the last one was complete, and how long it took.
    last: Option<(Instant, Duration)>,
}

impl<'a> Preview<'a> {
    /// Previews in the files of `output` that are, or will be, regular ones; `data_of` a picture is written.
    pub(crate) fn new(output: &PictureOutput, data_of: impl Fn(&Picture) -> PictureData + Send + 'a) -> Self {
        let is_file =
            |path: &&PathBuf| path.as_path() != Path::new(STDOUT) && AtomicFile::target(path).is_some();
        let paths = output.out.iter().filter(is_file).cloned().collect();
        let data_of = Box::new(data_of);
        Self { paths, exposure: output.exposure, data_of, start: Instant::now(), last: None }
    }

    /// Writes the picture if it is time to. After an error there are no more previews.
    pub(crate) fn show_if_due(&mut self, picture: &Picture) {
        let begun = Instant::now();
        let before = self.last.map_or(Duration::ZERO, |(last, _)| last - self.start);
        let took = self.last.map_or_else(|| self.estimate(picture), |(_, took)| took);
        if self.paths.is_empty() || begun - self.start < next(before, took) {
            return;
        }
        let data = (self.data_of)(picture);
        if let Err(error) = self.paths.iter().try_for_each(|path| self.write(path, &data)) {
            console::warn(format_args!("{error}; there are no more previews"));
            self.paths.clear();
        }
        self.last = Some((Instant::now(), begun.elapsed()));
    }

    fn write(&self, path: &Path, data: &PictureData) -> Result<(), IoError> {
        PictureFile::create(path)?.exposed(self.exposure).write_data(data)
    }

    /// How long the first one takes, with a microsecond a pixel of each file.
    fn estimate(&self, picture: &Picture) -> Duration {
        let pixels = u64::from(picture.film.width()) * u64::from(picture.film.height());
        Duration::from_micros(pixels * self.paths.len() as u64)
    }
}

/// When the next preview is due, counted from the start, if the one `before` it ended then and each takes `took`.
fn next(before: Duration, took: Duration) -> Duration {
    FIRST.max(before.mul_f64(GROWTH)).max(before + (SHARE - 1) * took)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn previews_take_a_twentieth_of_the_time_at_most_and_become_rare() {
        for milliseconds in [0, 10, 1000, 60_000] {
            let took = Duration::from_millis(milliseconds);
            let (mut end, mut count) = (Duration::ZERO, 0);
            while end < Duration::from_secs(100_000) {
                let begin = next(end, took);
                assert!(begin >= FIRST && begin >= end.mul_f64(GROWTH), "{begin:?}");
                (end, count) = (begin + took, count + 1);
                assert!(
                    count * took * SHARE <= end + Duration::from_millis(1),
                    "{count} of {took:?} in {end:?}"
                );
            }
            assert!(count < 60, "{count}");
        }
    }
}
