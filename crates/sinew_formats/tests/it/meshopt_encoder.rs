//! Writes the simplest streams of `EXT_meshopt_compression` that use all features of the format.

fn zigzag8(d: u8) -> u8 {
    (d << 1) ^ ((d as i8 >> 7) as u8)
}

fn zigzag(d: u32) -> u32 {
    (d << 1) ^ ((d as i32 >> 31) as u32)
}

fn varint(mut value: u32, out: &mut Vec<u8>) {
    while value >= 128 {
        out.push(value as u8 | 128);
        value >>= 7;
    }
    out.push(value as u8);
}

/// Writes 16 numbers with `bits` bits each.
fn group(numbers: &[u8], bits: u32, out: &mut Vec<u8>) {
    if bits == 0 {
        return;
    }
    if bits == 8 {
        return out.extend(numbers);
    }
    let most = (1_u8 << bits) - 1;
    for chunk in numbers.chunks(8 / bits as usize) {
        let byte = chunk.iter().fold(0, |byte, &n| byte << bits | n.min(most));
        out.push(if bits == 1 { byte.reverse_bits() } else { byte });
    }
    out.extend(numbers.iter().filter(|&&n| n >= most));
}

/// Encodes one byte of each element of a block, with the fewest of the allowed bits for each group.
fn lane(mut numbers: Vec<u8>, bits: [u32; 4]) -> Vec<u8> {
    numbers.resize(numbers.len().div_ceil(16) * 16, 0);
    let groups: Vec<&[u8]> = numbers.chunks(16).collect();
    let mut headers = vec![0_u8; groups.len().div_ceil(4)];
    let mut data = Vec::new();
    for (i, numbers) in groups.into_iter().enumerate() {
        let fits = |bits: u32| bits != 0 || numbers.iter().all(|&n| n == 0);
        let size = |bits: u32| {
            let mut out = Vec::new();
            group(numbers, bits, &mut out);
            out.len()
        };
        let best = (0..4).filter(|&k| fits(bits[k])).min_by_key(|&k| size(bits[k])).expect("8 or 4 bits fit");
        headers[i / 4] |= (best as u8) << (2 * (i % 4));
        group(numbers, bits[best], &mut data);
    }
    [headers, data].concat()
}

/// Encodes attributes. Version 1 uses each kind of differences and of lane encodings in turn.
pub fn attributes(bytes: &[u8], stride: usize, version: u8) -> Vec<u8> {
    let mut out = vec![0xA0 | version];
    let mut last = bytes[..stride].to_vec();
    let channels: Vec<u8> = (0..stride / 4).map(|k| [2 | 5 << 4, 0, 1][k % 3]).collect();
    let block = ((8192 / stride) & !15).min(256);
    for (number, elements) in bytes.chunks(block * stride).enumerate() {
        let (mut control, mut data) = (Vec::new(), Vec::new());
        for k in (0..stride).step_by(4) {
            let channel = if version == 0 { 0 } else { channels[k / 4] };
            let mut differences: Vec<[u8; 4]> = Vec::new();
            for element in elements.chunks(stride) {
                let (new, old) = (&element[k..k + 4], &last[k..k + 4]);
                let short = |b: &[u8], i: usize| u16::from_le_bytes([b[i], b[i + 1]]);
                let long = |b: &[u8]| u32::from_le_bytes([b[0], b[1], b[2], b[3]]);
                differences.push(match channel & 3 {
                    0 => core::array::from_fn(|i| zigzag8(new[i].wrapping_sub(old[i]))),
                    1 => {
                        let half = |i: usize| {
                            let d = short(new, i).wrapping_sub(short(old, i));
                            ((d << 1) ^ ((d as i16 >> 15) as u16)).to_le_bytes()
                        };
                        [half(0)[0], half(0)[1], half(2)[0], half(2)[1]]
                    }
                    _ => (long(new) ^ long(old)).rotate_left(u32::from(channel >> 4)).to_le_bytes(),
                });
                last[k..k + 4].copy_from_slice(new);
            }
            let mut byte = 0;
            for i in 0..4 {
                let numbers: Vec<u8> = differences.iter().map(|d| d[i]).collect();
                let way = match version {
                    0 => 4,
                    _ if numbers.iter().all(|&n| n == 0) => 2,
                    _ => [0, 1, 3][(number + k / 4 + i) % 3],
                };
                byte |= (way & 3) << (2 * i);
                // With at most four bits, large numbers follow their groups.
                data.extend(match way {
                    4 => lane(numbers, [0, 2, 4, 8]),
                    0 => lane(numbers, [0, 1, 2, 4]),
                    1 => lane(numbers, [1, 2, 4, 8]),
                    2 => Vec::new(),
                    _ => numbers,
                });
            }
            control.push(byte as u8);
        }
        if version == 1 {
            out.extend(control);
        }
        out.extend(data);
    }
    let mut tail = bytes[..stride].to_vec();
    if version == 1 {
        tail.extend(channels);
    }
    let padded = tail.len().max(if version == 0 { 32 } else { 24 });
    out.resize(out.len() + padded - tail.len(), 0);
    out.extend(tail);
    out
}

