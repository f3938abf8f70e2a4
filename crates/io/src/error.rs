use crate::Location;
use crate::plain::plain;
use globillum_integrator::RenderError;
use globillum_material::MaterialError;
use std::error::Error as StdError;
use std::io;
use std::path::PathBuf;
use thiserror::Error;

/// Why a file could not be loaded or written.
///
/// Messages are one line that starts with the file and the place in it, the way compilers write
/// it: a command-line program can print them as they are. Whatever names a file holds, control
/// characters in them are escaped.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum IoError {
    /// The file could not be read.
    #[error("{}: cannot be read: {source}", plain(path.display()))]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// Not a file but a folder, a pipe or a device.
    #[error("{}: is not a regular file", plain(path.display()))]
    NotRegularFile {
        /// What is not a file.
        path: PathBuf,
    },
    /// The extension names no scene format that can be read.
    #[error("{}: unknown scene format; supported are {supported}", plain(path.display()))]
    UnknownScene {
        /// The file.
        path: PathBuf,
        /// The extensions that are.
        supported: &'static str,
    },
    /// More than [`Limits`](crate::Limits) allow.
    #[error("{at}: more than {limit} {what}")]
    TooLarge {
        /// Where.
        at: Location,
        /// What there is too much of, in the plural.
        what: &'static str,
        /// How many are allowed.
        limit: u64,
    },
    /// A statement or a structure is malformed.
    #[error("{at}: {}", plain(message))]
    Parse {
        /// Where.
        at: Location,
        /// What is wrong.
        message: String,
    },
    /// A coordinate is NaN or infinite, or too large for `f32`.
    #[error("{at}: coordinate is not finite")]
    NonFinite {
        /// Where.
        at: Location,
    },
    /// A number outside the range in which a scene can be traced.
    #[error("{at}: {}", plain(message))]
    Domain {
        /// Where.
        at: Location,
        /// Which number, and the range.
        message: String,
    },
    /// Something refers to what is not there.
    #[error("{at}: index {index} refers to none of the {count} {what}")]
    Index {
        /// Where.
        at: Location,
        /// The index as written; in OBJ from 1, or negative to count back from the face.
        index: i64,
        /// How many there are to refer to.
        count: usize,
        /// What they are, in the plural.
        what: &'static str,
    },
    /// A glTF accessor, its view or its buffer contradicts the data, or is of a type that its use
    /// does not allow.
    #[error("{at}: {}", plain(message))]
    Accessor {
        /// Which.
        at: Location,
        /// What is wrong.
        message: String,
    },
    /// A file asks for another one outside its own folder.
    #[error("{at}: `{}` is not within the file's own folder", plain(name))]
    PathEscape {
        /// Where it asks.
        at: Location,
        /// The name it asks for.
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
    #[error("{at}: URIs of scheme `{scheme}:` are not followed")]
    Scheme {
        /// Where.
        at: Location,
        /// The scheme.
        scheme: String,
    },
    /// A glTF of a version that is not read.
    #[error("{at}: glTF version {} is not supported, only 2.0", plain(version))]
    Version {
        /// The file.
        at: Location,
        /// The version that it has, or that it asks for.
        version: String,
    },
    /// An extension without which the file can not be read, and which is not known.
    #[error("{at}: extension `{}` is required and not supported", plain(extension))]
    Unsupported {
        /// The file.
        at: Location,
        /// The extension.
        extension: String,
    },
    /// A node is its own ancestor.
    #[error("{at}: is its own ancestor")]
    Cycle {
        /// The node.
        at: Location,
    },
    /// A node has two parents, or is a root of the scene twice or beside a parent.
    #[error("{at}: has more than one parent")]
    NotATree {
        /// The node.
        at: Location,
    },
    /// A material reflects or emits what no surface can.
    #[error("{at}: material `{}`: {source}", plain(name))]
    Material {
        /// Where the material begins.
        at: Location,
        /// The material's name.
        name: String,
        /// What is wrong with it.
        source: MaterialError,
    },
    /// A camera that can not be.
    #[error("{at}: {source}")]
    Camera {
        /// The camera, or its node.
        at: Location,
        /// What is wrong with it.
        source: RenderError,
    },
    /// A scene without a single triangle that could be hit.
    #[error("{}: has no triangles", plain(path.display()))]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// The monitor asked to stop.
    #[error("{}: loading was cancelled", plain(path.display()))]
    Cancelled {
        /// The file.
        path: PathBuf,
    },
    /// The extension names no picture format that can be written.
    #[error("{}: unknown picture format; supported are .png and .exr", plain(path.display()))]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// The file could not be written. A regular file is unchanged, unless only forcing the folder's names
    /// to disk failed at the very end. A FIFO or a device may have received part of the content.
    #[error("{}: cannot be written: {source}", plain(path.display()))]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The picture could not be encoded; what was there before is still there.
    #[error("{}: cannot be encoded: {source}", plain(path.display()))]
    Encode {
        /// The file.
        path: PathBuf,
        /// What the encoder said.
        source: Box<dyn StdError + Send + Sync>,
    },
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Place;
    use std::path::Path;

    #[test]
    fn messages_start_with_the_file_and_the_place() {
        let at = |place: Place| {
            IoError::Parse { at: place.of(Path::new("a.x")), message: "odd".into() }.to_string()
        };
        assert_eq!(at(Place::Line(7)), "a.x:7: odd");
        assert_eq!(at(Place::File), "a.x: odd");
        assert_eq!(at(Place::Node(2)), "a.x: nodes[2]: odd");
        assert_eq!(at(Place::Primitive { mesh: 1, primitive: 0 }), "a.x: meshes[1].primitives[0]: odd");
        let (path, source) = ("a.x".into(), io::ErrorKind::PermissionDenied.into());
        assert_eq!(IoError::Read { path, source }.to_string(), "a.x: cannot be read: permission denied");
    }
}
