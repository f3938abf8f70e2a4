use crate::{IoError, Limits, Location, Place};
use std::iter;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// What some editors put before UTF-8 text.
const BYTE_ORDER_MARK: char = '\u{feff}';

/// The text of an OBJ or MTL file; the two share their syntax.
pub(super) struct Source {
    path: PathBuf,
    text: String,
}

impl Source {
    /// Makes text of a file's content.
    pub(super) fn of(path: &Path, bytes: Vec<u8>, limits: &Limits) -> Result<Self, IoError> {
        let malformed = |valid: &[u8], message: &str| {
            let line = 1 + valid.iter().filter(|&&byte| byte == b'\n').count();
            IoError::Parse { at: Place::Line(line).of(path), message: message.into() }
        };
        let mut text = String::from_utf8(bytes).map_err(|error| {
            malformed(&error.as_bytes()[..error.utf8_error().valid_up_to()], "is not UTF-8")
        })?;
        if let Some(nul) = text.find('\0') {
            return Err(malformed(&text.as_bytes()[..nul], "text contains a NUL byte"));
        }
        if text.starts_with(BYTE_ORDER_MARK) {
            text.remove(0);
        }
        let text = joined(text);
        let limit = limits.line_bytes;
        let is_long = |text: &str| text.len() as u64 > limit;
        // Most files are shorter than a line may be.
        if is_long(&text)
            && let Some((_, line)) = text.lines().zip(1..).find(|(text, _)| is_long(text))
        {
            return Err(IoError::TooLarge { at: Place::Line(line).of(path), what: "bytes in a line", limit });
        }
        Ok(Self { path: path.into(), text })
    }

    /// All lines, in order.
    pub(super) fn lines(&self) -> impl Iterator<Item = &str> {
        self.text.lines()
    }

    /// All lines that say something, in order.
    pub(super) fn statements(&self) -> impl Iterator<Item = Statement<'_>> {
        self.lines().zip(1..).filter_map(|(text, line)| Statement::of(&self.path, line, text))
    }

    /// Bytes of text.
    pub(super) fn len(&self) -> usize {
        self.text.len()
    }
}

/// One statement: `keyword arguments`.
#[derive(Clone, Copy)]
pub(super) struct Statement<'a> {
    path: &'a Path,
    /// From 1.
    pub(super) line: usize,
    pub(super) keyword: &'a str,
    pub(super) arguments: &'a str,
}

impl<'a> Statement<'a> {
    fn of(path: &'a Path, line: usize, text: &'a str) -> Option<Self> {
        let text = text.trim_ascii();
        let end = text.bytes().position(|byte| byte == b' ' || byte == b'\t').unwrap_or(text.len());
        let (keyword, arguments) = text.split_at(end);
        let says_something = !keyword.is_empty() && !keyword.starts_with('#');
        says_something.then(|| Self { path, line, keyword, arguments: arguments.trim_ascii_start() })
    }

    /// The arguments, up to a comment.
    pub(super) fn words(&self) -> impl Iterator<Item = &'a str> + use<'a> {
        self.arguments.split_ascii_whitespace().take_while(|word| !word.starts_with('#'))
    }

    /// File and line.
    pub(super) fn at(&self) -> Location {
        Place::Line(self.line).of(self.path)
    }

    /// All arguments as one name, which may have spaces, and a `#` too.
    pub(super) fn name(&self) -> Result<&'a str, IoError> {
        if self.arguments.is_empty() { Err(self.malformed("expected a name")) } else { Ok(self.arguments) }
    }

    pub(super) fn number<T: FromStr>(&self, word: &str) -> Result<T, IoError> {
        word.parse().map_err(|_| self.malformed(&format!("`{word}` is not a number")))
    }

    /// Bytes that it takes, about.
    pub(super) fn len(&self) -> u64 {
        (self.keyword.len() + self.arguments.len() + 2) as u64
    }

    /// Refuses to go on if there are more than `limit` of something.
    pub(super) fn check_count(&self, count: usize, what: &'static str, limit: u64) -> Result<(), IoError> {
        if count as u64 > limit { Err(IoError::TooLarge { at: self.at(), what, limit }) } else { Ok(()) }
    }

    pub(super) fn malformed(&self, why: &str) -> IoError {
        IoError::Parse { at: self.at(), message: format!("{}: {why}", self.keyword) }
    }
}

/// `text` with each line that ends in a backslash joined to the next.
///
/// Empty lines make up for the joined ones, so that what follows keeps its line number.
fn joined(text: String) -> String {
    if !text.contains('\\') {
        return text;
    }
    let mut out = String::with_capacity(text.len() + 1);
    let mut owed = 0;
    for line in text.lines() {
        match line.strip_suffix('\\') {
            Some(head) if !line.starts_with('#') => {
                out.extend([head, " "]);
                owed += 1;
            }
            _ => {
                out.push_str(line);
                out.extend(iter::repeat_n('\n', owed + 1));
                owed = 0;
            }
        }
    }
    out
}
