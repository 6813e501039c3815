//! URIs inside a glTF file: `data:` URIs, and relative URIs inside the file's folder.

use crate::error::quoted;

/// Target of a URI in a file.
pub(crate) enum Uri {
    /// The decoded bytes of a data URI.
    Data(Vec<u8>),
    /// A path relative to the file's folder, decoded and checked.
    Relative(String),
}

/// Parses a URI as glTF 2.0 §2.8 allows it. Errors have no location; the caller adds it.
pub(crate) fn parse(uri: &str) -> Result<Uri, String> {
    if let Some(rest) = uri.strip_prefix("data:") {
        return data(rest).map(Uri::Data);
    }
    relative_path(uri).map(Uri::Relative)
}

/// Decodes the bytes of a data URI (RFC 2397) after `data:`.
fn data(rest: &str) -> Result<Vec<u8>, String> {
    let (head, body) = rest.split_once(',').ok_or("data URI has no comma")?;
    if head.ends_with(";base64") { base64(body) } else { percent_decode(body) }
}

/// Decodes a relative path that stays inside its base folder.
///
/// # Errors
/// Returns a one-line error for an absolute path, a scheme (`http:`, `C:`), a `..`, a backslash, a NUL or bad
/// UTF-8.
pub(crate) fn relative_path(uri: &str) -> Result<String, String> {
    let path = String::from_utf8(percent_decode(uri)?).map_err(|_| "URI is not UTF-8")?;
    let head = path.split('/').next().unwrap_or_default();
    if head.contains(':') {
        return Err(format!("URI {} has a scheme; only files beside this one are read", quoted(uri)));
    }
    if path.contains(['\\', '\0']) {
        return Err(format!("URI {} has a character that no URI may have", quoted(uri)));
    }
    if path.is_empty() || path.starts_with('/') || path.split('/').any(|part| part == "..") {
        return Err(format!("URI {} leaves the folder of the file", quoted(uri)));
    }
    Ok(path)
}

/// Decodes `%20` and the like to bytes (RFC 3986 §2.1).
fn percent_decode(text: &str) -> Result<Vec<u8>, String> {
    let mut out = Vec::with_capacity(text.len());
    let mut bytes = text.bytes();
    while let Some(byte) = bytes.next() {
        if byte != b'%' {
            out.push(byte);
            continue;
        }
        let mut digit = || bytes.next().and_then(|d| char::from(d).to_digit(16));
        let (Some(high), Some(low)) = (digit(), digit()) else {
            return Err("`%` in a URI needs two hexadecimal digits".into());
        };
        out.push((high * 16 + low) as u8);
    }
    Ok(out)
}

/// Decodes base64 (RFC 4648 §4), with or without padding.
fn base64(text: &str) -> Result<Vec<u8>, String> {
    let text = text.trim_end_matches('=').as_bytes();
    let mut out = Vec::with_capacity(text.len() / 4 * 3 + 2);
    for (group, chunk) in text.chunks(4).enumerate() {
        let mut bits = 0_u32;
        for (i, &byte) in chunk.iter().enumerate() {
            let value = sextet(byte)
                .ok_or_else(|| format!("not a base64 digit at character {} of the data", group * 4 + i))?;
            bits |= u32::from(value) << (18 - 6 * i);
        }
        let [_, a, b, c] = bits.to_be_bytes();
        match chunk.len() {
            4 => out.extend([a, b, c]),
            3 => out.extend([a, b]),
            2 => out.push(a),
            _ => return Err("base64 data ends inside a byte".into()),
        }
    }
    Ok(out)
}

fn sextet(byte: u8) -> Option<u8> {
    match byte {
        b'A'..=b'Z' => Some(byte - b'A'),
        b'a'..=b'z' => Some(byte - b'a' + 26),
        b'0'..=b'9' => Some(byte - b'0' + 52),
        b'+' => Some(62),
        b'/' => Some(63),
        _ => None,
    }
}

/// Encodes bytes as a `data:` URI with base64 (RFC 2397, RFC 4648 §4).
pub(crate) fn encode_data(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::from("data:application/octet-stream;base64,");
    for chunk in bytes.chunks(3) {
        let byte = |i: usize| u32::from(chunk.get(i).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for i in 0..4 {
            let digit = DIGITS[(bits >> (18 - 6 * i) & 63) as usize];
            out.push(if i <= chunk.len() { char::from(digit) } else { '=' });
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_round_trips_for_every_tail_length() {
        for n in 0..8_u8 {
            let bytes: Vec<u8> = (0..n).map(|i| i.wrapping_mul(83)).collect();
            let Ok(Uri::Data(back)) = parse(&encode_data(&bytes)) else { panic!("{n} bytes") };
            assert_eq!(back, bytes);
        }
    }

    #[test]
    fn base64_matches_the_vectors_of_rfc_4648() {
        for (plain, coded) in [("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")] {
            assert_eq!(base64(coded), Ok(plain.as_bytes().to_vec()));
        }
        assert!(base64("Z").is_err());
        assert!(base64("Zm9*").is_err());
    }

    #[test]
    fn paths_out_of_the_folder_are_rejected() {
        for bad in [
            "../x",
            "a/../../x",
            "%2e%2e/x",
            "a/%2E%2e/x",
            "/etc/passwd",
            "%2Fetc/passwd",
            "file:///x",
            "http://h/x",
            "C:/x",
            "c:x",
            "..\\x",
            "a%5c..%5cx",
            "",
            "a%00b",
            "%zz",
            "%4",
            "%ff",
        ] {
            assert!(relative_path(bad).is_err(), "{bad}");
        }
        assert_eq!(relative_path("a%20b/c.bin"), Ok("a b/c.bin".into()));
        assert_eq!(relative_path("./..a/b..bin"), Ok("./..a/b..bin".into()));
    }
}
