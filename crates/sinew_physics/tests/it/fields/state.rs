//! Fields as part of the world's state: snapshots, threads, sleep, memory.

use super::closed_forms::{particle, point_mass, run, weightless};
use crate::build::{box_body, capsule_body, floor, sphere_body};
use sinew_math::{Random, ReadError, Reader, Transform, Vec3, Writer};
use sinew_physics::particles::{AttachmentDef, AttachmentTarget, RopeDef};
use sinew_physics::*;

fn swirl(at: &FieldPoint, parameters: &[f32; field::PARAMETERS]) -> Wrench {
    let turn = Vec3::Y.cross(at.position) * (parameters[0] * at.mass);
    let beat = if at.step.is_multiple_of(40) { parameters[1] } else { 0.0 };
    Wrench { force: turn + Vec3::Y * beat, torque: Vec3::ZERO }
}

/// Returns a world with all kinds of fields, bodies of all shapes within `spread` metres, and a rope.
fn crowded(spread: f32) -> World {
    let mut world = World::new(WorldDef { sleeping: Sleeping::Off, ..WorldDef::default() });
    world.register_field(1, swirl);
    floor(&mut world);
    let mut random = Random::new(21);
    for i in 0..24 {
        let place = random.in_cube() * spread + Vec3::Y * (spread + 1.0);
        let mut def = match i % 3 {
            0 => box_body(Vec3::new(0.1, 0.15, 0.2), place),
            1 => sphere_body(0.15, place),
            _ => capsule_body(0.2, 0.1, place),
        };
        def.shapes[0].density = 400.0;
        def.angular_velocity = random.in_cube();
        let id = world.add_body(&def);
        if i % 5 == 0 {
            world.add_force(id, &ForceDef { force: Vec3::Y * 3.0, ..ForceDef::default() });
        }
    }
    let mut rope = RopeDef {
        from: Vec3::new(0.0, 4.0, 0.0),
        to: Vec3::new(2.0, 4.0, 0.0),
        links: 12,
        mass: 0.3,
        stiffness: 2e3,
        radius: 0.02,
    }
    .build()
    .group;
    let target = AttachmentTarget::World(Vec3::new(0.0, 4.0, 0.0));
    rope.attachments = vec![AttachmentDef { particle: 0, target }];
    world.add_particles(&rope);
    let gusts = Some(Gusts { speed: 5.0, length: 1.0, time: 0.3, seed: 5 });
    let inside = Region::ball(Vec3::Y * 3.0, 3.0, Fade::Smooth);
    let mut parameters = [0.0; field::PARAMETERS];
    parameters[..2].copy_from_slice(&[0.8, 2.0]);
    for kind in [
        FieldKind::Wind(Wind { velocity: Vec3::X * 4.0, lift: 0.5, gusts, ..Wind::default() }),
        FieldKind::Drag(Drag { linear: 0.1, quadratic: 0.01, angular: 0.01, ..Drag::default() }),
        FieldKind::Buoyancy(Buoyancy {
            world_from_surface: Transform::from_translation(Vec3::Y * 0.8),
            ..Buoyancy::default()
        }),
        FieldKind::Mutual(MutualGravity { constant: 0.02, softening: 0.2 }),
        FieldKind::Point(PointGravity { center: Vec3::Y * 2.0, strength: 3.0, softening: 0.5 }),
        FieldKind::Custom { function: 1, parameters },
    ] {
        let region = if matches!(kind, FieldKind::Point(_)) { inside.clone() } else { Region::Everywhere };
        world.add_field(&FieldDef { region, ..FieldDef::new(kind) });
    }
    world
}

fn saved(world: &World) -> Vec<u8> {
    let mut w = Writer::new();
    world.save(&mut w);
    w.into_bytes()
}

#[test]
fn restored_world_with_fields_continues_with_the_same_bits() {
    let mut world = crowded(2.0);
    run(&mut world, 50);
    let bytes = saved(&world);
    let mut copy = World::new(WorldDef::default());
    copy.register_field(1, swirl);
    copy.load(&mut Reader::new(&bytes)).expect("the snapshot must load");
    for step in 0..100 {
        world.step();
        copy.step();
        assert_eq!(copy.hash(), world.hash(), "step {step} after the restore");
    }
    for end in (0..bytes.len()).step_by(41) {
        assert!(copy.load(&mut Reader::new(&bytes[..end])).is_err());
    }
    let error = World::new(WorldDef::default())
        .load(&mut Reader::new(&bytes))
        .expect_err("a world without the function must refuse the snapshot");
    assert!(error.to_string().contains("not registered"), "{error}");
}

#[test]
fn field_results_do_not_depend_on_threads() {
    let hash = |threads: usize| {
        let mut world = crowded(2.0);
        for _ in 0..90 {
            world.step_with(&Threads::new(threads), &stage::NoProfiler);
        }
        world.hash()
    };
    let one = hash(1);
    assert_eq!(hash(2), one);
    assert_eq!(hash(4), one);
}

#[test]
fn a_warm_step_with_fields_allocates_nothing() {
    // The bodies are far apart, so that none meet: another test covers contacts.
    let mut world = crowded(40.0);
    run(&mut world, 20);
    let seen = allocation_counter::measure(|| run(&mut world, 50));
    assert_eq!(seen.count_total, 0, "{seen:?}");
}

