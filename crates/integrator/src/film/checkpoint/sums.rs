//! The end of a checkpoint: the sums over all its pixels (their number, means, variances of means), and a checksum.

use super::bytes::{ByteReader, sealed, unsealed};
use crate::CheckpointError;
use crate::film::PixelSums;

/// Bytes of the end.
pub(super) const LENGTH: u64 = 64;

pub(super) fn to_bytes(sums: &PixelSums, seed: u64) -> Vec<u8> {
    let mut bytes = sums.pixels.to_le_bytes().to_vec();
    let numbers = [sums.mean, sums.variance].into_iter().flat_map(|sum| sum.to_array());
    bytes.extend(numbers.flat_map(f64::to_le_bytes));
    sealed(seed, bytes).0
}

pub(super) fn from_bytes(bytes: &[u8], seed: u64) -> Result<PixelSums, CheckpointError> {
    let (content, _) = unsealed(seed, bytes)?;
    let mut numbers = ByteReader(content);
    Ok(PixelSums { pixels: numbers.u64()?, mean: numbers.rgb()?, variance: numbers.rgb()? })
}
