use super::number::{is_plain_fraction, plain_index};
use super::seen::Seen;
use super::source::Statement;
use crate::IoError;
use crate::loading::Loading;
use globillum_geom::Triangles;
use std::io::{self, BufRead, Read};

/// How much text is prepared at once, in bytes.
const CHUNK: usize = 1 << 16;

/// An OBJ file on its way to tobj, looked through line by line.
///
/// tobj names no line in its errors, takes NaN for a coordinate and a polyline of three vertices
/// for a triangle. The scan refuses what is malformed, and passes on only what makes triangles:
/// positions, and the positions of faces. It is a reader, so that the file is never in memory a
/// second time.
pub(super) struct Scan<'a, 'm, 'l, S> {
    statements: S,
    pub(super) seen: Seen<'a>,
    /// Why the scan stopped, if it did.
    pub(super) failure: Option<IoError>,
    loading: &'m mut Loading<'l>,
    /// Bytes of the file, for the monitor.
    done: u64,
    total: u64,
    /// What tobj is to read next, and how much of it is read.
    text: String,
    read: usize,
    /// How many of each of [`REFERENTS`] there are so far.
    counts: [usize; 3],
}

/// What the numbers in a face's corner `v/vt/vn` refer to.
const REFERENTS: [&str; 3] = ["vertices above it", "texture coordinates above it", "normals above it"];

impl<'a, 'm, 'l, S: Iterator<Item = Statement<'a>>> Scan<'a, 'm, 'l, S> {
    /// A scan of `statements` that have `total` bytes.
    pub(super) fn new(statements: S, total: usize, loading: &'m mut Loading<'l>) -> Self {
        Self {
            statements,
            seen: Seen::default(),
            failure: None,
            loading,
            done: 0,
            total: total as u64,
            text: String::with_capacity(2 * CHUNK),
            read: 0,
            counts: [0; 3],
        }
    }

    fn refill(&mut self) -> Result<(), IoError> {
        self.text.clear();
        self.read = 0;
        while self.text.len() < CHUNK {
            let Some(statement) = self.statements.next() else {
                return self.loading.progress(self.total, self.total);
            };
            self.done += statement.len();
            self.loading.progress(self.done, self.total)?;
            self.statement(&statement)?;
        }
        Ok(())
    }

    fn statement(&mut self, statement: &Statement<'a>) -> Result<(), IoError> {
        match statement.keyword {
            "v" => self.position(statement)?,
            "f" => self.face(statement)?,
            "vt" => self.counts[1] += 1,
            "vn" => {
                self.seen.normal(statement);
                self.counts[2] += 1;
            }
            "usemtl" => self.seen.material(statement, self.loading.limits)?,
            "mtllib" => self.seen.libraries.push(*statement),
            // Names, points, lines, curves: nothing that a ray could meet.
            _ => {}
        }
        Ok(())
    }

    /// `v x y z`, or `v x y z weight`, or `v x y z r g b`.
    fn position(&mut self, statement: &Statement<'a>) -> Result<(), IoError> {
        let mut words = statement.words();
        self.text.push('v');
        let mut plain = 0;
        for word in words.by_ref().take(3) {
            plain += usize::from(is_plain_fraction(word));
            self.pass_on(word);
        }
        // Colours stay behind: tobj wants them on all vertices or on none.
        let fourth = words.next();
        if let (Some(weight), None) = (fourth, words.next()) {
            self.pass_on(weight);
        }
        self.text.push('\n');
        if plain < 3 || fourth.is_some() {
            check_position(statement)?;
        }
        self.counts[0] += 1;
        Ok(())
    }

    /// `f` with three corners or more.
    fn face(&mut self, statement: &Statement<'a>) -> Result<(), IoError> {
        let mut corners = 0;
        let length_before = self.text.len();
        self.text.push('f');
        for word in statement.words() {
            if plain_index(word).is_some_and(|index| 0 < index && index <= self.counts[0]) {
                self.pass_on(word);
            } else {
                self.check_corner(statement, word)?;
                self.pass_on(word.split_once('/').map_or(word, |(vertex, _)| vertex));
            }
            corners += 1;
        }
        self.text.push('\n');
        if corners < 3 {
            self.text.truncate(length_before);
        }
        self.seen.face(statement, corners, self.loading.limits)
    }

    /// `v`, `v/vt`, `v//vn` or `v/vt/vn`, each an index from 1, or negative to count back.
    fn check_corner(&self, statement: &Statement<'a>, word: &str) -> Result<(), IoError> {
        for (kind, field) in word.split('/').enumerate() {
            // Only `v//vn` leaves something out.
            if kind == 1 && field.is_empty() {
                continue;
            }
            let too_many = || statement.malformed("a corner has more than v/vt/vn");
            let count = *self.counts.get(kind).ok_or_else(too_many)?;
            let index: i64 = statement.number(field)?;
            if index == 0 || index.unsigned_abs() > count as u64 {
                return Err(IoError::Index { at: statement.at(), index, count, what: REFERENTS[kind] });
            }
        }
        Ok(())
    }

    /// Adds a word to the line for tobj.
    fn pass_on(&mut self, word: &str) {
        self.text.push(' ');
        self.text.push_str(word);
    }
}

/// The thorough look at a position that is not plain.
fn check_position(statement: &Statement<'_>) -> Result<(), IoError> {
    let numbers = statement.words().map(|word| statement.number(word)).collect::<Result<Vec<f32>, _>>()?;
    let (position, weight) = match numbers[..] {
        [x, y, z] | [x, y, z, _, _, _] => ([x, y, z], 1.0),
        [_, _, _, 0.0] => return Err(statement.malformed("the weight is zero")),
        [x, y, z, weight] => ([x, y, z], weight),
        _ => return Err(statement.malformed("takes 3, 4 or 6 numbers")),
    };
    let position = position.map(|x| x / weight);
    if !position.iter().all(|x| x.is_finite()) {
        return Err(IoError::NonFinite { at: statement.at() });
    }
    match position.iter().find(|x| x.abs() > Triangles::MAX_COORDINATE) {
        Some(x) => Err(IoError::Domain { at: statement.at(), message: out_of_range(*x) }),
        None => Ok(()),
    }
}

fn out_of_range(x: f32) -> String {
    format!("coordinate {x:e} is beyond {:e}", Triangles::MAX_COORDINATE)
}

impl<'a, S: Iterator<Item = Statement<'a>>> BufRead for Scan<'a, '_, '_, S> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.read == self.text.len()
            && let Err(error) = self.refill()
        {
            self.failure = Some(error);
            return Err(io::ErrorKind::InvalidData.into());
        }
        Ok(&self.text.as_bytes()[self.read..])
    }

    fn consume(&mut self, count: usize) {
        self.read += count;
    }
}

impl<'a, S: Iterator<Item = Statement<'a>>> Read for Scan<'a, '_, '_, S> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.fill_buf()?.read(buffer)?;
        self.consume(count);
        Ok(count)
    }
}
