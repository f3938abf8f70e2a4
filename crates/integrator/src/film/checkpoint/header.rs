use super::bytes::{self, ByteReader, sealed};
use crate::error::CHECKPOINT_VERSION;
use crate::film::moments::Tally;
use crate::film::pass_node::{PassNodeHeader, passes_of};
use crate::film::{Film, Picture};
use crate::pixel_rect::SQUARE_SIDE;
use crate::{CheckpointError, Counters, PathReuse, Settings};
use std::io::Read;
use std::ops::Range;

const MAGIC: [u8; 8] = *b"GLBLPASS";
/// Bytes before the strips.
const FIXED_BYTES: u64 = 8 + 11 * 4 + 8 * (1 + Counters::COUNT as u64);
/// Bytes of a strip before its nodes.
const STRIP_BYTES: u64 = 12;
/// Bytes of a node.
const NODE_BYTES: u64 = 24;

/// What a checkpoint says before its pixels: of which picture it holds which passes.
///
/// Fixed numbers (magic, version, number of strips and their length in bytes, width, height, size of the whole picture,
/// origin of the crop, samples in a pass, kind of path reuse, key, counters) are followed by the strips (first row, one
/// past the last, number of nodes, and for each node first pass, passes, samples, observations), and by a checksum.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct CheckpointHeader {
    /// [`Picture::key`].
    pub key: u64,
    /// Width of the picture or crop in pixels.
    pub width: u32,
    /// Height of the picture or crop in pixels.
    pub height: u32,
    /// Width and height of the whole picture ([`Film::full_size`]).
    pub full_size: [u32; 2],
    /// Column and row in the whole picture of the upper left pixel of the picture or crop. Rows of strips count from there.
    pub crop_origin: [u32; 2],
    /// [`Picture::pass_samples`].
    pub pass_samples: u32,
    /// [`Film::path_reuse`].
    pub path_reuse: PathReuse,
    /// Counts of rays and ends of paths.
    pub counters: Counters,
    /// The rows that are held, from the top; none if no pass is. Strips that meet hold different passes.
    pub strips: Vec<CheckpointStrip>,
}

/// Rows of a picture that hold the same passes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CheckpointStrip {
    pub(in crate::film) rows: Range<u32>,
    /// In the order of their passes; no two that could be joined.
    pub(in crate::film) nodes: Vec<PassNodeHeader>,
}

impl CheckpointStrip {
    /// The rows of the picture or crop, of which row 0 is at the top.
    pub fn rows(&self) -> Range<u32> {
        self.rows.clone()
    }

    /// The passes that each pixel holds, as ranges in ascending order that neither meet nor overlap.
    pub fn passes(&self) -> Vec<Range<u32>> {
        passes_of(&self.nodes)
    }

    /// The samples that each pixel holds.
    pub fn samples(&self) -> u64 {
        self.nodes.iter().map(|node| node.tally.samples).sum()
    }

    /// The strip's rows of tiles.
    pub(super) fn tile_rows(&self) -> impl Iterator<Item = Range<u32>> {
        (0..).map_while(|index| self.tile_row(index))
    }

    /// The rows of a row of tiles; `None` after the last one.
    pub(super) fn tile_row(&self, index: u32) -> Option<Range<u32>> {
        let Range { start, end } = self.rows;
        let first = start.checked_add(index.checked_mul(SQUARE_SIDE)?)?;
        (first < end).then(|| first..end.min(first.saturating_add(SQUARE_SIDE)))
    }
}

impl CheckpointHeader {
    pub(in crate::film) fn of(picture: &Picture) -> Self {
        let film = &picture.film;
        let nodes: Vec<PassNodeHeader> = film.nodes().iter().map(|node| node.header).collect();
        let strips = (!nodes.is_empty()).then(|| CheckpointStrip { rows: film.rows(), nodes });
        Self {
            key: picture.key,
            width: film.width(),
            height: picture.height,
            full_size: film.full_size,
            crop_origin: film.crop_origin,
            pass_samples: picture.pass_samples,
            path_reuse: film.path_reuse(),
            counters: picture.counters,
            strips: strips.into_iter().collect(),
        }
    }

    /// The number of bytes of the checkpoint. A file of another length is damaged.
    pub fn file_length(&self) -> u64 {
        let rows = self.strips.iter().flat_map(|strip| {
            strip.tile_rows().map(|rows| super::rows::length(&self.empty(rows), &strip.nodes))
        });
        FIXED_BYTES + self.strips_length() + 8 + rows.sum::<u64>() + super::sums::LENGTH
    }

    /// A film of these rows without passes.
    pub(super) fn empty(&self, rows: Range<u32>) -> Film {
        Film::new(self.width, rows, self.path_reuse).within(self.full_size, self.crop_origin)
    }

    fn strips_length(&self) -> u64 {
        let length = |strip: &CheckpointStrip| STRIP_BYTES + NODE_BYTES * strip.nodes.len() as u64;
        self.strips.iter().map(length).sum()
    }

