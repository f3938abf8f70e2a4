//! The checkpoint format.
//!
//! All numbers are little-endian. A header (magic, version, key, width, height, samples in a pass,
//! kind of path reuse, counters, number of blocks) is followed by the blocks of the film (first pass,
//! passes, samples, observations, variance and degrees of freedom of its dispersion, then for each pixel the
//! sum and the spread of three components as `f64`), and by a checksum of all bytes before it.

use super::block::Block;
use super::dispersion::Dispersion;
use super::moments::{Moments, Tally};
use super::{Film, Picture};
use crate::error::CHECKPOINT_VERSION;
use crate::hash::fold;
use crate::{CheckpointError, Counters, PathReuse, Settings};
use globillum_material::Rgb;

const MAGIC: [u8; 8] = *b"GLBLPASS";

/// Bytes of a pixel in a block: six numbers.
const PIXEL_BYTES: u64 = 48;
/// Bytes of a block before its pixels.
const BLOCK_BYTES: u64 = 40;
/// Passes are numbered by 32 bits: the tree's nodes that cover any number of them, gaps included,
/// are fewer than this for every picture that is rendered in a sensible number of parts.
const MAX_BLOCKS: u32 = 1 << 20;

impl Picture {
    /// The picture as a checkpoint, the same bytes on every machine.
    pub fn to_bytes(&self) -> Vec<u8> {
        let blocks = self.film.blocks();
        let mut bytes = Vec::with_capacity(
            128 + blocks.len() * (BLOCK_BYTES + PIXEL_BYTES * self.film.pixel_count() as u64) as usize,
        );
        bytes.extend(MAGIC);
        bytes.extend(CHECKPOINT_VERSION.to_le_bytes());
        bytes.extend(self.key.to_le_bytes());
        bytes.extend(self.film.width().to_le_bytes());
        bytes.extend(self.film.height().to_le_bytes());
        bytes.extend(self.pass_samples.to_le_bytes());
        bytes.extend(self.film.path_reuse().code().to_le_bytes());
        bytes.extend(self.counters.to_array().iter().flat_map(|n| n.to_le_bytes()));
        bytes.extend((blocks.len() as u32).to_le_bytes());
        for block in blocks {
            put_block(&mut bytes, block);
        }
        let checksum = checksum(&bytes);
        bytes.extend(checksum.to_le_bytes());
        bytes
    }

    /// The picture that [`Picture::to_bytes`] wrote.
    ///
    /// # Errors
    /// [`CheckpointError`] for any other bytes, without having allocated more memory than a small
    /// multiple of their length.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, CheckpointError> {
        let content = check(bytes)?;
        let mut reader = Reader { bytes: &content[MAGIC.len() + 4..] };
        let (key, width, height) = (reader.u64()?, reader.u32()?, reader.u32()?);
        let (pass_samples, path_reuse) = (reader.u32()?, reader.u32()?);
        let path_reuse =
            PathReuse::of_code(path_reuse).ok_or(CheckpointError::Malformed("kind of path reuse"))?;
        let counters = reader.counters()?;
        let count = reader.u32()?;
        let pixels = u64::from(width) * u64::from(height);
        if pixels == 0 || pixels > Settings::MAX_PIXELS {
            return Err(CheckpointError::Malformed("size"));
        }
        if count > MAX_BLOCKS {
            return Err(CheckpointError::Malformed("number of blocks"));
        }
        if reader.bytes.len() as u64 != u64::from(count) * (BLOCK_BYTES + PIXEL_BYTES * pixels) {
            return Err(CheckpointError::Length);
        }
        let mut film = Film::new(width, height, path_reuse);
        let (mut held, mut samples) = (0_u64, 0_u64);
        for _ in 0..count {
            let block = reader.block(pixels as usize)?;
            let last = film.blocks().last();
            if last.is_some_and(|last| block.range().start < last.range().end) {
                return Err(CheckpointError::Malformed("order of passes"));
            }
            // Only the last block may lack samples, fewer than a pass.
            let full = u64::from(block.passes) * u64::from(pass_samples);
            let lacking = full.checked_sub(block.tally.samples);
            if samples != held || lacking.is_none_or(|lacking| lacking >= u64::from(pass_samples)) {
                return Err(CheckpointError::Malformed("number of samples"));
            }
            held += full;
            samples += block.tally.samples;
            film.insert(block);
        }
        // Blocks were joined, and sums of finite numbers may overflow.
        if film.blocks().iter().flat_map(|block| &block.pixels).any(|moments| !moments.are_possible()) {
            return Err(CheckpointError::Malformed("radiance"));
        }
        let samples = samples.try_into().map_err(|_| CheckpointError::Malformed("number of samples"))?;
        Ok(Self { counters, samples, ..Self::new(film, pass_samples, key) })
    }
}

