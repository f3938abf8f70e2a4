use super::source::Statement;
use crate::IoError;
use crate::error::Result;

/// The numbers of vertices, texture coordinates and normals above a face.
pub(super) type Counts = [usize; 3];

/// The elements that the indices of a corner `v/vt/vn` refer to.
const REFERENTS: [&str; 3] = ["vertices above", "texture coordinates above", "normals above"];

/// The index `v` of a corner `v`, `v/vt`, `v//vn` or `v/vt/vn`, after a check of all its indices. An index
/// counts from 1, or back from the face if it is negative. One that is left empty is none: `v/`, `v//`, `v/vt/`.
pub(super) fn vertex<'a>(statement: &Statement<'a>, corner: &'a str, counts: &Counts) -> Result<&'a str> {
    let mut fields = corner.split('/');
    let vertex = fields.next().unwrap_or_default();
    check(statement, vertex, 0, counts)?;
    for (field, kind) in fields.zip(1..) {
        if kind >= REFERENTS.len() {
            return Err(statement.malformed("a vertex has more indices than v/vt/vn"));
        }
        if !field.is_empty() {
            check(statement, field, kind, counts)?;
        }
    }
    Ok(vertex)
}

/// Checks that an index refers to an element above the face.
fn check(statement: &Statement<'_>, field: &str, kind: usize, counts: &Counts) -> Result<()> {
    let index: i64 = statement.number(field)?;
    let count = counts[kind];
    if index == 0 || index.unsigned_abs() > count as u64 {
        return Err(IoError::Index { at: statement.at(), index, count, what: REFERENTS[kind] });
    }
    Ok(())
}
