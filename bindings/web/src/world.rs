//! Worlds and their bodies and joints.

use crate::border::{Failure, Outcome, Shared};
use crate::definitions::{KINDS, body, body_def, joint, joint_def, mass, motor, world_def};
use crate::inner::Inner;
use crate::types::{
    BodyOptions, Events, JointOptions, MotorOptions, PoseOut, QuatLike, Vec3Like, Vec3Out, VelocityOut,
    WorldOptions,
};
use crate::values::{object, pose, rotation, vec3, vector};
use js_sys::Float32Array;
use sinew::math::{Rotation, Transform};
use sinew::physics::{BodyKind, JointState, Velocity};
use std::time::Duration;
use wasm_bindgen::prelude::*;

/// A world of bodies, joints, particles and characters. Metres, kilograms, seconds, radians; +Y is up.
#[wasm_bindgen]
pub struct World {
    pub(crate) inner: Shared<Inner>,
}

#[wasm_bindgen]
impl World {
    /// Creates an empty world.
    #[wasm_bindgen(constructor)]
    pub fn new(options: Option<WorldOptions>) -> Outcome<World> {
        let def = world_def(&options.map(JsValue::from).unwrap_or_default())?;
        Ok(World { inner: Shared::new(Inner::new(sinew::physics::World::new(def))) })
    }

    /// Advances by `seconds`: takes all whole steps, including the remainder of earlier calls, then interpolates the shown pose
    /// between the last two steps. Returns the number of steps. Call it once per frame with the elapsed time.
    pub fn update(&self, seconds: f64) -> Outcome<u32> {
        let time = Duration::try_from_secs_f64(seconds)
            .map_err(|_| Failure(format!("seconds must be finite and not negative, not {seconds}")))?;
        self.inner.run(|inner| Ok(inner.update(time)))
    }

    /// Takes `count` steps (1 by default) and shows the last state: for tests, servers and lockstep.
    pub fn step(&self, count: Option<f64>) -> Outcome {
        self.inner.run(|inner| {
            let count = count.unwrap_or(1.0);
            if !(0.0..=f64::from(u32::MAX)).contains(&count) || count.fract() != 0.0 {
                return Err(Failure(format!(
                    "the number of steps must be whole and not negative, not {count}"
                )));
            }
            inner.step(count as u32);
            Ok(())
        })
    }

    /// Remaining time as a share of a step, 0 to 1: the position of the shown pose between the last two steps.
    #[wasm_bindgen(getter)]
    pub fn alpha(&self) -> Outcome<f32> {
        self.inner.read(|inner| Ok(inner.alpha()))
    }

    /// Number of steps since the world was created.
    #[wasm_bindgen(getter, js_name = stepCount)]
    pub fn step_count(&self) -> Outcome<f64> {
        self.inner.read(|inner| Ok(inner.world.step_count() as f64))
    }

    /// Simulated time since the world was created, seconds.
    #[wasm_bindgen(getter)]
    pub fn time(&self) -> Outcome<f64> {
        self.inner.read(|inner| Ok(inner.world.time()))
    }

    /// Events of the last `update` or `step`, in order.
    pub fn events(&self) -> Outcome<Events> {
        self.inner.read(|inner| {
            let roles = |index: usize| {
                let member = inner.characters.get(index)?.as_ref()?;
                let bodies = &member.character.def().ragdoll.bodies;
                Some(bodies.iter().map(crate::character_def::bone_name).collect())
            };
            Ok(JsValue::from(crate::events::to_js(&inner.told, roles)).unchecked_into())
        })
    }

    /// Sets the gravity, m/s².
    #[wasm_bindgen(js_name = setGravity)]
    pub fn set_gravity(&self, gravity: Vec3Like) -> Outcome {
        let gravity = vec3(&gravity, "gravity")?;
        self.inner.change(|inner| {
            inner.world.set_gravity(gravity);
            Ok(())
        })
    }

    // Bodies

    /// Adds a body and returns its id.
    #[wasm_bindgen(js_name = addBody)]
    pub fn add_body(&self, options: BodyOptions) -> Outcome<u64> {
        let def = body_def(&options)?;
        self.inner.change(|inner| Ok(inner.world.add_body(&def).to_bits()))
    }

