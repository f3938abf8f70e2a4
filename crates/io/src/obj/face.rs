use super::number::plain_index;
use super::source::Statement;
use crate::IoError;
use crate::error::Result;

/// The numbers of vertices, texture coordinates and normals above a face.
pub(super) type Counts = [usize; 3];

/// The elements that the indices of a corner `v/vt/vn` refer to.
const REFERENTS: [&str; 3] = ["vertices above", "texture coordinates above", "normals above"];

/// The vertex, from 0, of a corner `v`, `v/vt`, `v//vn` or `v/vt/vn`. An index in the file counts from 1,
/// or back from the face if it is negative.
pub(super) fn corner(statement: &Statement<'_>, word: &str, counts: &Counts) -> Result<usize> {
    if let Some(index) = plain_index(word)
        && 0 < index
        && index <= counts[0]
    {
        return Ok(index - 1);
    }
    let mut fields = word.split('/').enumerate();
    let (kind, field) = fields.next().unwrap_or_default();
    let vertex = position(statement, field, kind, counts)?;
    for (kind, field) in fields {
        // Only `v//vn` has an empty field.
        if kind == 1 && field.is_empty() {
            continue;
        }
        if kind >= REFERENTS.len() {
            return Err(statement.malformed("a vertex has more indices than v/vt/vn"));
        }
        position(statement, field, kind, counts)?;
    }
    Ok(vertex)
}

/// The position, from 0, of the element that an index refers to.
fn position(statement: &Statement<'_>, field: &str, kind: usize, counts: &Counts) -> Result<usize> {
    let index: i64 = statement.number(field)?;
    let (count, distance) = (counts[kind], index.unsigned_abs());
    if index == 0 || distance > count as u64 {
        return Err(IoError::Index { at: statement.at(), index, count, what: REFERENTS[kind] });
    }
    Ok(if index > 0 { distance as usize - 1 } else { count - distance as usize })
}
