//! User interaction with a running scene.

use crate::framework::acts::Act;
use crate::framework::instance::Instance;
use sinew::math::{Transform, Vec3, max};
use sinew::physics::{
    BodyDef, BodyId, BodyKind, JointCollision, JointDef, JointId, JointKind, Motor, Quality, Shape, ShapeDef,
    SixDof, Sleeping, Softness, World,
};

/// User operation on a running scene between two steps. Lengths are in metres, positions in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Operation {
    /// Takes hold of a body at a point.
    Grab {
        /// The body; if it does not exist or does not move, nothing happens.
        body: BodyId,
        /// Point at which the body is grabbed.
        point: Vec3,
    },
    /// Pulls the grabbed body toward a point.
    Lead {
        /// Point toward which the body is pulled.
        to: Vec3,
    },
    /// Releases the grabbed body.
    Release,
    /// Applies an impulse to a body, or pushes the character whose clips move it.
    Push {
        /// The body; if it does not exist or is static, nothing happens.
        body: BodyId,
        /// Impulse, N·s.
        impulse: Vec3,
        /// Point of application.
        point: Vec3,
    },
    /// Throws a ball.
    Throw {
        /// Position of the ball's centre.
        position: Vec3,
        /// Velocity of the ball, m/s.
        velocity: Vec3,
        /// Radius of the ball, metres; above 0.
        radius: f32,
        /// Density of the ball, kg/m³; above 0.
        density: f32,
    },
    /// Sets the velocity of the character that a user may control; in scenes without one, nothing happens.
    Steer {
        /// Velocity, m/s.
        way: Vec3,
    },
    /// Gives an instruction to the character that a user may control; in scenes without one, nothing happens.
    Act {
        /// The instruction.
        act: Act,
    },
    /// Sets the gravity of the world.
    Gravity {
        /// Acceleration, m/s².
        gravity: Vec3,
    },
    /// Sets the quality of the solver.
    Solve {
        /// The quality.
        quality: Quality,
    },
    /// Sets the sleeping of all bodies in the world.
    Sleep {
        /// Permission to fall asleep.
        sleeping: Sleeping,
    },
    /// Adds a box to the world.
    Put {
        /// Position of the box's centre.
        position: Vec3,
        /// Half of each side, metres; above 0.
        half_extents: Vec3,
        /// Density of the box, kg/m³; above 0.
        density: f32,
    },
}

/// Frequency at which connected bodies swing on the hand, Hz. Lower: the bodies lag behind the hand. Higher: the bodies
/// jerk.
const HERTZ: f32 = 2.5;
/// Largest force of a hand, as a multiple of the connected bodies' weight (at 9.81 m/s²). Lower: the hand cannot lift a
/// body that lies under others. Higher: the hand pulls joints apart.
const STRENGTH: f32 = 12.0;
/// Weight of a kilogram, N.
const WEIGHT: f32 = 9.81;

/// The body that a user grabbed in a world. Plain data beside the world; the effects are in the world's snapshot.
#[derive(Clone, Debug, Default)]
pub struct Hands {
    grip: Option<Grip>,
}

#[derive(Clone, Copy, Debug)]
struct Grip {
    hand: BodyId,
    joint: JointId,
    body: BodyId,
    /// Grab point in the body's frame.
    held: Vec3,
    pull: Pull,
}

/// Spring of a hand with a limited force.
#[derive(Clone, Copy, Debug)]
struct Pull {
    /// Largest force, N.
    max_force: f32,
    softness: Softness,
}

impl Pull {
    /// Creates a critically damped spring for a mass, kg.
    fn on(mass: f32) -> Self {
        let omega = HERTZ * core::f32::consts::TAU;
        let softness = Softness::Stiffness { stiffness: mass * omega * omega, damping: 2.0 * mass * omega };
        Self { max_force: STRENGTH * WEIGHT * mass, softness }
    }

    fn toward(self, to: Vec3) -> Motor {
        let target = Transform::from_translation(to);
        Motor { max_force: self.max_force, max_torque: 0.0, ..Motor::toward(target, self.softness) }
    }
}