/// Bytes for codes 0xF0 to 0xFD: for each of the other two corners, 0 if it is new, or the number of vertices
/// back.
const TABLE: [u8; 16] =
    [0x00, 0x12, 0x10, 0x01, 0x11, 0x21, 0x20, 0x02, 0x13, 0x31, 0x30, 0x03, 0x22, 0x33, 0, 0];

/// Returns the entry that is `by` entries before the end.
fn back_by<T: Copy>(list: &[T], by: usize) -> Option<T> {
    list.len().checked_sub(by).map(|at| list[at])
}

/// Returns a stream of version 1, and the decoded triangles, whose first corner may be another one.
pub fn triangles(indices: &[u32]) -> (Vec<u8>, Vec<u32>) {
    let (mut codes, mut data, mut out) = (vec![0xE1], Vec::new(), Vec::new());
    let (mut edges, mut vertices): (Vec<[u32; 2]>, Vec<u32>) = (Vec::new(), Vec::new());
    let (mut next, mut last) = (0_u32, 0_u32);
    for triangle in indices.chunks(3) {
        let turned = |r: usize| [triangle[r], triangle[(r + 1) % 3], triangle[(r + 2) % 3]];
        let edge = |[a, b, _]: [u32; 3]| (0..15).find(|&k| back_by(&edges, 1 + k) == Some([a, b]));
        let shared = (0..3).find_map(|r| Some((turned(r), edge(turned(r))?)));
        if let Some(([a, b, c], back)) = shared {
            let seen = (1..13).find(|&k| back_by(&vertices, 1 + k) == Some(c));
            let third = if c == next {
                next += 1;
                0
            } else if let Some(k) = seen {
                k as u8
            } else {
                let code =
                    [(last.wrapping_sub(1), 13), (last + 1, 14)].into_iter().find(|&(near, _)| near == c);
                if code.is_none() {
                    varint(zigzag(c.wrapping_sub(last)), &mut data);
                }
                last = c;
                code.map_or(15, |(_, code)| code)
            };
            if third == 0 || third >= 13 {
                vertices.push(c);
            }
            codes.push((back as u8) << 4 | third);
            edges.extend([[c, b], [a, c]]);
            out.extend([a, b, c]);
            continue;
        }
        let first_new = (0..3).find(|&r| turned(r)[0] == next);
        let corners = turned(first_new.unwrap_or(0));
        let mut kinds = [15_u8; 3];
        for (i, &corner) in corners.iter().enumerate() {
            let seen = (1..15).find(|&k| back_by(&vertices, k) == Some(corner));
            if corner == next {
                next += 1;
                kinds[i] = 0;
            } else if let (Some(k), true) = (seen, i > 0) {
                kinds[i] = k as u8;
            }
        }
        let others = kinds[1] << 4 | kinds[2];
        let entry = TABLE[..14].iter().position(|&code| code == others);
        if let Some(entry) = entry.filter(|_| kinds[0] == 0) {
            codes.push(0xF0 | entry as u8);
        } else {
            codes.push(if kinds[0] == 0 { 0xFE } else { 0xFF });
            data.push(others);
            // The byte 0 would restart the numbering.
            assert_ne!(others, 0, "two new vertices beside an old one are not in these tests");
            for (&corner, _) in corners.iter().zip(kinds).filter(|&(_, kind)| kind == 15) {
                varint(zigzag(corner.wrapping_sub(last)), &mut data);
                last = corner;
            }
        }
        let [a, b, c] = corners;
        vertices.push(a);
        for (kind, corner) in [(kinds[1], b), (kinds[2], c)] {
            if kind == 0 || kind == 15 {
                vertices.push(corner);
            }
        }
        edges.extend([[b, a], [c, b], [a, c]]);
        out.extend(corners);
    }
    (([codes, data, TABLE.to_vec()]).concat(), out)
}

/// Returns a stream of any indices; every third is relative to the second of the last two indices.
pub fn sequence(indices: &[u32]) -> Vec<u8> {
    let (mut out, mut last) = (vec![0xD1], [0_u32; 2]);
    for (i, &index) in indices.iter().enumerate() {
        let which = usize::from(i % 3 == 2);
        varint(zigzag(index.wrapping_sub(last[which])) << 1 | which as u32, &mut out);
        last[which] = index;
    }
    out.extend([0; 4]);
    out
}
