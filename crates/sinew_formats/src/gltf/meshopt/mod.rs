//! Compressed buffer views: `EXT_meshopt_compression`, and `KHR_meshopt_compression`, which adds a second version of
//! the attribute streams and a filter for colours.
//!
//! Streams are untrusted: every read is bounds-checked, and a view's claimed size counts against the budget before
//! decoding.

mod attributes;
mod filter;
mod indices;

use super::source::{Buffer, buffer_bytes};
use crate::container::json::At;
use crate::error::Result;

/// Both names of the extension; the streams themselves mark the additions of the newer one.
const NAMES: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// True if this module reads the extension.
pub(super) fn is_known(name: &str) -> bool {
    NAMES.contains(&name)
}

/// Decoded bytes, or the reason why a stream cannot be decoded, in a few words.
type Decoded = Result<Vec<u8>, &'static str>;

/// Returns the bytes of each compressed buffer view; `None` for other views. `budget` shrinks by their size.
pub(super) fn decode_views(
    root: At<'_>,
    buffers: &[Buffer],
    bin: Option<&[u8]>,
    budget: &mut usize,
) -> Result<Vec<Option<Vec<u8>>>> {
    let entries = root.list("buffers")?;
    let decode = |view: At<'_>| {
        let Some(at) = extension(view)? else { return Ok(None) };
        let bytes = buffer_bytes(buffers, &entries, bin, at)?;
        decode_view(at, view, bytes, budget).map(Some)
    };
    root.list("bufferViews")?.into_iter().map(decode).collect()
}

fn extension(view: At<'_>) -> Result<Option<At<'_>>> {
    let Some(all) = view.get("extensions")? else { return Ok(None) };
    for name in NAMES {
        if let Some(at) = all.get(name)? {
            return Ok(Some(at));
        }
    }
    Ok(None)
}

fn decode_view(at: At<'_>, view: At<'_>, bytes: &[u8], budget: &mut usize) -> Result<Vec<u8>> {
    let (count, stride) = (at.need("count")?.usize()?, at.need("byteStride")?.usize()?);
    let size = count.checked_mul(stride).filter(|size| size <= budget);
    let Some(size) = size else {
        return Err(at.malformed(format!("{count} elements are more than the size of the file justifies")));
    };
    let length_at = view.need("byteLength")?;
    if length_at.usize()? > size {
        return Err(length_at.malformed(format!("the compressed view has {size} bytes")));
    }
    *budget -= size;
    let mode = at.need("mode")?;
    let broken = |what: &str| at.malformed(format!("broken stream: {what}"));
    let mut decoded = match mode.str()? {
        "ATTRIBUTES" => attributes::decode(bytes, count, stride),
        "TRIANGLES" => indices::decode_triangles(bytes, count).and_then(|list| packed(&list, stride)),
        "INDICES" => indices::decode_sequence(bytes, count).and_then(|list| packed(&list, stride)),
        _ => return Err(mode.malformed("unknown mode")),
    }
    .map_err(broken)?;
    if let Some(filter) = at.get("filter")? {
        if mode.str()? != "ATTRIBUTES" && filter.str()? != "NONE" {
            return Err(filter.malformed("a filter is for attributes"));
        }
        filter::apply(filter.str()?, &mut decoded, stride).map_err(|what| filter.malformed(what))?;
    }
    Ok(decoded)
}

/// Packs indices as bytes, two or four each.
fn packed(indices: &[u32], stride: usize) -> Decoded {
    match stride {
        2 => {
            let short = |&i: &u32| u16::try_from(i).map(u16::to_le_bytes);
            let shorts: Result<Vec<[u8; 2]>, _> = indices.iter().map(short).collect();
            shorts.map(Vec::into_flattened).map_err(|_| "an index needs more than its two bytes")
        }
        4 => Ok(indices.iter().flat_map(|i| i.to_le_bytes()).collect()),
        _ => Err("indices have two or four bytes"),
    }
}

/// Reads a stream from its start.
struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    /// Returns the next `count` bytes.
    fn take(&mut self, count: usize) -> Result<&'a [u8], &'static str> {
        let (taken, rest) = self.rest.split_at_checked(count).ok_or("it is cut off")?;
        self.rest = rest;
        Ok(taken)
    }

    fn byte(&mut self) -> Result<u8, &'static str> {
        Ok(self.take(1)?[0])
    }

    /// Reads a number with seven bits per byte, the lowest first, at most five bytes.
    fn varint(&mut self) -> Result<u32, &'static str> {
        let mut value = 0_u32;
        for shift in (0..35).step_by(7) {
            let byte = self.byte()?;
            value |= u32::from(byte & 127) << shift;
            if byte < 128 {
                return Ok(value);
            }
        }
        Err("a number has too many bytes")
    }
}

/// Decodes zigzag-coded signed numbers: 0, −1, 1, −2, …
fn unzigzag(value: u32) -> u32 {
    (value >> 1) ^ (value & 1).wrapping_neg()
}
