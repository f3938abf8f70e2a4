use crate::Location;
use crate::plain::plain;
use std::fmt;

/// What a loader passed over or approximated.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct LoadReport {
    /// In the order in which they were found; one entry where the same thing occurs often, at the
    /// place where it first does. Those beyond a quarter of the files' size and 128 KiB are
    /// only counted.
    pub warnings: Vec<Warning>,
    /// Triangles that were dropped because their corners lie on one line: nothing can hit them.
    pub degenerate_triangles: usize,
}

/// One thing that a loader passed over or approximated. Its message is one line that names the
/// place.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Warning {
    /// Where it first occurs.
    pub at: Location,
    /// What it is.
    pub kind: WarningKind,
}

/// What was passed over or approximated.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
#[allow(missing_docs, reason = "names, and counts in the file as a whole")]
pub enum WarningKind {
    /// A material library that does not exist.
    MissingLibrary { name: String },
    /// A material that no library defines: its faces got the default.
    UnknownMaterial { name: String },
    /// A second material of the same name, which took the place of the first.
    DuplicateMaterial { name: String },
    /// Textures of a material: its plain factors are used instead.
    TexturesIgnored { name: String },
    /// An opaque surface stands for one that lets light through.
    TransparencyIgnored { name: String },
    /// A spectral curve, which is not read: the material keeps the default.
    SpectrumIgnored { name: String },
    /// A material that is neither ideally diffuse nor an ideal mirror: the nearer one is used.
    Approximated { name: String, by: &'static str },
    /// Faces of one or two vertices, which enclose nothing.
    ShortFaces { count: usize },
    /// Polygons that are not convex: cut into a fan, they may cover other ground.
    NonConvex { count: usize },
    /// Vertex normals: every triangle is shaded flat.
    NormalsIgnored { count: usize },
    /// Points and lines, which have no area.
    NotTriangles { count: usize },
    /// Vertices left over by the last triangle of a primitive.
    LeftOver { count: usize },
    /// A primitive without positions.
    NoPositions,
    /// A camera that is not a perspective one.
    CameraIgnored,
    /// A mesh in its resting pose: skins and morph targets are not applied.
    PoseIgnored,
    /// Animations: the scene stands still.
    AnimationsIgnored { count: usize },
    /// An extension that is not known, whose effect is missing.
    ExtensionIgnored { name: String },
    /// Triangles whose corners lie on one line, dropped.
    Degenerate { count: usize },
    /// Nothing emits light: without an environment the picture is black.
    NoLight,
    /// Warnings for which the report has no room left.
    LeftOut { count: usize },
    /// Emitting triangles that lie in the plane of another triangle and overlap it, so that chance
    /// decides which of the two is seen.
    CoplanarLights { count: usize },
}

impl Warning {
    /// Bytes that it takes, with its texts.
    pub(crate) fn bytes(&self) -> usize {
        let name = match &self.kind {
            WarningKind::MissingLibrary { name }
            | WarningKind::UnknownMaterial { name }
            | WarningKind::DuplicateMaterial { name }
            | WarningKind::TexturesIgnored { name }
            | WarningKind::TransparencyIgnored { name }
            | WarningKind::SpectrumIgnored { name }
            | WarningKind::Approximated { name, .. }
            | WarningKind::ExtensionIgnored { name } => name.len(),
            _ => 0,
        };
        size_of::<Self>() + self.at.path.as_os_str().len() + name
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.at, plain(&self.kind))
    }
}

impl fmt::Display for WarningKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::MissingLibrary { name } => write!(f, "material library `{name}` does not exist"),
            Self::UnknownMaterial { name } => {
                write!(f, "material `{name}` is not defined, grey used instead")
            }
            Self::DuplicateMaterial { name } => {
                write!(f, "material `{name}` is defined again, the last one counts")
            }
            Self::TexturesIgnored { name } => write!(f, "textures of material `{name}` ignored"),
            Self::TransparencyIgnored { name } => write!(f, "transparency of material `{name}` ignored"),
            Self::SpectrumIgnored { name } => write!(f, "spectral curve of material `{name}` ignored"),
            Self::Approximated { name, by } => write!(f, "material `{name}` approximated by {by}"),
            Self::ShortFaces { count } => write!(f, "faces of fewer than three vertices skipped: {count}"),
            Self::NonConvex { count } => {
                write!(f, "polygons that are not convex, cut into fans all the same: {count}")
            }
            Self::NormalsIgnored { count } => write!(f, "vertex normals ignored: {count}"),
            Self::NotTriangles { count } => write!(f, "primitives of points or lines skipped: {count}"),
            Self::LeftOver { count } => write!(f, "vertices left over by the last triangle: {count}"),
            Self::NoPositions => write!(f, "primitive without positions skipped"),
            Self::CameraIgnored => write!(f, "camera ignored, it is not a perspective one"),
            Self::PoseIgnored => write!(f, "skins and morph targets ignored"),
            Self::AnimationsIgnored { count } => write!(f, "animations ignored: {count}"),
            Self::ExtensionIgnored { name } => write!(f, "extension `{name}` ignored"),
            Self::Degenerate { count } => write!(f, "degenerate triangles dropped: {count}"),
            Self::LeftOut { count } => write!(f, "further warnings left out: {count}"),
            Self::NoLight => write!(f, "nothing emits light"),
            Self::CoplanarLights { count } => {
                write!(f, "emitting triangles that overlap another in their plane: {count}")
            }
        }
    }
}