    /// Removes a body with its joints.
    #[wasm_bindgen(js_name = removeBody)]
    pub fn remove_body(&self, id: u64) -> Outcome {
        self.inner.change(|inner| {
            let body = body(&inner.world, id)?;
            inner.world.remove_body(body);
            Ok(())
        })
    }

    /// True if a body with that id exists.
    #[wasm_bindgen(js_name = hasBody)]
    pub fn has_body(&self, id: u64) -> Outcome<bool> {
        self.inner.read(|inner| Ok(body(&inner.world, id).is_ok()))
    }

    /// Ids of all bodies, including those of characters.
    pub fn bodies(&self) -> Outcome<Vec<u64>> {
        self.inner.read(|inner| Ok(inner.world.body_ids().map(|id| id.to_bits()).collect()))
    }

    /// Adds a body's pose to `poses` and returns its index there: `poses` has seven numbers per index, the position and
    /// the rotation x, y, z, w, interpolated between steps.
    pub fn track(&self, id: u64) -> Outcome<usize> {
        self.inner.change(|inner| {
            let body = body(&inner.world, id)?;
            Ok(inner.track(body))
        })
    }

    /// Removes a pose from `poses`; its index can be reused.
    pub fn untrack(&self, place: usize) -> Outcome {
        self.inner.change(|inner| {
            inner.untrack(place);
            Ok(())
        })
    }

    /// Poses of tracked bodies: a view of memory. Request it again in each frame, because memory may have moved.
    #[wasm_bindgen(getter)]
    pub fn poses(&self) -> Outcome<Float32Array> {
        self.inner.read(|inner| Ok(inner.poses()))
    }

    /// Pose of a body after the last step.
    pub fn pose(&self, id: u64) -> Outcome<PoseOut> {
        self.inner.read(|inner| Ok(pose(inner.world.transform(body(&inner.world, id)?)).unchecked_into()))
    }

    /// Velocity of a body: of its centre of mass, m/s, and angular, rad/s.
    pub fn velocity(&self, id: u64) -> Outcome<VelocityOut> {
        self.inner.read(|inner| {
            let Velocity { linear, angular } = inner.world.velocity(body(&inner.world, id)?);
            Ok(object([("linear", vector(linear)), ("angular", vector(angular))]).unchecked_into())
        })
    }

    /// Mass of a body, kg, and its centre in the body's frame.
    pub fn mass(&self, id: u64) -> Outcome<JsValue> {
        self.inner.read(|inner| Ok(mass(inner.world.mass(body(&inner.world, id)?))))
    }

    /// Kind of a body: "dynamic", "static" or "kinematic".
    pub fn kind(&self, id: u64) -> Outcome<String> {
        self.inner.read(|inner| {
            let kind = inner.world.kind(body(&inner.world, id)?);
            let named = KINDS.iter().find(|(_, other)| *other == kind);
            Ok(named.map_or("", |(name, _)| name).to_owned())
        })
    }

    /// Makes a body dynamic, static or kinematic.
    #[wasm_bindgen(js_name = setKind)]
    pub fn set_kind(&self, id: u64, kind: &str) -> Outcome {
        let found = KINDS.iter().find(|(name, _)| *name == kind).map(|(_, kind)| *kind);
        let kind: BodyKind =
            found.ok_or_else(|| Failure(format!("a body is dynamic, static or kinematic, not '{kind}'")))?;
        self.inner.change(|inner| {
            let body = body(&inner.world, id)?;
            inner.world.set_kind(body, kind);
            Ok(())
        })
    }

    /// Teleports a body. Without a rotation the body keeps its own.
    #[wasm_bindgen(js_name = setPose)]
    pub fn set_pose(&self, id: u64, position: Vec3Like, turn: Option<QuatLike>) -> Outcome {
        let (position, turn) = read_pose(&position, turn)?;
        self.inner.change(|inner| {
            let body = body(&inner.world, id)?;
            let rotation = turn.unwrap_or_else(|| inner.world.transform(body).rotation);
            inner.world.set_transform(body, Transform::new(position, rotation));
            Ok(())
        })
    }

