//! Streams of attributes: elements in blocks, byte by byte. Each byte is stored as the difference from the same byte of
//! the previous element, in groups of 16 with 0 to 8 bits each (extension, appendix A, mode 0).

use super::{Decoded, Reader, unzigzag};

/// Number of elements in a group.
const GROUP: usize = 16;
/// Largest number of bytes and of elements in a block.
const BLOCK: [usize; 2] = [8192, 256];
/// Bits per element for each two-bit code in a group's header: of version 0, and of version 1 with its two tables.
const BITS: [[u32; 4]; 3] = [[0, 2, 4, 8], [0, 1, 2, 4], [1, 2, 4, 8]];

/// Decodes `count` elements of `stride` bytes.
pub(super) fn decode(bytes: &[u8], count: usize, stride: usize) -> Decoded {
    if stride == 0 || stride > 256 || !stride.is_multiple_of(4) {
        return Err("an element has 4 to 256 bytes, a multiple of 4");
    }
    let version = match bytes.first() {
        Some(0xA0) => 0,
        Some(0xA1) => 1,
        _ => return Err("it does not have the first byte of attributes"),
    };
    // The end of the stream holds the initial element and the channel types.
    let tail = stride + if version == 0 { 0 } else { stride / 4 };
    let padded = tail.max(if version == 0 { 32 } else { 24 });
    let body = bytes.len().checked_sub(1 + padded).ok_or("it is cut off")?;
    let (last, channels) = bytes[bytes.len() - tail..].split_at(stride);
    let mut last = last.to_vec();
    let mut reader = Reader { rest: &bytes[1..1 + body] };
    let mut out = vec![0; count * stride];
    let block = (BLOCK[0] / stride / GROUP * GROUP).min(BLOCK[1]);
    for elements in out.chunks_mut(block * stride) {
        let mut lanes = Lanes { reader: &mut reader, count: elements.len() / stride, version };
        let control = lanes.reader.take(if version == 0 { 0 } else { stride / 4 })?;
        for k in (0..stride).step_by(4) {
            let numbers = lanes.read(control.get(k / 4).copied().unwrap_or(0))?;
            let channel = channels.get(k / 4).copied().unwrap_or(0);
            undo_differences(&numbers, channel, &mut last[k..k + 4], &mut elements[k..], stride)?;
        }
    }
    if reader.rest.is_empty() { Ok(out) } else { Err("bytes are left over") }
}

/// Four bytes of each element in a block.
struct Lanes<'r, 'a> {
    reader: &'r mut Reader<'a>,
    count: usize,
    version: usize,
}

impl Lanes<'_, '_> {
    fn read(&mut self, control: u8) -> Result<Vec<[u8; 4]>, &'static str> {
        let mut numbers = vec![[0; 4]; self.count];
        for lane in 0..4 {
            let control = usize::from(control >> (2 * lane) & 3);
            let bytes = match (self.version, control) {
                (0, _) => self.groups(BITS[0])?,
                (_, 2) => continue,
                (_, 3) => self.reader.take(self.count)?.to_vec(),
                (_, table) => self.groups(BITS[1 + table])?,
            };
            for (number, byte) in numbers.iter_mut().zip(bytes) {
                number[lane] = byte;
            }
        }
        Ok(numbers)
    }

    /// Reads one lane: headers of two bits for each group, then the groups.
    fn groups(&mut self, bits: [u32; 4]) -> Result<Vec<u8>, &'static str> {
        let groups = self.count.div_ceil(GROUP);
        let headers = self.reader.take(groups.div_ceil(4))?;
        let mut out = Vec::with_capacity(groups * GROUP);
        for group in 0..groups {
            let header = headers[group / 4] >> (2 * (group % 4)) & 3;
            self.group(bits[usize::from(header)], &mut out)?;
        }
        Ok(out)
    }

    /// Reads 16 numbers of `bits` bits; the largest code means that a whole byte follows after the group.
    fn group(&mut self, bits: u32, out: &mut Vec<u8>) -> Result<(), &'static str> {
        if bits == 0 {
            out.resize(out.len() + GROUP, 0);
            return Ok(());
        }
        let packed = self.reader.take(2 * bits as usize)?;
        if bits == 8 {
            out.extend(packed);
            return Ok(());
        }
        let most = (1 << bits) - 1;
        for &byte in packed {
            // The first number is in the highest bits, except with one bit each.
            let mut byte = if bits == 1 { byte.reverse_bits() } else { byte };
            for _ in 0..8 / bits {
                let number = byte >> (8 - bits);
                byte <<= bits;
                out.push(if number == most { self.reader.byte()? } else { number });
            }
        }
        Ok(())
    }
}

/// Converts differences to values, starting from `last`: of bytes, of 16-bit numbers, or as exclusive or of 32 bits.
fn undo_differences(
    numbers: &[[u8; 4]],
    channel: u8,
    last: &mut [u8],
    out: &mut [u8],
    stride: usize,
) -> Result<(), &'static str> {
    let mut value = [last[0], last[1], last[2], last[3]];
    for (i, &number) in numbers.iter().enumerate() {
        value = match channel & 3 {
            0 => core::array::from_fn(|k| value[k].wrapping_add(unzigzag(number[k].into()) as u8)),
            1 => {
                let half = |k: usize| {
                    let pair = |from: [u8; 4]| u16::from_le_bytes([from[k], from[k + 1]]);
                    pair(value).wrapping_add(unzigzag(pair(number).into()) as u16).to_le_bytes()
                };
                let [[a, b], [c, d]] = [half(0), half(2)];
                [a, b, c, d]
            }
            2 => {
                let turned = u32::from_le_bytes(number).rotate_right(u32::from(channel >> 4));
                (turned ^ u32::from_le_bytes(value)).to_le_bytes()
            }
            _ => return Err("unknown channel"),
        };
        out[i * stride..i * stride + 4].copy_from_slice(&value);
    }
    last.copy_from_slice(&value);
    Ok(())
}
