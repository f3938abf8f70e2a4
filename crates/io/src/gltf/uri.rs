//! Uniform resource identifiers (RFC 3986) of the files of a scene.

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
        if let Some(data) = uri.strip_prefix("data:") {
            let (kind, content) = data.split_once(',').ok_or("comma after `data:` is missing")?;
            let bytes = if kind.ends_with(";base64") { base64(content)? } else { percent_decoded(content)? };
            return Ok(Self::Data(bytes));
        }
        if let Some(scheme) = scheme(uri) {
            return Ok(Self::Other(scheme));
        }
        if !uri.contains('%') {
            return Ok(Self::File(uri.into()));
        }
        let name = String::from_utf8(percent_decoded(uri)?).map_err(|_| "is not UTF-8")?;
        if name.contains('\0') { Err("file name contains a NUL byte") } else { Ok(Self::File(name.into())) }
    }
}

/// The scheme that a URI starts with.
fn scheme(uri: &str) -> Option<&str> {
    let (scheme, _) = uri.split_once(':')?;
    let letter = scheme.starts_with(|c: char| c.is_ascii_alphabetic());
    let rest = scheme.bytes().all(|b| b.is_ascii_alphanumeric() || matches!(b, b'+' | b'-' | b'.'));
    (letter && rest).then_some(scheme)
}

fn percent_decoded(text: &str) -> Result<Vec<u8>, &'static str> {
    let mut bytes = text.bytes();
    let mut decoded = Vec::with_capacity(text.len());
    while let Some(byte) = bytes.next() {
        decoded.push(match byte {
            b'%' => {
                let mut digit = || bytes.next().and_then(|b| char::from(b).to_digit(16));
                let (high, low) = (digit(), digit());
                high.zip(low)
                    .map(|(high, low)| (16 * high + low) as u8)
                    .ok_or("`%` without two hexadecimal digits")?
            }
            byte => byte,
        });
    }
    Ok(decoded)
}

/// Decodes base64 (RFC 4648), padded or not.
fn base64(text: &str) -> Result<Vec<u8>, &'static str> {
    let digits = text.trim_end_matches('=').as_bytes();
    if digits.len() % 4 == 1 || text.len() - digits.len() > 2 {
        return Err("base64 data is truncated");
    }
    let mut bytes = Vec::with_capacity(digits.len() / 4 * 3 + 2);
    for group in digits.chunks(4) {
        let mut bits = 0;
        for &digit in group {
            bits = bits << 6 | six_bits(digit).ok_or("invalid base64 character")?;
        }
        bits <<= 6 * (4 - group.len());
        // Four digits encode three bytes, three encode two, and two encode one.
        bytes.extend(&bits.to_be_bytes()[1..group.len()]);
    }
    Ok(bytes)
}

fn six_bits(digit: u8) -> Option<u32> {
    let value = match digit {
        b'A'..=b'Z' => digit - b'A',
        b'a'..=b'z' => digit - b'a' + 26,
        b'0'..=b'9' => digit - b'0' + 52,
        b'+' => 62,
        b'/' => 63,
        _ => return None,
    };
    Some(value.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_by_the_rfcs_examples() {
        let known = [("", ""), ("Zg==", "f"), ("Zm8=", "fo"), ("Zm9v", "foo"), ("Zm9vYg==", "foob")];
        for (text, bytes) in known {
            assert_eq!(base64(text).unwrap(), bytes.as_bytes());
            assert_eq!(base64(text.trim_end_matches('=')).unwrap(), bytes.as_bytes());
        }
        assert_eq!(base64("/+8=").unwrap(), [0xff, 0xef]);
        for bad in ["Z", "Zm9vY", "Zm9*", "Zg===", "Z g="] {
            assert!(base64(bad).is_err(), "{bad}");
        }
        assert_eq!(Target::of("data:application/octet-stream;base64,Zm8="), Ok(Target::Data(b"fo".into())));
        for bad in ["%FF.bin", "%", "%1", "%zz", "%00", "data:;base64"] {
            assert!(Target::of(bad).is_err(), "{bad}");
        }
    }
}
