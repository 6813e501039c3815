//! sRGB bytes ↔ linear numbers (IEC 61966-2-1).

use crate::pipeline::shade::limited;
use sinew::math::lanes::{Lanes, WIDTH};
use sinew::math::{clamp, trig};

/// Number of entries of the encoding table. In the dark range, where the curve is steepest, one entry is 0.8 of the
/// step between two bytes, so every byte occurs.
const ENCODE_STEPS: usize = 4096;

/// Tables of the two transfer functions: a power per pixel would cost more than its shading.
#[derive(Clone, Debug)]
pub(crate) struct ColorTables {
    linear: [f32; 256],
    srgb: Box<[u8; ENCODE_STEPS]>,
}

impl ColorTables {
    pub(crate) fn new() -> Self {
        let mut linear = [0.0; 256];
        for (byte, slot) in linear.iter_mut().enumerate() {
            *slot = decode(byte as f32 / 255.0);
        }
        let top = (ENCODE_STEPS - 1) as f32;
        let mut srgb = Box::new([0; ENCODE_STEPS]);
        for (i, byte) in srgb.iter_mut().enumerate() {
            *byte = (encode(i as f32 / top) * 255.0 + 0.5) as u8;
        }
        Self { linear, srgb }
    }

    /// Returns the linear value, 0..=1, of an sRGB byte.
    #[inline(always)]
    pub(crate) fn to_linear(&self, byte: u8) -> f32 {
        self.linear[byte as usize]
    }

    /// Returns the sRGB byte of a linear value; limited to 0..=1, NaN gives 0.
    #[inline(always)]
    pub(crate) fn to_srgb(&self, linear: f32) -> u8 {
        self.srgb[(clamp(linear, 0.0, 1.0) * (ENCODE_STEPS - 1) as f32 + 0.5) as usize]
    }

    /// Writes neighbouring pixels as red, green, blue and alpha. `channels` are linear; the bytes are those of
    /// [`Self::to_srgb3`].
    #[inline(always)]
    pub(crate) fn write_srgb<L: Lanes>(&self, linear: [L; 3], pixels: &mut [[u8; 4]; WIDTH]) {
        /// Value from which on all `f32` numbers are whole. The low bits of such a number are its difference from this
        /// value.
        const WHOLE: f32 = 8_388_608.0;
        let mut steps = [[0.0; WIDTH]; 3];
        for (steps, linear) in steps.iter_mut().zip(linear) {
            let x = limited(linear, 0.0, 1.0) * L::splat((ENCODE_STEPS - 1) as f32) + L::splat(0.5);
            let nearest = (x + L::splat(WHOLE)) - L::splat(WHOLE);
            let below = L::select(L::gt(nearest, x), nearest - L::splat(1.0), nearest);
            (below + L::splat(WHOLE)).store(steps);
        }
        for (i, pixel) in pixels.iter_mut().enumerate() {
            for channel in 0..3 {
                pixel[channel] = self.srgb[steps[channel][i].to_bits() as usize % ENCODE_STEPS];
            }
        }
    }

    /// Returns the sRGB bytes of a linear colour.
    #[inline(always)]
    pub(crate) fn to_srgb3(&self, [r, g, b]: [f32; 3]) -> [u8; 3] {
        [self.to_srgb(r), self.to_srgb(g), self.to_srgb(b)]
    }
}

fn decode(srgb: f32) -> f32 {
    if srgb <= 0.04045 { srgb / 12.92 } else { trig::pow((srgb + 0.055) / 1.055, 2.4) }
}

fn encode(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * trig::pow(linear, 1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_survives_the_round_trip() {
        let tables = ColorTables::new();
        for byte in 0..=255 {
            assert_eq!(tables.to_srgb(tables.to_linear(byte)), byte);
        }
        assert_eq!(tables.to_srgb(f32::NAN), 0);
        assert_eq!(tables.to_srgb(7.0), 255);
    }
}
