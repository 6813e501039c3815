//! Using an id of a removed object or of another world panics with a message that names the id and the caller's place.

use crate::build::sphere_body;
use sinew_math::{Random, Reader, Transform, Vec3, Writer};
use sinew_physics::*;
use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Once;

thread_local! {
    /// File of the last panic of this thread.
    static PLACE: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Returns the message of the panic of `f`, and the source file in which it occurred.
fn panic_of<T>(f: impl FnOnce() -> T) -> (String, String) {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let before = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            PLACE.set(info.location().map_or_else(String::new, |place| place.file().to_owned()));
            before(info);
        }));
    });
    let payload = catch_unwind(AssertUnwindSafe(f)).err().expect("the call must panic");
    let text = payload.downcast_ref::<String>().cloned().expect("the panic's payload is a text");
    (text, PLACE.take())
}

fn world() -> World {
    World::new(WorldDef::default())
}

#[test]
fn removed_ids_panic_at_the_caller() {
    let mut world = world();
    let gone = world.add_body(&sphere_body(0.1, Vec3::ZERO));
    world.remove_body(gone);
    let (text, file) = panic_of(|| world.velocity(gone));
    assert_eq!(text, "BodyId 0v0 was removed");
    assert!(file.ends_with("ids.rs"), "{file}");
    world.add_body(&sphere_body(0.1, Vec3::ZERO));
    assert_eq!(panic_of(|| world.transform(gone)).0, "BodyId 0v0 was removed");
    assert_eq!(panic_of(|| world.apply_impulse(gone, Vec3::X, Vec3::ZERO)).0, "BodyId 0v0 was removed");
    assert!(!world.contains(gone));
}

/// Every method that changes or reads a body names the removed id in its panic.
#[test]
fn every_setter_names_the_removed_id() {
    let mut world = world();
    let gone = world.add_body(&sphere_body(0.1, Vec3::ZERO));
    let other = world.add_body(&sphere_body(0.1, Vec3::X));
    world.remove_body(gone);
    let (pose, shape) = (Transform::IDENTITY, ShapeDef::new(Shape::sphere(0.1)));
    let of_gone = ShapeId { body: gone, shape: 0 };
    type Call<'a> = &'a mut dyn FnMut(&mut World);
    let calls: [Call<'_>; 17] = [
        &mut |w| w.set_linear_damping(gone, 0.1),
        &mut |w| w.set_angular_damping(gone, 0.1),
        &mut |w| w.set_gravity_scale(gone, 0.1),
        &mut |w| w.set_user_data(gone, 1),
        &mut |w| w.set_mass(gone, Shape::sphere(0.1).mass_properties(1.0)),
        &mut |w| w.set_mass_of_shapes(gone),
        &mut |w| w.set_kind(gone, BodyKind::Static),
        &mut |w| w.move_to(gone, pose, 1.0),
        &mut |w| w.lead_all(&[other, gone], &[pose; 2], &[pose; 2], 1.0),
        &mut |w| _ = w.add_shape(gone, &shape, MassUpdate::Keep),
        &mut |w| w.set_shape(of_gone, &shape, MassUpdate::Keep),
        &mut |w| w.remove_shape(of_gone, MassUpdate::Keep),
        &mut |w| drop(w.shape_def(of_gone)),
        &mut |w| _ = w.add_hinge(gone, other, Vec3::ZERO, Vec3::X),
        &mut |w| _ = w.add_fixed(other, gone),
        &mut |w| _ = w.add_ball(gone, other, Vec3::ZERO),
        &mut |w| _ = w.axis_locks(other, gone, LockedAxes::ROTATIONS),
    ];
    for (i, call) in calls.into_iter().enumerate() {
        let (text, file) = panic_of(|| call(&mut world));
        assert_eq!(text, "BodyId 0v0 was removed", "call {i}");
        assert!(file.ends_with("ids.rs"), "call {i}: {file}");
    }
}

/// Setters refuse invalid numbers before they change anything.
#[test]
fn every_setter_refuses_bad_numbers() {
    let mut world = world();
    let ball = world.add_body(&sphere_body(0.1, Vec3::ZERO));
    let other = world.add_body(&sphere_body(0.1, Vec3::X));
    let hash = world.hash();
    let bad = ShapeDef::new(Shape::sphere(-1.0));
    let mass = Shape::sphere(0.1).mass_properties(1.0);
    let (pose, nowhere) = (Transform::IDENTITY, Transform::from_translation(Vec3::NAN));
    type Call<'a> = &'a mut dyn FnMut(&mut World);
    let calls: [Call<'_>; 14] = [
        &mut |w| w.set_linear_damping(ball, f32::NAN),
        &mut |w| w.set_angular_damping(ball, f32::INFINITY),
        &mut |w| w.set_gravity_scale(ball, f32::NAN),
        &mut |w| w.set_mass(ball, MassProperties { mass: 0.0, ..mass }),
        &mut |w| w.set_mass(ball, MassProperties { center: Vec3::NAN, ..mass }),
        &mut |w| w.move_to(ball, nowhere, 1.0),
        &mut |w| w.move_to(ball, pose, 0.0),
        &mut |w| w.lead_all(&[ball], &[nowhere], &[pose], 1.0),
        &mut |w| w.lead_all(&[ball], &[pose], &[pose], -1.0),
        &mut |w| w.lead_all(&[ball, other], &[pose], &[pose], 1.0),
        &mut |w| _ = w.add_shape(ball, &bad, MassUpdate::Keep),
        &mut |w| _ = w.add_hinge(ball, other, Vec3::ZERO, Vec3::ZERO),
        &mut |w| _ = w.add_ball(ball, other, Vec3::NAN),
        &mut |w| _ = w.add_rope(ball, other, Vec3::ZERO, Vec3::X, -1.0),
    ];
    for (i, call) in calls.into_iter().enumerate() {
        assert!(catch_unwind(AssertUnwindSafe(|| call(&mut world))).is_err(), "call {i}");
        assert_eq!(world.hash(), hash, "call {i}");
    }
}

