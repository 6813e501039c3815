//! Little-endian writer and reader for snapshots. The reader never panics and never allocates more than the remaining
//! bytes can fill.

use crate::{Rotation, Sym3, Transform, Vec3};

/// Error of a [`Reader`]: what is wrong with the bytes, and at which offset.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReadError {
    /// Offset of the byte at which reading failed.
    pub at: usize,
    /// Description of what is wrong, a phrase in lower case.
    pub what: &'static str,
}

impl core::fmt::Display for ReadError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{} (at byte {})", self.what, self.at)
    }
}

impl std::error::Error for ReadError {}

/// Appends plain data to a byte vector.
#[derive(Clone, Debug, Default)]
pub struct Writer {
    bytes: Vec<u8>,
}

impl Writer {
    /// Creates an empty writer.
    pub fn new() -> Self {
        Self::default()
    }
    /// Creates an empty writer that reuses the memory of `bytes` and drops their content, so that repeated snapshots do
    /// not allocate.
    pub fn reuse(mut bytes: Vec<u8>) -> Self {
        bytes.clear();
        Self { bytes }
    }
    /// Bytes written so far.
    pub fn as_bytes(&self) -> &[u8] {
        &self.bytes
    }
    /// Returns the written bytes.
    pub fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }
    /// Appends bytes unchanged, without a byte count.
    pub fn raw(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
    }
    /// Writes one byte.
    pub fn u8(&mut self, v: u8) {
        self.bytes.push(v);
    }
    /// Writes a boolean as one byte, 0 or 1.
    pub fn bool(&mut self, v: bool) {
        self.u8(u8::from(v));
    }
    /// Writes four bytes.
    pub fn u32(&mut self, v: u32) {
        self.raw(&v.to_le_bytes());
    }
    /// Writes eight bytes.
    pub fn u64(&mut self, v: u64) {
        self.raw(&v.to_le_bytes());
    }
    /// Writes the bits of a number, including NaN payload and sign of zero.
    pub fn f32(&mut self, v: f32) {
        self.u32(v.to_bits());
    }
    /// Writes three numbers.
    pub fn vec3(&mut self, v: Vec3) {
        self.f32(v.x);
        self.f32(v.y);
        self.f32(v.z);
    }
    /// Writes x, y, z, w.
    pub fn rotation(&mut self, r: Rotation) {
        self.vec3(r.vector());
        self.f32(r.w);
    }
    /// Writes translation, then rotation.
    pub fn transform(&mut self, t: Transform) {
        self.vec3(t.translation);
        self.rotation(t.rotation);
    }
    /// Writes diagonal, then off-diagonal.
    pub fn sym3(&mut self, s: Sym3) {
        self.vec3(s.diagonal);
        self.vec3(s.off);
    }
    /// Writes the number of items that follow.
    ///
    /// # Panics
    /// If the count does not fit 32 bits.
    pub fn count(&mut self, n: usize) {
        self.u32(u32::try_from(n).expect("a snapshot holds at most 2^32 items of a kind"));
    }
    /// Writes a byte count, then the bytes that `write` writes, so that a reader of the block cannot read beyond it.
    ///
    /// # Panics
    /// If the block is 4 GiB or larger.
    pub fn block(&mut self, write: impl FnOnce(&mut Self)) {
        let at = self.bytes.len();
        self.u32(0);
        write(self);
        let count = u32::try_from(self.bytes.len() - at - 4).expect("a block holds less than 4 GiB");
        self.bytes[at..at + 4].copy_from_slice(&count.to_le_bytes());
    }
    /// Writes a byte count, then the text as UTF-8.
    pub fn text(&mut self, s: &str) {
        self.count(s.len());
        self.raw(s.as_bytes());
    }
}

