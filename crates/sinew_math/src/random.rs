//! Seeded random numbers for scenes and tests: the same sequence everywhere.

use crate::{Rotation, Vec3};

/// SplitMix64 (Steele, Lea & Flood 2014).
#[derive(Clone, Debug)]
pub struct Random {
    state: u64,
}

impl Random {
    /// The sequence number `seed`.
    pub fn new(seed: u64) -> Self {
        Self { state: seed }
    }
    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }
    /// Uniform in 0..1.
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 * (1.0 / 16_777_216.0)
    }
    /// Uniform in `lo..hi`.
    pub fn range(&mut self, lo: f32, hi: f32) -> f32 {
        lo + (hi - lo) * self.unit()
    }
    /// Uniform in `0..n`; 0 if `n` is 0.
    pub fn index(&mut self, n: usize) -> usize {
        if n == 0 { 0 } else { (self.bits() % n as u64) as usize }
    }
    /// Uniform in the cube −1..1.
    pub fn in_cube(&mut self) -> Vec3 {
        Vec3::new(self.range(-1.0, 1.0), self.range(-1.0, 1.0), self.range(-1.0, 1.0))
    }
    /// Uniform on the unit sphere, by rejection.
    pub fn direction(&mut self) -> Vec3 {
        loop {
            let v = self.in_cube();
            let l = v.length();
            if l > 0.01 && l <= 1.0 {
                return v / l;
            }
        }
    }
    /// Uniform over all rotations, by rejection in the 4-cube.
    pub fn rotation(&mut self) -> Rotation {
        loop {
            let v = self.in_cube();
            let q = Rotation::from_xyzw(v.x, v.y, v.z, self.range(-1.0, 1.0));
            let l = q.dot(q);
            if l > 0.01 && l <= 1.0 {
                return q.normalize();
            }
        }
    }
}
