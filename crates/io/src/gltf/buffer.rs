use super::document::Document;
use super::json::Buffer;
use super::uri::Target;
use crate::loading::Loading;
use crate::{IoError, Place};
use std::borrow::Cow;

/// The bytes of every buffer, as many as it declares.
pub(super) fn all<'a>(
    document: &Document<'_>,
    binary: Option<&'a [u8]>,
    loading: &mut Loading<'_>,
) -> Result<Vec<Cow<'a, [u8]>>, IoError> {
    let buffers = document.buffers.iter().enumerate();
    buffers
        .map(|(index, buffer)| {
            let bytes = match &buffer.uri {
                Some(uri) => Cow::Owned(follow(&uri.0, index, loading)?),
                None => Cow::Borrowed(binary.filter(|_| index == 0).unwrap_or_default()),
            };
            cut(bytes, buffer, index, loading)
        })
        .collect()
}

fn follow(uri: &str, index: usize, loading: &mut Loading<'_>) -> Result<Vec<u8>, IoError> {
    let at = loading.at(Place::Buffer(index));
    match Target::of(uri) {
        Ok(Target::Data(bytes)) => Ok(bytes),
        Ok(Target::File(name)) => {
            let path = loading.jail.resolve(&name, &at)?;
            loading.jail.read(&path)
        }
        Ok(Target::Other(scheme)) => Err(IoError::Scheme { at, scheme: scheme.into() }),
        Err(message) => Err(IoError::Uri { at, message: message.into() }),
    }
}

/// Cuts what is beyond the declared length, which may be padding.
fn cut<'a>(
    bytes: Cow<'a, [u8]>,
    buffer: &Buffer<'_>,
    index: usize,
    loading: &Loading<'_>,
) -> Result<Cow<'a, [u8]>, IoError> {
    let declared = buffer.byte_length;
    if declared > bytes.len() as u64 {
        let message = format!("has {} bytes instead of {declared}", bytes.len());
        return Err(IoError::Accessor { at: loading.at(Place::Buffer(index)), message });
    }
    let length = declared as usize;
    Ok(match bytes {
        Cow::Borrowed(bytes) => Cow::Borrowed(&bytes[..length]),
        Cow::Owned(mut bytes) => {
            bytes.truncate(length);
            Cow::Owned(bytes)
        }
    })
}
