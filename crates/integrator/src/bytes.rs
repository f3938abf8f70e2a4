//! Numbers written as bytes and read again, and checksums.

use crate::CheckpointError;
use crate::hash::fold;
use globillum_material::Rgb;
use std::io::Read;

/// Words of a checksum that are hashed at the same time.
const LANES: usize = 4;

/// A hash of all bytes, their number and `seed`.
pub(super) fn checksum(seed: u64, bytes: &[u8]) -> u64 {
    let word = |chunk: &[u8]| {
        let mut word = [0; 8];
        word[..chunk.len()].copy_from_slice(chunk);
        u64::from_le_bytes(word)
    };
    let mut lanes: [u64; LANES] = std::array::from_fn(|lane| lane as u64);
    let mut chunks = bytes.chunks_exact(8 * LANES);
    for chunk in &mut chunks {
        for (lane, chunk) in lanes.iter_mut().zip(chunk.chunks_exact(8)) {
            *lane = fold(*lane, word(chunk));
        }
    }
    let rest = chunks.remainder().chunks(8).map(word);
    lanes.into_iter().chain(rest).fold(fold(seed, bytes.len() as u64), fold)
}

/// Bytes with the checksum of all of them at the end.
pub(super) fn sealed(seed: u64, mut bytes: Vec<u8>) -> (Vec<u8>, u64) {
    let checksum = checksum(seed, &bytes);
    bytes.extend(checksum.to_le_bytes());
    (bytes, checksum)
}

/// The content of bytes that [`sealed`] has made, and its checksum.
pub(super) fn unsealed(seed: u64, bytes: &[u8]) -> Result<(&[u8], u64), CheckpointError> {
    let (content, end) = bytes.split_last_chunk::<8>().ok_or(CheckpointError::Length)?;
    let checksum = checksum(seed, content);
    if checksum == u64::from_le_bytes(*end) {
        Ok((content, checksum))
    } else {
        Err(CheckpointError::Checksum)
    }
}

/// Appends `length` bytes of `source` to `bytes`, of which no more are allocated than there are.
pub(super) fn read(source: &mut impl Read, length: u64, bytes: &mut Vec<u8>) -> Result<(), CheckpointError> {
    let taken =
        source.take(length).read_to_end(bytes).map_err(|error| CheckpointError::Read(error.kind()))?;
    if taken as u64 == length { Ok(()) } else { Err(CheckpointError::Length) }
}

/// Takes numbers from the front.
#[derive(Debug)]
pub(super) struct ByteReader<'a>(pub(super) &'a [u8]);

impl ByteReader<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], CheckpointError> {
        let (head, rest) = self.0.split_first_chunk().ok_or(CheckpointError::Length)?;
        self.0 = rest;
        Ok(*head)
    }

    pub(super) fn u32(&mut self) -> Result<u32, CheckpointError> {
        Ok(u32::from_le_bytes(self.take()?))
    }

    pub(super) fn u64(&mut self) -> Result<u64, CheckpointError> {
        Ok(u64::from_le_bytes(self.take()?))
    }

    pub(super) fn f64(&mut self) -> Result<f64, CheckpointError> {
        Ok(f64::from_le_bytes(self.take()?))
    }

    pub(super) fn rgb(&mut self) -> Result<Rgb, CheckpointError> {
        Ok(Rgb::new(self.f64()?, self.f64()?, self.f64()?))
    }
}