    /// The header's bytes, and their checksum.
    pub(super) fn to_bytes(&self) -> (Vec<u8>, u64) {
        let mut bytes = MAGIC.to_vec();
        let (strips, length) = (self.strips.len() as u32, self.strips_length() as u32);
        let window = [[self.width, self.height], self.full_size, self.crop_origin].into_iter().flatten();
        let numbers = [CHECKPOINT_VERSION, strips, length].into_iter().chain(window);
        let numbers = numbers.chain([self.pass_samples, self.path_reuse.code()]);
        bytes.extend(numbers.flat_map(u32::to_le_bytes));
        let numbers = [self.key].into_iter().chain(self.counters.to_array());
        bytes.extend(numbers.flat_map(u64::to_le_bytes));
        for CheckpointStrip { rows, nodes } in &self.strips {
            bytes.extend([rows.start, rows.end, nodes.len() as u32].into_iter().flat_map(u32::to_le_bytes));
            for PassNodeHeader { first, passes, tally } in nodes {
                bytes.extend([first, passes].into_iter().flat_map(|number| number.to_le_bytes()));
                bytes.extend([tally.samples, tally.observations].into_iter().flat_map(u64::to_le_bytes));
            }
        }
        sealed(0, bytes)
    }

    /// Reads a header and its checksum.
    pub(super) fn read(source: &mut impl Read) -> Result<(Self, u64), CheckpointError> {
        let mut bytes = Vec::new();
        let fixed = bytes::read(source, FIXED_BYTES, &mut bytes);
        let rest = bytes.strip_prefix(&MAGIC).ok_or(CheckpointError::NoCheckpoint)?;
        let version = ByteReader(rest).u32()?;
        if version != CHECKPOINT_VERSION {
            return Err(CheckpointError::Version(version));
        }
        fixed?;
        let mut numbers = ByteReader(&rest[4..]);
        let (count, length) = (numbers.u32()?, numbers.u32()?);
        let mut pair = || Ok::<_, CheckpointError>([numbers.u32()?, numbers.u32()?]);
        let ([width, height], full_size, crop_origin) = (pair()?, pair()?, pair()?);
        let (pass_samples, path_reuse) = (numbers.u32()?, numbers.u32()?);
        let key = numbers.u64()?;
        let mut counters = [0; Counters::COUNT];
        for counter in &mut counters {
            *counter = numbers.u64()?;
        }
        bytes::read(source, u64::from(length) + 8, &mut bytes)?;
        let (content, checksum) = bytes::unsealed(0, &bytes)?;
        let mut numbers = ByteReader(&content[FIXED_BYTES as usize..]);
        let strips = (0..count).map(|_| CheckpointStrip::read(&mut numbers)).collect::<Result<_, _>>()?;
        if !numbers.0.is_empty() {
            return Err(CheckpointError::Length);
        }
        let path_reuse =
            PathReuse::of_code(path_reuse).ok_or(CheckpointError::Malformed("kind of path reuse"))?;
        let counters = Counters::from_array(counters);
        let header =
            Self { key, width, height, full_size, crop_origin, pass_samples, path_reuse, counters, strips };
        header.validate()?;
        Ok((header, checksum))
    }

    /// The bytes of the header that `bytes` begin with, without its checksum.
    #[cfg(any(test, feature = "fuzz"))]
    pub(super) fn content(bytes: &[u8]) -> Option<&[u8]> {
        // The magic, the version and the number of strips are before the length.
        let length = ByteReader(bytes.get(16..)?).u32().ok()?;
        bytes.get(..FIXED_BYTES as usize + length as usize)
    }

    fn validate(&self) -> Result<(), CheckpointError> {
        let [width, height] = self.full_size.map(u64::from);
        let are_within = [self.width, self.height]
            .into_iter()
            .zip(self.crop_origin)
            .zip([width, height])
            .all(|((length, start), end)| length > 0 && u64::from(start) + u64::from(length) <= end);
        if !are_within || width * height > Settings::MAX_PIXELS {
            return Err(CheckpointError::Malformed("size"));
        }
        for strip in &self.strips {
            strip.validate(self)?;
        }
        let in_order = |pair: &[CheckpointStrip]| {
            let [upper, lower] = pair else { return true };
            let meet = upper.rows.end == lower.rows.start;
            upper.rows.end <= lower.rows.start && !(meet && upper.nodes == lower.nodes)
        };
        if !self.strips.windows(2).all(in_order) {
            return Err(CheckpointError::Malformed("order of rows"));
        }
        Ok(())
    }
}

impl CheckpointStrip {
    fn read(numbers: &mut ByteReader<'_>) -> Result<Self, CheckpointError> {
        let rows = numbers.u32()?..numbers.u32()?;
        let count = numbers.u32()?;
        let node = |_| {
            let (first, passes) = (numbers.u32()?, numbers.u32()?);
            let tally = Tally { samples: numbers.u64()?, observations: numbers.u64()? };
            Ok(PassNodeHeader { first, passes, tally })
        };
        Ok(Self { rows, nodes: (0..count).map(node).collect::<Result<_, _>>()? })
    }

