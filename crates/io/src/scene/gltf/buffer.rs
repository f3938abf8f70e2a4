use super::document::Document;
use super::uri::Target;
use crate::error::Result;
use crate::scene::loading::Loading;
use crate::{IoError, Place};
use gltf::json;
use std::collections::HashMap;
use std::path::PathBuf;
use std::rc::Rc;

/// The bytes of every buffer, of the declared length.
pub(super) struct Buffers<'a>(Vec<Bytes<'a>>);

enum Bytes<'a> {
    /// The binary chunk, or an empty slice.
    Chunk(&'a [u8]),
    /// The first bytes of a file or of a `data:` URI. Buffers may share a file.
    Of(Rc<Vec<u8>>, usize),
}

impl<'a> Buffers<'a> {
    pub(super) fn of(
        document: &Document,
        binary: Option<&'a [u8]>,
        loading: &mut Loading<'_>,
    ) -> Result<Self> {
        let mut all = Vec::with_capacity(document.buffers.len());
        let mut files = Files::default();
        for (index, json) in document.buffers.iter().enumerate() {
            all.push(match &json.uri {
                Some(uri) => {
                    let bytes = files.follow(uri, index, loading)?;
                    let length = check_length(&bytes, json, index, loading)?;
                    Bytes::Of(bytes, length)
                }
                None => {
                    let bytes = binary.filter(|_| index == 0).unwrap_or_default();
                    Bytes::Chunk(&bytes[..check_length(bytes, json, index, loading)?])
                }
            });
        }
        Ok(Self(all))
    }

    /// The bytes of buffer `index`; `None` if the buffer does not exist.
    pub(super) fn get(&self, index: usize) -> Option<&[u8]> {
        Some(match self.0.get(index)? {
            Bytes::Chunk(bytes) => bytes,
            Bytes::Of(bytes, length) => &bytes[..*length],
        })
    }
}

/// The files of buffers. Each is read once, so that a small scene cannot request the memory of many copies.
#[derive(Default)]
struct Files(HashMap<PathBuf, Rc<Vec<u8>>>);

impl Files {
    fn follow(&mut self, uri: &str, index: usize, loading: &mut Loading<'_>) -> Result<Rc<Vec<u8>>> {
        let at = loading.at(Place::Buffer(index));
        match Target::of(uri) {
            Ok(Target::Data(bytes)) => Ok(Rc::new(bytes)),
            Ok(Target::File(name)) => {
                let path = loading.files.resolve(&name, &at)?;
                // A file may have several names.
                let identity = loading.files.identity(&path);
                if let Some(bytes) = self.0.get(&identity) {
                    return Ok(Rc::clone(bytes));
                }
                let bytes = Rc::new(loading.files.read_named(&path, &name, &at)?);
                self.0.insert(identity, Rc::clone(&bytes));
                Ok(bytes)
            }
            Ok(Target::Other(scheme)) => Err(IoError::Scheme { at, scheme: scheme.into() }),
            Err(message) => Err(IoError::Uri { at, message: message.into() }),
        }
    }
}

/// The declared length of a buffer. Bytes beyond it may be padding.
fn check_length(bytes: &[u8], json: &json::Buffer, index: usize, loading: &Loading<'_>) -> Result<usize> {
    let declared = json.byte_length.0;
    if declared <= bytes.len() as u64 {
        return Ok(declared as usize);
    }
    let message = format!("buffer has {} bytes; {declared} are declared", bytes.len());
    Err(IoError::Accessor { at: loading.at(Place::Buffer(index)), message })
}
