//! Checkpoints: films as files.
//!
//! All numbers are little-endian. A [header](CheckpointHeader) says which passes of which rows are held. The
//! [rows](rows) follow from the top, a row of tiles at a time, and at the end the sums over all pixels.
//! Each of these ends with a checksum, so that a checkpoint is read and written with the memory of one row of tiles.

mod header;
mod merge;
mod reader;
mod rows;
mod sums;
mod writer;

pub use header::{CheckpointHeader, CheckpointStrip};
pub use merge::Merge;
pub use reader::CheckpointReader;
pub use writer::CheckpointWriter;

use super::{Film, Picture};
use crate::{CheckpointError, bytes};

impl Picture {
    /// The picture as a checkpoint, the same bytes on every machine.
    pub fn to_bytes(&self) -> Vec<u8> {
        let header = CheckpointHeader::of(self);
        let bytes = Vec::with_capacity(header.file_length() as usize);
        let written = CheckpointWriter::new(bytes, &header).and_then(|mut writer| {
            writer.write(&self.film)?;
            writer.finish()
        });
        written.unwrap_or_else(|error| unreachable!("a vector takes all bytes: {error}"))
    }

    /// The picture that [`Picture::to_bytes`] wrote.
    ///
    /// # Errors
    /// [`CheckpointError`] for any other bytes, without having allocated more memory than a small multiple of
    /// their length; [`CheckpointError::Uneven`] for a checkpoint whose rows hold different passes.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, CheckpointError> {
        let mut reader = CheckpointReader::new(bytes)?;
        let header = reader.header().clone();
        let rows = match header.strips.as_slice() {
            [] => 0..header.height,
            [strip] => strip.rows.clone(),
            _ => return Err(CheckpointError::Uneven),
        };
        let samples = header.strips.iter().map(CheckpointStrip::samples).sum::<u64>();
        let samples = samples.try_into().map_err(|_| CheckpointError::Malformed("number of samples"))?;
        let mut film: Option<Film> = None;
        while let Some(below) = reader.next_rows()? {
            match &mut film {
                Some(film) => film.append(below),
                None => film = Some(below),
            }
        }
        let film = film.unwrap_or_else(|| header.empty(rows));
        let picture = Self::new(film, header.height, header.pass_samples, header.key);
        Ok(Self { counters: header.counters, samples, ..picture })
    }
}

/// `bytes` with correct checksums, which a fuzzer does not find by itself; `None` if they are not even as long as their header.
#[cfg(any(test, feature = "fuzz"))]
pub(super) fn resealed(bytes: &[u8]) -> Option<Vec<u8>> {
    let content = CheckpointHeader::content(bytes)?;
    let mut rest = bytes.get(content.len() + 8..)?;
    let (mut all, checksum) = bytes::sealed(0, content.to_vec());
    let Ok((header, _)) = CheckpointHeader::read(&mut &all[..]) else { return Some([&all, rest].concat()) };
    for strip in &header.strips {
        for tile_row in strip.tile_rows() {
            let length = rows::length(&header.empty(tile_row.clone()), &strip.nodes) as usize;
            let Some((row, below)) = rest.split_at_checked(length) else {
                return Some([&all, rest].concat());
            };
            let seed = reader::row_seed(checksum, tile_row.start);
            all.extend(bytes::sealed(seed, row[..length - 8].to_vec()).0);
            rest = below;
        }
    }
    let Some((sums, below)) = rest.split_at_checked(sums::LENGTH as usize) else {
        return Some([&all, rest].concat());
    };
    all.extend(bytes::sealed(checksum, sums[..sums.len() - 8].to_vec()).0);
    Some([&all, below].concat())
}
