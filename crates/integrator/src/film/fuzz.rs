use super::checkpoint::resealed;
use super::picture::Picture;

/// Reads `bytes` as a checkpoint, as they are and with their checksum made right, which nobody
/// guesses; returns whether the latter is one.
///
/// # Panics
/// If what is read does not come back from its own bytes, or tells what no picture can.
pub fn check_checkpoint(bytes: &[u8]) -> bool {
    let check = |bytes: &[u8]| Picture::from_bytes(bytes).is_ok_and(|picture| check_picture(&picture));
    check(bytes);
    resealed(bytes).is_some_and(|bytes| check(&bytes))
}

fn check_picture(picture: &Picture) -> bool {
    assert_eq!(Picture::from_bytes(&picture.to_bytes()).as_ref(), Ok(picture));
    let film = &picture.film;
    if film.samples() > 0 {
        assert!(film.means().all(|mean| mean.is_finite()));
        assert!(film.variances_of_mean().all(|variance| variance.to_array().iter().all(|&x| x >= 0.0)));
        assert!(picture.clone().merge(picture.clone()).is_err(), "passes count once");
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{CheckpointError, Film, PathReuse, Settings};

    #[test]
    fn the_fuzzers_corpus() {
        let corpus = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/corpus/checkpoint");
        let files = std::fs::read_dir(corpus).unwrap().map(|entry| std::fs::read(entry.unwrap().path()));
        let good = files.filter(|bytes| check_checkpoint(bytes.as_ref().unwrap())).count();
        assert!(good > 0, "not one file is good");
    }

    fn picture(width: u32, height: u32) -> Picture {
        Picture::new(Film::new(width, height, PathReuse::Off), 1, 0)
    }

    /// A checkpoint of one pixel: its blocks hold one pass each, with these sums and spreads.
    fn checkpoint(passes: impl IntoIterator<Item = (u32, f64, f64)>) -> Vec<u8> {
        let empty = picture(1, 1).to_bytes();
        let (mut bytes, mut count) = (empty[..empty.len() - 12].to_vec(), 0_u32);
        let mut blocks = Vec::new();
        for (first, sum, spread) in passes {
            blocks.extend([first, 1].into_iter().flat_map(u32::to_le_bytes));
            blocks.extend([1_u64, 1, 0, 0].into_iter().flat_map(u64::to_le_bytes));
            blocks.extend([sum, sum, sum, spread, spread, spread].into_iter().flat_map(f64::to_le_bytes));
            count += 1;
        }
        bytes.extend(count.to_le_bytes());
        bytes.extend(blocks);
        bytes.extend([0; 8]);
        resealed(&bytes).unwrap()
    }

    #[test]
    fn numbers_that_no_picture_has_are_refused() {
        assert!(check_checkpoint(&checkpoint([(0, 1.0, 0.0), (1, 2.0, 0.0), (5, 3.0, 0.5)])));
        let impossible: [&[_]; 4] = [
            &[(0, f64::NAN, 0.0)],
            &[(0, 1.0, f64::INFINITY)],
            &[(0, 1.0, -1.0)],
            // Each is finite, their sum is not.
            &[(0, f64::MAX, 0.0), (1, f64::MAX, 0.0)],
        ];
        for passes in impossible {
            let result = Picture::from_bytes(&checkpoint(passes.iter().copied()));
            assert_eq!(result, Err(CheckpointError::Malformed("radiance")), "{passes:?}");
        }
        for (variance, dof) in [(f64::NAN, 1.0), (-1.0, 1.0), (1.0, f64::INFINITY), (1.0, 0.0)] {
            let mut bytes = checkpoint([(0, 1.0, 0.0)]);
            // Before the pixel and the checksum.
            let at = bytes.len() - 8 - 48 - 16;
            bytes[at..at + 8].copy_from_slice(&variance.to_le_bytes());
            bytes[at + 8..at + 16].copy_from_slice(&f64::to_le_bytes(dof));
            let result = Picture::from_bytes(&resealed(&bytes).unwrap());
            assert_eq!(result, Err(CheckpointError::Malformed("dispersion")), "{variance}, {dof}");
        }
        let mut huge = picture(1 << 20, 1 << 20).to_bytes();
        assert_eq!(Picture::from_bytes(&huge), Err(CheckpointError::Malformed("size")));
        huge = picture(Settings::MAX_PIXELS as u32, 1).to_bytes();
        assert!(Picture::from_bytes(&huge).is_ok(), "a large picture without passes is small");
    }
}
