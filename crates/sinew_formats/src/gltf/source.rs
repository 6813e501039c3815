//! Lists of a glTF file that other parts reference, and the budget for decoded data.

use crate::container::json::At;
use crate::error::Result;
use core::cell::Cell;

/// Source of the bytes of a buffer.
#[derive(Clone, Debug)]
pub(super) enum Buffer {
    /// The binary chunk of the GLB.
    Chunk,
    /// A data URI.
    DataUri(Vec<u8>),
    /// An external file.
    External(Vec<u8>),
    /// A placeholder without bytes, which must not be read.
    Absent,
}

impl Buffer {
    pub(super) fn bytes<'a>(&'a self, bin: Option<&'a [u8]>) -> Option<&'a [u8]> {
        match self {
            Self::Chunk => bin,
            Self::DataUri(bytes) | Self::External(bytes) => Some(bytes),
            Self::Absent => None,
        }
    }
}

/// A parsed file with lookup.
pub(super) struct Source<'a> {
    pub(super) root: At<'a>,
    pub(super) nodes: Vec<At<'a>>,
    pub(super) accessors: Vec<At<'a>>,
    views: Vec<At<'a>>,
    buffers: &'a [Buffer],
    buffer_entries: Vec<At<'a>>,
    bin: Option<&'a [u8]>,
    /// Decoded bytes of compressed buffer views; `None` for other views.
    decompressed: &'a [Option<Vec<u8>>],
    /// Number of bytes that may still be decoded.
    budget: Cell<usize>,
}

/// Number of bytes that may be decoded from a file of that size with these buffers.
pub(super) fn budget(buffers: &[Buffer], file_size: usize) -> usize {
    let outside: usize =
        buffers.iter().map(|b| if let Buffer::External(bytes) = b { bytes.len() } else { 0 }).sum();
    file_size.saturating_add(outside).saturating_mul(64).saturating_add(16 << 20)
}

/// Returns the bytes that `holder` selects by `buffer`, `byteOffset` and `byteLength`.
pub(super) fn buffer_bytes<'a>(
    buffers: &'a [Buffer],
    entries: &[At<'_>],
    bin: Option<&'a [u8]>,
    holder: At<'_>,
) -> Result<&'a [u8]> {
    let buffer_index = holder.need("buffer")?.index(buffers.len(), "buffers")?;
    let size = entries[buffer_index].need("byteLength")?.usize()?;
    let buffer = buffers[buffer_index].bytes(bin).and_then(|bytes| bytes.get(..size));
    let Some(buffer) = buffer else {
        return Err(holder.malformed(format!("buffer {buffer_index} has no bytes")));
    };
    let offset = holder.get("byteOffset")?.map_or(Ok(0), At::usize)?;
    let length = holder.need("byteLength")?.usize()?;
    let bytes = offset.checked_add(length).and_then(|end| buffer.get(offset..end));
    bytes.ok_or_else(|| {
        let there = buffer.len();
        holder.malformed(format!("{length} bytes from {offset} on are outside a buffer of {there} bytes"))
    })
}

impl<'a> Source<'a> {
    pub(super) fn new(
        root: At<'a>,
        buffers: &'a [Buffer],
        bin: Option<&'a [u8]>,
        decompressed: &'a [Option<Vec<u8>>],
        budget: usize,
    ) -> Result<Self> {
        Ok(Self {
            root,
            nodes: root.list("nodes")?,
            accessors: root.list("accessors")?,
            views: root.list("bufferViews")?,
            buffers,
            buffer_entries: root.list("buffers")?,
            bin,
            decompressed,
            budget: Cell::new(budget),
        })
    }

    /// Subtracts `count × size` bytes from the budget, for decoding `at`.
    pub(super) fn spend(&self, at: At<'_>, count: usize, size: usize) -> Result<()> {
        let left = count.checked_mul(size).and_then(|bytes| self.budget.get().checked_sub(bytes));
        let Some(left) = left else {
            return Err(
                at.malformed(format!("{count} elements are more than the size of the file justifies"))
            );
        };
        self.budget.set(left);
        Ok(())
    }

    /// Number of bytes that may still be decoded.
    pub(super) fn left(&self) -> usize {
        self.budget.get()
    }

    /// Returns the bytes of the buffer view with the index `at`, and the view itself.
    pub(super) fn view(&self, at: At<'a>) -> Result<(&'a [u8], At<'a>)> {
        let index = at.index(self.views.len(), "buffer views")?;
        let view = self.views[index];
        let bytes = match &self.decompressed[index] {
            Some(bytes) => &bytes[..view.need("byteLength")?.usize()?],
            None => buffer_bytes(self.buffers, &self.buffer_entries, self.bin, view)?,
        };
        Ok((bytes, view))
    }
}
