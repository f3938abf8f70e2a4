use super::source::Statement;
use crate::IoError;
use crate::error::Result;

/// The index `v` of a corner `v`, `v/vt`, `v//vn` or `v/vt/vn` of a face with `count` vertices above it. An index
/// counts from 1, or back from the face if it is negative. One that is left empty is none: `v/`, `v//`, `v/vt/`. `vt` and
/// `vn` may be any numbers, since nothing reads what they refer to.
pub(super) fn vertex<'a>(statement: &Statement<'a>, corner: &'a str, count: usize) -> Result<&'a str> {
    let mut fields = corner.split('/');
    let vertex = fields.next().unwrap_or_default();
    let index: i64 = statement.number(vertex)?;
    if index == 0 || index.unsigned_abs() > count as u64 {
        return Err(IoError::Index { at: statement.at(), index, count, what: "vertices above" });
    }
    for (field, number) in fields.zip(2..) {
        if number > 3 {
            return Err(statement.malformed("a vertex has more indices than v/vt/vn"));
        }
        if !field.is_empty() {
            statement.number::<i64>(field)?;
        }
    }
    Ok(vertex)
}
