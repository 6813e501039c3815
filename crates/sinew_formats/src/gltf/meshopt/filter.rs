//! Filters after the attribute streams: unit vectors, quaternions, floats and colours in fewer bits (extension,
//! appendix B).

/// Undoes the filter on elements of `stride` bytes.
pub(super) fn apply(filter: &str, bytes: &mut [u8], stride: usize) -> Result<(), &'static str> {
    match (filter, stride) {
        ("NONE", _) => {}
        ("OCTAHEDRAL", 4) => each_i8(bytes, octahedral),
        ("OCTAHEDRAL", 8) => each_i16(bytes, octahedral),
        ("QUATERNION", 8) => each_i16(bytes, quaternion),
        ("EXPONENTIAL", _) if stride.is_multiple_of(4) => exponential(bytes),
        ("COLOR", 4) => each_i8(bytes, color),
        ("COLOR", 8) => each_i16(bytes, color),
        ("OCTAHEDRAL" | "QUATERNION" | "EXPONENTIAL" | "COLOR", _) => {
            return Err("the filter is not for elements of that size");
        }
        _ => return Err("unknown filter"),
    }
    Ok(())
}

/// Applies `f` to the four numbers of each element; its second argument is their largest value.
fn each_i8(bytes: &mut [u8], f: impl Fn([i32; 4], i32) -> [i32; 4]) {
    for element in bytes.chunks_exact_mut(4) {
        let numbers = [element[0], element[1], element[2], element[3]].map(|byte| i32::from(byte as i8));
        element.copy_from_slice(&f(numbers, 127).map(|number| number as u8));
    }
}

fn each_i16(bytes: &mut [u8], f: impl Fn([i32; 4], i32) -> [i32; 4]) {
    for element in bytes.chunks_exact_mut(8) {
        let number = |k: usize| i32::from(i16::from_le_bytes([element[2 * k], element[2 * k + 1]]));
        let numbers = f([number(0), number(1), number(2), number(3)], 32767);
        element.copy_from_slice(numbers.map(|number| (number as u16).to_le_bytes()).as_flattened());
    }
}

/// Rounds to the nearest integer, halves away from 0.
fn rounded(x: f32) -> i32 {
    (if x >= 0.0 { x + 0.5 } else { x - 0.5 }) as i32
}

/// Decodes a unit vector from octahedral coordinates; the third number is the encoder's rounded 1, the fourth is kept.
fn octahedral([x, y, one, w]: [i32; 4], most: i32) -> [i32; 4] {
    let [mut x, mut y] = [x as f32, y as f32];
    let z = one as f32 - x.abs() - y.abs();
    // The lower half is folded outward.
    let fold = if z >= 0.0 { 0.0 } else { z };
    x += if x >= 0.0 { fold } else { -fold };
    y += if y >= 0.0 { fold } else { -fold };
    let length = (x * x + y * y + z * z).sqrt();
    let scale = if length > 0.0 { most as f32 / length } else { 0.0 };
    [rounded(x * scale), rounded(y * scale), rounded(z * scale), w]
}

/// Decodes a quaternion from its three smaller components; the fourth number gives the missing index and the scale of
/// 1.
fn quaternion([x, y, z, code]: [i32; 4], most: i32) -> [i32; 4] {
    let scale = core::f32::consts::FRAC_1_SQRT_2 / (code | 3) as f32;
    let three = [x, y, z].map(|number| number as f32 * scale);
    let square: f32 = three.iter().map(|x| x * x).sum();
    let missing = if square < 1.0 { (1.0 - square).sqrt() } else { 0.0 };
    let at = (code & 3) as usize;
    let mut out = [0; 4];
    out[at] = rounded(missing * most as f32);
    for (k, x) in three.into_iter().enumerate() {
        out[(at + 1 + k) & 3] = rounded(x * most as f32);
    }
    out
}

/// Decodes floats from a mantissa of 24 bits and an exponent of 8.
fn exponential(bytes: &mut [u8]) {
    for element in bytes.chunks_exact_mut(4) {
        let bits = i32::from_le_bytes([element[0], element[1], element[2], element[3]]);
        let (exponent, mantissa) = (bits >> 24, bits << 8 >> 8);
        // Multiplies by powers of 2, down to the smallest `f32`, in two exact steps.
        let power = |e: i32| f32::from_bits(((e + 127).clamp(1, 254) as u32) << 23);
        let half = exponent / 2;
        let value = mantissa as f32 * power(half) * power(exponent - half);
        element.copy_from_slice(&value.to_le_bytes());
    }
}

/// Decodes RGBA from luma, two colour differences, and alpha, whose highest bit gives the scale of 1.
fn color([y, co, cg, alpha]: [i32; 4], most: i32) -> [i32; 4] {
    let full = 2 * most + 1;
    let (y, alpha) = (y & full, alpha & full);
    let mut one = alpha;
    for shift in [1, 2, 4, 8] {
        one |= one >> shift;
    }
    let alpha = alpha << 1 & one | alpha & 1;
    let scale = if one > 0 { full as f32 / one as f32 } else { 0.0 };
    [y + co - cg, y + cg, y - co - cg, alpha].map(|x| rounded(x as f32 * scale).clamp(0, full))
}
