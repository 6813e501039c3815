//! NaN and infinity in any number of any setter of the world cause a panic and leave the world unchanged.

use crate::build::{ball, box_body, floor, sphere_body};
use core::panic::AssertUnwindSafe;
use sinew_math::{Range, Rotation, Sym3, Transform, Vec3};
use sinew_physics::particles::{AttachmentDef, AttachmentTarget, GroupDef, ParticleDef, SpringDef};
use sinew_physics::*;

const BAD: [f32; 3] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];

/// A world with one object of each kind.
struct Fixture {
    world: World,
    body: BodyId,
    other: BodyId,
    joint: JointId,
    group: GroupId,
    force: ForceId,
    field: FieldId,
}

impl Fixture {
    fn new() -> Self {
        let mut world = World::new(WorldDef::default());
        floor(&mut world);
        let body = world.add_body(&box_body(Vec3::splat(0.2), Vec3::Y));
        let other = world.add_body(&sphere_body(0.2, Vec3::Y * 2.0));
        let joint = world.add_joint(&ball(&world, body, other, Vec3::Y * 1.5));
        let group = world.add_particles(&particles());
        let force = world.add_force(body, &ForceDef::default());
        let uniform = FieldKind::Uniform(UniformGravity::default());
        let field = world.add_field(&FieldDef::new(uniform));
        world.step();
        Self { world, body, other, joint, group, force, field }
    }
}

fn particles() -> GroupDef {
    let at = |x: f32| ParticleDef { position: Vec3::X * x, velocity: Vec3::ZERO, mass: 0.1, radius: 0.01 };
    GroupDef {
        particles: vec![at(3.0), at(4.0)],
        springs: vec![SpringDef { damping: 1.0, ..SpringDef::new([0, 1], 1.0, 100.0) }],
        attachments: vec![AttachmentDef { particle: 0, target: AttachmentTarget::World(Vec3::X * 3.0) }],
        ..GroupDef::default()
    }
}

/// Checks that `act` panics with each of the numbers and leaves the world unchanged.
fn refuses(what: &str, bad: &[f32], act: impl Fn(&mut Fixture, f32)) {
    for &x in bad {
        let mut fixture = Fixture::new();
        let before = fixture.world.hash();
        let result = std::panic::catch_unwind(AssertUnwindSafe(|| act(&mut fixture, x)));
        assert!(result.is_err(), "setting {what} to {x} must panic");
        assert_eq!(fixture.world.hash(), before, "setting {what} to {x} must not change the world");
    }
}

/// Checks that `act` panics with each bad number in each component of a vector, and leaves the world unchanged.
fn refuses_in(what: &str, act: impl Fn(&mut Fixture, Vec3)) {
    for k in 0..3 {
        refuses(what, &BAD, |fixture, x| {
            let mut v = Vec3::ONE;
            v[k] = x;
            act(fixture, v);
        });
    }
}

/// Checks that `act` panics with each bad number in a pose, and leaves the world unchanged.
fn refuses_pose(what: &str, act: impl Fn(&mut Fixture, Transform)) {
    refuses_in(what, |f, v| act(f, Transform::from_translation(v)));
    refuses(what, &BAD, |f, x| {
        act(f, Transform::new(Vec3::ZERO, Rotation::from_xyzw(0.0, x, 0.0, 1.0)));
    });
}

#[test]
fn world_definitions_refuse_nonfinite_numbers() {
    let world = |change: &dyn Fn(&mut WorldDef, f32)| {
        for x in BAD {
            let mut def = WorldDef::default();
            change(&mut def, x);
            assert!(
                std::panic::catch_unwind(|| World::new(def)).is_err(),
                "a world must refuse the number {x}"
            );
        }
    };
    world(&|def, x| def.gravity.y = x);
    world(&|def, x| def.max_speed = x);
    world(&|def, x| def.max_turn = x);
}

