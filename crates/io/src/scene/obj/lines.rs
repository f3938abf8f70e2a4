use super::source::{Source, Statement};
use crate::error::Result;
use crate::{IoError, Place};
use std::io::{self, BufReader, Cursor, Read};
use tobj::LoadError;

/// What `read`, a function of tobj, makes of the lines that `pass` writes for the statements of `source`.
///
/// # Errors
/// That of `pass`, which ends reading, or else that of tobj.
pub(super) fn read<'a, T>(
    source: &'a Source,
    mut pass: impl FnMut(&Statement<'a>, &mut String) -> Result<()>,
    read: impl FnOnce(&mut BufReader<Lines<'_>>) -> Result<T, LoadError>,
) -> Result<T> {
    let (mut statements, mut refused) = (source.statements(), None);
    let mut next = |line: &mut String| {
        while line.is_empty()
            && let Some(statement) = statements.next()
        {
            pass(&statement, line).map_err(|error| {
                refused = Some(error);
                // tobj does not return the errors of its reader.
                io::ErrorKind::InvalidData
            })?;
        }
        Ok(())
    };
    let lines = Lines { next: &mut next, line: Cursor::default() };
    read(&mut BufReader::new(lines)).map_err(|error| {
        let at = Place::File.of(&source.path);
        refused.unwrap_or_else(|| IoError::Parse { at, message: error.to_string() })
    })
}

/// The text that tobj reads. Only one line is in memory.
pub(super) struct Lines<'n> {
    /// Writes the next line, or nothing at the end.
    next: &'n mut dyn FnMut(&mut String) -> io::Result<()>,
    line: Cursor<String>,
}

impl Read for Lines<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.line.position() == self.line.get_ref().len() as u64 {
            let line = self.line.get_mut();
            line.clear();
            (self.next)(line)?;
            self.line.set_position(0);
        }
        self.line.read(buffer)
    }
}

/// Writes a statement as a line.
pub(super) fn write<'w>(line: &mut String, keyword: &str, words: impl Iterator<Item = &'w str>) {
    line.push_str(keyword);
    words.for_each(|word| line.extend([" ", word]));
    line.push('\n');
}