    fn validate(&self, header: &CheckpointHeader) -> Result<(), CheckpointError> {
        let Range { start, end } = self.rows;
        let whole = |row: u32| row.is_multiple_of(SQUARE_SIDE);
        if start >= end || end > header.height || !whole(start) || !(whole(end) || end == header.height) {
            return Err(CheckpointError::Malformed("range of rows"));
        }
        let Some(last) = self.nodes.last() else { return Err(CheckpointError::Malformed("strip")) };
        if !self.nodes.iter().all(PassNodeHeader::is_node) {
            return Err(CheckpointError::Malformed("node of passes"));
        }
        let in_order = |pair: &[PassNodeHeader]| {
            let [a, b] = pair else { return true };
            a.range().end <= b.range().start && !a.is_sibling(b)
        };
        if !self.nodes.windows(2).all(in_order) {
            return Err(CheckpointError::Malformed("order of passes"));
        }
        for node in &self.nodes {
            let PassNodeHeader { passes, tally, .. } = *node;
            let lacking = node.lacks(header.pass_samples);
            // Only the last node may lack samples, fewer than a pass.
            let whole = lacking == Some(0) || node == last && lacking.is_some();
            let observed = (u64::from(passes)..=tally.samples).contains(&tally.observations);
            if !whole || !observed || tally.samples > u64::from(u32::MAX) {
                return Err(CheckpointError::Malformed("number of samples"));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::{CheckpointReader, CheckpointWriter};
    use super::*;

    /// Headers of strips and nodes that no render writes.
    #[test]
    fn strips_that_no_picture_has_are_refused() {
        let node = |first, passes: u32| {
            let tally = Tally { samples: 2 * u64::from(passes), observations: passes.into() };
            PassNodeHeader { first, passes, tally }
        };
        let strip = |rows, nodes: &[PassNodeHeader]| CheckpointStrip { rows, nodes: nodes.to_vec() };
        let header = |strips: Vec<CheckpointStrip>| {
            let picture = Picture::new(Film::new(3, 0..40, PathReuse::Off), 40, 2, 7);
            CheckpointHeader { strips, ..CheckpointHeader::of(&picture) }
        };
        let read = |strips| {
            let bytes = CheckpointWriter::new(Vec::new(), &header(strips)).unwrap().finish().unwrap();
            CheckpointReader::new(&bytes[..]).map(|reader| reader.header().clone())
        };
        let good = vec![strip(0..16, &[node(0, 2), node(2, 1)]), strip(16..40, &[node(4, 4)])];
        assert_eq!(read(good.clone()), Ok(header(good)));
        let short = PassNodeHeader { tally: Tally { samples: 1, observations: 1 }, ..node(2, 1) };
        assert!(read(vec![strip(0..40, &[node(0, 2), short])]).is_ok(), "the last pass may be cut short");
        for (what, strips) in [
            ("range of rows", vec![strip(0..8, &[node(0, 1)])]),
            ("range of rows", vec![strip(16..16, &[node(0, 1)])]),
            ("range of rows", vec![strip(32..48, &[node(0, 1)])]),
            ("strip", vec![strip(0..16, &[])]),
            ("node of passes", vec![strip(0..16, &[node(1, 2)])]),
            ("node of passes", vec![strip(0..16, &[node(0, 3)])]),
            ("order of passes", vec![strip(0..16, &[node(0, 1), node(1, 1)])]),
            ("order of passes", vec![strip(0..16, &[node(4, 1), node(2, 1)])]),
            ("order of rows", vec![strip(16..32, &[node(0, 1)]), strip(0..16, &[node(0, 1)])]),
            ("order of rows", vec![strip(0..16, &[node(0, 1)]), strip(16..32, &[node(0, 1)])]),
            ("number of samples", vec![strip(0..16, &[short, node(4, 1)])]),
        ] {
            assert_eq!(read(strips.clone()), Err(CheckpointError::Malformed(what)), "{strips:?}");
        }
    }

    /// Crops that lie within no picture.
    #[test]
    fn windows_that_no_picture_has_are_refused() {
        let read = |width: u32, full_size, origin| {
            let film = Film::new(width, 0..40, PathReuse::Off).within(full_size, origin);
            let bytes = Picture::new(film, 40, 2, 7).to_bytes();
            Picture::from_bytes(&bytes).map(|picture| (picture.film.full_size(), picture.film.origin()))
        };
        assert_eq!(read(3, [9, 50], [6, 10]), Ok(([9, 50], [6, 10])));
        for (width, full_size, origin) in [
            (3, [9, 50], [7, 0]),
            (3, [9, 50], [0, 11]),
            (3, [9, 50], [u32::MAX, 0]),
            (0, [9, 50], [0, 0]),
            (3, [1 << 14, (1 << 13) + 1], [0, 0]),
        ] {
            assert_eq!(
                read(width, full_size, origin),
                Err(CheckpointError::Malformed("size")),
                "{full_size:?}"
            );
        }
    }
}