#[test]
fn body_setters_refuse_nonfinite_numbers() {
    let add = |f: &mut Fixture, change: &dyn Fn(&mut BodyDef)| {
        let mut def = box_body(Vec3::splat(0.2), Vec3::Y);
        change(&mut def);
        f.world.add_body(&def);
    };
    refuses_in("position", |f, v| add(f, &|def| def.position = v));
    refuses_in("linear velocity", |f, v| add(f, &|def| def.linear_velocity = v));
    refuses_in("angular velocity", |f, v| add(f, &|def| def.angular_velocity = v));
    refuses("rotation", &BAD, |f, x| add(f, &|def| def.rotation = Rotation::from_xyzw(x, 0.0, 0.0, 1.0)));
    refuses("linear damping", &BAD, |f, x| add(f, &|def| def.linear_damping = x));
    refuses("angular damping", &BAD, |f, x| add(f, &|def| def.angular_damping = x));
    refuses("gravity scale", &BAD, |f, x| add(f, &|def| def.gravity_scale = x));
    refuses_pose("a shape's pose", |f, pose| add(f, &|def| def.shapes[0].body_from_shape = pose));
    refuses_in("box", |f, half_extents| add(f, &|def| def.shapes[0].shape = Shape::Box { half_extents }));
    refuses("ball", &BAD, |f, radius| add(f, &|def| def.shapes[0].shape = Shape::Sphere { radius }));
    refuses("capsule", &BAD, |f, radius| {
        add(f, &|def| def.shapes[0].shape = Shape::Capsule { half_height: 1.0, radius });
    });
    refuses("capsule's height", &BAD, |f, half_height| {
        add(f, &|def| def.shapes[0].shape = Shape::Capsule { half_height, radius: 1.0 });
    });
    refuses("density", &BAD, |f, x| add(f, &|def| def.shapes[0].density = x));
    refuses("friction", &BAD, |f, x| add(f, &|def| def.shapes[0].material.friction = x));
    refuses("restitution", &BAD, |f, x| add(f, &|def| def.shapes[0].material.restitution = x));
    refuses("rolling", &BAD, |f, x| add(f, &|def| def.shapes[0].material.rolling = x));
    let mass = |mass: f32, center: Vec3, diagonal: Vec3| {
        let inertia = Sym3::from_diagonal(diagonal);
        Some(MassProperties { mass, center, inertia })
    };
    for kind in [BodyKind::Dynamic, BodyKind::Kinematic, BodyKind::Static] {
        refuses("mass", &BAD, |f, x| {
            add(f, &|def| (def.kind, def.mass) = (kind, mass(x, Vec3::ZERO, Vec3::ONE)));
        });
        refuses_in("centre of mass", |f, v| {
            add(f, &|def| (def.kind, def.mass) = (kind, mass(1.0, v, Vec3::ONE)));
        });
        refuses_in("inertia", |f, v| add(f, &|def| (def.kind, def.mass) = (kind, mass(1.0, Vec3::ZERO, v))));
    }
    refuses_pose("set_transform", |f, pose| f.world.set_transform(f.body, pose));
    refuses_in("set_velocity", |f, linear| {
        f.world.set_velocity(f.body, Velocity { linear, angular: Vec3::ZERO });
    });
    refuses_in("set_velocity", |f, angular| {
        f.world.set_velocity(f.body, Velocity { linear: Vec3::ZERO, angular });
    });
}

