//! Applies drives to a world: joint motors, pins, kinematic bodies.

use super::{Drive, DriveMode, Drives, target};
use crate::def::RagdollDef;
use crate::ragdoll::Ragdoll;
use crate::tuning::{LEAST_HERTZ, NO_STRENGTH, RETURN_ACCELERATION, RETURN_LEVER, RETURN_SPEED, RETURN_TURN};
use sinew_math::{Rotation, Transform, Vec3, max, min};
use sinew_physics::{
    BodyDef, BodyId, BodyKind, Gains, JointCollision, JointDef, JointId, JointKind, Motor, Reaction, SixDof,
    Softness, Velocity, World,
};

impl Drives {
    /// Advances the drives by one step and sets the motors, pins and velocities that move the bodies to their targets.
    /// Call it before each step.
    ///
    /// `targets`: world pose of each body frame at the end of the coming step. `velocities`: linear velocity of each
    /// centre of mass and angular velocity, world axes. A target beyond a joint limit is clamped to the limit.
    ///
    /// # Panics
    /// If `targets` or `velocities` does not have one finite entry per body, or the ragdoll is not an instance of `def`
    /// in `world`.
    pub fn apply(
        &mut self,
        world: &mut World,
        def: &RagdollDef,
        ragdoll: &Ragdoll,
        targets: &[Transform],
        velocities: &[Velocity],
    ) {
        let count = self.drives.len();
        let all = [def.bodies.len(), ragdoll.bodies.len(), targets.len(), velocities.len()];
        assert_eq!(
            all, [count; 4],
            "definition, ragdoll, targets and velocities must have one entry per drive"
        );
        let (dt, recovery) = (world.def().dt(), self.recovery);
        for body in 0..count {
            let drive = &mut self.drives[body];
            let keyed = drive.pass(dt, recovery);
            if ragdoll.lost.contains(&body) {
                continue;
            }
            let id = ragdoll.bodies[body];
            if keyed != drive.keyed {
                drive.keyed = keyed;
                world.set_kind(id, if keyed { BodyKind::Kinematic } else { BodyKind::Dynamic });
            }
            if keyed {
                let is_back = drive.half_life == 0.0;
                let target =
                    if is_back { targets[body] } else { nearer(world, id, targets[body], velocities[body]) };
                world.move_to(id, target, dt);
            }
            self.pin(world, id, body, def.bodies[body].mass.center, targets[body], velocities[body]);
        }
        for (child, id) in ragdoll.own_joints() {
            let joint = &def.joints[child - 1];
            let ends = [joint.parent, joint.child];
            let drive = &self.drives[joint.child];
            let torque = self.torques[joint.child];
            let motor =
                muscle(world, id, drive, torque, ends.map(|b| targets[b]), ends.map(|b| velocities[b]));
            world.set_motor(id, motor);
        }
    }

    /// Advances the drives in time without a world: blends continue and weakness decays. For drives that are recreated
    /// in a running world, call this once per step taken so far, with the step length.
    pub fn skip(&mut self, seconds: f32) {
        for drive in &mut self.drives {
            drive.pass(seconds, self.recovery);
        }
    }

    /// Removes pins and motors from the world and makes keyed bodies dynamic again, with the velocity at which they
    /// were driven. Call this before removing the ragdoll; the modes do not change.
    pub fn release(&mut self, world: &mut World, ragdoll: &Ragdoll) {
        let all: Vec<usize> = ragdoll.own_bodies().map(|(body, _)| body).collect();
        self.release_bodies(world, ragdoll, &all);
        if let Some(ground) = self.ground.take().filter(|&ground| world.contains(ground)) {
            world.remove_body(ground);
        }
    }

