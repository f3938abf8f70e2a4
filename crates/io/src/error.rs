use globillum_material::MaterialError;
use std::error::Error as StdError;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why a file could not be loaded or written.
///
/// Messages are one line that starts with the file, and the line in it where there is one, the
/// way compilers write it: a command-line program can print them as they are.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum IoError {
    /// The file could not be read.
    #[error("{}: can not be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A statement is malformed.
    #[error("{}: {message}", Place(path, *line))]
    Parse {
        /// The file.
        path: PathBuf,
        /// Line, from 1; `None` if only the file as a whole is known to be bad.
        line: Option<usize>,
        /// What is wrong with it.
        message: String,
    },
    /// A vertex has a coordinate that is NaN or infinite, or too large for `f32`.
    #[error("{}: coordinate is not finite", Place(path, Some(*line)))]
    NonFinite {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
    },
    /// A face refers to something that is not defined above it.
    #[error("{}: index {index} refers to none of the {count} {what} above it", Place(path, Some(*line)))]
    Index {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// The index as written: from 1, or negative to count back from the face.
        index: i64,
        /// How many there are to refer to.
        count: usize,
        /// What they are, in the plural.
        what: &'static str,
    },
    /// A file asks for another one outside its own folder.
    #[error("{}: `{name}` is not within the file's own folder", Place(path, Some(*line)))]
    Escape {
        /// The file that asks.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// The name it asks for.
        name: String,
    },
    /// A material reflects or emits what no surface can.
    #[error("{}: material `{name}`: {source}", Place(path, Some(*line)))]
    Material {
        /// The material library.
        path: PathBuf,
        /// Line, from 1, on which the material begins.
        line: usize,
        /// The material's name.
        name: String,
        /// What is wrong with it.
        source: MaterialError,
    },
    /// A mesh without a single triangle.
    #[error("{}: has no faces", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// The extension names no picture format that can be written.
    #[error("{}: unknown picture format; supported are .png and .exr", path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// The file could not be written. What was there before is still there, unless all that failed
    /// was to force the folder's names to disk at the very end.
    #[error("{}: can not be written: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The picture could not be encoded; what was there before is still there.
    #[error("{}: can not be encoded: {source}", path.display())]
    Encode {
        /// The file.
        path: PathBuf,
        /// What the encoder said.
        source: Box<dyn StdError + Send + Sync>,
    },
}

/// A file, and a line of it if one is known, as `file:line`.
pub(crate) struct Place<'a>(pub(crate) &'a Path, pub(crate) Option<usize>);

impl fmt::Display for Place<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.0.display())?;
        self.1.map_or(Ok(()), |line| write!(f, ":{line}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_start_with_file_and_line() {
        let path = PathBuf::from("a.obj");
        let at = |line| IoError::Parse { path: path.clone(), line, message: "odd".into() }.to_string();
        assert_eq!((at(Some(7)), at(None)), ("a.obj:7: odd".into(), "a.obj: odd".into()));
        let index = IoError::Index { path: path.clone(), line: 3, index: -9, count: 8, what: "vertices" };
        assert_eq!(index.to_string(), "a.obj:3: index -9 refers to none of the 8 vertices above it");
        let source = io::ErrorKind::PermissionDenied.into();
        assert_eq!(IoError::Read { path, source }.to_string(), "a.obj: can not be read: permission denied");
    }
}