#[test]
fn forces_and_impulses_refuse_nonfinite_numbers() {
    refuses_in("apply_impulse", |f, v| f.world.apply_impulse(f.body, v, Vec3::ZERO));
    refuses_in("apply_impulse at", |f, v| f.world.apply_impulse(f.body, Vec3::X, v));
    refuses_in("apply_impulse_at_center", |f, v| f.world.apply_impulse_at_center(f.body, v));
    refuses_in("apply_angular_impulse", |f, v| f.world.apply_angular_impulse(f.body, v));
    refuses_in("apply_force", |f, v| f.world.apply_force(f.body, v, Vec3::ZERO));
    refuses_in("apply_force at", |f, v| f.world.apply_force(f.body, Vec3::X, v));
    refuses_in("apply_force_at_center", |f, v| f.world.apply_force_at_center(f.body, v));
    refuses_in("apply_torque", |f, v| f.world.apply_torque(f.body, v));
    let lasting = |f: &mut Fixture, def: ForceDef| {
        let added = std::panic::catch_unwind(AssertUnwindSafe(|| f.world.add_force(f.body, &def)));
        assert!(added.is_err(), "add_force must refuse {def:?}");
        f.world.set_force(f.force, &def);
    };
    refuses_in("force", |f, force| lasting(f, ForceDef { force, ..ForceDef::default() }));
    refuses_in("torque", |f, torque| lasting(f, ForceDef { torque, ..ForceDef::default() }));
    refuses_in("point", |f, v| lasting(f, ForceDef { point: Some(v), ..ForceDef::default() }));
    let hit = |f: &mut Fixture, mass: f32, velocity: Vec3, point: Vec3| {
        f.world.apply_bullet_impact(f.body, mass, velocity, point);
    };
    refuses("apply_bullet_impact", &[f32::NAN, f32::INFINITY, 0.0, -1.0], |f, x| {
        hit(f, x, Vec3::X, Vec3::ZERO);
    });
    refuses_in("apply_bullet_impact at a speed", |f, v| hit(f, 1.0, v, Vec3::ZERO));
    refuses_in("apply_bullet_impact at", |f, v| hit(f, 1.0, Vec3::X, v));
    let blast = |f: &mut Fixture, change: &dyn Fn(&mut Explosion)| {
        let mut explosion = Explosion::new(Vec3::ZERO, 5.0, 10.0);
        change(&mut explosion);
        f.world.explode(&explosion);
    };
    refuses_in("explosion", |f, v| blast(f, &|it| it.center = v));
    refuses("an explosion's radius", &BAD, |f, x| blast(f, &|it| it.radius = x));
    refuses("an explosion's impulse", &BAD, |f, x| blast(f, &|it| it.impulse = x));
}

#[test]
fn field_setters_refuse_nonfinite_numbers() {
    let set = |f: &mut Fixture, kind: FieldKind| {
        let def = FieldDef::new(kind);
        let added = std::panic::catch_unwind(AssertUnwindSafe(|| f.world.add_field(&def)));
        assert!(added.is_err(), "add_field must refuse {def:?}");
        f.world.set_field(f.field, &def);
    };
    refuses_in("uniform", |f, acceleration| set(f, FieldKind::Uniform(UniformGravity { acceleration })));
    let point = PointGravity::default();
    refuses_in("centre", |f, center| set(f, FieldKind::Point(PointGravity { center, ..point })));
    refuses("strength", &BAD, |f, strength| set(f, FieldKind::Point(PointGravity { strength, ..point })));
    refuses("softening", &BAD, |f, softening| set(f, FieldKind::Point(PointGravity { softening, ..point })));
    let mutual = MutualGravity::default();
    refuses("G", &BAD, |f, constant| set(f, FieldKind::Mutual(MutualGravity { constant, ..mutual })));
    refuses("ε", &BAD, |f, softening| set(f, FieldKind::Mutual(MutualGravity { softening, ..mutual })));
    let wind = Wind::default();
    refuses_in("wind", |f, velocity| set(f, FieldKind::Wind(Wind { velocity, ..wind })));
    refuses("density", &BAD, |f, density| set(f, FieldKind::Wind(Wind { density, ..wind })));
    refuses("drag", &BAD, |f, drag| set(f, FieldKind::Wind(Wind { drag, ..wind })));
    refuses("lift", &BAD, |f, lift| set(f, FieldKind::Wind(Wind { lift, ..wind })));
    let blow = |f: &mut Fixture, gusts: Gusts| set(f, FieldKind::Wind(Wind { gusts: Some(gusts), ..wind }));
    let gusts = Gusts { speed: 1.0, length: 1.0, time: 1.0, seed: 0 };
    refuses("gusts", &BAD, |f, speed| blow(f, Gusts { speed, ..gusts }));
    refuses("gusts' length", &BAD, |f, length| blow(f, Gusts { length, ..gusts }));
    refuses("gusts' time", &BAD, |f, time| blow(f, Gusts { time, ..gusts }));
    let drag = Drag::default();
    refuses("linear", &BAD, |f, linear| set(f, FieldKind::Drag(Drag { linear, ..drag })));
    refuses("quadratic", &BAD, |f, quadratic| set(f, FieldKind::Drag(Drag { quadratic, ..drag })));
    refuses("angular", &BAD, |f, angular| set(f, FieldKind::Drag(Drag { angular, ..drag })));
    refuses_in("drag's flow", |f, flow| set(f, FieldKind::Drag(Drag { flow, ..drag })));
    let water = Buoyancy::default();
    refuses_pose("surface", |f, pose| {
        set(f, FieldKind::Buoyancy(Buoyancy { world_from_surface: pose, ..water }));
    });
    refuses("water", &BAD, |f, density| set(f, FieldKind::Buoyancy(Buoyancy { density, ..water })));
    refuses("damping", &BAD, |f, damping| set(f, FieldKind::Buoyancy(Buoyancy { damping, ..water })));
    refuses("drag of water", &BAD, |f, drag| set(f, FieldKind::Buoyancy(Buoyancy { drag, ..water })));
    refuses_in("flow", |f, flow| set(f, FieldKind::Buoyancy(Buoyancy { flow, ..water })));
    refuses("parameters", &BAD, |f, x| {
        f.world.register_field(1, |_, _| Wrench::default());
        let parameters = [x; field::PARAMETERS];
        set(f, FieldKind::Custom { function: 1, parameters });
    });
    let within = |f: &mut Fixture, radius: f32, pose: Transform, margin: f32| {
        let shape = Shape::Sphere { radius };
        let region = Region::Inside { shape, world_from_shape: pose, margin, fade: Fade::Linear };
        let kind = FieldKind::Wind(Wind::default());
        f.world.set_field(f.field, &FieldDef { region, ..FieldDef::new(kind) });
    };
    refuses("a region's shape", &BAD, |f, x| within(f, x, Transform::IDENTITY, 1.0));
    refuses_pose("a region's pose", |f, pose| within(f, 1.0, pose, 1.0));
    refuses("a region's margin", &BAD, |f, x| within(f, 1.0, Transform::IDENTITY, x));
}

