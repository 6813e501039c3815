//! Seeded random numbers for scenes and tests, the same sequence on every machine.

use crate::{Rotation, Vec3};

/// Random numbers by SplitMix64 (Steele, Lea & Flood 2014).
#[derive(Clone, Debug)]
pub struct Random {
    state: u64,
}

impl Random {
    /// Creates a generator with the given seed.
    pub fn new(seed: u64) -> Self {
        Self { state: seed }
    }
    /// Returns 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }
    /// Returns a number uniform in 0..1.
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 * (1.0 / 16_777_216.0)
    }
    /// Returns a number uniform in `lo..hi`.
    pub fn range(&mut self, lo: f32, hi: f32) -> f32 {
        lo + (hi - lo) * self.unit()
    }
    /// Returns an index uniform in `0..n`; 0 if `n` is 0.
    pub fn index(&mut self, n: usize) -> usize {
        if n == 0 { 0 } else { (self.bits() % n as u64) as usize }
    }
    /// Returns a point uniform in the cube −1..1.
    pub fn in_cube(&mut self) -> Vec3 {
        Vec3::new(self.range(-1.0, 1.0), self.range(-1.0, 1.0), self.range(-1.0, 1.0))
    }
    /// Returns a unit vector uniform on the sphere, by rejection.
    pub fn direction(&mut self) -> Vec3 {
        loop {
            let v = self.in_cube();
            let l = v.length();
            if l > 0.01 && l <= 1.0 {
                return v / l;
            }
        }
    }
    /// Returns a rotation uniform over all rotations, by rejection in the 4-cube.
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
