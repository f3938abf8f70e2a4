use super::header::CheckpointHeader;
use super::reader::row_seed;
use super::{rows, sums};
use crate::film::{Film, PixelSums};
use crate::pixel_rect::SQUARE_SIDE;
use std::io::{self, Write};

/// Writes a checkpoint from the top: first what it holds, then its rows, and at the [end](CheckpointWriter::finish)
/// the sums over all pixels.
#[derive(Debug)]
pub struct CheckpointWriter<W> {
    target: W,
    checksum: u64,
    sums: PixelSums,
}

impl<W: Write> CheckpointWriter<W> {
    /// Writes the header.
    ///
    /// # Errors
    /// Those of `target`.
    pub fn new(mut target: W, header: &CheckpointHeader) -> io::Result<Self> {
        let (bytes, checksum) = header.to_bytes();
        target.write_all(&bytes)?;
        Ok(Self { target, checksum, sums: PixelSums::default() })
    }

    /// Writes rows, which must be the next of those that the header lists, with their passes. What reads the
    /// checkpoint finds out if they are not.
    ///
    /// # Errors
    /// Those of `target`.
    pub fn write(&mut self, rows: &Film) -> io::Result<()> {
        if rows.nodes().is_empty() {
            return Ok(());
        }
        for (index, y) in rows.rows().step_by(SQUARE_SIDE as usize).enumerate() {
            let seed = row_seed(self.checksum, y);
            self.target.write_all(&rows::to_bytes(rows, index, seed))?;
        }
        self.sums.add(rows);
        Ok(())
    }

    /// Writes the end, after the last rows; returns what was written to.
    ///
    /// # Errors
    /// Those of `target`.
    pub fn finish(mut self) -> io::Result<W> {
        self.target.write_all(&sums::to_bytes(&self.sums, self.checksum))?;
        Ok(self.target)
    }
}
