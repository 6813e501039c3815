//! Inertial transitions: the difference between the old and the new motion decays.
//!
//! Bollo, "Inertialization: high-performance animation transitions in Gears of War", GDC 2018. In that talk an offset
//! is an axis and an angle, and only the velocity along the axis counts. Here the perpendicular velocity decays by the
//! same curve, and nearly zero offsets may overshoot, so that no joint's velocity jumps.

use crate::pose::Pose;
use crate::rig::LocalTransform;
use crate::tuning::SHORTEST_DECAY;
use sinew_math::{ReadError, Reader, Rotation, Vec3, Writer, max, min, trig};

/// An offset that decays within a given time from its initial velocity; its final velocity and acceleration are zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Decay {
    /// Offset at the start, any unit.
    pub offset: Vec3,
    /// Velocity of the offset at the start, per second.
    pub velocity: Vec3,
}

impl Decay {
    /// Returns the time to decay, at most `seconds`: shorter, down to a third, if a fast return would overshoot.
    pub fn shortened(&self, seconds: f32) -> f32 {
        let size = self.offset.length();
        if size > 0.0 { shortened(size, self.offset.dot(self.velocity) / size, seconds) } else { seconds }
    }

    /// Returns the offset after `time` seconds, 0 or more, of a decay that may take `seconds`.
    pub fn at(&self, time: f32, seconds: f32) -> Vec3 {
        let size = self.offset.length();
        let (mut sum, mut aside) = (Vec3::ZERO, self.velocity);
        if size > 0.0 {
            let along = self.offset / size;
            let speed = along.dot(self.velocity);
            sum += along * quintic(size, speed, shortened(size, speed, seconds), time);
            aside -= along * speed;
        }
        // Without an offset, the curve is proportional to the velocity.
        sum + aside * quintic(0.0, 1.0, seconds, time)
    }
}

/// `t₁ = min(t₁, −5 x₀/v₀)` if the offset shrinks, because more time would change its sign. A tiny offset would stop a
/// limb within a frame, so it keeps its time and overshoots.
fn shortened(x0: f32, v0: f32, t1: f32) -> f32 {
    let without_overshoot = if v0 < 0.0 { -5.0 * x0 / v0 } else { t1 };
    if without_overshoot < SHORTEST_DECAY * t1 { t1 } else { min(t1, without_overshoot) }
}

/// `A t⁵ + B t⁴ + C t³ + a₀/2 t² + v₀ t + x₀` with value, velocity and acceleration 0 at `t₁`, and
/// `a₀ = max(0, (−8 v₀ t₁ − 20 x₀)/t₁²)`, which prevents a change of sign; 0 for overshoot. The acceleration is at most
/// `6 x₀/t₁² + 4 |v₀|/t₁`.
fn quintic(x0: f32, v0: f32, t1: f32, time: f32) -> f32 {
    if t1.is_nan() || t1 <= 0.0 || time >= t1 {
        return 0.0;
    }
    // Computes in units of t₁, to avoid dividing by powers of t₁.
    let (t, v) = (time / t1, v0 * t1);
    let swings_through = -v > 5.001 * x0;
    let a = if swings_through { 0.0 } else { max(0.0, -8.0 * v - 20.0 * x0) };
    let fifth = -0.5 * (a + 6.0 * v + 12.0 * x0);
    let fourth = 0.5 * (3.0 * a + 16.0 * v + 30.0 * x0);
    let third = -0.5 * (3.0 * a + 12.0 * v + 20.0 * x0);
    ((((fifth * t + fourth) * t + third) * t + 0.5 * a) * t + v) * t + x0
}

/// Offsets of all joints.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Inertia {
    joints: Vec<JointDecay>,
    seconds: f32,
    elapsed: f32,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct JointDecay {
    translation: Decay,
    /// Offset of the rotation: scaled axis in the parent's space, radians.
    rotation: Decay,
    scale: Decay,
}

/// Two poses of one motion, and the time between them.
#[derive(Clone, Copy, Debug)]
pub struct Motion<'a> {
    /// The present pose.
    pub now: &'a Pose,
    /// Another pose of the same rig: `seconds` earlier for the old motion, `seconds` later for the new one.
    pub other: &'a Pose,
    /// Time between both poses, seconds; without velocity if it is not above 0.
    pub seconds: f32,
}

