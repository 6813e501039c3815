//! Typed reading of accessors (glTF 2.0 §3.6.2): strides, sparse parts, normalised integers.

use super::source::Source;
use crate::container::json::At;
use crate::error::{Error, Result};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn read(at: At<'_>) -> Result<Self> {
        Ok(match at.usize()? {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            other => return Err(at.malformed(format!("unknown component type {other}"))),
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// Reads one component as a number; `b` has at least [`size`](Self::size) bytes. Normalised numbers:
    /// §3.6.2.2.
    fn number(self, b: &[u8], normalized: Normalized) -> f32 {
        let (value, full) = match self {
            Self::I8 => (f32::from(b[0] as i8), 127.0),
            Self::U8 => (f32::from(b[0]), 255.0),
            Self::I16 => (f32::from(i16::from_le_bytes([b[0], b[1]])), 32767.0),
            Self::U16 => (f32::from(u16::from_le_bytes([b[0], b[1]])), 65535.0),
            Self::U32 => (u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as f32, 4_294_967_295.0),
            Self::F32 => return f32::from_le_bytes([b[0], b[1], b[2], b[3]]),
        };
        match normalized {
            Normalized::No => value,
            Normalized::Yes => sinew_math::max(value / full, -1.0),
        }
    }

    /// Reads one component of an unsigned type as an integer.
    fn integer(self, b: &[u8]) -> u32 {
        match self {
            Self::U8 | Self::I8 => u32::from(b[0]),
            Self::U16 | Self::I16 => u32::from(u16::from_le_bytes([b[0], b[1]])),
            Self::U32 | Self::F32 => u32::from_le_bytes([b[0], b[1], b[2], b[3]]),
        }
    }

    fn is_unsigned(self) -> bool {
        matches!(self, Self::U8 | Self::U16 | Self::U32)
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Normalized {
    No,
    Yes,
}

/// Elements at a stride, checked against the available bytes.
#[derive(Clone, Copy)]
struct Strided<'a> {
    bytes: &'a [u8],
    stride: usize,
}

impl<'a> Strided<'a> {
    fn element(self, i: usize) -> &'a [u8] {
        &self.bytes[i * self.stride..]
    }
}

/// Values that replace those of some elements.
struct Sparse<'a> {
    indices: Vec<u32>,
    values: Strided<'a>,
}

struct Accessor<'a> {
    at: At<'a>,
    component: Component,
    normalized: Normalized,
    count: usize,
    base: Option<Strided<'a>>,
    sparse: Option<Sparse<'a>>,
}

impl Accessor<'_> {
    fn decode<T: Copy + Default, const N: usize>(&self, convert: impl Fn(&[u8]) -> T) -> Vec<[T; N]> {
        let size = self.component.size();
        let element = |view: Strided<'_>, i: usize| {
            let bytes = view.element(i);
            core::array::from_fn(|c| convert(&bytes[c * size..(c + 1) * size]))
        };
        let mut out: Vec<[T; N]> = match self.base {
            Some(view) => (0..self.count).map(|i| element(view, i)).collect(),
            None => vec![[T::default(); N]; self.count],
        };
        if let Some(sparse) = &self.sparse {
            for (k, &i) in sparse.indices.iter().enumerate() {
                out[i as usize] = element(sparse.values, k);
            }
        }
        out
    }
}

/// Replaces numbers that are not finite by 0; returns the indices of the elements with such numbers.
pub(super) fn fill_holes<const N: usize>(elements: &mut [[f32; N]]) -> Vec<usize> {
    let is_hole = |element: &[f32; N]| element.iter().any(|x| !x.is_finite());
    let holes: Vec<usize> = (0..elements.len()).filter(|&i| is_hole(&elements[i])).collect();
    for &i in &holes {
        elements[i] = elements[i].map(|x| if x.is_finite() { x } else { 0.0 });
    }
    holes
}

impl<'a> Source<'a> {
    /// Returns the count of numbers in an element of the accessor at index `at`: 1 for SCALAR to 16 for MAT4.
    pub(super) fn width(&self, at: At<'a>) -> Result<usize> {
        let kind = self.accessors[at.index(self.accessors.len(), "accessors")?].need("type")?;
        Ok(match kind.str()? {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" | "MAT2" => 4,
            "MAT3" => 9,
            "MAT4" => 16,
            _ => return Err(kind.malformed("unknown accessor type")),
        })
    }

    /// Reads elements of `N` finite numbers of the accessor at index `at`; normalised integers become −1..=1.
    pub(super) fn floats<const N: usize>(&self, at: At<'a>) -> Result<Vec<[f32; N]>> {
        let (out, holes) = self.floats_and_holes(at)?;
        match holes.first() {
            Some(i) => Err(self.not_finite(at, *i)),
            None => Ok(out),
        }
    }

    /// Returns the error for an element of the accessor at index `at` that is not finite.
    pub(super) fn not_finite(&self, at: At<'a>, element: usize) -> Error {
        let accessor = at.index(self.accessors.len(), "accessors").map_or(at, |index| self.accessors[index]);
        accessor.malformed(format!("element {element} holds a number that is not finite"))
    }