/// Checks magic, version and checksum; returns the bytes before the checksum.
fn check(bytes: &[u8]) -> Result<&[u8], CheckpointError> {
    let rest = bytes.strip_prefix(&MAGIC).ok_or(CheckpointError::NoCheckpoint)?;
    let version = Reader { bytes: rest }.u32()?;
    if version != CHECKPOINT_VERSION {
        return Err(CheckpointError::Version(version));
    }
    let (content, end) = bytes.split_last_chunk::<8>().ok_or(CheckpointError::Length)?;
    if content.len() < MAGIC.len() + 4 {
        return Err(CheckpointError::Length);
    }
    if checksum(content) == u64::from_le_bytes(*end) { Ok(content) } else { Err(CheckpointError::Checksum) }
}

/// `bytes` with a correct checksum.
#[cfg(any(test, feature = "fuzz"))]
pub(crate) fn resealed(bytes: &[u8]) -> Option<Vec<u8>> {
    let (content, _) = bytes.split_last_chunk::<8>()?;
    Some([content, &checksum(content).to_le_bytes()].concat())
}

/// A hash of all bytes and their number.
fn checksum(bytes: &[u8]) -> u64 {
    let words = bytes.chunks(8).map(|chunk| {
        let mut word = [0; 8];
        word[..chunk.len()].copy_from_slice(chunk);
        u64::from_le_bytes(word)
    });
    words.fold(bytes.len() as u64, fold)
}

fn put_block(bytes: &mut Vec<u8>, block: &Block) {
    bytes.extend(block.first.to_le_bytes());
    bytes.extend(block.passes.to_le_bytes());
    bytes.extend(block.tally.samples.to_le_bytes());
    bytes.extend(block.tally.observations.to_le_bytes());
    bytes.extend(block.dispersion.variance.to_le_bytes());
    bytes.extend(block.dispersion.dof.to_le_bytes());
    for pixel in &block.pixels {
        let numbers = pixel.sum.to_array().into_iter().chain(pixel.spread.to_array());
        bytes.extend(numbers.flat_map(f64::to_le_bytes));
    }
}

/// Reads numbers from the front.
struct Reader<'a> {
    bytes: &'a [u8],
}

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], CheckpointError> {
        let (head, rest) = self.bytes.split_first_chunk().ok_or(CheckpointError::Length)?;
        self.bytes = rest;
        Ok(*head)
    }

    fn u32(&mut self) -> Result<u32, CheckpointError> {
        Ok(u32::from_le_bytes(self.take()?))
    }

    fn u64(&mut self) -> Result<u64, CheckpointError> {
        Ok(u64::from_le_bytes(self.take()?))
    }

    fn f64(&mut self) -> Result<f64, CheckpointError> {
        Ok(f64::from_le_bytes(self.take()?))
    }

    fn rgb(&mut self) -> Result<Rgb, CheckpointError> {
        Ok(Rgb::new(self.f64()?, self.f64()?, self.f64()?))
    }

    fn counters(&mut self) -> Result<Counters, CheckpointError> {
        let mut numbers = [0; Counters::COUNT];
        for number in &mut numbers {
            *number = self.u64()?;
        }
        Ok(Counters::from_array(numbers))
    }

    fn block(&mut self, pixels: usize) -> Result<Block, CheckpointError> {
        let (first, passes) = (self.u32()?, self.u32()?);
        let tally = Tally { samples: self.u64()?, observations: self.u64()? };
        let dispersion = Dispersion { variance: self.f64()?, dof: self.f64()? };
        if !dispersion.is_possible() {
            return Err(CheckpointError::Malformed("dispersion"));
        }
        if !Block::is_node(first, passes) {
            return Err(CheckpointError::Malformed("block of passes"));
        }
        if tally.samples > u64::from(u32::MAX)
            || tally.observations < u64::from(passes)
            || tally.observations > tally.samples
        {
            return Err(CheckpointError::Malformed("number of samples"));
        }
        let moments = |reader: &mut Self| {
            let moments = Moments { sum: reader.rgb()?, spread: reader.rgb()? };
            if moments.are_possible() { Ok(moments) } else { Err(CheckpointError::Malformed("radiance")) }
        };
        let pixels = (0..pixels).map(|_| moments(self)).collect::<Result<_, _>>()?;
        Ok(Block { first, passes, tally, pixels, dispersion })
    }
}