impl Inertia {
    /// Copies another inertia into existing memory; allocates for more joints than before.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.joints.clone_from(&other.joints);
        (self.seconds, self.elapsed) = (other.seconds, other.elapsed);
    }

    /// Stores the difference between `from` (its pose now, and an earlier one) and `to` (its pose now, and a later
    /// one); it decays within `seconds`. All four poses have the same length. Allocates for more joints than before.
    ///
    /// # Panics
    /// If the poses differ in length, or `seconds` is negative or not finite.
    pub fn start(&mut self, from: Motion<'_>, to: Motion<'_>, seconds: f32) {
        assert!(
            seconds >= 0.0 && seconds.is_finite(),
            "the duration of a transition must be at least 0 s, not {seconds}"
        );
        let joints = from.now.len();
        for pose in [from.other, to.now, to.other] {
            assert_eq!(pose.len(), joints, "the poses must be of one rig");
        }
        (self.seconds, self.elapsed) = (seconds, 0.0);
        self.joints.clear();
        self.joints.extend((0..joints).map(|joint| {
            let of = |pose: &Pose| pose.get(joint);
            let from = (of(from.other), of(from.now), rate(from.seconds));
            JointDecay::between(from, (of(to.now), of(to.other), rate(to.seconds)))
        }));
    }

    /// True if no offset is left.
    pub fn is_over(&self) -> bool {
        self.joints.is_empty() || self.elapsed >= self.seconds
    }

    /// Removes all offsets.
    pub fn clear(&mut self) {
        self.joints.clear();
    }

    /// Advances by `seconds` and adds the remaining offset to a pose of the new motion.
    ///
    /// # Panics
    /// If an offset remains and `pose` has another length than the poses given to [`start`](Self::start).
    pub fn apply(&mut self, seconds: f32, pose: &mut Pose) {
        self.elapsed += seconds;
        if self.is_over() {
            self.clear();
            return;
        }
        assert_eq!(pose.len(), self.joints.len(), "a pose of the same rig");
        for (joint, decay) in self.joints.iter().enumerate() {
            if *decay != JointDecay::default() {
                pose.set(joint, &decay.on(pose.get(joint), self.elapsed, self.seconds));
            }
        }
    }

    /// Writes the state for [`load`](Self::load).
    pub fn save(&self, out: &mut Writer) {
        out.f32(self.seconds);
        out.f32(self.elapsed);
        out.count(self.joints.len());
        for joint in &self.joints {
            for decay in [joint.translation, joint.rotation, joint.scale] {
                out.vec3(decay.offset);
                out.vec3(decay.velocity);
            }
        }
    }

    /// Reads an inertia that [`save`](Self::save) wrote, for a rig of `joints` joints.
    ///
    /// # Errors
    /// If the bytes end too early, or hold an impossible state.
    pub fn load(bytes: &mut Reader<'_>, joints: usize) -> Result<Self, ReadError> {
        let (seconds, elapsed) = (bytes.f32()?, bytes.f32()?);
        if !(seconds >= 0.0 && seconds.is_finite() && elapsed >= 0.0 && elapsed.is_finite()) {
            return Err(bytes.error("a transition's time is negative or not finite"));
        }
        let count = bytes.count(72)?;
        if count != 0 && count != joints {
            return Err(bytes.error("a transition is of another number of joints"));
        }
        let decay = |bytes: &mut Reader<'_>| {
            let decay = Decay { offset: bytes.vec3()?, velocity: bytes.vec3()? };
            if decay.offset.is_finite() && decay.velocity.is_finite() {
                return Ok(decay);
            }
            Err(bytes.error("an offset is not finite"))
        };
        let joint = |_| {
            let (translation, rotation, scale) = (decay(bytes)?, decay(bytes)?, decay(bytes)?);
            Ok(JointDecay { translation, rotation, scale })
        };
        Ok(Self { joints: (0..count).map(joint).collect::<Result<_, _>>()?, seconds, elapsed })
    }
}

fn rate(seconds: f32) -> f32 {
    if seconds > 0.0 { 1.0 / seconds } else { 0.0 }
}

impl JointDecay {
    /// Returns the offsets of a joint. `from`: earlier, now, one over the time between. `to`: now, later, one over the
    /// time between.
    fn between(
        from: (LocalTransform, LocalTransform, f32),
        to: (LocalTransform, LocalTransform, f32),
    ) -> Self {
        let straight = |of: fn(&LocalTransform) -> Vec3| Decay {
            offset: of(&from.1) - of(&to.0),
            velocity: (of(&from.1) - of(&from.0)) * from.2 - (of(&to.1) - of(&to.0)) * to.2,
        };
        Self {
            translation: straight(|local| local.translation),
            rotation: turn((from.0.rotation, from.1.rotation, from.2), (to.0.rotation, to.1.rotation, to.2)),
            scale: straight(|local| local.scale),
        }
    }

    fn on(&self, local: LocalTransform, time: f32, seconds: f32) -> LocalTransform {
        LocalTransform {
            translation: local.translation + self.translation.at(time, seconds),
            rotation: (Rotation::from_scaled_axis(self.rotation.at(time, seconds)) * local.rotation)
                .normalize(),
            scale: local.scale + self.scale.at(time, seconds),
        }
    }
}

/// Returns the offset of the rotation and its velocity. The offset is the logarithm of `from · to⁻¹`. The velocity is
/// the difference to that logarithm a moment earlier, with `to` extrapolated backward by its next motion.
fn turn(from: (Rotation, Rotation, f32), to: (Rotation, Rotation, f32)) -> Decay {
    let now = (from.1 * to.0.inverse()).positive();
    let offset = logarithm(now);
    let moment = if from.2 > 0.0 { from.2 } else { to.2 };
    if moment == 0.0 {
        return Decay { offset, velocity: Vec3::ZERO };
    }
    let seconds = 1.0 / moment;
    let back = Rotation::from_scaled_axis(to.0.angular_velocity_to(to.1, 1.0) * (-to.2 * seconds));
    let earlier = if from.2 > 0.0 { from.0 } else { from.1 };
    let before = (earlier * (back * to.0).inverse()).toward(now);
    Decay { offset, velocity: (offset - logarithm(before)) * moment }
}

/// Returns axis times angle, up to a full turn. Close quaternions have close logarithms, also at half a turn, where
/// [`Rotation::to_scaled_axis`] jumps.
pub(crate) fn logarithm(q: Rotation) -> Vec3 {
    let v = q.vector();
    let sin = v.length();
    if sin < 1e-6 { v * 2.0 } else { v * (2.0 * trig::atan2(sin, q.w) / sin) }
}
