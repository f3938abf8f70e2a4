//! Uniform resource identifiers (RFC 3986) of the files of a scene.

use data_url::DataUrl;
use percent_encoding::percent_decode_str;
use std::borrow::Cow;

/// The resource that a URI refers to.
#[derive(Debug, PartialEq)]
pub(super) enum Target<'a> {
    /// The bytes of a `data:` URI.
    Data(Vec<u8>),
    /// A file name relative to the scene file.
    File(Cow<'a, str>),
    /// A URI of an unsupported scheme.
    Other(&'a str),
}

impl<'a> Target<'a> {
    /// The target of a URI, or a message that says why the URI is invalid.
    pub(super) fn of(uri: &'a str) -> Result<Self, &'static str> {
        match scheme(uri) {
            Some("data") => {
                let data = DataUrl::process(uri).map_err(|_| "comma after `data:` is missing")?;
                let (bytes, _) = data.decode_to_vec().map_err(|_| "base64 data is malformed")?;
                Ok(Self::Data(bytes))
            }
            Some(scheme) => Ok(Self::Other(scheme)),
            None => {
                let name = percent_decode_str(uri).decode_utf8();
                Ok(Self::File(name.map_err(|_| "is not UTF-8")?))
            }
        }
    }
}

/// The scheme that a URI starts with.
fn scheme(uri: &str) -> Option<&str> {
    let (scheme, _) = uri.split_once(':')?;
    let letter = scheme.starts_with(|c: char| c.is_ascii_alphabetic());
    let rest = scheme.bytes().all(|b| b.is_ascii_alphanumeric() || matches!(b, b'+' | b'-' | b'.'));
    (letter && rest).then_some(scheme)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uris_lead_to_data_and_files_or_nowhere() {
        for (uri, bytes) in [
            ("data:,f%6f", &b"fo"[..]),
            ("data:application/octet-stream;base64,Zm8=", b"fo"),
            ("data:application/gltf-buffer;base64,/+8", &[0xff, 0xef]),
        ] {
            assert_eq!(Target::of(uri), Ok(Target::Data(bytes.into())), "{uri}");
        }
        assert_eq!(Target::of("my%20data/a.bin"), Ok(Target::File("my data/a.bin".into())));
        assert_eq!(Target::of("https://a/b.bin"), Ok(Target::Other("https")));
        for bad in ["%FF.bin", "data:;base64", "data:;base64,Z", "data:;base64,Zm9*", "data:;base64,Zg==="] {
            assert!(Target::of(bad).is_err(), "{bad}");
        }
    }
}
