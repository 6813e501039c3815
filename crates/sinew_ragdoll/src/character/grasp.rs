//! A grip: a joint with a motor that holds one point. Its stiffness reaches the full force at a stretch of 1 cm.

use super::tuning::{GRIP_SHARE, GRIP_STRETCH, LEAST_ALONG, LEAST_GAP};
use sinew_math::{ReadError, Reader, Rotation, Transform, Vec3, Writer, max, min};
use sinew_physics::{
    BodyId, BodyKind, Gains, JointDef, JointId, JointKind, Motor, SixDof, Softness, Velocity, World,
};

/// Settings of a grab.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grab {
    /// Largest force of the grip, N. Default 1300, which drags a man at a walk.
    pub max_force: f32,
    /// Largest distance from the surface to the centre of the hand, or to the point, metres. Default 0.25.
    pub reach: f32,
    /// Distance by which the grip slips at its full force before it releases the body, metres; for a
    /// [`GrabPoint`](super::GrabPoint) the distance from its target. Default 0.4.
    pub slip: f32,
    /// Point in the frame of the hand's body to which the grip pulls the held body, at `speed`; `None`: to the hand's
    /// surface. Default `None`.
    pub to: Option<Vec3>,
    /// Speed at which the grip pulls the held body, and at which a [`GrabPoint`](super::GrabPoint) moves, m/s. Default
    /// 1.
    pub speed: f32,
    /// True if the grip releases the body when its character goes limp. Default true.
    pub drops: bool,
}

impl Grab {
    /// Grip of a hand.
    pub const HAND: Self =
        Self { max_force: 1300.0, reach: 0.25, slip: 0.4, to: None, speed: 1.0, drops: true };
    /// Grip for a point that a person moves, for instance with a mouse: at most 2.5 m/s. It never releases the body by
    /// itself.
    pub const POINT: Self = Self { slip: f32::INFINITY, speed: 2.5, ..Self::HAND };

    /// # Panics
    /// If a number is invalid.
    #[track_caller]
    pub(super) fn check(&self) {
        let positive = |x: f32| x > 0.0 && x < f32::INFINITY;
        assert!(
            positive(self.max_force),
            "`Grab::max_force` must be positive and finite, not {}",
            self.max_force
        );
        assert!(positive(self.speed), "`Grab::speed` must be positive and finite, not {}", self.speed);
        assert!(self.reach >= 0.0, "`Grab::reach` must be at least 0, not {}", self.reach);
        assert!(self.slip > 0.0, "`Grab::slip` must be positive, not {}", self.slip);
        assert!(self.to.is_none_or(Vec3::is_finite), "`Grab::to` must be finite, not {:?}", self.to);
    }
}

impl Default for Grab {
    fn default() -> Self {
        Self::HAND
    }
}

/// An active grip. Points are relative to the anchor on the hand, in the axes of the hand's body, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Grasp {
    /// Target to which the held point is pulled.
    pub goal: Vec3,
    /// Offset from the target to the point at which the motor currently holds the body. It shrinks to zero while the
    /// body is pulled to the hand.
    pub off: Vec3,
    /// Anchors on the hand's body and on the held body, in their frames.
    anchors: [Vec3; 2],
    max_force: f32,
    slip: f32,
    speed: f32,
    /// Damping of the motor, N·s/m.
    damping: f32,
}

impl Grasp {
    /// Returns the point of `held` that a hand at `palm` grabs, world; `None` if it is out of reach.
    pub fn touch(world: &World, held: BodyId, palm: Vec3, reach: f32) -> Option<Vec3> {
        let surface = world.nearest_surface(held, palm)?;
        let point = if surface.distance <= 0.0 { palm } else { surface.point };
        (surface.distance <= reach).then_some(point)
    }

    /// Joins two bodies at `point` of the held one, which is pulled to `to`; both in world space.
    pub fn take(
        world: &mut World,
        [hand, held]: [BodyId; 2],
        [point, to]: [Vec3; 2],
        grab: &Grab,
    ) -> (Self, JointId) {
        let [place, of_held] = [hand, held].map(|body| world.transform(body));
        let anchors = [place.inverse_point(point), of_held.inverse_point(point)];
        let moving = [held, hand].into_iter().filter(|&body| world.kind(body) == BodyKind::Dynamic);
        let mass = moving.map(|body| world.mass(body).mass).fold(f32::INFINITY, min);
        let grasp = Self {
            goal: place.inverse_point(to) - anchors[0],
            off: point - to,
            anchors,
            max_force: grab.max_force,
            slip: grab.slip,
            speed: grab.speed,
            damping: 2.0 * (grab.max_force / GRIP_STRETCH * mass).sqrt(),
        };
        let [frame_a, frame_b] = anchors.map(Transform::from_translation);
        let def = JointDef::between(hand, held, frame_a, frame_b, JointKind::SixDof(SixDof::FREE));
        let joint = world.add_joint(&grasp.pulling(&def, Vec3::ZERO, Vec3::ZERO, Vec3::ZERO));
        (grasp, joint)
    }