#[test]
fn ids_of_another_world_are_refused() {
    let (mut one, mut other) = (world(), world());
    let mine = one.add_body(&sphere_body(0.1, Vec3::ZERO));
    let theirs = other.add_body(&sphere_body(0.1, Vec3::X));
    let (text, file) = panic_of(|| one.transform(theirs));
    assert_eq!(text, "BodyId 0v0 is of another world");
    assert!(file.ends_with("ids.rs"), "{file}");
    assert!(!one.contains(theirs) && one.contains(mine));
    assert_eq!(panic_of(|| one.remove_body(theirs)).0, "BodyId 0v0 is of another world");
    assert!(one.contains(mine));
    let field = other.add_field(&FieldDef::new(FieldKind::Mutual(MutualGravity::default())));
    assert_eq!(panic_of(|| one.field(field)).0, "FieldId 0v0 is of another world");
}

/// The bits of an id do not contain its world, because games store ids in their own files.
#[test]
fn ids_from_bits_work_in_any_world() {
    let (mut one, mut other) = (world(), world());
    let mine = one.add_body(&sphere_body(0.1, Vec3::ZERO));
    let theirs = other.add_body(&sphere_body(0.1, Vec3::X));
    let bits = BodyId::from_bits(theirs.to_bits());
    assert_eq!(one.transform(bits).translation, Vec3::ZERO);
    assert_eq!(bits, mine);
    assert_eq!(panic_of(|| one.transform(BodyId::from_bits(7))).0, "BodyId 7v0 was never in this world");
}

/// A world that loads the snapshot of another accepts the other's ids, and the hashes are equal.
#[test]
fn world_that_loads_a_snapshot_accepts_the_other_worlds_ids() {
    let (mut one, mut other) = (world(), world());
    let mine = one.add_body(&sphere_body(0.1, Vec3::ZERO));
    let theirs = other.add_body(&sphere_body(0.1, Vec3::ZERO));
    assert_eq!(one.hash(), other.hash());
    let mut bytes = Writer::new();
    other.save(&mut bytes);
    one.load(&mut Reader::new(bytes.as_bytes())).expect("the snapshot must load");
    one.step();
    other.step();
    assert_eq!(one.hash(), other.hash());
    assert_eq!(one.transform(mine), other.transform(theirs));
    assert_eq!(one.transform(theirs), other.transform(theirs));
    one.remove_body(theirs);
    assert_eq!(panic_of(|| one.transform(mine)).0, "BodyId 0v0 was removed");
}

/// A body is removed in the step in which a shape leaves its bounds. Both search for pairs at the same time, and the
/// result must not contain pairs of the removed body.
#[test]
fn removing_a_body_removes_its_pairs() {
    let sensor = |radius: f32| ShapeDef { sensing: Sensing::Sensor, ..ShapeDef::new(Shape::sphere(radius)) };
    let moving = |def: BodyDef, at: Vec3, linear_velocity: Vec3| BodyDef { linear_velocity, ..def }.at(at);
    for seed in 0..200 {
        let mut random = Random::new(seed);
        let mut world = World::new(WorldDef { gravity: Vec3::ZERO, ..WorldDef::default() });
        let mut place = || (random.in_cube() * 0.7, random.in_cube());
        let ((at, way), (its, its_way), (ball_at, ball_way)) = (place(), place(), place());
        let goes = world.add_body(&moving(BodyDef::kinematic(sensor(0.4)), at, way));
        let stays = world.add_body(&moving(BodyDef::dynamic(sensor(0.35)), its, its_way));
        (0..4).for_each(|_| world.step());
        world.add_body(&moving(BodyDef::dynamic(Shape::sphere(0.7)), ball_at, ball_way));
        (0..10).for_each(|_| world.step());
        world.set_velocity(stays, Velocity { linear: random.in_cube() * 4.0, angular: Vec3::ZERO });
        world.remove_body(goes);
        (0..10).for_each(|_| world.step());
        assert!(world.body_ids().all(|id| id != goes));
    }
}
