use super::header::{CheckpointHeader, CheckpointStrip};
use super::reader::CheckpointReader;
use crate::film::error::ErrorSums;
use crate::film::pass_node::{PassNodeHeader, insert};
use crate::film::{ErrorEstimate, Film};
use crate::{CheckpointError, Counters, MergeError};
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::io::{self, Read};

/// Checkpoints that are read at the same time.
const CHECKPOINTS_AT_ONCE: usize = 16;

/// A merge of checkpoints of one picture, a row of tiles at a time.
///
/// The bits are those of one run, whatever the order of the checkpoints, with merges of merges too. Checkpoints
/// may hold any passes of any strips; equal ones count once. The memory is that of a row of tiles of all
/// checkpoints at most, whatever the height of the picture.
///
/// ```
/// use globillum_integrator::{CheckpointReader, CheckpointWriter, Merge, Render, Settings, render};
/// # use globillum_integrator::{Model, PinholeCamera, Scene};
/// # use glam::{DVec3, Vec3};
/// # use globillum_geom::{KdTree, Triangle};
/// # use globillum_material::{Material, Rgb};
/// # let mut model = Model::default();
/// # let [a, b, c] = [Vec3::new(-9.0, -9.0, -1.0), Vec3::new(9.0, -9.0, -1.0), Vec3::new(0.0, 9.0, -1.0)];
/// # model.add(Material::light(Rgb::WHITE)?, [Triangle::new(a, b, c)]);
/// # let scene = Scene::build(model, KdTree::build)?;
/// # let camera = PinholeCamera::look_at(DVec3::ZERO, -DVec3::Z, DVec3::Y, 0.7)?;
/// let settings = Settings::new(8, 32, 64); // four passes of 16 samples
/// // The tasks of a farm: two strips, and two ranges of passes of each.
/// let mut tasks = Vec::new();
/// for rows in [0..16, 16..32] {
///     for passes in [0..2, 2..4] {
///         let task = Render::new(&scene, &camera, &settings).rows(rows.clone()).passes(passes);
///         tasks.push(task.run()?.to_bytes());
///     }
/// }
/// let readers = tasks.iter().map(|bytes| CheckpointReader::new(&bytes[..])).collect::<Result<_, _>>()?;
/// let merge = Merge::new(readers)?;
/// let mut merged = CheckpointWriter::new(Vec::new(), merge.header())?;
/// let error = merge.run(|rows| merged.write(rows))?;
/// let whole = render(&scene, &camera, &settings)?;
/// assert_eq!((merged.finish()?, error), (whole.to_bytes(), whole.film.error()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Merge<R> {
    inputs: Vec<Input<R>>,
    header: CheckpointHeader,
}

#[derive(Debug)]
struct Input<R> {
    index: usize,
    reader: CheckpointReader<R>,
    /// Checkpoints with the same header.
    twins: Vec<Input<R>>,
}

impl<R: Read + Send> Merge<R> {
    /// Compares what the checkpoints hold. No row is read yet.
    ///
    /// # Errors
    /// [`MergeError::Empty`] without checkpoints. [`MergeError::Input`] for one of another picture than the
    /// first, or with a pass cut short that is not the last of all. [`MergeError::Overlap`] for two that hold
    /// the same pass of a row and do not hold all the same passes.
    pub fn new(checkpoints: Vec<CheckpointReader<R>>) -> Result<Self, MergeError> {
        let mut inputs: Vec<Input<R>> = Vec::new();
        for (index, reader) in checkpoints.into_iter().enumerate() {
            let input = Input { index, reader, twins: Vec::new() };
            input.check_same_picture(inputs.first())?;
            inputs.push(input);
        }
        inputs.sort_by(|a, b| a.place().cmp(&b.place()).then(a.index.cmp(&b.index)));
        inputs = with_twins(inputs);
        let strips = merged_strips(&inputs)?;
        let mut counters = Counters::default();
        inputs.iter().for_each(|input| counters += input.header().counters);
        let header = inputs.first().ok_or(MergeError::Empty)?.header();
        let header = CheckpointHeader { counters, strips, ..header.clone() };
        check_cut_passes(&inputs, &header)?;
        Ok(Self { inputs, header })
    }

    /// What all checkpoints together hold.
    pub fn header(&self) -> &CheckpointHeader {
        &self.header
    }

    /// Hands the merged rows to `each`, from the top, a row of tiles at a time; returns the error of all of them
    /// as one picture ([`Film::error`]). Its interval is unknown if rows hold different passes.
    ///
    /// # Errors
    /// [`MergeError::Input`] for a checkpoint that cannot be read or is damaged, [`MergeError::Overlap`] for two
    /// that differ though their headers are equal, [`MergeError::Write`] for an error of `each`.
    pub fn run(mut self, mut each: impl FnMut(&Film) -> io::Result<()>) -> Result<ErrorEstimate, MergeError> {
        let mut sums = ErrorSums::default();
        for rows in self.header.strips.iter().flat_map(CheckpointStrip::tile_rows) {
            let mut film = self.header.empty(rows.clone());
            let mut holding: Vec<&mut Input<R>> = self
                .inputs
                .iter_mut()
                .filter(|input| input.reader.next_row() == Some(rows.clone()))
                .collect();
            for inputs in holding.chunks_mut(CHECKPOINTS_AT_ONCE) {
                let read: Vec<_> =
                    inputs.par_iter_mut().map(|input| Ok((input.index, input.next_rows()?))).collect();
                for part in read {
                    let (index, part) = part?;
                    film.merge(part).map_err(|error| MergeError::Input { index, error })?;
                }
            }
            sums.add(&film);
            each(&film).map_err(|error| MergeError::Write(error.kind()))?;
        }
        // Nothing may follow the last row.
        self.inputs.iter_mut().try_for_each(Input::end)?;
        Ok(sums.error())
    }
}