    /// Moves a kinematic body to a pose within `seconds` (one step by default), pushing bodies in its way.
    #[wasm_bindgen(js_name = moveTo)]
    pub fn move_to(
        &self,
        id: u64,
        position: Vec3Like,
        turn: Option<QuatLike>,
        seconds: Option<f32>,
    ) -> Outcome {
        let (position, turn) = read_pose(&position, turn)?;
        self.inner.change(|inner| {
            let body = body(&inner.world, id)?;
            let rotation = turn.unwrap_or_else(|| inner.world.transform(body).rotation);
            let seconds = seconds.unwrap_or_else(|| inner.world.def().dt());
            inner.world.move_to(body, Transform::new(position, rotation), seconds);
            Ok(())
        })
    }

    /// Sets the velocity of a body, m/s and rad/s; omitted values stay.
    #[wasm_bindgen(js_name = setVelocity)]
    pub fn set_velocity(&self, id: u64, linear: Option<Vec3Like>, angular: Option<Vec3Like>) -> Outcome {
        let linear = linear.map(|v| vec3(&v, "linear")).transpose()?;
        let angular = angular.map(|v| vec3(&v, "angular")).transpose()?;
        self.inner.change(|inner| {
            let body = body(&inner.world, id)?;
            let now = inner.world.velocity(body);
            let velocity =
                Velocity { linear: linear.unwrap_or(now.linear), angular: angular.unwrap_or(now.angular) };
            inner.world.set_velocity(body, velocity);
            Ok(())
        })
    }

    /// Applies an impulse to a dynamic body, N·s, at a point in the world; by default at its centre of mass.
    #[wasm_bindgen(js_name = applyImpulse)]
    pub fn apply_impulse(&self, id: u64, impulse: Vec3Like, point: Option<Vec3Like>) -> Outcome {
        let impulse = vec3(&impulse, "impulse")?;
        let point = point.map(|point| vec3(&point, "point")).transpose()?;
        self.inner.change(|inner| {
            let body = body(&inner.world, id)?;
            let point = point.unwrap_or_else(|| inner.world.center_of_mass(body));
            inner.world.apply_impulse(body, impulse, point);
            Ok(())
        })
    }

    /// Applies a force to a dynamic body during the next step, N, at a point in the world; by default at its centre of
    /// mass.
    #[wasm_bindgen(js_name = applyForce)]
    pub fn apply_force(&self, id: u64, force: Vec3Like, point: Option<Vec3Like>) -> Outcome {
        let force = vec3(&force, "force")?;
        let point = point.map(|point| vec3(&point, "point")).transpose()?;
        self.inner.change(|inner| {
            let body = body(&inner.world, id)?;
            let point = point.unwrap_or_else(|| inner.world.center_of_mass(body));
            inner.world.apply_force(body, force, point);
            Ok(())
        })
    }

    /// Applies a torque to a dynamic body during the next step, N·m.
    #[wasm_bindgen(js_name = applyTorque)]
    pub fn apply_torque(&self, id: u64, torque: Vec3Like) -> Outcome {
        let torque = vec3(&torque, "torque")?;
        self.inner.change(|inner| {
            let body = body(&inner.world, id)?;
            inner.world.apply_torque(body, torque);
            Ok(())
        })
    }

    /// True if a body is awake.
    #[wasm_bindgen(js_name = isAwake)]
    pub fn is_awake(&self, id: u64) -> Outcome<bool> {
        self.inner.read(|inner| Ok(inner.world.is_awake(body(&inner.world, id)?)))
    }

    /// Wakes a body.
    pub fn wake(&self, id: u64) -> Outcome {
        self.inner.change(|inner| {
            let body = body(&inner.world, id)?;
            inner.world.wake(body);
            Ok(())
        })
    }

    // Joints

    /// Adds a joint between two bodies at their present poses, and returns its id.
    #[wasm_bindgen(js_name = addJoint)]
    pub fn add_joint(&self, options: JointOptions) -> Outcome<u64> {
        self.inner.change(|inner| {
            let def = joint_def(&options, &inner.world)?;
            Ok(inner.world.add_joint(&def).to_bits())
        })
    }

