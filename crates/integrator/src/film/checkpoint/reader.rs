use super::bytes;
use super::header::CheckpointHeader;
use super::{rows, sums};
use crate::CheckpointError;
use crate::film::{Film, PixelSums};
use crate::hash::fold;
use std::io::{ErrorKind, Read, Seek, SeekFrom};
use std::mem;
use std::ops::Range;

/// Reads a checkpoint from the top: first what it holds, then its rows, a row of tiles at a time.
///
/// The memory is that of one row of tiles, [`Film::TILE_ROWS`] rows of pixels, whatever the height of the picture.
///
/// ```
/// use globillum_integrator::{CheckpointError, CheckpointReader};
/// use std::io::Read;
///
/// /// The mean luminance of the rows that a checkpoint holds, and of how many samples a pixel.
/// fn mean(file: impl Read) -> Result<(f64, u64), CheckpointError> {
///     let mut reader = CheckpointReader::new(file)?;
///     let samples = reader.header().strips.first().map_or(0, |strip| strip.samples());
///     let (mut sum, mut pixels) = (0.0, 0);
///     while let Some(rows) = reader.next_rows()? {
///         sum += rows.means().map(|mean| mean.luminance()).sum::<f64>();
///         pixels += rows.width() * rows.height();
///     }
///     Ok((sum / f64::from(pixels), samples))
/// }
/// ```
#[derive(Debug)]
pub struct CheckpointReader<R> {
    source: R,
    header: CheckpointHeader,
    checksum: u64,
    /// The strips that are read.
    strips: usize,
    /// The rows of tiles of the next one that are read.
    tile_rows: u32,
    /// Whether the end is read.
    has_ended: bool,
}

impl<R: Read> CheckpointReader<R> {
    /// Reads the header. `source` need not be buffered: it is read by whole rows of tiles.
    ///
    /// # Errors
    /// [`CheckpointError`] if `source` cannot be read or does not begin with the header of a checkpoint.
    pub fn new(mut source: R) -> Result<Self, CheckpointError> {
        let (header, checksum) = CheckpointHeader::read(&mut source)?;
        Ok(Self { source, header, checksum, strips: 0, tile_rows: 0, has_ended: false })
    }

    /// What the checkpoint holds.
    pub fn header(&self) -> &CheckpointHeader {
        &self.header
    }

    /// The next row of tiles as a film of its own; `None` after the last one.
    ///
    /// # Errors
    /// [`CheckpointError`] if `source` cannot be read, ends too early or too late, or is damaged.
    pub fn next_rows(&mut self) -> Result<Option<Film>, CheckpointError> {
        let Some(rows) = self.next_row() else {
            // The end is read once.
            return if mem::replace(&mut self.has_ended, true) { Ok(None) } else { self.end().map(|_| None) };
        };
        let strip = &self.header.strips[self.strips];
        let is_last = rows.end == strip.rows.end;
        let (film, seed) = (self.header.empty(rows.clone()), row_seed(self.checksum, rows.start));
        let mut bytes = Vec::new();
        bytes::read(&mut self.source, rows::length(&film, &strip.nodes), &mut bytes)?;
        let film = rows::from_bytes(film, &strip.nodes, &bytes, seed)?;
        (self.strips, self.tile_rows) =
            if is_last { (self.strips + 1, 0) } else { (self.strips, self.tile_rows + 1) };
        Ok(Some(film))
    }

    /// The rows that [`CheckpointReader::next_rows`] returns next.
    pub(super) fn next_row(&self) -> Option<Range<u32>> {
        self.header.strips.get(self.strips)?.tile_row(self.tile_rows)
    }

    /// Nothing follows the sums over all pixels.
    fn end(&mut self) -> Result<PixelSums, CheckpointError> {
        let mut bytes = Vec::new();
        bytes::read(&mut self.source, sums::LENGTH, &mut bytes)?;
        let sums = sums::from_bytes(&bytes, self.checksum)?;
        match self.source.read_exact(&mut [0]) {
            Ok(()) => Err(CheckpointError::Length),
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => Ok(sums),
            Err(error) => Err(CheckpointError::Read(error.kind())),
        }
    }
}

impl<R: Read + Seek> CheckpointReader<R> {
    /// The sums over all pixels, read from the end of a checkpoint that begins where `source` does. No row is
    /// read: damage in one is not found.
    ///
    /// # Errors
    /// [`CheckpointError`] if `source` cannot be read, has another length than the header says, or ends with a
    /// damaged sum.
    pub fn into_sums(mut self) -> Result<PixelSums, CheckpointError> {
        let end = self.header.file_length() - sums::LENGTH;
        self.source.seek(SeekFrom::Start(end)).map_err(|error| CheckpointError::Read(error.kind()))?;
        self.end()
    }
}

/// Rows of another file, or of another place in the same, have another checksum.
pub(super) fn row_seed(checksum: u64, first_row: u32) -> u64 {
    fold(checksum, first_row.into())
}
