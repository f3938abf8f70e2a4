use super::checkpoint::{CheckpointReader, CheckpointWriter, Merge, resealed};
use super::picture::Picture;
use crate::{Estimates, MergeError};

/// Reads `bytes` as a checkpoint, as they are and with correct checksums, which a fuzzer does not find by itself; returns
/// whether the latter is one.
///
/// # Panics
/// If what is read does not come back from its own bytes, or tells what no picture can.
pub fn check_checkpoint(bytes: &[u8]) -> bool {
    check(bytes);
    resealed(bytes).is_some_and(|bytes| check(&bytes))
}

/// Whether `bytes` are a checkpoint.
fn check(bytes: &[u8]) -> bool {
    let picture = Picture::from_bytes(bytes);
    if let Ok(picture) = &picture {
        check_picture(picture);
    }
    let Ok(once) = merged(&[bytes]) else {
        assert!(picture.is_err(), "a picture can be merged");
        return false;
    };
    // The sums at the end are computed anew.
    let rows = |bytes: &[u8]| bytes[..bytes.len() - 64].to_vec();
    assert_eq!(rows(&once), rows(bytes), "of one checkpoint there is nothing to merge");
    assert_eq!(merged(&[bytes, bytes]), Ok(once), "equal checkpoints count once");
    true
}

/// The checkpoint of all of them.
fn merged(checkpoints: &[&[u8]]) -> Result<Vec<u8>, MergeError> {
    let mut readers = Vec::new();
    for (index, &bytes) in checkpoints.iter().enumerate() {
        readers.push(CheckpointReader::new(bytes).map_err(|error| MergeError::Input { index, error })?);
    }
    let merge = Merge::new(readers)?;
    let mut writer =
        CheckpointWriter::new(Vec::new(), merge.header()).map_err(|e| MergeError::Write(e.kind()))?;
    merge.run(|rows| writer.write(rows))?;
    writer.finish().map_err(|error| MergeError::Write(error.kind()))
}

fn check_picture(picture: &Picture) {
    assert_eq!(Picture::from_bytes(&picture.to_bytes()).as_ref(), Ok(picture));
    let film = &picture.film;
    if film.samples() > 0 {
        assert!(film.means().all(|mean| mean.is_finite()));
        assert!(film.variances_of_mean().all(|variance| variance.to_array().iter().all(|&x| x >= 0.0)));
        assert!(picture.clone().merge(picture.clone()).is_err(), "passes count once");
        let mut whole = Estimates::of(film);
        whole.paste(&whole.clone());
        assert_eq!(whole, Estimates::of(film), "the film lies within its picture");
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Moments, PassNode, Tally};
    use super::*;
    use crate::{CheckpointError, Film, PathReuse, Settings};
    use globillum_material::Rgb;

    #[test]
    fn the_fuzzers_corpus() {
        let corpus = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/corpus/checkpoint");
        let files = std::fs::read_dir(corpus).unwrap().map(|entry| std::fs::read(entry.unwrap().path()));
        let good = files.filter(|bytes| check_checkpoint(bytes.as_ref().unwrap())).count();
        assert!(good > 0, "not one file is good");
    }

    /// A checkpoint of one pixel: its nodes hold one pass each, with these sums and spreads.
    fn checkpoint(passes: &[(u32, f64, f64)]) -> Vec<u8> {
        let mut film = Film::new(1, 0..1, PathReuse::Off);
        for &(first, sum, spread) in passes {
            let tally = Tally { samples: 2, observations: 2 };
            let moments = Moments { sum: Rgb::splat(sum), spread: Rgb::splat(spread) };
            film.insert(PassNode::of_pass(first, tally, vec![moments], 1));
        }
        Picture { samples: 2 * passes.len() as u32, ..Picture::new(film, 1, 2, 0) }.to_bytes()
    }

    #[test]
    fn numbers_that_no_picture_has_are_refused() {
        assert!(check_checkpoint(&checkpoint(&[(0, 1.0, 0.0), (1, 2.0, 0.0), (5, 3.0, 0.5)])));
        for (sum, spread) in [(f64::NAN, 0.0), (1.0, f64::INFINITY), (1.0, -1.0)] {
            let result = Picture::from_bytes(&checkpoint(&[(0, sum, spread)]));
            assert_eq!(result, Err(CheckpointError::Malformed("radiance")), "{sum} {spread}");
        }
        let good = checkpoint(&[(0, 1.0, 0.0)]);
        for number in [f64::NAN, -1.0, f64::INFINITY] {
            let mut bytes = good.clone();
            // Before the pixel, its block, the checksum and the end.
            let at = bytes.len() - 64 - 8 - 24 - 48 - 24;
            bytes[at..at + 8].copy_from_slice(&number.to_le_bytes());
            let result = Picture::from_bytes(&resealed(&bytes).unwrap());
            assert_eq!(result, Err(CheckpointError::Malformed("dispersion")), "{number}");
        }
        let empty = |width, height| {
            Picture::new(Film::new(width, 0..height, PathReuse::Off), height, 1, 0).to_bytes()
        };
        let huge = empty(1 << 20, 1 << 20);
        assert_eq!(Picture::from_bytes(&huge), Err(CheckpointError::Malformed("size")));
        let large = empty(Settings::MAX_PIXELS as u32, 1);
        assert!(Picture::from_bytes(&large).is_ok(), "a large picture without passes is small");
    }
}
