use crate::Location;
use crate::escaped::escaped;
use globillum_integrator::{DeltaLightError, RenderError};
use globillum_material::MaterialError;
use std::error::Error as StdError;
use std::io;
use std::path::PathBuf;
use thiserror::Error;

/// A result whose error is an [`IoError`] by default.
#[cfg(any(feature = "obj", feature = "gltf"))]
pub(crate) type Result<T, E = IoError> = std::result::Result<T, E>;

/// Why a file could not be loaded or written.
///
/// A message is one line that starts with the file and the place in it, as in compiler messages, so
/// command-line programs can print it unchanged. Control characters in names are escaped.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum IoError {
    /// The file could not be read.
    #[error("{}: cannot be read: {source}", escaped(path.display()))]
    Read {
        /// The file.
        path: PathBuf,
        /// The error of the operating system, [`InvalidData`](io::ErrorKind::InvalidData) for a pointer of Git LFS, or
        /// [`NotFound`](io::ErrorKind::NotFound) for a file that is not among those of `Loader::files`.
        source: io::Error,
    },
    /// The path names a folder, a FIFO or a device.
    #[error("{}: is not a regular file", escaped(path.display()))]
    NotRegularFile {
        /// The path.
        path: PathBuf,
    },
    /// A file that the scene refers to could not be read, or is a folder, a FIFO or a device.
    #[error("{at}: `{}` cannot be read: {source}", escaped(name))]
    Reference {
        /// The place of the reference.
        at: Location,
        /// The name of the file, as the scene gives it.
        name: String,
        /// The error of the operating system, or [`InvalidInput`](io::ErrorKind::InvalidInput) for what is no regular file,
        /// [`InvalidData`](io::ErrorKind::InvalidData) for a pointer of Git LFS, [`NotFound`](io::ErrorKind::NotFound) for
        /// a file that is not among those of `Loader::files`.
        source: io::Error,
    },
    /// The extension names no supported scene format.
    #[error("{}: unknown scene format; supported formats are {supported}", escaped(path.display()))]
    UnknownScene {
        /// The file.
        path: PathBuf,
        /// The supported extensions.
        supported: &'static str,
    },
    /// The file exceeds [`Limits`](crate::Limits).
    #[error("{at}: too many {what} (limit: {limit})")]
    TooLarge {
        /// Where.
        at: Location,
        /// What exceeds the limit, in the plural.
        what: &'static str,
        /// The limit.
        limit: u64,
    },
    /// A statement or a structure is malformed.
    #[error("{at}: {}", escaped(message))]
    Parse {
        /// Where.
        at: Location,
        /// What is wrong.
        message: String,
    },
    /// A coordinate is NaN or infinite, or too large for `f32`.
    #[error("{at}: coordinate is not finite in single precision")]
    NonFinite {
        /// Where: the line of an OBJ file, or the vertex of a glTF file ([`Place::Vertex`](crate::Place::Vertex)).
        at: Location,
    },
    /// A number is outside the range in which a scene can be traced, or that glTF allows, or a transform is invalid.
    #[error("{at}: {}", escaped(message))]
    Domain {
        /// Where.
        at: Location,
        /// The number and the range.
        message: String,
    },
    /// An index is out of range.
    #[error("{at}: index {index} is out of range ({what}: {count})")]
    Index {
        /// Where.
        at: Location,
        /// The index as written; in OBJ from 1, or negative to count back from the face.
        index: i64,
        /// The number of elements.
        count: usize,
        /// The kind of element, in the plural.
        what: &'static str,
    },
    /// A glTF accessor, its buffer view or its buffer is inconsistent, or has a type that its use does not
    /// allow.
    #[error("{at}: {}", escaped(message))]
    Accessor {
        /// Which.
        at: Location,
        /// What is wrong.
        message: String,
    },
    /// The scene refers to a file outside its folder.
    #[error("{at}: `{}` is outside the scene's folder", escaped(name))]
    PathEscape {
        /// The place of the reference.
        at: Location,
        /// The name of the file.
        name: String,
    },
    /// A malformed URI.
    #[error("{at}: malformed URI: {message}")]
    Uri {
        /// Where.
        at: Location,
        /// What is wrong.
        message: String,
    },
    /// A URI with a scheme other than `data:`.
    #[error("{at}: URI scheme `{scheme}:` is not supported")]
    Scheme {
        /// Where.
        at: Location,
        /// The scheme.
        scheme: String,
    },
    /// The glTF version is not supported.
    #[error("{at}: glTF version `{}` is not supported (supported: 2.0)", escaped(version))]
    Version {
        /// The file.
        at: Location,
        /// The version of the file, or the minimum version that it requires.
        version: String,
    },
    /// Required extensions are not supported.
    #[error("{at}: requires extensions that are not supported: {}", escaped(extensions.join(", ")))]
    Unsupported {
        /// The file.
        at: Location,
        /// All of these extensions.
        extensions: Vec<String>,
    },
    /// A node is its own ancestor.
    #[error("{at}: node is its own ancestor")]
    Cycle {
        /// The node.
        at: Location,
    },
    /// A node has two parents, or is a root of the scene twice or beside a parent.
    #[error("{at}: node has more than one parent")]
    NotATree {
        /// The node.
        at: Location,
    },
    /// A material reflects or emits outside the valid range.
    #[error("{at}: material `{}`: {source}", escaped(name))]
    Material {
        /// Its element in glTF; the line of the refused colour in MTL.
        at: Location,
        /// The material's name.
        name: String,
        /// What is wrong with it.
        source: MaterialError,
    },
    /// A camera is invalid.
    #[error("{at}: {source}")]
    Camera {
        /// The camera, or its node.
        at: Location,
        /// What is wrong with it.
        source: RenderError,
    },
    /// A delta light is invalid.
    #[error("{at}: {source}")]
    Light {
        /// The light.
        at: Location,
        /// What is wrong with it.
        source: DeltaLightError,
    },
    /// The scene has no triangle that a ray can hit.
    #[error("{}: scene has no triangles{}", escaped(path.display()), escaped(skipped_text(skipped)))]
    Empty {
        /// The file.
        path: PathBuf,
        /// The first warnings about what has been skipped, such as lines and degenerate triangles.
        skipped: Vec<String>,
    },
    /// The monitor asked to stop.
    #[error("{}: loading was cancelled", escaped(path.display()))]
    Cancelled {
        /// The file.
        path: PathBuf,
    },
    /// The extension names no supported picture format.
    #[error("{}: unknown picture format; supported formats are .png and .exr", escaped(path.display()))]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// The file could not be written. A regular file is unchanged, unless only forcing the folder's names
    /// to disk failed at the very end. A FIFO or a device may have received part of the content.
    #[error("{}: cannot be written: {source}", escaped(path.display()))]
    Write {
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        source: io::Error,
    },
    /// The picture file is damaged, or is no such picture as can be read.
    #[error("{}: {}", escaped(path.display()), escaped(source))]
    Decode {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: Box<dyn StdError + Send + Sync>,
    },
    /// The picture could not be encoded. The old file is unchanged.
    #[error("{}: cannot be encoded: {source}", escaped(path.display()))]
    Encode {
        /// The file.
        path: PathBuf,
        /// The error of the encoder.
        source: Box<dyn StdError + Send + Sync>,
    },
}

/// What is told of what has been skipped in a scene without triangles.
fn skipped_text(skipped: &[String]) -> String {
    if skipped.is_empty() { String::new() } else { format!(" ({})", skipped.join("; ")) }
}
