use crate::IoError;
use std::path::{Path, PathBuf};
use std::str::{FromStr, SplitAsciiWhitespace};
use std::{fs, iter};

/// What some editors put before UTF-8 text.
const BYTE_ORDER_MARK: char = '\u{feff}';

/// The text of an OBJ or MTL file; the two share their syntax.
pub(super) struct Source {
    path: PathBuf,
    text: String,
}

impl Source {
    pub(super) fn read(path: &Path) -> Result<Self, IoError> {
        let bytes = fs::read(path).map_err(|source| IoError::Read { path: path.into(), source })?;
        let mut text = String::from_utf8(bytes).map_err(|error| {
            let valid = &error.as_bytes()[..error.utf8_error().valid_up_to()];
            let line = 1 + valid.iter().filter(|&&byte| byte == b'\n').count();
            IoError::Parse { path: path.into(), line: Some(line), message: "is not UTF-8".into() }
        })?;
        if text.starts_with(BYTE_ORDER_MARK) {
            text.remove(0);
        }
        Ok(Self { path: path.into(), text: joined(text) })
    }

    /// Bytes of text.
    pub(super) fn len(&self) -> usize {
        self.text.len()
    }

    /// All lines that say something, in order.
    pub(super) fn statements(&self) -> impl Iterator<Item = Statement<'_>> {
        self.text.lines().zip(1..).filter_map(|(text, line)| {
            let text = text.trim();
            let (keyword, arguments) = text.split_once([' ', '\t']).unwrap_or((text, ""));
            let says_something = !keyword.is_empty() && !keyword.starts_with('#');
            says_something.then(|| Statement {
                path: &self.path,
                line,
                keyword,
                arguments: arguments.trim_start(),
            })
        })
    }
}

/// One statement: `keyword arguments`.
#[derive(Clone, Copy)]
pub(super) struct Statement<'a> {
    pub(super) path: &'a Path,
    /// From 1.
    pub(super) line: usize,
    pub(super) keyword: &'a str,
    pub(super) arguments: &'a str,
}

impl<'a> Statement<'a> {
    pub(super) fn words(&self) -> SplitAsciiWhitespace<'a> {
        self.arguments.split_ascii_whitespace()
    }

    /// File and line, for an error or a warning.
    pub(super) fn place(&self) -> (PathBuf, usize) {
        (self.path.into(), self.line)
    }

    /// All arguments as one name, which may have spaces.
    pub(super) fn name(&self) -> Result<&'a str, IoError> {
        if self.arguments.is_empty() { Err(self.malformed("takes a name")) } else { Ok(self.arguments) }
    }

    pub(super) fn number<T: FromStr>(&self, word: &str) -> Result<T, IoError> {
        word.parse().map_err(|_| self.malformed(&format!("`{word}` is not a number")))
    }

    pub(super) fn malformed(&self, why: &str) -> IoError {
        let (path, line) = self.place();
        IoError::Parse { path, line: Some(line), message: format!("{}: {why}", self.keyword) }
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