    /// Removes a joint.
    #[wasm_bindgen(js_name = removeJoint)]
    pub fn remove_joint(&self, id: u64) -> Outcome {
        self.inner.change(|inner| {
            let joint = joint(&inner.world, id)?;
            inner.world.remove_joint(joint);
            Ok(())
        })
    }

    /// Ids of all joints, including those of characters.
    pub fn joints(&self) -> Outcome<Vec<u64>> {
        self.inner.read(|inner| Ok(inner.world.joint_ids().map(|id| id.to_bits()).collect()))
    }

    /// Sets the motor of a joint; without options, removes it.
    #[wasm_bindgen(js_name = setMotor)]
    pub fn set_motor(&self, id: u64, options: Option<MotorOptions>) -> Outcome {
        let motor = options.map(|options| motor(&options)).transpose()?;
        self.inner.change(|inner| {
            let joint = joint(&inner.world, id)?;
            inner.world.set_motor(joint, motor);
            Ok(())
        })
    }

    /// Enables or disables a joint. A broken joint is disabled.
    #[wasm_bindgen(js_name = setJointEnabled)]
    pub fn set_joint_enabled(&self, id: u64, enabled: bool) -> Outcome {
        self.inner.change(|inner| {
            let joint = joint(&inner.world, id)?;
            let state = if enabled { JointState::Enabled } else { JointState::Disabled };
            inner.world.set_joint_state(joint, state);
            Ok(())
        })
    }

    /// Pose of body B relative to body A in the joint's frame: a hinge rotates about x, a slider moves along x.
    #[wasm_bindgen(js_name = jointPose)]
    pub fn joint_pose(&self, id: u64) -> Outcome<PoseOut> {
        self.inner
            .read(|inner| Ok(pose(inner.world.joint_transform(joint(&inner.world, id)?)).unchecked_into()))
    }

    /// Distance between the joint's two anchors, metres.
    #[wasm_bindgen(js_name = jointGap)]
    pub fn joint_gap(&self, id: u64) -> Outcome<f32> {
        self.inner.read(|inner| Ok(inner.world.joint_gap(joint(&inner.world, id)?)))
    }

    // State

    /// Hash of the state of bodies, joints and particles, 16 hexadecimal digits: the same on every machine, native or in a browser.
    pub fn hash(&self) -> Outcome<String> {
        self.inner.read(|inner| Ok(format!("{:016x}", inner.world.hash())))
    }

    /// Saves the state of the world as bytes, with its characters and grab points.
    pub fn save(&self) -> Outcome<Vec<u8>> {
        self.inner.read(|inner| Ok(inner.save()))
    }

    /// Restores a saved state; the world must have the same characters as at the time of saving.
    pub fn load(&self, state: &[u8]) -> Outcome {
        self.inner.run(|inner| inner.load(state))
    }

    /// Draws shapes, joints and contacts as lines: views of memory, six numbers of positions and six of colours per
    /// line. Request them again in each frame.
    #[wasm_bindgen(js_name = debugLines)]
    pub fn debug_lines(&self) -> Outcome<crate::types::LinesOut> {
        self.inner.change(|inner| {
            let Inner { world, lines, .. } = inner;
            lines.positions.clear();
            lines.colors.clear();
            world.draw(lines);
            let [positions, colors] = [lines.views[0].of(&lines.positions), lines.views[1].of(&lines.colors)];
            Ok(object([("positions", positions.into()), ("colors", colors.into())]).unchecked_into())
        })
    }

    /// Linear momentum of all dynamic bodies and all particles, kg·m/s.
    pub fn momentum(&self) -> Outcome<Vec3Out> {
        self.inner.read(|inner| Ok(vector(inner.world.momentum().linear).unchecked_into()))
    }
}

fn read_pose(position: &JsValue, turn: Option<QuatLike>) -> Outcome<(sinew::math::Vec3, Option<Rotation>)> {
    let turn = turn.map(|turn| rotation(&turn, "rotation")).transpose()?;
    Ok((vec3(position, "position")?, turn))
}
