//! Properties of bodies as components: they are applied to the world, follow changes, and leave defaults when
//! removed.

use super::*;
use bevy_sinew::physics::{LockedAxes, Motor, Sensing};

fn body(app: &App, entity: Entity) -> physics::BodyId {
    app.world().get::<BodyHandle>(entity).expect("the entity has this component").id()
}

fn set<T: Component<Mutability = bevy_ecs::component::Mutable>>(app: &mut App, entity: Entity, value: T) {
    *app.world_mut().get_mut::<T>(entity).expect("the entity has this component") = value;
}

#[test]
fn body_is_there_at_once() {
    let mut app = app();
    let ball = app.world_mut().spawn(ball(Vec3::Y * 3.0)).id();
    let id = body(&app, ball);
    assert_eq!(physics(&app).transform(id).translation, Vec3::Y * 3.0);
    app.world_mut().resource_mut::<Physics>().apply_impulse_at_center(id, Vec3::X);
    assert!(physics(&app).velocity(id).linear.x > 0.0);
    // Entities spawned by commands have their bodies when the commands have run.
    app.add_systems(FixedUpdate, |mut commands: Commands, bodies: Query<(), Added<BodyHandle>>| {
        if bodies.iter().count() == 1 {
            commands.spawn(super::ball(Vec3::Y * 9.0));
        }
    });
    run(&mut app, 1);
    assert_eq!(physics(&app).len(), 2);
    // Without the world, the body waits for the next step.
    let physics = app.world_mut().remove_resource::<Physics>().expect("the resource exists");
    let late = app.world_mut().spawn(super::ball(Vec3::Y * 20.0)).id();
    assert!(app.world().get::<BodyHandle>(late).is_none());
    app.world_mut().insert_resource(physics);
    run(&mut app, 1);
    assert!((at(&app, late).y - 20.0).abs() < 0.01);
}

#[test]
fn surfaces_follow_their_components() {
    let mut app = app();
    let parts = (Friction(0.1), Restitution(0.5), Layers { layers: 2, mask: 4 }, Mass(7.0), Sensor);
    let entity = app.world_mut().spawn((ball(Vec3::Y), parts)).id();
    let id = body(&app, entity);
    let shape = |app: &App| {
        let physics = physics(app);
        physics.shape_def(physics.shape_ids(id).next().expect("the body has a shape"))
    };
    run(&mut app, 1);
    let found = shape(&app);
    assert_eq!((found.material.friction, found.material.restitution), (0.1, 0.5));
    assert_eq!((found.filter.layers, found.filter.mask, found.sensing), (2, 4, Sensing::Sensor));
    assert_eq!(physics(&app).mass(id).mass, 7.0);
    set(&mut app, entity, Friction(0.9));
    set(&mut app, entity, Mass(3.0));
    run(&mut app, 1);
    assert_eq!((shape(&app).material.friction, physics(&app).mass(id).mass), (0.9, 3.0));
    app.world_mut().entity_mut(entity).remove::<(Friction, Restitution, Layers, Mass, Sensor)>();
    run(&mut app, 1);
    let plain: physics::ShapeDef = Shape::sphere(0.25).into();
    assert_eq!(shape(&app), plain);
    let due = Shape::sphere(0.25).mass_properties(plain.density).mass;
    assert!((physics(&app).mass(id).mass - due).abs() < 1e-3);
}

#[test]
fn friction_decides_who_slides() {
    let mut app = app();
    ground(&mut app);
    let box_at = |z: f32| {
        let shape = Collider::from(Shape::cuboid(Vec3::splat(0.25)));
        let velocity = Velocity { linear: Vec3::X * 3.0, angular: Vec3::ZERO };
        (RigidBody::Dynamic, shape, Transform::from_xyz(0.0, 0.25, z), velocity)
    };
    let smooth = app.world_mut().spawn((box_at(0.0), Friction(0.0))).id();
    let rough = app.world_mut().spawn((box_at(2.0), Friction(1.0))).id();
    run(&mut app, 120);
    assert!(at(&app, smooth).x > 4.0 && at(&app, rough).x < 1.5);
}

#[test]
fn motion_follows_damping_gravity_and_forces() {
    let mut app = app();
    let fast = Velocity { linear: Vec3::X, angular: Vec3::ZERO };
    let entity = app.world_mut().spawn((ball(Vec3::ZERO), fast, GravityScale(0.0), Damping::default())).id();
    run(&mut app, 60);
    assert!((at(&app, entity) - Vec3::X).length() < 1e-3, "{}", at(&app, entity));
    set(&mut app, entity, Damping { linear: 5.0, angular: 0.0 });
    run(&mut app, 60);
    assert!(at(&app, entity).x < 1.25);
    let mass = physics(&app).mass(body(&app, entity)).mass;
    app.world_mut().entity_mut(entity).remove::<Damping>();
    app.world_mut().entity_mut(entity).insert(ConstantForce { force: Vec3::Z * mass, torque: Vec3::ZERO });
    run(&mut app, 60);
    assert!((at(&app, entity).z - 0.5).abs() < 0.02, "{}", at(&app, entity));
    app.world_mut().entity_mut(entity).remove::<(ConstantForce, GravityScale)>();
    run(&mut app, 60);
    let place = at(&app, entity);
    assert!((place.z - 1.5).abs() < 0.03 && (place.y + 4.9).abs() < 0.2, "{place}");
}

