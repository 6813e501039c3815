//! Encodes key values in 48 bits.

use sinew_math::{Rotation, clamp, max, min};

/// A value of a track at a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Key {
    /// Index into the clip's table of times.
    pub time: u16,
    /// The value, encoded by the track's [`Code`].
    pub packed: [u16; 3],
}

/// Decoder of the values of a track's keys.
pub(super) trait Code<const N: usize>: Copy {
    fn decode(&self, packed: [u16; 3]) -> [f32; N];
}

/// Bounds of three numbers, with 16 bits for each.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Bounds {
    pub low: [f32; 3],
    /// Width of one of the 65,535 steps, axis by axis.
    pub step: [f32; 3],
}

impl Bounds {
    /// Returns the smallest bounds that contain all values.
    pub fn around(values: &[[f32; 3]]) -> Self {
        let fold = |i: usize, pick: fn(f32, f32) -> f32| values.iter().map(|v| v[i]).fold(values[0][i], pick);
        let low = core::array::from_fn(|i| fold(i, min));
        Self { low, step: core::array::from_fn(|i| (fold(i, max) - low[i]) / 65_535.0) }
    }

    pub fn encode(&self, value: [f32; 3]) -> [u16; 3] {
        core::array::from_fn(|i| {
            let units = if self.step[i] > 0.0 { (value[i] - self.low[i]) / self.step[i] } else { 0.0 };
            clamp(units + 0.5, 0.0, 65_535.0) as u16
        })
    }
}

impl Code<3> for Bounds {
    #[inline(always)]
    fn decode(&self, packed: [u16; 3]) -> [f32; 3] {
        [
            self.low[0] + f32::from(packed[0]) * self.step[0],
            self.low[1] + f32::from(packed[1]) * self.step[1],
            self.low[2] + f32::from(packed[2]) * self.step[2],
        ]
    }
}

/// A unit quaternion without its component of largest magnitude, which follows from the other three. These are at most
/// √½ and have 15 bits each, with 0 exact. Of the three remaining bits, two name the omitted component and one is its
/// sign, so that keys of a track stay on one hemisphere.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct SmallestThree;

/// Half the number of steps from −√½ to √½.
const HALF: f32 = 16_383.0;
/// √½ divided by [`HALF`].
const STEP: f32 = core::f32::consts::FRAC_1_SQRT_2 / HALF;
/// The highest of the 16 bits.
const FLAG: u16 = 0x8000;

/// Largest angle, radians, between a unit quaternion and its quantised form. Each of the three numbers is off by at
/// most half a step, the fourth (the largest) by three times that; an angle is twice the chord.
pub(super) const ROTATION_BOUND: f32 = 1.51e-4;

impl SmallestThree {
    pub fn encode(q: Rotation) -> [u16; 3] {
        let numbers = [q.x, q.y, q.z, q.w];
        let largest = (1..4).fold(0, |best, i| if numbers[i].abs() > numbers[best].abs() { i } else { best });
        let mut packed = [0; 3];
        let others = (0..4).filter(|&i| i != largest);
        for (field, i) in packed.iter_mut().zip(others) {
            *field = clamp(numbers[i] / STEP + HALF + 0.5, 0.0, 2.0 * HALF) as u16;
        }
        let flag = |is_set: bool| if is_set { FLAG } else { 0 };
        packed[0] |= flag(largest & 1 != 0);
        packed[1] |= flag(largest & 2 != 0);
        packed[2] |= flag(numbers[largest] < 0.0);
        packed
    }
}

impl Code<4> for SmallestThree {
    #[inline(always)]
    fn decode(&self, packed: [u16; 3]) -> [f32; 4] {
        let [a, b, c] = packed.map(|field| (f32::from(field & !FLAG) - HALF) * STEP);
        let rest = max(1.0 - (a * a + b * b + c * c), 0.0).sqrt();
        let largest = if packed[2] & FLAG == 0 { rest } else { -rest };
        match (packed[1] & FLAG != 0, packed[0] & FLAG != 0) {
            (false, false) => [largest, a, b, c],
            (false, true) => [a, largest, b, c],
            (true, false) => [a, b, largest, c],
            (true, true) => [a, b, c, largest],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_math::{Random, trig};

    /// Angle between rotations, radians, in `f64`, because the error of `angle_to` exceeds the tolerance.
    fn angle(a: Rotation, b: Rotation) -> f64 {
        let pairs =
            [(a.x, b.x), (a.y, b.y), (a.z, b.z), (a.w, b.w)].map(|(a, b)| (f64::from(a), f64::from(b)));
        let sign = if pairs.iter().map(|(a, b)| a * b).sum::<f64>() < 0.0 { -1.0 } else { 1.0 };
        2.0 * pairs.iter().map(|(a, b)| (a - sign * b) * (a - sign * b)).sum::<f64>().sqrt()
    }

    #[test]
    fn a_rotation_keeps_its_place_and_its_sign_within_the_bound() {
        let mut random = Random::new(1);
        let mut worst: f64 = 0.0;
        for i in 0..200_000 {
            let half = f32::from(i % 3 == 0);
            // Every third rotation is near equal numbers, the worst case.
            let q = random.rotation();
            let q = Rotation::from_xyzw(q.x, q.y + half, q.z + half, q.w + half).normalize();
            let [x, y, z, w] = SmallestThree.decode(SmallestThree::encode(q));
            let back = Rotation::from_xyzw(x, y, z, w);
            assert!(q.dot(back) > 0.99, "{q:?} became {back:?}");
            worst = worst.max(angle(q, back));
        }
        assert!(worst < f64::from(ROTATION_BOUND), "{worst}");
        assert!(worst > 0.8 * f64::from(ROTATION_BOUND), "the bound is too wide; largest error {worst}");
        assert_eq!(SmallestThree.decode(SmallestThree::encode(Rotation::IDENTITY)), [0.0, 0.0, 0.0, 1.0]);
        let half = trig::sin(core::f32::consts::FRAC_PI_4);
        let [.., w] = SmallestThree.decode(SmallestThree::encode(Rotation::from_xyzw(half, 0.0, 0.0, half)));
        assert!((w - half).abs() < 1e-4);
    }

    #[test]
    fn three_numbers_keep_their_bounds() {
        let values = [[0.0, -5.0, 7.0], [1.0, 3.0, 7.0], [0.3, 1.0, 7.0]];
        let bounds = Bounds::around(&values);
        for value in values {
            let back = bounds.decode(bounds.encode(value));
            for i in 0..3 {
                assert!(
                    (back[i] - value[i]).abs() <= 0.51 * bounds.step[i] + 1e-6,
                    "{value:?} decodes to {back:?}"
                );
            }
        }
        assert_eq!(bounds.decode(bounds.encode(values[0])), values[0]);
    }
}
