//! Pairs of boxes that may overlap.

use super::rays::PlacedBox;
use sinew::math::{Random, Transform, Vec3};
use sinew_scenes::blueprint::{in_box, rotation};

/// Two boxes, the first around the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoxPair {
    /// A box around the origin.
    pub a: PlacedBox,
    /// The other box, up to 1.6 m away on each axis.
    pub b: PlacedBox,
}

/// A list of pairs; 51.4 % overlap.
pub struct BoxPairs {
    /// Pairs, tested from first to last, then again.
    pub pairs: Vec<BoxPair>,
    /// Number of pairs in one measured step.
    pub per_step: usize,
}

impl BoxPairs {
    /// Returns the first `count` pairs of a fixed sequence, of which `per_step` are tested in one step.
    pub fn new(count: usize, per_step: usize) -> Self {
        let mut random = Random::new(42);
        let pairs = (0..count)
            .map(|_| {
                let [a, b] = [(); 2].map(|()| {
                    let half_extents = in_box(&mut random, 0.2, 1.0);
                    let world_from_box = Transform::new(Vec3::ZERO, rotation(&mut random));
                    PlacedBox { half_extents, world_from_box }
                });
                let offset = in_box(&mut random, -1.6, 1.6);
                let world_from_box = Transform::new(offset, b.world_from_box.rotation);
                BoxPair { a, b: PlacedBox { world_from_box, ..b } }
            })
            .collect();
        Self { pairs, per_step }
    }

    /// Returns the pairs of measured step number `step`, cyclically.
    pub fn pairs_of_step(&self, step: usize) -> core::ops::Range<usize> {
        let start = step * self.per_step % self.pairs.len();
        start..start + self.per_step
    }
}