    /// Like [`release`](Self::release), but only for the bodies with the indices `bodies` and the joints above them.
    pub(crate) fn release_bodies(&mut self, world: &mut World, ragdoll: &Ragdoll, bodies: &[usize]) {
        for &body in bodies {
            let (drive, id) = (&mut self.drives[body], ragdoll.bodies[body]);
            if let Some(pin) = drive.pin.take().filter(|&pin| world.contains_joint(pin)) {
                world.remove_joint(pin);
            }
            if core::mem::take(&mut drive.keyed) && world.contains(id) {
                world.set_kind(id, BodyKind::Dynamic);
            }
            let joint = body.checked_sub(1).map(|joint| ragdoll.joints[joint]);
            if let Some(joint) = joint.filter(|&joint| world.contains_joint(joint)) {
                world.set_motor(joint, None);
            }
        }
    }

    /// Returns the reaction of a body's pin in the last step, averaged over the step: force in N at the centre of mass
    /// and torque in N·m about it, world axes. Zero without a pin.
    pub fn pin_force(&self, world: &World, body: usize) -> Reaction {
        let pin = self.drives[body].pin.filter(|&pin| world.contains_joint(pin));
        pin.map_or(Reaction::default(), |pin| world.reaction(pin))
    }

    /// Returns the sums of the magnitudes of all pins' forces (N) and torques (N·m) in the last step. Real bodies get
    /// no such external help.
    pub fn pin_effort(&self, world: &World) -> (f32, f32) {
        (0..self.drives.len()).fold((0.0, 0.0), |(force, torque), body| {
            let reaction = self.pin_force(world, body);
            (force + reaction.force.length(), torque + reaction.torque.length())
        })
    }

    /// Creates, moves or removes the pin of a body. `center`: centre of mass in the body frame.
    fn pin(
        &mut self,
        world: &mut World,
        id: BodyId,
        body: usize,
        center: Vec3,
        wanted: Transform,
        velocity: Velocity,
    ) {
        let drive = &self.drives[body];
        let vigour = 1.0 - drive.weakness;
        // The user may have made the body kinematic or static.
        let moves = !drive.keyed && world.kind(id) == BodyKind::Dynamic;
        let softness = drive.level.pin.softness(vigour).filter(|_| moves);
        let old = drive.pin.filter(|&pin| world.contains_joint(pin));
        let Some(softness) = softness.filter(|_| drive.level.force + drive.level.torque > NO_STRENGTH) else {
            if let Some(pin) = old {
                world.remove_joint(pin);
            }
            self.drives[body].pin = None;
            return;
        };
        let back = Lag::of(world).back(wanted.rotation, velocity.angular);
        let place = wanted.point(center) - velocity.linear * Lag::of(world).seconds;
        let mut motor = Motor {
            gains: Gains::Position(softness),
            target: Transform::new(place, back),
            velocity,
            max_force: drive.level.force * vigour,
            max_torque: drive.level.torque * vigour,
        };
        if drive.mode == DriveMode::Keyed {
            return_slowly(&mut motor, world, id);
        }
        match old {
            Some(pin) => world.set_motor(pin, Some(motor)),
            None => {
                let ground = self.ground(world);
                let frame_b = Transform::from_translation(center);
                let kind = JointKind::SixDof(SixDof::FREE);
                let def = JointDef {
                    motor: Some(motor),
                    collision: JointCollision::Enabled,
                    ..JointDef::between(ground, id, Transform::IDENTITY, frame_b, kind)
                };
                self.drives[body].pin = Some(world.add_joint(&def));
            }
        }
    }

    /// Returns the static body without shape at the origin, to which pins attach.
    fn ground(&mut self, world: &mut World) -> BodyId {
        if let Some(ground) = self.ground.filter(|&ground| world.contains(ground)) {
            return ground;
        }
        let ground = world.add_body(&BodyDef { kind: BodyKind::Static, ..BodyDef::default() });
        self.ground = Some(ground);
        ground
    }
}