#[test]
fn fields_are_added_changed_and_removed() {
    let mut world = weightless();
    let id = world.add_body(&point_mass(1.0, Vec3::ZERO, Vec3::ZERO));
    let along = |acceleration| FieldDef::new(FieldKind::Uniform(UniformGravity { acceleration }));
    let field = world.add_field(&along(Vec3::X));
    run(&mut world, 30);
    world.set_field(field, &along(-Vec3::X));
    assert_eq!(*world.field(field), along(-Vec3::X));
    run(&mut world, 30);
    assert!(world.velocity(id).linear.length() < 1e-5);
    let other = world.add_field(&along(Vec3::Y));
    assert_eq!(world.field_ids().collect::<Vec<_>>(), [field, other]);
    world.remove_field(field);
    assert!(!world.contains_field(field) && world.contains_field(other));
    run(&mut world, 30);
    assert!(world.velocity(id).linear.y > 0.4 && world.velocity(id).linear.x.abs() < 1e-5);
}

/// Returns a box asleep on the floor, 3 m from the origin.
fn sleeper() -> (World, BodyId) {
    let mut world = World::new(WorldDef::default());
    floor(&mut world);
    let id = world.add_body(&box_body(Vec3::splat(0.2), Vec3::new(3.0, 0.2, 0.0)));
    run(&mut world, 120);
    assert!(!world.is_awake(id));
    (world, id)
}

#[test]
fn fields_wake_bodies_in_reach_and_gusts_keep_them_awake() {
    let up = FieldKind::Uniform(UniformGravity { acceleration: Vec3::Y });
    let (mut world, id) = sleeper();
    let region = Region::ball(Vec3::ZERO, 2.0, Fade::None);
    let field = world.add_field(&FieldDef { region, ..FieldDef::new(up) });
    assert!(!world.is_awake(id), "a field out of reach must not wake the body");
    world.set_field(field, &FieldDef::new(up));
    assert!(world.is_awake(id), "a field that reaches the body must wake it");
    run(&mut world, 120);
    assert!(!world.is_awake(id), "a steady field must let the body sleep");
    world.remove_field(field);
    assert!(world.is_awake(id), "a field that is moved to the body must wake it");
    let gusts = Some(Gusts { speed: 1.0, length: 1.0, time: 1.0, seed: 1 });
    let field = world.add_field(&FieldDef::new(FieldKind::Wind(Wind { gusts, ..Wind::default() })));
    run(&mut world, 120);
    assert!(world.is_awake(id), "gusts must keep the body awake");
    world.set_field(field, &FieldDef::new(FieldKind::Wind(Wind::default())));
    run(&mut world, 120);
    assert!(!world.is_awake(id), "still air must let the body sleep");
}

#[test]
fn attracting_bodies_sleep_and_wake_together() {
    let (mut world, id) = sleeper();
    let other = world.add_body(&box_body(Vec3::splat(0.2), Vec3::new(-3.0, 0.2, 0.0)));
    let law = MutualGravity { constant: 1e-3, softening: 0.0 };
    world.add_field(&FieldDef::new(FieldKind::Mutual(law)));
    run(&mut world, 120);
    assert!(!world.is_awake(id) && !world.is_awake(other));
    world.wake(other);
    assert!(world.is_awake(id), "bodies that attract each other must be one island");
    run(&mut world, 120);
    let third = world.add_body(&box_body(Vec3::splat(0.2), Vec3::new(0.0, 0.2, 3.0)));
    world.step();
    assert!(world.is_awake(id) && world.is_awake(third), "a new body must wake those that it attracts");
}

#[test]
fn attached_particles_pass_forces_to_their_body() {
    let mut world = weightless();
    let body = world.add_body(&sphere_body(0.1, Vec3::ZERO));
    let mut def = particle(0.5, 0.0, Vec3::ZERO);
    let target = AttachmentTarget::Body { body, point: Vec3::ZERO };
    def.attachments = vec![AttachmentDef { particle: 0, target }];
    // Only the particle is on this layer.
    def.filter.layers = 4;
    world.add_particles(&def);
    let pull = FieldKind::Uniform(UniformGravity { acceleration: Vec3::X * 100.0 });
    world.add_field(&FieldDef { layers: 4, ..FieldDef::new(pull) });
    run(&mut world, 60);
    let gained = 0.5 * 100.0 * 60.0 * world.def().dt();
    let found = world.velocity(body).linear.x * (world.mass(body).mass + 0.5);
    assert!((found / gained - 1.0).abs() < 1e-3, "the field reports {found}, the body gained {gained}");
}

/// Object that pulls a body along x.
struct Puller {
    body: BodyId,
    force: f32,
}

impl PhysicsObject for Puller {
    fn kind(&self) -> &'static str {
        "puller"
    }

    fn add_forces(&mut self, forces: &mut Forces<'_>) {
        forces.apply_force_at_center(self.body, Vec3::X * self.force);
    }

    fn save(&self, _: &mut Writer) {}

    fn load(&mut self, _: &mut Reader<'_>) -> Result<(), ReadError> {
        Ok(())
    }
}

#[test]
fn fields_objects_and_lasting_forces_add_up() {
    let mut world = weightless();
    let body = world.add_body(&point_mass(2.0, Vec3::ZERO, Vec3::ZERO));
    world.add_object(Box::new(Puller { body, force: 6.0 }));
    let up = UniformGravity { acceleration: Vec3::Y * 3.0 };
    world.add_field(&FieldDef::new(FieldKind::Uniform(up)));
    world.add_force(body, &ForceDef { force: Vec3::Z * 6.0, ..ForceDef::default() });
    run(&mut world, 60);
    let expected = Vec3::splat(3.0 * 60.0 * world.def().dt());
    assert!((world.velocity(body).linear - expected).length() < 1e-4, "{:?}", world.velocity(body));
}