/// Reads bytes that a [`Writer`] wrote.
#[derive(Clone, Debug)]
pub struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Reader<'a> {
    /// Reader that starts at the first byte of `bytes`.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }
    /// Offset of the next byte.
    pub fn position(&self) -> usize {
        self.at
    }
    /// Number of bytes left.
    pub fn remaining(&self) -> usize {
        self.bytes.len() - self.at
    }
    /// Error at the current offset.
    pub fn error(&self, what: &'static str) -> ReadError {
        ReadError { at: self.at, what }
    }
    /// Reads the next `n` bytes.
    pub fn raw(&mut self, n: usize) -> Result<&'a [u8], ReadError> {
        if n > self.remaining() {
            return Err(self.error("ends too early"));
        }
        let slice = &self.bytes[self.at..self.at + n];
        self.at += n;
        Ok(slice)
    }
    fn array<const N: usize>(&mut self) -> Result<[u8; N], ReadError> {
        let mut out = [0; N];
        out.copy_from_slice(self.raw(N)?);
        Ok(out)
    }
    /// Reads one byte.
    pub fn u8(&mut self) -> Result<u8, ReadError> {
        Ok(self.array::<1>()?[0])
    }
    /// Reads a boolean; any byte but 0 and 1 is an error.
    pub fn bool(&mut self) -> Result<bool, ReadError> {
        match self.u8()? {
            0 => Ok(false),
            1 => Ok(true),
            _ => Err(ReadError { at: self.at - 1, what: "truth value is neither 0 nor 1" }),
        }
    }
    /// Reads four bytes.
    pub fn u32(&mut self) -> Result<u32, ReadError> {
        Ok(u32::from_le_bytes(self.array()?))
    }
    /// Reads eight bytes.
    pub fn u64(&mut self) -> Result<u64, ReadError> {
        Ok(u64::from_le_bytes(self.array()?))
    }
    /// Reads a number, bit for bit.
    pub fn f32(&mut self) -> Result<f32, ReadError> {
        Ok(f32::from_bits(self.u32()?))
    }
    /// Reads three numbers.
    pub fn vec3(&mut self) -> Result<Vec3, ReadError> {
        Ok(Vec3::new(self.f32()?, self.f32()?, self.f32()?))
    }
    /// Reads x, y, z, w.
    pub fn rotation(&mut self) -> Result<Rotation, ReadError> {
        let v = self.vec3()?;
        Ok(Rotation::from_xyzw(v.x, v.y, v.z, self.f32()?))
    }
    /// Reads translation, then rotation.
    pub fn transform(&mut self) -> Result<Transform, ReadError> {
        Ok(Transform::new(self.vec3()?, self.rotation()?))
    }
    /// Reads diagonal, then off-diagonal.
    pub fn sym3(&mut self) -> Result<Sym3, ReadError> {
        Ok(Sym3 { diagonal: self.vec3()?, off: self.vec3()? })
    }
    /// Reads a count of items of at least `item_bytes` bytes each; fails if the remaining bytes cannot hold them.
    pub fn count(&mut self, item_bytes: usize) -> Result<usize, ReadError> {
        let at = self.at;
        let n = self.u32()? as usize;
        if n.saturating_mul(item_bytes.max(1)) > self.remaining() {
            return Err(ReadError { at, what: "claims more items than there are bytes" });
        }
        Ok(n)
    }
    /// Reads a block written by [`Writer::block`]; error offsets remain relative to the whole input.
    pub fn block(&mut self) -> Result<Self, ReadError> {
        let n = self.count(1)?;
        let start = self.at;
        self.raw(n)?;
        Ok(Self { bytes: &self.bytes[..self.at], at: start })
    }
    /// Reads text with its byte count.
    pub fn text(&mut self) -> Result<&'a str, ReadError> {
        let n = self.count(1)?;
        let at = self.at;
        core::str::from_utf8(self.raw(n)?).map_err(|_| ReadError { at, what: "text is not UTF-8" })
    }
    /// Fails if bytes are left over.
    pub fn finish(self) -> Result<(), ReadError> {
        if self.remaining() == 0 { Ok(()) } else { Err(self.error("has bytes left over")) }
    }
}
