use crate::error::Result;
use crate::limits::check_count;
use crate::scene::loading::Loading;
use crate::{IoError, Location, Place, WarningKind};
use std::iter;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// The mark that some editors write before UTF-8 text.
const BYTE_ORDER_MARK: char = '\u{feff}';

/// The text of an OBJ or MTL file. Both have the same syntax.
pub(super) struct Source {
    pub(super) path: PathBuf,
    text: String,
}

impl Source {
    /// The text in a file's content. Continued lines are joined. Bytes that are not UTF-8 cause a warning.
    pub(super) fn of(path: &Path, bytes: Vec<u8>, loading: &mut Loading<'_>) -> Result<Self> {
        let mut text =
            String::from_utf8(bytes).unwrap_or_else(|error| lossy(error.as_bytes(), path, loading));
        if let Some(nul) = text.find('\0') {
            let at = line_after(&text[..nul]).of(path);
            return Err(IoError::Parse { at, message: "text contains a NUL byte".into() });
        }
        if text.trim_ascii_end().contains('\r') && !text.contains('\n') {
            let message = "lines end in lone carriage returns; save the file with line feeds".into();
            return Err(IoError::Parse { at: Place::File.of(path), message });
        }
        if text.starts_with(BYTE_ORDER_MARK) {
            text.remove(0);
        }
        let text = joined(text);
        let limit = loading.limits.line_bytes;
        // Most files are shorter than the limit for one line.
        if text.len() as u64 > limit {
            for (line, number) in text.lines().zip(1..) {
                check_count(line.len() as u64, limit, "bytes in a line", || Place::Line(number).of(path))?;
            }
        }
        Ok(Self { path: path.into(), text })
    }

    /// All lines but empty ones and comments, in order.
    pub(super) fn statements(&self) -> impl Iterator<Item = Statement<'_>> {
        self.text.lines().zip(1..).filter_map(|(text, line)| Statement::of(&self.path, line, text))
    }

    /// Bytes of text.
    pub(super) fn len(&self) -> u64 {
        self.text.len() as u64
    }
}

/// One statement: `keyword arguments`.
#[derive(Clone, Copy)]
pub(super) struct Statement<'a> {
    path: &'a Path,
    /// The line number, from 1.
    pub(super) line: usize,
    pub(super) keyword: &'a str,
    pub(super) arguments: &'a str,
}

impl<'a> Statement<'a> {
    fn of(path: &'a Path, line: usize, text: &'a str) -> Option<Self> {
        let text = text.trim_ascii();
        let end = text.bytes().position(|byte| byte == b' ' || byte == b'\t').unwrap_or(text.len());
        let (keyword, arguments) = text.split_at(end);
        let is_statement = !keyword.is_empty() && !keyword.starts_with('#');
        is_statement.then(|| Self { path, line, keyword, arguments: arguments.trim_ascii_start() })
    }

    /// The words of the arguments, up to a comment.
    pub(super) fn words(&self) -> impl Iterator<Item = &'a str> + Clone + use<'a> {
        self.arguments.split_ascii_whitespace().take_while(|word| !word.starts_with('#'))
    }

    /// Its line.
    pub(super) fn place(&self) -> Place {
        Place::Line(self.line)
    }

    /// Its file and line.
    pub(super) fn at(&self) -> Location {
        self.place().of(self.path)
    }

    /// Another line of its file.
    pub(super) fn at_line(&self, line: usize) -> Location {
        Place::Line(line).of(self.path)
    }

    /// All arguments as one name. A name may contain spaces and `#`.
    pub(super) fn name(&self) -> Result<&'a str> {
        if self.arguments.is_empty() { Err(self.malformed("expected a name")) } else { Ok(self.arguments) }
    }

    pub(super) fn number<T: FromStr>(&self, word: &str) -> Result<T> {
        let why =
            || if word.is_empty() { "expected a number".into() } else { format!("`{word}` is not a number") };
        word.parse().map_err(|_| self.malformed(&why()))
    }

    /// The approximate length in bytes.
    pub(super) fn len(&self) -> u64 {
        (self.keyword.len() + self.arguments.len() + 2) as u64
    }

    /// An error about this statement if `count` exceeds `limit`.
    pub(super) fn check_count(&self, count: usize, what: &'static str, limit: u64) -> Result<()> {
        check_count(count as u64, limit, what, || self.at())
    }

    pub(super) fn malformed(&self, why: &str) -> IoError {
        IoError::Parse { at: self.at(), message: format!("{}: {why}", self.keyword) }
    }
}

/// The place after `text`, which begins a file.
fn line_after(text: &str) -> Place {
    Place::Line(1 + text.matches('\n').count())
}

/// The text of `bytes` with U+FFFD for each run of bytes that are not UTF-8, so that it is at most twice as long. Adds
/// a warning at the first of them.
fn lossy(bytes: &[u8], path: &Path, loading: &mut Loading<'_>) -> String {
    let mut text = String::with_capacity(2 * bytes.len());
    let (mut first, mut count) = (None, 0);
    for chunk in bytes.utf8_chunks() {
        text.push_str(chunk.valid());
        if !chunk.invalid().is_empty() {
            first = first.or_else(|| Some(line_after(&text)));
            count += chunk.invalid().len();
            if !text.ends_with(char::REPLACEMENT_CHARACTER) {
                text.push(char::REPLACEMENT_CHARACTER);
            }
        }
    }
    loading.warn_of(first.unwrap_or(Place::File).of(path), WarningKind::NotUtf8 { count });
    text
}

/// `text` with each line that ends in a backslash joined to the next, unless the backslash ends a comment.
///
/// Empty lines follow the joined line, so that the line numbers below it do not change.
fn joined(text: String) -> String {
    if !text.contains('\\') {
        return text;
    }
    let mut out = String::with_capacity(text.len() + 1);
    let mut continued = 0;
    for line in text.lines() {
        match line.strip_suffix('\\') {
            Some(head) if !has_comment(line) => {
                out.extend([head, " "]);
                continued += 1;
            }
            _ => {
                out.push_str(line);
                out.extend(iter::repeat_n('\n', continued + 1));
                continued = 0;
            }
        }
    }
    out
}

/// Whether the line is or ends in a comment: whether one of its words begins with `#`.
fn has_comment(line: &str) -> bool {
    line.split_ascii_whitespace().any(|word| word.starts_with('#'))
}
