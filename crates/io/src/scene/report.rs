use crate::Location;
use crate::escaped::escaped;
use std::fmt;
use thiserror::Error;

/// The extension that places a mesh several times, so that triangles are missing without it.
const INSTANCES: &str = "EXT_mesh_gpu_instancing";

/// File content that a loader ignored or approximated.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct LoadReport {
    /// Warnings in the order of their discovery. Repeated occurrences share one entry at the first place.
    /// Warnings beyond a quarter of the files' size plus 128 KiB are only counted.
    pub warnings: Vec<Warning>,
    /// Triangles that were dropped because their vertices are collinear: no ray can hit them.
    pub degenerate_triangles: usize,
}

/// Content that a loader ignored or approximated. The message is one line that starts with the place.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Warning {
    /// The place of the first occurrence.
    pub at: Location,
    /// The kind of content.
    pub kind: WarningKind,
}

/// The kind of content that was ignored or approximated.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "names, and counts in the file as a whole")]
pub enum WarningKind {
    /// A material library that does not exist.
    #[error("material library `{name}` does not exist")]
    MissingLibrary { name: String },
    /// A material that no library defines: its faces have the default material. The name is empty for `usemtl` without one.
    #[error("{}", unknown_material(name))]
    UnknownMaterial { name: String },
    /// A second material of the same name, which replaces the first.
    #[error("material `{name}` is redefined; the last definition is used")]
    DuplicateMaterial { name: String },
    /// Bytes of an OBJ or MTL file that are not UTF-8: each run of them is read as U+FFFD, so that names may become equal.
    #[error("bytes that are not UTF-8 are read as U+FFFD: {count}")]
    NotUtf8 { count: usize },
    /// Textures of a material: its constant factors are used instead, and a texture of colours counts as a grey of 0.5.
    #[error("textures of material `{name}` are ignored; one of colours counts as grey 0.5")]
    TexturesIgnored { name: String },
    /// The emission of a material, which a texture defines: it does not emit.
    #[error("emission of material `{name}` is ignored: a texture defines it")]
    EmissionIgnored { name: String },
    /// A transparent material, which is treated as opaque.
    #[error("transparency of material `{name}` is ignored: it is opaque")]
    TransparencyIgnored { name: String },
    /// A spectral curve, which is not supported: the default is used.
    #[error("spectral curve of material `{name}` is ignored")]
    SpectrumIgnored { name: String },
    /// A glTF material without any property of reflection or emission, such as one whose shader the exporter does not know:
    /// it is white.
    #[error(
        "material `{name}` has no properties and is white: exporters leave out shaders that they do not know"
    )]
    Unspecified { name: String },
    /// A material that is neither ideally diffuse nor an ideal mirror: the closer one is used.
    #[error("material `{name}` is approximated by {by}")]
    Approximated { name: String, by: &'static str },
    /// Faces of one or two vertices, which have no area.
    #[error("faces with fewer than three vertices are skipped: {count}")]
    ShortFaces { count: usize },
    /// Non-convex polygons: their triangle fans may cover a different area.
    #[error("non-convex polygons are triangulated as fans: {count}")]
    NonConvex { count: usize },
    /// Vertex normals: every triangle has its geometric normal.
    #[error("vertex normals are ignored: {count}")]
    NormalsIgnored { count: usize },
    /// Vertex colours, which multiply `baseColorFactor` in glTF.
    #[error("vertex colours are ignored: {count}")]
    ColorsIgnored { count: usize },
    /// Points and lines, which have no area.
    #[error("primitives of points or lines are skipped: {count}")]
    NotTriangles { count: usize },
    /// Curves and surfaces of free form: Bézier, B-spline and others.
    #[error("free-form curves and surfaces are skipped: {count}")]
    FreeFormIgnored { count: usize },
    /// Statements that OBJ or MTL does not define, that name another OBJ file, or that precede the first material of a
    /// library: they are ignored. The first has this keyword.
    #[error("unknown statements are ignored, first `{keyword}`: {count}")]
    UnknownStatements { keyword: String, count: usize },
    /// Bytes of a .glb file after the length that its header states.
    #[error("bytes after the end of the GLB are ignored: {count}")]
    BytesAfterEnd { count: usize },
    /// Vertices of a primitive after its last complete triangle.
    #[error("vertices after the last complete triangle are ignored: {count}")]
    LeftOver { count: usize },
    /// A primitive without positions.
    #[error("primitive without positions is skipped")]
    NoPositions,
    /// A camera that is not a perspective one.
    #[error("camera is not perspective and is ignored")]
    CameraIgnored,
    /// A perspective camera whose node, or a node above it, flattens its view by a scale of zero.
    #[error("camera is ignored: the node's transform flattens its view direction or its up vector")]
    CameraFlattened,
    /// A spot or directional light of a node that has no direction, such as one with a scale of zero.
    #[error("light has no direction and is ignored")]
    LightIgnored,
    /// Ranges of delta lights, beyond which a renderer may ignore them: they shine at any distance.
    #[error("ranges of delta lights are ignored: {count}")]
    RangeIgnored { count: usize },
    /// Skins and morph targets: a mesh stays in its rest pose.
    #[error("skins and morph targets are ignored")]
    PoseIgnored,
    /// Animations.
    #[error("animations are ignored: {count}")]
    AnimationsIgnored { count: usize },
    /// An unsupported extension that is not required, or that changes no triangle, light or camera.
    #[error("{}", extension_ignored(name))]
    ExtensionIgnored { name: String },
    /// Triangles with collinear vertices, which are dropped.
    #[error("degenerate triangles are dropped: {count}")]
    Degenerate { count: usize },
    /// No triangle emits, and there are no delta lights: without an environment the picture is black.
    #[error("scene has no lights")]
    NoLight,
    /// Warnings for which the report has no room.
    #[error("further warnings are omitted: {count}")]
    LeftOut { count: usize },
    /// Lights that overlap another triangle in the same plane, so that rounding decides which of the two
    /// a ray hits.
    #[error("lights overlap another triangle in their plane, so rounding decides what they light: {count}")]
    CoplanarLights { count: usize },
}