    /// Sets the motor for the next step; returns false if the grip releases the body. If `leads` is true, the target
    /// stays near the held point instead of dragging it from afar.
    pub fn pull(&mut self, world: &mut World, joint: JointId, leads: bool) -> bool {
        let (dt, def) = (world.def().dt(), world.joint(joint));
        let held = def.frame_a.rotation * world.joint_transform(joint).translation;
        let world_from_hand = world.transform(def.body_a).rotation;
        let before = self.off;
        self.off -= before * min(self.speed * dt / max(before.length(), 1e-9), 1.0);
        let hand_from_world = world_from_hand.inverse();
        let velocity = hand_from_world * ((self.off - before) / dt);
        let mut at = self.goal + hand_from_world * self.off;
        let gap = held - if leads { self.goal } else { at };
        if gap.length() > self.slip {
            return false;
        }
        if leads {
            at = near(at, held);
            self.off = world_from_hand * (at - self.goal);
        }
        world.set_joint(joint, &self.pulling(&def, at, held, velocity));
        true
    }

    /// Sets another target, relative to the anchor on a hand that is not rotated; the currently held point does not
    /// move.
    pub fn lead(&mut self, goal: Vec3) {
        self.off += self.goal - goal;
        self.goal = goal;
    }

    /// Returns the joint that pulls the held point; `velocity` is the velocity of the target.
    ///
    /// The motor limits the force along each of its three axes. The pull makes equal angles with the axes, so that
    /// their limits together give the full force along the pull, and no more in any other direction.
    fn pulling(&self, def: &JointDef, at: Vec3, held: Vec3, velocity: Vec3) -> JointDef {
        let (gap, third) = (at - held, (1.0_f32 / 3.0).sqrt());
        let (about, mut turn) = (Vec3::splat(third), def.frame_a.rotation);
        if gap.length() > LEAST_GAP && (turn * about).dot(gap) < LEAST_ALONG * gap.length() {
            turn = Rotation::from_arc(about, gap.normalize());
        }
        let back = turn.inverse();
        let softness =
            Softness::Stiffness { stiffness: self.max_force / GRIP_STRETCH, damping: self.damping };
        let motor = Motor {
            gains: Gains::Position(softness),
            target: Transform::from_translation(back * near(at, held)),
            velocity: Velocity { linear: back * velocity, angular: Vec3::ZERO },
            max_force: self.max_force * (GRIP_SHARE * third),
            max_torque: 0.0,
        };
        let [hand, held] = self.anchors;
        JointDef {
            frame_a: Transform::new(hand, turn),
            frame_b: Transform::from_translation(held),
            motor: Some(motor),
            ..*def
        }
    }

    pub fn save(&self, w: &mut Writer) {
        let [hand, held] = self.anchors;
        [self.goal, self.off, hand, held].into_iter().for_each(|v| w.vec3(v));
        [self.max_force, self.slip, self.speed, self.damping].into_iter().for_each(|x| w.f32(x));
    }

    pub fn load(r: &mut Reader<'_>) -> Result<Self, ReadError> {
        let (goal, off, anchors) = (r.vec3()?, r.vec3()?, [r.vec3()?, r.vec3()?]);
        let (max_force, slip, speed, damping) = (r.f32()?, r.f32()?, r.f32()?, r.f32()?);
        let positive = |x: f32| x > 0.0 && x < f32::INFINITY;
        let damps = (0.0..f32::INFINITY).contains(&damping);
        let numbers = positive(max_force) && positive(speed) && damps;
        if !(numbers && slip > 0.0 && [goal, off, anchors[0], anchors[1]].into_iter().all(Vec3::is_finite)) {
            return Err(r.error("invalid settings of a grip"));
        }
        Ok(Self { goal, off, anchors, max_force, slip, speed, damping })
    }
}

/// Returns `at`, or the point toward it at the distance from `held` at which the grip pulls with its full force.
fn near(at: Vec3, held: Vec3) -> Vec3 {
    let gap = at - held;
    held + gap * min(GRIP_STRETCH / max(gap.length(), 1e-9), 1.0)
}
