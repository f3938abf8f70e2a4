use super::container::Container;
use super::json::{Root, Text};
use crate::error::Result;
use crate::loading::Loading;
use crate::{IoError, Place, WarningKind};

/// The supported extensions. The emissive strength is read. The texture transform has no effect, since
/// textures are ignored.
const SUPPORTED: [&str; 2] = ["KHR_materials_emissive_strength", "KHR_texture_transform"];

/// The structure of a glTF file.
pub(super) type Document<'a> = Root<'a, true>;

impl<'a> Document<'a> {
    /// Parses the JSON and checks its version, its required extensions and its images.
    pub(super) fn parse(container: &Container<'a>, loading: &mut Loading<'_>) -> Result<Self> {
        // Offsets within the JSON have 32 bits.
        loading.check_count(container.json.len() as u64, u32::MAX.into(), "bytes of JSON")?;
        // Counted before memory is allocated for values. Commas within strings also count.
        let values = container.json.iter().filter(|byte| matches!(byte, b',' | b'{' | b'[')).count();
        loading.check_count(values as u64, loading.limits.json_values, "values in JSON")?;
        let refused = |error: serde_json::Error| {
            parse_error(&error.to_string(), (error.line(), error.column()), container, loading)
        };
        serde_json::from_slice::<Root<'a, false>>(container.json).map_err(refused)?;
        // The first reading does not check the encoding of ignored values.
        let text = str::from_utf8(container.json).map_err(|error| {
            let (line, column) = line_and_column(&container.json[..error.valid_up_to()]);
            let text = format!("is not UTF-8 at line {line} column {column}");
            parse_error(&text, (line, column), container, loading)
        })?;
        let document: Self = serde_json::from_str(text).map_err(refused)?;
        document.check_version(loading)?;
        document.check_extensions(loading)?;
        document.check_images(loading)?;
        Ok(document)
    }

    fn check_version(&self, loading: &Loading<'_>) -> Result<()> {
        let asset = &self.asset;
        let readable = |version: &str| version.starts_with("2.");
        let needed = asset.min_version.as_ref().map_or("2.0", |version| version.0.as_ref());
        let refused = match (needed, asset.version.0.as_ref()) {
            ("2.0", version) if readable(version) => return Ok(()),
            ("2.0", version) => version,
            (needed, _) => needed,
        };
        Err(IoError::Version { at: loading.at(Place::File), version: refused.into() })
    }

    fn check_extensions(&self, loading: &mut Loading<'_>) -> Result<()> {
        let unknown = |name: &Text<'_>| !SUPPORTED.contains(&name.0.as_ref());
        if let Some(extension) = self.extensions_required.iter().find(unknown) {
            let extension = extension.0.into();
            return Err(IoError::Unsupported { at: loading.at(Place::File), extension });
        }
        for name in self.extensions_used.iter().filter(unknown) {
            loading.warn(Place::File, WarningKind::ExtensionIgnored { name: name.0.into() });
        }
        let count = self.animations.count;
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
