use super::container::Container;
use super::json::{Root, Text};
use crate::loading::Loading;
use crate::{IoError, Place, WarningKind};

/// Extensions whose effect is not lost: the strength of emission is read, and where a texture lies
/// does not matter, since textures are not.
const READ: [&str; 2] = ["KHR_materials_emissive_strength", "KHR_texture_transform"];

/// A glTF file's structure, of a version that is understood and needing no unknown extension.
pub(super) struct Document<'a>(Root<'a, true>);

impl<'a> Document<'a> {
    pub(super) fn parse(container: &Container<'a>, loading: &mut Loading<'_>) -> Result<Self, IoError> {
        check_length(container.json.len() as u64, loading)?;
        check_count_of_values(container.json, loading)?;
        let refused = |error: serde_json::Error| {
            parse_error(&error.to_string(), error.line(), error.column(), container, loading)
        };
        serde_json::from_slice::<Root<'a, false>>(container.json).map_err(refused)?;
        // Text that nothing reads may be of another encoding.
        let text = str::from_utf8(container.json).map_err(|error| {
            let (line, column) = line_and_column(&container.json[..error.valid_up_to()]);
            let text = format!("is not UTF-8 at line {line} column {column}");
            parse_error(&text, line, column, container, loading)
        })?;
        let document = Self(serde_json::from_str(text).map_err(refused)?);
        document.check_version(loading)?;
        document.check_extensions(loading)?;
        document.check_images(loading)?;
        Ok(document)
    }

    fn check_version(&self, loading: &Loading<'_>) -> Result<(), IoError> {
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

    fn check_extensions(&self, loading: &mut Loading<'_>) -> Result<(), IoError> {
        let unknown = |name: &Text<'_>| !READ.contains(&name.0.as_ref());
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

    /// Images are not read, but a file that does not even say where they are is broken.
    fn check_images(&self, loading: &Loading<'_>) -> Result<(), IoError> {
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

impl<'a> std::ops::Deref for Document<'a> {
    type Target = Root<'a, true>;

    fn deref(&self) -> &Root<'a, true> {
        &self.0
    }
}

/// Places within JSON are kept in 32 bits.
fn check_length(length: u64, loading: &Loading<'_>) -> Result<(), IoError> {
    let limit = u32::MAX.into();
    let at = loading.at(Place::File);
    if length > limit { Err(IoError::TooLarge { at, what: "bytes of JSON", limit }) } else { Ok(()) }
}

/// Looks for too many values before any memory is spent on them. Commas within strings count too,
/// so what passes may be a little less than the limit.
fn check_count_of_values(json: &[u8], loading: &Loading<'_>) -> Result<(), IoError> {
    let limit = loading.limits.json_values;
    let count = json.iter().filter(|byte| matches!(byte, b',' | b'{' | b'[')).count();
    if count as u64 > limit {
        let at = loading.at(Place::File);
        return Err(IoError::TooLarge { at, what: "values in JSON", limit });
    }
    Ok(())
}

/// Where the text ends that `before` is, both counted from 1.
fn line_and_column(before: &[u8]) -> (usize, usize) {
    let line = 1 + before.iter().filter(|&&byte| byte == b'\n').count();
    let column = 1 + before.iter().rev().take_while(|&&byte| byte != b'\n').count();
    (line, column)
}

/// An error of that text, which ends in line and column; those are the file's if it is nothing but
/// JSON.
fn parse_error(
    text: &str,
    line: usize,
    column: usize,
    container: &Container<'_>,
    loading: &Loading<'_>,
) -> IoError {
    let (at, message) = if container.is_text {
        let (what, _) = text.rsplit_once(" at line ").unwrap_or((text, ""));
        (Place::Line(line.max(1)), format!("column {column}: {what}"))
    } else {
        (Place::File, format!("JSON chunk: {text}"))
    };
    IoError::Parse { at: loading.at(at), message }
}
