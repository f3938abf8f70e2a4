use super::container::Container;
use super::guard;
use super::json_material::JsonMaterial;
use crate::error::Result;
use crate::scene::loading::Loading;
use crate::{IoError, Place, WarningKind};
use gltf::json::extensions::root::Root as Extensions;
use gltf::json::{Accessor, Asset, Buffer, Camera, Image, Index, Mesh, Node, buffer};
use serde::Deserialize;
use serde::de::IgnoredAny;
use std::collections::HashSet;
use std::mem::take;

/// The extensions that are read. The texture transform has no effect, since textures are ignored. What is lost of specular
/// reflection and of transmission is a warning of each material.
const SUPPORTED: [&str; 5] = [
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_texture_transform",
];

/// How the names of extensions begin that change no triangle, light or camera: a file may require them, since what they
/// add is ignored with a warning.
const APPEARANCE: [&str; 10] = [
    "ADOBE_materials_",
    "EXT_materials_",
    "EXT_texture_",
    "GOOGLE_texture_",
    "KHR_animation_pointer",
    "KHR_materials_",
    "KHR_techniques_webgl",
    "KHR_texture_",
    "KHR_xmp_json_ld",
    "MSFT_texture_",
];

/// The structure of a glTF file, in the types of the crate `gltf`. Other members are ignored.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Document {
    asset: Asset,
    pub(super) scene: Option<Index<gltf::json::Scene>>,
    #[serde(default)]
    pub(super) scenes: Vec<Scene>,
    #[serde(default)]
    pub(super) nodes: Vec<Node>,
    #[serde(default)]
    pub(super) meshes: Vec<Mesh>,
    #[serde(default)]
    pub(super) accessors: Vec<Accessor>,
    #[serde(default)]
    pub(super) buffer_views: Vec<buffer::View>,
    #[serde(default)]
    pub(super) buffers: Vec<Buffer>,
    #[serde(default)]
    pub(super) materials: Vec<JsonMaterial>,
    #[serde(default)]
    pub(super) cameras: Vec<Camera>,
    #[serde(default)]
    images: Vec<Image>,
    #[serde(default)]
    animations: Vec<IgnoredAny>,
    #[serde(default)]
    extensions_used: Vec<String>,
    #[serde(default)]
    extensions_required: Vec<String>,
    pub(super) extensions: Option<Extensions>,
}

/// The crate's own type demands `nodes`, which glTF does not.
#[derive(Deserialize)]
pub(super) struct Scene {
    #[serde(default)]
    pub(super) nodes: Vec<Index<Node>>,
}

impl Document {
    /// Parses the JSON and checks its version, its required extensions and its images.
    pub(super) fn parse(container: &Container<'_>, loading: &mut Loading<'_>) -> Result<Self> {
        let text = str::from_utf8(container.json).map_err(|error| {
            let (line, column) = line_and_column(&container.json[..error.valid_up_to()]);
            let text = format!("is not UTF-8 at line {line} column {column}");
            parse_error(&text, (line, column), container, loading)
        })?;
        let refused = |error: serde_json::Error| {
            parse_error(&error.to_string(), (error.line(), error.column()), container, loading)
        };
        let counts = guard::check(text).map_err(refused)?;
        loading.check_count(counts.objects, loading.limits.json_objects, "objects in JSON")?;
        loading.check_count(counts.values, loading.limits.json_values, "values in JSON")?;
        let mut document: Self = serde_json::from_str(text).map_err(refused)?;
        document.check_version(loading)?;
        document.check_extensions(loading)?;
        document.check_images(loading)?;
        Ok(document)
    }

    fn check_version(&self, loading: &Loading<'_>) -> Result<()> {
        let needed = self.asset.min_version.as_deref().unwrap_or("2.0");
        let refused = match (needed, self.asset.version.as_str()) {
            ("2.0", version) if version.starts_with("2.") => return Ok(()),
            ("2.0", version) => version,
            (needed, _) => needed,
        };
        Err(IoError::Version { at: loading.at(Place::File), version: refused.into() })
    }

    fn check_extensions(&mut self, loading: &mut Loading<'_>) -> Result<()> {
        let unknown = |name: &str| !SUPPORTED.contains(&name);
        let needed = |name: &str| unknown(name) && !APPEARANCE.iter().any(|start| name.starts_with(start));
        if self.extensions_required.iter().any(|name| needed(name)) {
            let mut extensions = take(&mut self.extensions_required);
            extensions.retain(|name| needed(name));
            return Err(IoError::Unsupported { at: loading.at(Place::File), extensions });
        }
        let mut warned = HashSet::new();
        let all = self.extensions_used.iter().chain(&self.extensions_required);
        for name in all.filter(|name| unknown(name) && warned.insert(name.as_str())) {
            loading.warn(Place::File, WarningKind::ExtensionIgnored { name: name.clone() });
        }
        let count = self.animations.len();
        if count > 0 {
            loading.warn(Place::File, WarningKind::AnimationsIgnored { count });
        }
        Ok(())
    }

    /// Checks that every image has a source. Images are not read.
    fn check_images(&self, loading: &Loading<'_>) -> Result<()> {
        for (index, image) in self.images.iter().enumerate() {
            let malformed = |message: &str| {
                Err(IoError::Parse { at: loading.at(Place::Image(index)), message: message.into() })
            };
            match (&image.uri, image.buffer_view, &image.mime_type) {
                (None, None, _) => return malformed("image has neither a URI nor a buffer view"),
                (None, Some(_), None) => return malformed("image in a buffer view has no MIME type"),
                _ => {}
            }
        }
        Ok(())
    }
}

/// The line and column, from 1, after the text `before`.
fn line_and_column(before: &[u8]) -> (usize, usize) {
    let line = 1 + before.iter().filter(|&&byte| byte == b'\n').count();
    let column = 1 + before.iter().rev().take_while(|&&byte| byte != b'\n').count();
    (line, column)
}

/// The error for the message `text`, which ends in line and column. In a text file these are the line and
/// column of the file; in a binary file they count within the JSON chunk.
fn parse_error(text: &str, at: (usize, usize), container: &Container<'_>, loading: &Loading<'_>) -> IoError {
    let (line, column) = at;
    let (at, message) = if container.is_text {
        let (what, _) = text.rsplit_once(" at line ").unwrap_or((text, ""));
        (Place::Line(line.max(1)), format!("column {column}: {what}"))
    } else {
        (Place::File, format!("JSON chunk: {text}"))
    };
    IoError::Parse { at: loading.at(at), message }
}
