//! The GLB container (glTF 2.0 §4): a header, a JSON chunk, and at most one binary chunk.

use crate::error::{Error, Result};

const MAGIC: &[u8; 4] = b"glTF";
const JSON: u32 = 0x4E4F_534A;
const BIN: u32 = 0x004E_4942;

/// The parts of a GLB, borrowed from its bytes.
pub(crate) struct Glb<'a> {
    pub(crate) json: &'a [u8],
    pub(crate) bin: Option<&'a [u8]>,
    /// Further chunks of other types, with their headers; they are preserved on writing.
    pub(crate) other_chunks: &'a [u8],
}

/// True if the bytes start with the magic bytes of a GLB.
pub(crate) fn is_glb(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// Splits a GLB into its parts. Checks every length against the available bytes; copies no bytes.
pub(crate) fn parse(bytes: &[u8]) -> Result<Glb<'_>> {
    let header = |offset| u32_at(bytes, offset).ok_or_else(|| truncated("GLB header", bytes.len()));
    match header(4)? {
        2 => {}
        version @ (0 | 1) => {
            return Err(Error::unsupported(
                format!("glTF version {version} is not supported, only 2"),
                "byte 4",
            ));
        }
        version => return Err(Error::malformed(format!("unknown GLB version {version}"), "byte 4")),
    }
    let claimed = header(8)? as usize;
    let body = bytes.get(..claimed).ok_or_else(|| {
        Error::malformed(
            format!("truncated: header claims {claimed} bytes, file has {}", bytes.len()),
            "byte 8",
        )
    })?;
    let (kind, json, mut rest) = chunk(body, 12)?;
    if kind != JSON {
        return Err(Error::malformed("first chunk is not JSON", "byte 12"));
    }
    let mut bin = None;
    if rest < body.len() {
        let (kind, data, after) = chunk(body, rest)?;
        if kind == BIN {
            bin = Some(data);
            rest = after;
        }
    }
    let other_chunks = &body[rest..];
    while rest < body.len() {
        let (kind, _, after) = chunk(body, rest)?;
        if kind == BIN || kind == JSON {
            return Err(Error::malformed("more than one JSON or BIN chunk", format!("byte {rest}")));
        }
        rest = after;
    }
    Ok(Glb { json, bin, other_chunks })
}

/// Returns type, bytes and end of the chunk at `offset`.
fn chunk(body: &[u8], offset: usize) -> Result<(u32, &[u8], usize)> {
    let missing = || truncated("chunk header", offset);
    let length = u32_at(body, offset).ok_or_else(missing)? as usize;
    let kind = u32_at(body, offset + 4).ok_or_else(missing)?;
    let start = offset + 8;
    let data = start.checked_add(length).and_then(|end| body.get(start..end)).ok_or_else(|| {
        let there = body.len() - start;
        Error::malformed(format!("chunk claims {length} bytes, {there} are there"), format!("byte {offset}"))
    })?;
    Ok((kind, data, start + length))
}

fn truncated(what: &str, at: usize) -> Error {
    Error::malformed(format!("truncated {what}"), format!("byte {at}"))
}

fn u32_at(bytes: &[u8], offset: usize) -> Option<u32> {
    bytes.get(offset..)?.first_chunk().map(|b| u32::from_le_bytes(*b))
}

/// Assembles a GLB: JSON padded with spaces, binary with zeros.
///
/// # Errors
/// If the file exceeds 4 GiB, the limit of its 32-bit lengths.
pub(crate) fn write(json: &[u8], bin: &[u8], other_chunks: &[u8]) -> Result<Vec<u8>> {
    let padded = |length: usize| length.div_ceil(4) * 4;
    let bin_size = if bin.is_empty() { 0 } else { 8 + padded(bin.len()) };
    let total = 12 + 8 + padded(json.len()) + bin_size + other_chunks.len();
    let total_u32 =
        u32::try_from(total).map_err(|_| Error::unsupported("a GLB cannot be larger than 4 GiB", ""))?;
    let mut out = Vec::with_capacity(total);
    out.extend(MAGIC);
    out.extend(2_u32.to_le_bytes());
    out.extend(total_u32.to_le_bytes());
    let mut push_chunk = |kind: u32, data: &[u8], pad: u8| {
        out.extend((padded(data.len()) as u32).to_le_bytes());
        out.extend(kind.to_le_bytes());
        out.extend(data);
        out.resize(out.len().div_ceil(4) * 4, pad);
    };
    push_chunk(JSON, json, b' ');
    if !bin.is_empty() {
        push_chunk(BIN, bin, 0);
    }
    out.extend(other_chunks);
    Ok(out)
}