impl<R: Read> Input<R> {
    fn header(&self) -> &CheckpointHeader {
        self.reader.header()
    }

    /// Where its first strip begins, in rows and passes.
    fn place(&self) -> Option<(u32, u32)> {
        let strip = self.header().strips.first()?;
        Some((strip.rows.start, strip.nodes.first()?.first))
    }

    fn error(&self, error: CheckpointError) -> MergeError {
        MergeError::Input { index: self.index, error }
    }

    fn check_same_picture(&self, other: Option<&Self>) -> Result<(), MergeError> {
        let picture = |input: &Self| {
            let CheckpointHeader { key, width, height, full_size, crop_origin, .. } = *input.header();
            let CheckpointHeader { pass_samples, path_reuse, .. } = *input.header();
            (key, [width, height], full_size, crop_origin, pass_samples, path_reuse)
        };
        match other {
            Some(other) if picture(self) != picture(other) => Err(self.error(CheckpointError::OTHER_PICTURE)),
            _ => Ok(()),
        }
    }

    /// The next row of tiles; that of the twins is the same.
    fn next_rows(&mut self) -> Result<Film, MergeError> {
        let next = |input: &mut Self| {
            let film = input.reader.next_rows().map_err(|error| input.error(error))?;
            film.ok_or_else(|| input.error(CheckpointError::Length))
        };
        let film = next(self)?;
        for twin in &mut self.twins {
            if next(twin)? != film {
                let pass = film.passes().first().map_or(0, |range| range.start);
                let indices = [self.index, twin.index];
                return Err(MergeError::Overlap { indices, pass, row: film.rows().start });
            }
        }
        Ok(film)
    }

    fn end(&mut self) -> Result<(), MergeError> {
        self.twins.iter_mut().try_for_each(Self::end)?;
        self.reader.next_rows().map_err(|error| self.error(error))?;
        Ok(())
    }
}

/// The inputs, which are ordered by place, each with those of equal headers.
fn with_twins<R: Read>(inputs: Vec<Input<R>>) -> Vec<Input<R>> {
    let mut all: Vec<Input<R>> = Vec::new();
    for input in inputs {
        let near = all.iter_mut().rev().take_while(|other| other.place() == input.place());
        match near.into_iter().find(|other| other.header() == input.header()) {
            Some(twin) => twin.twins.push(input),
            None => all.push(input),
        }
    }
    all
}

/// What the inputs hold together.
fn merged_strips<R: Read>(inputs: &[Input<R>]) -> Result<Vec<CheckpointStrip>, MergeError> {
    let all =
        || inputs.iter().flat_map(|input| input.header().strips.iter().map(move |strip| (input, strip)));
    let ends: BTreeSet<u32> = all().flat_map(|(_, strip)| [strip.rows.start, strip.rows.end]).collect();
    let ends: Vec<u32> = ends.into_iter().collect();
    let mut strips: Vec<CheckpointStrip> = Vec::new();
    for rows in ends.windows(2).map(|pair| pair[0]..pair[1]) {
        let there = all().filter(|(_, strip)| strip.rows.contains(&rows.start));
        let nodes = merged_nodes(rows.start, there)?;
        match strips.last_mut() {
            Some(last) if last.rows.end == rows.start && last.nodes == nodes => last.rows.end = rows.end,
            _ if nodes.is_empty() => {}
            _ => strips.push(CheckpointStrip { rows, nodes }),
        }
    }
    Ok(strips)
}

/// The nodes of one row.
fn merged_nodes<'a, R: Read + 'a>(
    row: u32,
    strips: impl Iterator<Item = (&'a Input<R>, &'a CheckpointStrip)>,
) -> Result<Vec<PassNodeHeader>, MergeError> {
    let nodes = strips.flat_map(|(input, strip)| strip.nodes.iter().map(|node| (*node, input.index)));
    let mut nodes: Vec<(PassNodeHeader, usize)> = nodes.collect();
    nodes.sort_by_key(|(node, index)| (node.first, *index));
    for pair in nodes.windows(2) {
        let [(a, i), (b, j)] = [pair[0], pair[1]];
        if b.range().start < a.range().end {
            return Err(MergeError::Overlap { indices: [i.min(j), i.max(j)], pass: b.first, row });
        }
    }
    let mut merged = Vec::new();
    for (node, _) in nodes {
        insert(&mut merged, node, |node, next| *node = node.joined(*next));
    }
    Ok(merged)
}

/// A pass cut short is the last of all.
fn check_cut_passes<R: Read>(inputs: &[Input<R>], merged: &CheckpointHeader) -> Result<(), MergeError> {
    let ends = merged.strips.iter().flat_map(|strip| strip.nodes.last()).map(|node| node.range().end);
    let end = ends.max().unwrap_or(0);
    let is_cut = |node: &PassNodeHeader| node.lacks(merged.pass_samples) != Some(0);
    for input in inputs {
        let lasts = input.header().strips.iter().flat_map(|strip| strip.nodes.last());
        if lasts.into_iter().any(|node| is_cut(node) && node.range().end < end) {
            return Err(input.error(CheckpointError::CutShort));
        }
    }
    Ok(())
}