    /// As [`floats`](Self::floats), with 0 for non-finite numbers, and the indices of the elements that had one.
    pub(super) fn floats_and_holes<const N: usize>(&self, at: At<'a>) -> Result<(Vec<[f32; N]>, Vec<usize>)> {
        let accessor = self.accessor::<N>(at)?;
        let (component, normalized) = (accessor.component, accessor.normalized);
        // Handles the common case separately, so that its loop is a plain copy.
        let mut out: Vec<[f32; N]> = match component {
            Component::F32 => accessor.decode(|b| Component::F32.number(b, Normalized::No)),
            _ => accessor.decode(|b| component.number(b, normalized)),
        };
        let holes = fill_holes(&mut out);
        Ok((out, holes))
    }

    /// Returns the divisor of the integers of the accessor at index `at`; 1 if they are not normalised.
    pub(super) fn full_scale(&self, at: At<'a>) -> Result<f32> {
        let accessor = self.accessors[at.index(self.accessors.len(), "accessors")?];
        let normalized = accessor.get("normalized")?.map_or(Ok(false), At::bool)?;
        Ok(match Component::read(accessor.need("componentType")?)? {
            _ if !normalized => 1.0,
            Component::I8 => 127.0,
            Component::U8 => 255.0,
            Component::I16 => 32767.0,
            Component::U16 => 65535.0,
            Component::U32 | Component::F32 => 1.0,
        })
    }

    /// Reads elements of `N` unsigned integers of the accessor at index `at`.
    pub(super) fn integers<const N: usize>(&self, at: At<'a>) -> Result<Vec<[u32; N]>> {
        let accessor = self.accessor::<N>(at)?;
        let component = accessor.component;
        if !component.is_unsigned() {
            return Err(accessor.at.malformed("component type must be an unsigned integer"));
        }
        Ok(accessor.decode(|b| component.integer(b)))
    }

    fn accessor<const N: usize>(&self, at: At<'a>) -> Result<Accessor<'a>> {
        let accessor = self.accessors[at.index(self.accessors.len(), "accessors")?];
        if self.width(at)? != N {
            return Err(accessor.malformed(format!("elements must have {N} numbers")));
        }
        let component = Component::read(accessor.need("componentType")?)?;
        let normalized = match accessor.get("normalized")?.map_or(Ok(false), At::bool)? {
            true => Normalized::Yes,
            false => Normalized::No,
        };
        let count = accessor.need("count")?.usize()?;
        // Decoded components have 4 bytes, for every size in the file.
        self.spend(accessor, count, N * 4)?;
        let base = match accessor.get("bufferView")? {
            Some(_) => Some(self.strided(accessor, count, N * component.size())?),
            None => None,
        };
        let sparse = match accessor.get("sparse")? {
            Some(sparse) => Some(self.sparse(sparse, count, N * component.size())?),
            None => None,
        };
        Ok(Accessor { at: accessor, component, normalized, count, base, sparse })
    }

    /// Returns `count` elements of `size` bytes at the `bufferView` and `byteOffset` of `holder`.
    fn strided(&self, holder: At<'a>, count: usize, size: usize) -> Result<Strided<'a>> {
        let (bytes, view) = self.view(holder.need("bufferView")?)?;
        let offset = holder.get("byteOffset")?.map_or(Ok(0), At::usize)?;
        let stride = match view.get("byteStride")? {
            Some(at) if at.usize()? < size => {
                return Err(at.malformed(format!("stride is less than the {size} bytes of an element")));
            }
            Some(at) => at.usize()?,
            None => size,
        };
        let needed = match count {
            0 => Some(0),
            _ => stride.checked_mul(count - 1).and_then(|n| n.checked_add(size)),
        };
        let fits = needed.is_some_and(|n| n <= bytes.len().saturating_sub(offset));
        if !fits || offset > bytes.len() {
            return Err(holder.malformed(format!(
                "{count} elements of {size} bytes at stride {stride} from {offset} on are outside a view of {} bytes",
                bytes.len()
            )));
        }
        Ok(Strided { bytes: &bytes[offset..], stride })
    }

    fn sparse(&self, sparse: At<'a>, base_count: usize, size: usize) -> Result<Sparse<'a>> {
        let count_at = sparse.need("count")?;
        let count = count_at.usize()?;
        if count > base_count {
            return Err(
                count_at.malformed(format!("more sparse elements than the {base_count} of the accessor"))
            );
        }
        let indices_at = sparse.need("indices")?;
        let component = Component::read(indices_at.need("componentType")?)?;
        if !component.is_unsigned() {
            return Err(indices_at.malformed("sparse indices must be unsigned integers"));
        }
        let raw = self.strided(indices_at, count, component.size())?;
        let indices: Vec<u32> = (0..count).map(|i| component.integer(raw.element(i))).collect();
        if let Some(bad) = indices.iter().find(|&&i| i as usize >= base_count) {
            return Err(
                indices_at.malformed(format!("index {bad} is out of range: there are {base_count} elements"))
            );
        }
        Ok(Sparse { indices, values: self.strided(sparse.need("values")?, count, size)? })
    }
}