#[test]
fn joint_setters_refuse_nonfinite_numbers() {
    // Both adding and setting refuse the number. Caps and ends of ranges may be infinite.
    let set = |f: &mut Fixture, change: &dyn Fn(&mut JointDef)| {
        let mut def = f.world.joint(f.joint);
        change(&mut def);
        let added = std::panic::catch_unwind(AssertUnwindSafe(|| f.world.add_joint(&def)));
        assert!(added.is_err(), "add_joint must refuse {def:?}");
        f.world.set_joint(f.joint, &def);
    };
    let nan = [f32::NAN];
    refuses_pose("frame a", |f, pose| set(f, &|def| def.frame_a = pose));
    refuses_pose("frame b", |f, pose| set(f, &|def| def.frame_b = pose));
    refuses("friction", &BAD, |f, x| set(f, &|def| def.friction_torque = x));
    refuses("friction later", &BAD, |f, x| f.world.set_joint_friction(f.joint, x));
    refuses("strength", &nan, |f, x| set(f, &|def| def.strength.force = x));
    refuses("strength", &nan, |f, x| set(f, &|def| def.strength.torque = x));
    for given in [true, false] {
        let softness = |p: f32, q: f32| match given {
            true => Softness::Stiffness { stiffness: p, damping: q },
            false => Softness::Frequency { hertz: p, damping_ratio: q },
        };
        for soft in [|x: f32| [x, 1.0], |x: f32| [1.0, x]] {
            let of = |x: f32| softness(soft(x)[0], soft(x)[1]);
            refuses("weld", &BAD, |f, x| set(f, &|def| def.weld = Some(of(x))));
            refuses("soft limits", &BAD, |f, x| set(f, &|def| def.limit_softness = Some(of(x))));
            refuses("soft zone", &BAD, |f, x| {
                set(f, &|def| def.soft_zone = Some(SoftZone { width: 0.1, softness: of(x) }));
            });
            refuses("spring", &BAD, |f, x| {
                set(f, &|def| def.spring = Some(Spring { rest: Transform::IDENTITY, softness: of(x) }));
            });
            refuses("motor", &BAD, |f, x| {
                set(f, &|def| def.motor = Some(Motor::toward(Transform::IDENTITY, of(x))));
            });
        }
    }
    let soft = Softness::Frequency { hertz: 1.0, damping_ratio: 1.0 };
    refuses("zone", &BAD, |f, width| set(f, &|def| def.soft_zone = Some(SoftZone { width, softness: soft })));
    refuses_pose("rest", |f, rest| set(f, &|def| def.spring = Some(Spring { rest, softness: soft })));
    for lo in [true, false] {
        let range = |x: f32| if lo { Range { lo: x, hi: 1.0 } } else { Range { lo: 0.0, hi: x } };
        refuses("hinge", &nan, |f, x| set(f, &|def| def.kind = JointKind::Hinge { limit: Some(range(x)) }));
        refuses("slider", &nan, |f, x| set(f, &|def| def.kind = JointKind::Slider { limit: Some(range(x)) }));
        refuses("distance", &nan, |f, x| set(f, &|def| def.kind = JointKind::Distance { range: range(x) }));
        refuses("axis", &nan, |f, x| {
            let six = SixDof { twist: AxisMotion::Limited(range(x)), ..SixDof::FREE };
            set(f, &|def| def.kind = JointKind::SixDof(six));
        });
    }
    let motor = Motor::toward(Transform::IDENTITY, soft);
    refuses_pose("target", |f, target| f.world.set_motor(f.joint, Some(Motor { target, ..motor })));
    refuses_in("rate", |f, linear| {
        let velocity = Velocity { linear, angular: Vec3::ZERO };
        f.world.set_motor(f.joint, Some(Motor { velocity, ..motor }));
    });
    refuses_in("rate", |f, angular| {
        let velocity = Velocity { linear: Vec3::ZERO, angular };
        f.world.set_motor(f.joint, Some(Motor { velocity, ..motor }));
    });
    refuses("cap", &nan, |f, x| f.world.set_motor(f.joint, Some(Motor { max_force: x, ..motor })));
    refuses("cap", &nan, |f, x| f.world.set_motor(f.joint, Some(Motor { max_torque: x, ..motor })));
}

