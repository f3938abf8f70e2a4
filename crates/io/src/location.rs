use crate::escaped::escaped;
use std::fmt;
use std::path::PathBuf;

/// Where in which file something is. Displayed as `file:line`, or as `file: nodes[3]` in glTF.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Location {
    /// The file.
    pub path: PathBuf,
    /// Where in it.
    pub place: Place,
}

/// A place in a file. Everything but lines counts from 0, as glTF does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
#[allow(missing_docs, reason = "named after the arrays of a glTF file")]
pub enum Place {
    /// The file as a whole.
    File,
    /// A line, from 1.
    Line(usize),
    /// The member `scene` of a glTF file, the index of the default scene.
    DefaultScene,
    Scene(usize),
    Node(usize),
    Mesh(usize),
    Primitive {
        mesh: usize,
        primitive: usize,
    },
    /// A vertex of a primitive: an element of its `POSITION`.
    Vertex {
        mesh: usize,
        primitive: usize,
        vertex: usize,
    },
    Material(usize),
    Accessor(usize),
    BufferView(usize),
    Buffer(usize),
    Camera(usize),
    Light(usize),
    Image(usize),
}

impl Place {
    /// This place in `path`.
    #[cfg(any(feature = "obj", feature = "gltf"))]
    pub(crate) fn of(self, path: &std::path::Path) -> Location {
        Location { path: path.into(), place: self }
    }
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let path = escaped(self.path.display());
        let (array, index) = match self.place {
            Place::File => return write!(f, "{path}"),
            Place::Line(line) => return write!(f, "{path}:{line}"),
            Place::DefaultScene => return write!(f, "{path}: scene"),
            Place::Primitive { mesh, primitive } => {
                return write!(f, "{path}: meshes[{mesh}].primitives[{primitive}]");
            }
            Place::Vertex { mesh, primitive, vertex } => {
                return write!(f, "{path}: meshes[{mesh}].primitives[{primitive}], vertex {vertex}");
            }
            Place::Scene(index) => ("scenes", index),
            Place::Node(index) => ("nodes", index),
            Place::Mesh(index) => ("meshes", index),
            Place::Material(index) => ("materials", index),
            Place::Accessor(index) => ("accessors", index),
            Place::BufferView(index) => ("bufferViews", index),
            Place::Buffer(index) => ("buffers", index),
            Place::Camera(index) => ("cameras", index),
            Place::Light(index) => ("extensions.KHR_lights_punctual.lights", index),
            Place::Image(index) => ("images", index),
        };
        write!(f, "{path}: {array}[{index}]")
    }
}
