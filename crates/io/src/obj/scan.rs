use super::source::{Source, Statement};
use crate::IoError;
use std::collections::BTreeMap;

/// What an OBJ file says, read line by line before tobj does.
///
/// tobj names no line in its errors, takes NaN for a coordinate and a polyline of three vertices
/// for a triangle. The scan refuses what is malformed, and leaves to tobj only what makes
/// triangles: positions, the positions of faces, and changes of material.
#[derive(Default)]
pub(super) struct Scan<'a> {
    /// The text for tobj.
    pub(super) triangles: String,
    /// Statements that name material libraries.
    pub(super) libraries: Vec<Statement<'a>>,
    /// Names of materials, each with the statement that first uses it.
    pub(super) materials: BTreeMap<&'a str, Statement<'a>>,
    /// The first face of fewer than three vertices, and how many there are.
    pub(super) short_faces: Option<(Statement<'a>, usize)>,
    /// How many of each of [`REFERENTS`] there are so far.
    counts: [usize; 3],
    /// The numbers of one line, kept only to be filled again.
    numbers: Vec<f32>,
}

/// What the numbers in a face's corner `v/vt/vn` refer to.
const REFERENTS: [&str; 3] = ["vertices", "texture coordinates", "normals"];

impl<'a> Scan<'a> {
    pub(super) fn of(source: &'a Source) -> Result<Self, IoError> {
        let mut scan = Self { triangles: String::with_capacity(source.len()), ..Self::default() };
        for statement in source.statements() {
            match statement.keyword {
                "v" => scan.position(&statement)?,
                "vt" => scan.counts[1] += 1,
                "vn" => scan.counts[2] += 1,
                "f" => scan.face(&statement)?,
                "usemtl" => scan.material(&statement)?,
                "mtllib" => scan.libraries.push(statement),
                // Names, points, lines, curves: nothing that a ray could meet.
                _ => {}
            }
        }
        Ok(scan)
    }

    /// `v x y z`, or `v x y z weight`, or `v x y z r g b`.
    fn position(&mut self, statement: &Statement<'a>) -> Result<(), IoError> {
        self.numbers.clear();
        for word in statement.words() {
            self.numbers.push(statement.number(word)?);
        }
        let (position, weight) = match self.numbers[..] {
            [x, y, z] | [x, y, z, _, _, _] => ([x, y, z], 1.0),
            [_, _, _, 0.0] => return Err(statement.malformed("the weight is zero")),
            [x, y, z, weight] => ([x, y, z], weight),
            _ => return Err(statement.malformed("takes 3, 4 or 6 numbers")),
        };
        if position.iter().any(|x| !(x / weight).is_finite()) {
            let (path, line) = statement.place();
            return Err(IoError::NonFinite { path, line });
        }
        self.counts[0] += 1;
        match self.numbers.len() {
            // Colours stay behind: tobj wants them on all vertices or on none.
            6 => self.pass_on("v", statement.words().take(3)),
            _ => self.pass_on("v", [statement.arguments]),
        }
        Ok(())
    }

    /// `f` with three corners or more.
    fn face(&mut self, statement: &Statement<'a>) -> Result<(), IoError> {
        let mut corners = 0;
        for word in statement.words() {
            self.check_corner(statement, word)?;
            corners += 1;
        }
        match corners {
            0 => return Err(statement.malformed("takes three corners or more")),
            1 | 2 => self.short_faces.get_or_insert((*statement, 0)).1 += 1,
            _ if statement.arguments.contains('/') => {
                self.pass_on("f", statement.words().filter_map(|word| word.split('/').next()));
            }
            _ => self.pass_on("f", [statement.arguments]),
        }
        Ok(())
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
                let (path, line) = statement.place();
                return Err(IoError::Index { path, line, index, count, what: REFERENTS[kind] });
            }
        }
        Ok(())
    }

    /// `usemtl name`.
    fn material(&mut self, statement: &Statement<'a>) -> Result<(), IoError> {
        let name = statement.name()?;
        self.materials.entry(name).or_insert(*statement);
        self.pass_on("usemtl", [name]);
        Ok(())
    }

    /// Adds a line to the text for tobj.
    fn pass_on<'w>(&mut self, keyword: &str, words: impl IntoIterator<Item = &'w str>) {
        self.triangles.push_str(keyword);
        for word in words {
            self.triangles.push(' ');
            self.triangles.push_str(word);
        }
        self.triangles.push('\n');
    }
}
