use crate::error::Place;
use std::fmt;
use std::path::PathBuf;

/// Something in a file that was passed over. Its message names the file and the line.
///
/// Lines count from 1; where something occurs often, the line is that of the first time.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
#[allow(missing_docs, reason = "path, line and name of what the variant is about")]
pub enum Warning {
    /// A material library that does not exist.
    MissingLibrary { path: PathBuf, line: usize, name: String },
    /// A material that no library defines: its faces got the default.
    UnknownMaterial { path: PathBuf, line: usize, name: String },
    /// A second material of the same name, which took the place of the first.
    DuplicateMaterial { path: PathBuf, line: usize, name: String },
    /// Texture maps of a material, which are not read.
    TexturesIgnored { path: PathBuf, line: usize, name: String },
    /// Faces of one or two vertices, which enclose nothing, and how many of them.
    ShortFaces { path: PathBuf, line: usize, count: usize },
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut say = |path, line: &usize, what| write!(f, "{}: {what}", Place(path, Some(*line)));
        match self {
            Self::MissingLibrary { path, line, name } => {
                say(path, line, format_args!("material library `{name}` does not exist"))
            }
            Self::UnknownMaterial { path, line, name } => {
                say(path, line, format_args!("material `{name}` is not defined, grey used instead"))
            }
            Self::DuplicateMaterial { path, line, name } => {
                say(path, line, format_args!("material `{name}` is defined again, the last one counts"))
            }
            Self::TexturesIgnored { path, line, name } => {
                say(path, line, format_args!("texture maps of material `{name}` ignored"))
            }
            Self::ShortFaces { path, line, count } => {
                say(path, line, format_args!("{count} faces of fewer than three vertices skipped"))
            }
        }
    }
}