impl Hands {
    /// Applies an operation to the world. Invalid ones (a removed body, non-finite numbers) have no effect.
    pub fn apply(&mut self, world: &mut World, operation: &Operation) {
        if !operation.is_sound() {
            return;
        }
        match *operation {
            Operation::Grab { body, point } => self.grab(world, body, point),
            Operation::Lead { to } => self.lead(world, to),
            Operation::Release => self.release(world),
            // These are operations on the scene.
            Operation::Steer { .. } | Operation::Act { .. } => {}
            Operation::Gravity { gravity } => world.set_gravity(gravity),
            Operation::Solve { quality } => world.set_world_quality(quality),
            Operation::Sleep { sleeping } => {
                let bodies: Vec<BodyId> = world.body_ids().collect();
                bodies.into_iter().for_each(|body| world.set_sleeping(body, sleeping));
            }
            Operation::Push { body, impulse, point } => {
                if moves(world, body) {
                    world.apply_impulse(body, impulse, point);
                }
            }
            Operation::Throw { position, velocity, radius, density } => {
                let ball = ShapeDef { density, ..ShapeDef::new(Shape::Sphere { radius }) };
                let mut def = BodyDef::dynamic(ball).at(position);
                def.linear_velocity = velocity;
                world.add_body(&def);
            }
            Operation::Put { position, half_extents, density } => {
                let cuboid = ShapeDef { density, ..ShapeDef::new(Shape::Box { half_extents }) };
                world.add_body(&BodyDef::dynamic(cuboid).at(position));
            }
        }
    }

    /// Returns the ends of the spring: the grab point and its target, metres, world space.
    pub fn spring(&self, world: &World) -> Option<[Vec3; 2]> {
        let grip = self.grip.filter(|grip| world.contains(grip.body) && world.contains_joint(grip.joint))?;
        let to = world.joint(grip.joint).motor?.target.translation;
        Some([world.transform(grip.body).point(grip.held), to])
    }

    fn grab(&mut self, world: &mut World, body: BodyId, point: Vec3) {
        self.release(world);
        if !moves(world, body) {
            return;
        }
        let pull = Pull::on(mass_together(world, body));
        let hand = world.add_body(&BodyDef { kind: BodyKind::Static, ..BodyDef::default() });
        let held = world.transform(body).inverse().point(point);
        let frame = Transform::from_translation(held);
        let kind = JointKind::SixDof(SixDof::FREE);
        let joint = world.add_joint(&JointDef {
            motor: Some(pull.toward(point)),
            collision: JointCollision::Enabled,
            ..JointDef::between(hand, body, Transform::IDENTITY, frame, kind)
        });
        self.grip = Some(Grip { hand, joint, body, held, pull });
    }

    fn lead(&mut self, world: &mut World, to: Vec3) {
        if let Some(grip) = self.grip.filter(|grip| world.contains_joint(grip.joint)) {
            world.set_motor(grip.joint, Some(grip.pull.toward(to)));
        }
    }

    fn release(&mut self, world: &mut World) {
        if let Some(grip) = self.grip.take()
            && world.contains(grip.hand)
        {
            world.remove_body(grip.hand);
        }
    }
}

fn moves(world: &World, body: BodyId) -> bool {
    world.contains(body) && world.kind(body) == BodyKind::Dynamic
}

/// Returns the mass of a body and of all bodies connected to it by joints, kg.
fn mass_together(world: &World, body: BodyId) -> f32 {
    let (mut found, mut next) = (vec![body], 0);
    while let Some(&body) = found.get(next) {
        next += 1;
        for joint in world.joints_of(body) {
            let (a, b) = world.joint_bodies(joint);
            for other in [a, b] {
                if moves(world, other) && !found.contains(&other) {
                    found.push(other);
                }
            }
        }
    }
    max(found.into_iter().map(|body| world.mass(body).mass).sum(), 1e-6)
}

impl Operation {
    /// Returns the operation on the body with the same index in any world: ids belong to one world, and a replay runs
    /// in another.
    pub fn of_any_world(mut self) -> Self {
        if let Self::Grab { body, .. } | Self::Push { body, .. } = &mut self {
            *body = BodyId::from_bits(body.to_bits());
        }
        self
    }

    /// Applies operations that need the scene, not only its world.
    pub fn apply_to(&self, instance: &mut Instance) {
        match *self {
            _ if !self.is_sound() => {}
            Self::Steer { way } => instance.steer(way),
            Self::Act { act } => instance.act(act),
            Self::Push { body, impulse, point } => instance.push(body, impulse, point),
            _ => {}
        }
    }

    /// Returns true if the numbers are finite and at most 10⁶ m, and the sizes above 0.
    fn is_sound(&self) -> bool {
        let near = |v: Vec3| v.to_array().into_iter().all(|x| x.abs() < 1e6);
        let positive = |x: f32| x > 1e-4 && x < 1e6;
        match *self {
            Self::Grab { point, .. } => near(point),
            Self::Lead { to } => near(to),
            Self::Release | Self::Act { .. } | Self::Solve { .. } | Self::Sleep { .. } => true,
            Self::Steer { way } => near(way),
            Self::Gravity { gravity } => near(gravity),
            Self::Push { impulse, point, .. } => near(impulse) && near(point),
            Self::Throw { position, velocity, radius, density } => {
                near(position) && near(velocity) && positive(radius) && positive(density)
            }
            Self::Put { position, half_extents, density } => {
                near(position) && half_extents.to_array().into_iter().all(positive) && positive(density)
            }
        }
    }
}
