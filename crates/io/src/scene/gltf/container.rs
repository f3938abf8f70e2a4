use crate::error::Result;
use crate::scene::loading::Loading;
use crate::{IoError, Place, WarningKind};

/// The parts of a glTF file.
pub(super) struct Container<'a> {
    pub(super) json: &'a [u8],
    /// The binary chunk, which only .glb has.
    pub(super) binary: Option<&'a [u8]>,
    /// Whether the file is text, so that lines of `json` are lines of the file.
    pub(super) is_text: bool,
}

const MAGIC: &[u8; 4] = b"glTF";
/// The magic, the version and the length.
const HEADER_BYTES: usize = 12;
const JSON: &[u8; 4] = b"JSON";
const BINARY: &[u8; 4] = b"BIN\0";

/// Splits a file into its parts. The first bytes determine the format, not the name.
pub(super) fn open<'a>(bytes: &'a [u8], loading: &mut Loading<'_>) -> Result<Container<'a>> {
    let at = loading.at(Place::File);
    let malformed = |message: &str| IoError::Parse { at: at.clone(), message: message.into() };
    let Some(after_magic) = bytes.strip_prefix(MAGIC) else {
        let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        if !text.trim_ascii_start().starts_with(b"{") {
            return Err(malformed("is neither GLB nor a JSON object"));
        }
        return Ok(Container { json: text, binary: None, is_text: true });
    };
    let (version, rest) = number(after_magic).ok_or_else(|| malformed("header is truncated"))?;
    if version != 2 {
        return Err(IoError::Version { at, version: version.to_string() });
    }
    let (length, _) = number(rest).ok_or_else(|| malformed("header is truncated"))?;
    let Some(mut rest) = bytes.get(HEADER_BYTES..length) else {
        let message = format!("file has {} bytes, but its header says {length}", bytes.len());
        return Err(malformed(&message));
    };
    if length < bytes.len() {
        loading.warn(Place::File, WarningKind::BytesAfterEnd { count: bytes.len() - length });
    }
    let mut next = || -> Result<Option<Chunk<'a>>> {
        if rest.is_empty() {
            return Ok(None);
        }
        let (chunk, after) = chunk(rest).ok_or_else(|| malformed("chunk is truncated"))?;
        rest = after;
        if chunk.content.is_empty() { Err(malformed("chunk is empty")) } else { Ok(Some(chunk)) }
    };
    let Some(json) = next()? else { return Err(malformed("JSON chunk is missing")) };
    if json.kind != JSON {
        return Err(malformed("first chunk is not JSON"));
    }
    let binary = next()?.filter(|chunk| chunk.kind == BINARY).map(|chunk| chunk.content);
    // Further chunks belong to extensions. They are ignored, but must be complete.
    while next()?.is_some() {}
    Ok(Container { json: json.content, binary, is_text: false })
}

struct Chunk<'a> {
    kind: &'a [u8],
    content: &'a [u8],
}

/// The first chunk and the bytes after it.
fn chunk(bytes: &[u8]) -> Option<(Chunk<'_>, &[u8])> {
    let (length, rest) = number(bytes)?;
    let (kind, rest) = rest.split_at_checked(4)?;
    let (content, rest) = rest.split_at_checked(length)?;
    Some((Chunk { kind, content }, rest))
}

fn number(bytes: &[u8]) -> Option<(usize, &[u8])> {
    let (head, rest) = bytes.split_first_chunk()?;
    Some((u32::from_le_bytes(*head) as usize, rest))
}