/// Returns the pose that a keyed body reaches within a step on its way to a moving target. An obstacle may have kept
/// the body away, so its speed of return is bounded.
fn nearer(world: &World, id: BodyId, target: Transform, velocity: Velocity) -> Transform {
    let (dt, now) = (world.def().dt(), world.transform(id));
    let left = target.translation - now.translation - velocity.linear * dt;
    let turn = (target.rotation * now.rotation.inverse()).to_scaled_axis();
    let share = |size: f32, most: f32| min(most * dt / max(size, f32::MIN_POSITIVE), 1.0);
    let share_left = share(left.length(), RETURN_SPEED);
    let share_turn = share(turn.length(), RETURN_TURN + velocity.angular.length());
    let place =
        if share_left < 1.0 { target.translation - left * (1.0 - share_left) } else { target.translation };
    let turned = Rotation::from_scaled_axis(turn * share_turn) * now.rotation;
    let rotation = if share_turn < 1.0 { turned.normalize() } else { target.rotation };
    Transform::new(place, rotation)
}

/// Bounds the force of the pin of a body that changes to keyed, and the speed at which the body approaches its target.
fn return_slowly(motor: &mut Motor, world: &World, id: BodyId) {
    let Gains::Position(Softness::Frequency { hertz, damping_ratio }) = motor.gains else { return };
    motor.max_force = min(motor.max_force, RETURN_ACCELERATION * world.mass(id).mass);
    motor.max_torque = min(motor.max_torque, RETURN_LEVER * motor.max_force);
    // A damped spring approaches its target at its angular frequency times the distance, over twice the damping ratio.
    // The bound is smooth, so that no limb jerks where it ends.
    let rate = core::f32::consts::PI * hertz / max(damping_ratio, LEAST_HERTZ);
    let from = Transform::new(world.center_of_mass(id), world.transform(id).rotation);
    let (way, turn) =
        (motor.target.translation - from.translation, motor.target.rotation * from.rotation.inverse());
    let turn = turn.to_scaled_axis();
    let share = |size: f32, speed: f32| speed / (speed + rate * size);
    let translation = from.translation + way * share(way.length(), RETURN_SPEED);
    let turned = Rotation::from_scaled_axis(turn * share(turn.length(), RETURN_TURN));
    motor.target = Transform::new(translation, (turned * from.rotation).normalize());
}

/// Returns the motor of a joint; `None` if the muscle has no strength, or the joint allows no motion.
fn muscle(
    world: &World,
    joint: JointId,
    drive: &Drive,
    torque: f32,
    targets: [Transform; 2],
    velocities: [Velocity; 2],
) -> Option<Motor> {
    let vigour = 1.0 - drive.weakness;
    let softness: Softness = drive.level.muscle.softness(vigour)?;
    let max_torque = torque * drive.level.strength * vigour;
    if max_torque <= 0.0 {
        return None;
    }
    let (held, rate) = target::of_joint(&world.joint(joint), targets, velocities);
    Some(Motor {
        gains: Gains::Position(softness),
        target: Transform::new(Vec3::ZERO, Lag::of(world).back(held, rate)),
        velocity: Velocity { linear: Vec3::ZERO, angular: rate },
        max_force: 0.0,
        max_torque,
    })
}

/// Time by which a motor's target precedes the step's end. A motor's target is constant within a step although the pose
/// moves. The target is therefore the pose at the mean of the times at which substeps start, because motors are
/// evaluated then.
struct Lag {
    /// Time before the step's end, seconds.
    seconds: f32,
}

impl Lag {
    fn of(world: &World) -> Self {
        let substeps = world.def().substeps as f32;
        Self { seconds: world.def().dt() * (substeps + 1.0) / (2.0 * substeps) }
    }

    /// Returns the rotation of a frame at the time `lag` before `end`, if it rotates at `rate` (rad/s, fixed axes).
    fn back(&self, end: Rotation, rate: Vec3) -> Rotation {
        (Rotation::from_scaled_axis(rate * -self.seconds) * end).normalize()
    }
}
