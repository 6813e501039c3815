//! Counts of joints that shake and of bodies inside static bodies, by state and part of the body.

use super::watch::STATES;
use crate::framework::metric::{Expected, Metric};
use sinew::math::{ReadError, Reader, Vec3, Writer};

/// Smallest displacement that counts as shaking if a joint moves by it back and forth in three successive frames,
/// metres.
const SHAKE: f32 = 0.005;

/// Metrics of shaking joints, in the order of [`STATES`].
const SHAKES: [&str; STATES.len()] = [
    "animated_shakes",
    "flinching_shakes",
    "powered_shakes",
    "limp_shakes",
    "preparing_shakes",
    "getting_up_shakes",
];

/// Endings of the roles of each part. The last part contains all other bodies.
const PARTS: [&[&str]; 5] = [&["Foot", "Toes"], &["hips"], &["Hand"], &["head", "neck"], &[""]];

/// Metrics of bodies inside static bodies, in the order of [`STATES`] and [`PARTS`].
const DEEP: [[&str; PARTS.len()]; STATES.len()] = [
    [
        "animated_deep_feet",
        "animated_deep_hips",
        "animated_deep_hands",
        "animated_deep_head",
        "animated_deep_others",
    ],
    [
        "flinching_deep_feet",
        "flinching_deep_hips",
        "flinching_deep_hands",
        "flinching_deep_head",
        "flinching_deep_others",
    ],
    [
        "powered_deep_feet",
        "powered_deep_hips",
        "powered_deep_hands",
        "powered_deep_head",
        "powered_deep_others",
    ],
    ["limp_deep_feet", "limp_deep_hips", "limp_deep_hands", "limp_deep_head", "limp_deep_others"],
    [
        "preparing_deep_feet",
        "preparing_deep_hips",
        "preparing_deep_hands",
        "preparing_deep_head",
        "preparing_deep_others",
    ],
    [
        "getting_up_deep_feet",
        "getting_up_deep_hips",
        "getting_up_deep_hands",
        "getting_up_deep_head",
        "getting_up_deep_others",
    ],
];

/// Numbers of readings.
#[derive(Default)]
pub(super) struct Readings {
    /// Joints that shake, by state.
    shakes: [u32; STATES.len()],
    /// Bodies inside static bodies, by state and part.
    deep: [[u32; PARTS.len()]; STATES.len()],
}

impl Readings {
    /// Counts a joint at `now` that was at `before` in the last three frames, the latest first.
    pub fn add_joint(&mut self, state: usize, before: [Vec3; 3], now: Vec3) {
        self.shakes[state] += u32::from(shakes(before, now));
    }

    /// Counts a body with this role that is inside a static body.
    pub fn add_deep(&mut self, state: usize, role: &str) {
        let part = PARTS.iter().position(|ends| ends.iter().any(|end| role.ends_with(end)));
        self.deep[state][part.expect("the last part matches every role")] += 1;
    }

    pub fn metrics(&self) -> impl Iterator<Item = Metric> {
        let shakes = SHAKES.into_iter().zip(self.shakes);
        let deep = DEEP.into_iter().flatten().zip(self.deep.into_iter().flatten());
        shakes.chain(deep).map(|(name, count)| Metric::new(name, count, Expected::Anything))
    }

    pub fn save(&self, out: &mut Writer) {
        self.shakes.iter().for_each(|&count| out.u32(count));
        self.deep.iter().flatten().for_each(|&count| out.u32(count));
    }

    pub fn load(&mut self, bytes: &mut Reader<'_>) -> Result<(), ReadError> {
        for count in self.shakes.iter_mut().chain(self.deep.iter_mut().flatten()) {
            *count = bytes.u32()?;
        }
        Ok(())
    }
}

/// Returns true if a joint at `now` that was at `before` in the last three frames, the latest first, moves back and
/// forth.
pub(super) fn shakes(before: [Vec3; 3], now: Vec3) -> bool {
    let [c, b, a] = before;
    let ways = [b - a, c - b, now - c];
    let reverses = ways.windows(2).all(|pair| pair[0].dot(pair[1]) < 0.0);
    reverses && ways.iter().all(|way| way.length() > SHAKE)
}