impl LoadReport {
    /// The texts of the first few different warnings about content that has no triangles but might be expected to.
    pub(crate) fn skipped(&self) -> Vec<String> {
        let mut kinds: Vec<_> = self.warnings.iter().map(|warning| &warning.kind).collect();
        kinds.retain(|kind| kind.loses_triangles());
        kinds.dedup();
        kinds.into_iter().take(8).map(ToString::to_string).collect()
    }
}

impl WarningKind {
    /// Whether it is about content that might be expected to have triangles.
    fn loses_triangles(&self) -> bool {
        match self {
            Self::ExtensionIgnored { name } => name.contains("mesh"),
            Self::ShortFaces { .. }
            | Self::NotTriangles { .. }
            | Self::FreeFormIgnored { .. }
            | Self::UnknownStatements { .. }
            | Self::LeftOver { .. }
            | Self::NoPositions
            | Self::Degenerate { .. } => true,
            _ => false,
        }
    }
}

impl Warning {
    /// The memory of the warning in bytes, with its text.
    pub(crate) fn bytes(&self) -> usize {
        let name = match &self.kind {
            WarningKind::MissingLibrary { name }
            | WarningKind::UnknownMaterial { name }
            | WarningKind::DuplicateMaterial { name }
            | WarningKind::TexturesIgnored { name }
            | WarningKind::EmissionIgnored { name }
            | WarningKind::TransparencyIgnored { name }
            | WarningKind::SpectrumIgnored { name }
            | WarningKind::Unspecified { name }
            | WarningKind::Approximated { name, .. }
            | WarningKind::ExtensionIgnored { name } => name.len(),
            WarningKind::UnknownStatements { keyword, .. } => keyword.len(),
            _ => 0,
        };
        size_of::<Self>() + self.at.path.as_os_str().len() + name
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.at, escaped(&self.kind))
    }
}

/// The message of [`WarningKind::UnknownMaterial`].
fn unknown_material(name: &str) -> String {
    match name {
        "" => "usemtl has no name; grey is used instead".into(),
        _ => format!("material `{name}` is not defined; grey is used instead"),
    }
}

/// The message of [`WarningKind::ExtensionIgnored`].
fn extension_ignored(name: &str) -> String {
    match name {
        INSTANCES => format!("extension `{name}` is ignored: copies of meshes are missing"),
        _ => format!("extension `{name}` is ignored"),
    }
}
