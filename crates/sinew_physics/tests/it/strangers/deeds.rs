//! Calls of a game between two steps, drawn from the world itself, so that equal worlds get equal calls.

use super::populate;
use sinew_math::{Random, Range, Rotation, SwingTwistLimit, Transform, Vec3};
use sinew_physics::*;

/// Probability that a call precedes a step.
const BUSY: f32 = 0.25;

fn never_twins(p: &PairSide, q: &PairSide) -> bool {
    p.user_data != q.user_data || p.user_data < 50
}

fn slippery(_: &FoundContact<'_>, material: ContactMaterial) -> Option<ContactMaterial> {
    Some(ContactMaterial { friction: 0.05, ..material })
}

/// Registers the functions that snapshots refer to.
pub fn register(world: &mut World) {
    world.register_pair_function(1, never_twins);
    world.register_modifier(1, slippery);
}

fn any<T: Copy>(random: &mut Random, all: impl Iterator<Item = T>) -> Option<T> {
    let all: Vec<T> = all.collect();
    (!all.is_empty()).then(|| all[random.index(all.len())])
}

/// Returns a random body that is not static.
fn loose(world: &World, random: &mut Random) -> Option<BodyId> {
    any(random, world.body_ids().filter(|&id| world.kind(id) != BodyKind::Static))
}

fn dynamic(world: &World, random: &mut Random) -> Option<BodyId> {
    any(random, world.body_ids().filter(|&id| world.kind(id) == BodyKind::Dynamic))
}

/// Returns whether particles are attached to a body.
fn is_worn(world: &World, id: BodyId) -> bool {
    let attached = |group: &particles::ParticleGroup| {
        group.attachments().iter().any(
            |attachment| matches!(attachment.target, particles::AttachmentTarget::Body { body, .. } if body == id),
        )
    };
    world.group_ids().any(|group| attached(world.particles(group)))
}

/// Returns a random kind of joint between two bodies in their current poses.
pub fn joint(world: &World, random: &mut Random, a: BodyId, b: BodyId, at: Vec3) -> JointDef {
    let cone = SwingTwistLimit {
        swing_y: Range::new(-0.5, 0.5),
        swing_z: Range::new(-0.7, 0.3),
        twist: Range::new(-0.3, 0.3),
    };
    let limited = random.unit() < 0.5;
    let kind = match random.index(7) {
        0..3 => JointKind::Ball { limit: limited.then_some(cone) },
        3 => JointKind::Hinge { limit: limited.then_some(Range::new(-0.5, 0.8)) },
        4 => JointKind::Universal { limit: limited.then_some(cone) },
        5 => JointKind::Slider { limit: limited.then_some(Range::new(-0.2, 0.2)) },
        _ => JointKind::Fixed,
    };
    let frame = Transform::new(at, random.rotation());
    let mut def = JointDef::new(a, b, world.transform(a), world.transform(b), frame, kind);
    if random.unit() < 0.3 {
        def.motor = Some(motor(random));
    }
    if random.unit() < 0.2 {
        def.friction_torque = random.range(0.0, 2.0);
    }
    if random.unit() < 0.2 {
        def.strength = Strength { force: random.range(50.0, 2000.0), ..Strength::UNBREAKABLE };
    }
    def
}

fn motor(random: &mut Random) -> Motor {
    if random.unit() < 0.5 {
        Motor::spin(random.range(-3.0, 3.0), 50.0)
    } else {
        Motor::push(random.range(-1.0, 1.0), 500.0)
    }
}

/// Makes one random call, or none.
pub fn act(world: &mut World, random: &mut Random) {
    for id in world.mover_ids().collect::<Vec<_>>() {
        if random.unit() < 0.03 {
            world.set_mover_walk(id, random.in_cube() * Vec3::new(3.0, 0.0, 3.0));
        }
        if random.unit() < 0.02 {
            world.mover_jump(id, 4.0);
        }
    }
    if random.unit() >= BUSY {
        return;
    }
    let _ = match random.index(4) {
        0 => push(world, random),
        1 => change(world, random),
        2 => reshape(world, random),
        _ => join(world, random),
    };
}

/// Pushes, moves, guides or wakes a body.
fn push(world: &mut World, random: &mut Random) -> Option<()> {
    let id = loose(world, random)?;
    let speed = random.range(0.0, 8.0);
    match random.index(9) {
        0 => world.wake(id),
        1 => world.put_to_sleep(id),
        2 => world.apply_impulse_at_center(id, random.in_cube() * 20.0),
        3 => world.set_velocity(
            id,
            Velocity { linear: random.in_cube() * speed, angular: random.in_cube() * speed },
        ),
        4 => world.set_velocity(id, Velocity::default()),
        5 => {
            let at = populate::place(random, 3.0, 3.0);
            world.set_transform(id, Transform::new(at, random.rotation()));
        }
        6 => {
            let pose = world.transform(id);
            world.set_transform(
                id,
                Transform { translation: pose.translation + random.in_cube() * 0.05, ..pose },
            );
        }
        7 => world.explode(&Explosion::new(populate::place(random, 3.0, 1.0), 2.0, 30.0)),
        _ => {
            let led = any(random, world.body_ids().filter(|&id| world.kind(id) == BodyKind::Kinematic))?;
            let to = Transform::new(populate::place(random, 3.0, 2.0), Rotation::IDENTITY);
            world.move_to(led, to, 1.0 + random.unit());
        }
    }
    Some(())
}