#[test]
fn particle_setters_refuse_nonfinite_numbers() {
    let add = |f: &mut Fixture, change: &dyn Fn(&mut GroupDef)| {
        let mut def = particles();
        change(&mut def);
        f.world.add_particles(&def);
    };
    refuses_in("position", |f, v| add(f, &|def| def.particles[1].position = v));
    refuses_in("velocity", |f, v| add(f, &|def| def.particles[1].velocity = v));
    refuses("mass", &BAD, |f, x| add(f, &|def| def.particles[1].mass = x));
    refuses("radius", &BAD, |f, x| add(f, &|def| def.particles[1].radius = x));
    refuses("rest length", &BAD, |f, x| add(f, &|def| def.springs[0].rest_length = x));
    refuses("stiffness", &BAD, |f, x| add(f, &|def| def.springs[0].stiffness = x));
    refuses("damping", &BAD, |f, x| add(f, &|def| def.springs[0].damping = x));
    refuses("linear damping", &BAD, |f, x| add(f, &|def| def.linear_damping = x));
    refuses("thickness", &BAD, |f, x| add(f, &|def| def.thickness = x));
    refuses("gravity scale", &BAD, |f, x| add(f, &|def| def.gravity_scale = x));
    refuses("friction", &BAD, |f, x| add(f, &|def| def.material.friction = x));
    refuses("restitution", &BAD, |f, x| add(f, &|def| def.material.restitution = x));
    refuses_in("attachment", |f, v| add(f, &|def| def.attachments[0].target = AttachmentTarget::World(v)));
    refuses_in("attachment to a body", |f, point| {
        let target = AttachmentTarget::Body { body: f.other, point };
        add(f, &|def| def.attachments[0].target = target);
    });
    refuses_in("apply_impulse", |f, v| f.world.particles_mut(f.group).apply_impulse(0, v));
}