#[test]
fn locked_axes_hold_until_they_are_removed() {
    let mut app = app();
    ground(&mut app);
    let pawn =
        (RigidBody::Dynamic, Collider::from(Shape::capsule(0.5, 0.3)), Transform::from_xyz(0.0, 0.8, 0.0));
    let pawn = app.world_mut().spawn((pawn, Locked(LockedAxes::ROTATIONS))).id();
    run(&mut app, 1);
    let id = body(&app, pawn);
    let push = |app: &mut App| {
        let mut physics = app.world_mut().resource_mut::<Physics>();
        let top = physics.transform(id).translation + Vec3::Y * 0.8;
        physics.apply_impulse(id, Vec3::X * 300.0, top);
    };
    let up = |app: &App| (physics(app).transform(id).rotation * Vec3::Y).y;
    push(&mut app);
    run(&mut app, 60);
    assert!(up(&app) > 0.9999);
    // A body moved by the user is locked at its new position.
    app.world_mut().get_mut::<Transform>(pawn).expect("the entity has this component").translation =
        Vec3::new(5.0, 0.8, 0.0);
    run(&mut app, 30);
    assert!(up(&app) > 0.9999 && at(&app, pawn).x > 4.9);
    app.world_mut().entity_mut(pawn).remove::<Locked>();
    push(&mut app);
    run(&mut app, 60);
    assert!(up(&app) < 0.5 && physics(&app).joint_ids().count() == 0);
}

#[test]
fn joints_have_motors() {
    let mut app = app();
    let frame = app.world_mut().spawn((RigidBody::Static, Transform::default())).id();
    let wheel = app.world_mut().spawn((ball(Vec3::ZERO), GravityScale(0.0))).id();
    let kind = JointKind::Hinge { limit: None };
    let joint = Joint { a: frame, b: wheel, anchor: Vec3::ZERO, axis: Vec3::Z, kind };
    let motor = |speed: f32| JointMotor(Motor::spin(speed, 1000.0));
    let joint = app.world_mut().spawn((joint, motor(4.0))).id();
    run(&mut app, 60);
    let turns = |app: &App| physics(app).velocity(body(app, wheel)).angular.z;
    assert!((turns(&app) - 4.0).abs() < 0.05, "{}", turns(&app));
    set(&mut app, joint, motor(-2.0));
    run(&mut app, 60);
    assert!((turns(&app) + 2.0).abs() < 0.05, "{}", turns(&app));
    app.world_mut().entity_mut(joint).remove::<JointMotor>();
    run(&mut app, 1);
    let id = app.world().get::<JointHandle>(joint).expect("the entity has this component").id();
    assert!(physics(&app).joint(id).motor.is_none());
}

#[test]
fn colliders_below_a_body_are_part_of_it() {
    let mut app = app();
    ground(&mut app);
    let table = Collider::from(Shape::cuboid(Vec3::new(0.5, 0.05, 0.5)));
    let table = app.world_mut().spawn((RigidBody::Dynamic, table, Transform::from_xyz(0.0, 2.0, 0.0))).id();
    let between = app.world_mut().spawn((Transform::from_xyz(0.0, -0.4, 0.0), ChildOf(table))).id();
    let leg = |x: f32, z: f32| {
        (Collider::from(Shape::cuboid(Vec3::new(0.05, 0.35, 0.05))), Transform::from_xyz(x, 0.0, z))
    };
    let legs = [(0.4, 0.4), (0.4, -0.4), (-0.4, 0.4), (-0.4, -0.4)]
        .map(|(x, z)| app.world_mut().spawn((leg(x, z), ChildOf(between))).id());
    run(&mut app, 120);
    let id = body(&app, table);
    assert_eq!(physics(&app).shape_ids(id).count(), 5);
    // Two legs of 0.7 m under the centre of the plate, which is 0.75 m above the ground.
    assert!((at(&app, table).y - 0.75).abs() < 0.01, "{}", at(&app, table));
    let (mass, leg_mass) = (physics(&app).mass(id).mass, 1000.0 * 0.1 * 0.7 * 0.1);
    assert!((mass - (1000.0 * 1.0 * 0.1 * 1.0 + 4.0 * leg_mass)).abs() < 0.1, "{mass}");
    assert_eq!(app.world().get::<ColliderOf>(legs[0]).map(ColliderOf::body), Some(table));
    // One leg is shortened, one is removed, one becomes a body.
    set(&mut app, legs[0], Collider::from(Shape::cuboid(Vec3::new(0.05, 0.3, 0.05))));
    app.world_mut().despawn(legs[1]);
    app.world_mut().entity_mut(legs[2]).insert(RigidBody::Dynamic);
    app.world_mut().entity_mut(legs[3]).remove::<Collider>();
    run(&mut app, 2);
    assert_eq!(physics(&app).shape_ids(id).count(), 2);
    assert!(app.world().get::<ColliderOf>(legs[2]).is_none() && physics(&app).len() == 3);
    app.world_mut().entity_mut(legs[0]).remove::<ChildOf>();
    run(&mut app, 2);
    assert_eq!(physics(&app).shape_ids(id).count(), 1);
}