/// Adds or removes bodies, or changes their kind, mass or surface.
fn change(world: &mut World, random: &mut Random) -> Option<()> {
    let id = loose(world, random)?;
    match random.index(9) {
        0 | 1 => {
            let at = populate::place(random, 3.0, 3.0);
            world.add_body(&populate::body(random, at));
        }
        2 if !is_worn(world, id) => world.remove_body(id),
        3 if !is_worn(world, id) => {
            world.remove_body(id);
            let at = populate::place(random, 3.0, 3.0);
            world.add_body(&populate::body(random, at));
        }
        4 => {
            let kinds = [BodyKind::Static, BodyKind::Kinematic, BodyKind::Dynamic];
            let solid = world.mass(id).mass > 0.0 || world.kind(id) == BodyKind::Dynamic;
            if solid {
                world.set_kind(id, kinds[random.index(3)]);
            }
        }
        5 if world.kind(id) == BodyKind::Dynamic => {
            let mass = world.mass(id);
            world.set_mass(id, mass.scaled_to(mass.mass * random.range(0.3, 3.0)));
        }
        6 => world.set_gravity_scale(id, random.range(-0.5, 1.5)),
        7 => world.set_gravity(Vec3::new(random.range(-1.0, 1.0), -9.81, 0.0)),
        _ => world.set_quality(id, [None, Some(Quality::Fast), Some(Quality::Exact)][random.index(3)]),
    }
    Some(())
}

/// Adds, removes or changes shapes.
fn reshape(world: &mut World, random: &mut Random) -> Option<()> {
    let id = loose(world, random)?;
    let count = world.shape_ids(id).count();
    let shape = ShapeId { body: id, shape: random.index(count.max(1)) as u32 };
    if count == 0 {
        return None;
    }
    match random.index(8) {
        0 => _ = world.add_shape(id, &populate::shape(random), MassUpdate::Keep),
        1 => world.set_shape(shape, &populate::shape(random), MassUpdate::Keep),
        2 if count > 1 => world.remove_shape(shape, MassUpdate::Keep),
        3 => {
            let sensing = if random.unit() < 0.5 { Sensing::Sensor } else { Sensing::Solid };
            world.set_sensing(shape, sensing);
        }
        4 => {
            let mask = if random.unit() < 0.5 { u32::MAX } else { 2 };
            world.set_filter(shape, Filter { mask, ..world.filter(shape) });
        }
        5 => world.set_contact_rule(shape, populate::rule(random)),
        6 => {
            let friction = random.range(0.0, 1.0);
            world.set_material(shape, Material { friction, ..world.material(shape) });
        }
        _ => world.set_contact_rule(shape, ContactRule::Push),
    }
    Some(())
}

/// Adds, removes or changes joints, pairs and forces.
fn join(world: &mut World, random: &mut Random) -> Option<()> {
    let (a, b) = (dynamic(world, random)?, loose(world, random)?);
    let held = any(random, world.joint_ids());
    match (random.index(10), held) {
        (0 | 1, _) if a != b => {
            let at = (world.center_of_mass(a) + world.center_of_mass(b)) * 0.5;
            if (world.center_of_mass(a) - at).length() < 1.0 {
                let def = joint(world, random, a, b, at);
                world.add_joint(&def);
            }
        }
        (2, Some(held)) => world.remove_joint(held),
        (3, Some(held)) => world.set_motor(held, (random.unit() < 0.7).then(|| motor(random))),
        (4, Some(held)) => {
            let state = if random.unit() < 0.5 { JointState::Enabled } else { JointState::Disabled };
            world.set_joint_state(held, state);
        }
        (5, Some(held)) => world.set_joint_friction(held, random.range(0.0, 2.0)),
        (6, _) if a != b => world.disable_pair(a, b),
        (7, _) if a != b => world.enable_pair(a, b),
        (8, _) => world.set_pair_function((random.unit() < 0.5).then_some(1)),
        (9, _) => match any(random, world.forces_of(a)) {
            Some(force) => world.remove_force(force),
            None => {
                let force = random.in_cube() * 30.0;
                world.add_force(a, &ForceDef { force, ..ForceDef::default() });
            }
        },
        _ => {}
    }
    Some(())
}
