//! The plugin without a window: compared with the library alone, and under changes of entities.

use bevy_app::{App, FixedUpdate};
use bevy_ecs::prelude::*;
use bevy_ecs::schedule::{LogLevel, ScheduleBuildSettings};
use bevy_math::{Quat, Vec3};
use bevy_sinew::math::Range;
use bevy_sinew::physics::{BodyDef, BodyKind, UniformGravity, World as PhysicsWorld};
use bevy_sinew::*;
use bevy_time::{Fixed, Time, TimePlugin, TimeUpdateStrategy};
use bevy_transform::components::Transform;
use std::time::Duration;

#[cfg(feature = "characters")]
mod animation;
#[cfg(feature = "characters")]
mod characters;
#[cfg(feature = "diagnostics")]
mod diagnostics;
#[path = "../../examples/door.rs"]
mod door;
#[cfg(feature = "gizmos")]
mod gizmos;
#[cfg(feature = "gltf")]
mod gltf;
#[path = "../../examples/hello.rs"]
mod hello;
#[cfg(feature = "mesh")]
mod mesh;
mod movers;
#[cfg(feature = "picking")]
mod picking;
mod properties;
#[cfg(feature = "reflect")]
mod reflect;

const DT: f32 = 1.0 / 60.0;

#[test]
fn box_falls() {
    hello::main();
}

#[test]
fn mover_goes_through_the_door() {
    door::main();
}

/// Returns an app in which each update is one fixed step.
fn app() -> App {
    let mut app = App::new();
    app.configure_schedules(ScheduleBuildSettings {
        ambiguity_detection: LogLevel::Error,
        ..ScheduleBuildSettings::default()
    });
    app.add_plugins((TimePlugin, SinewPlugin::default()));
    app.insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    app.insert_resource(Interpolation::Off);
    // Bevy's first update has no elapsed time.
    app.update();
    app
}

fn run(app: &mut App, updates: usize) {
    (0..updates).for_each(|_| app.update());
}

fn ball(at: Vec3) -> impl Bundle {
    (RigidBody::Dynamic, Collider::from(Shape::sphere(0.25)), Transform::from_translation(at))
}

fn ground(app: &mut App) -> Entity {
    app.world_mut().spawn((RigidBody::Static, Collider::from(Shape::HalfSpace))).id()
}

fn at(app: &App, entity: Entity) -> Vec3 {
    app.world().get::<Transform>(entity).expect("the entity has this component").translation
}

fn physics(app: &App) -> &Physics {
    app.world().resource::<Physics>()
}

#[test]
fn scene_has_the_same_bits_as_in_the_library() {
    let mut app = app();
    let mut world = PhysicsWorld::new(WorldDef::default());
    let shape =
        |i: usize| if i.is_multiple_of(2) { Shape::sphere(0.25) } else { Shape::cuboid(Vec3::splat(0.2)) };
    let floor = ground(&mut app);
    let mut entities = vec![floor];
    world.add_body(&BodyDef { user_data: floor.to_bits(), ..BodyDef::fixed(Shape::HalfSpace) });
    for i in 0..40 {
        let place = Vec3::new(0.1 * (i % 5) as f32, 0.5 + 0.45 * i as f32, 0.07 * (i % 3) as f32);
        let velocity = Velocity { linear: Vec3::X * 0.1 * i as f32, angular: Vec3::Z };
        let bundle =
            (RigidBody::Dynamic, Collider::from(shape(i)), Transform::from_translation(place), velocity);
        let entity = app.world_mut().spawn(bundle).id();
        entities.push(entity);
        world.add_body(&BodyDef {
            linear_velocity: velocity.linear,
            angular_velocity: velocity.angular,
            user_data: entity.to_bits(),
            ..BodyDef::dynamic(shape(i)).at(place)
        });
    }
    for step in 0..300 {
        app.update();
        world.step();
        assert_eq!(physics(&app).hash(), world.hash(), "step {step}");
    }
    for (entity, id) in entities.into_iter().zip(world.body_ids()) {
        assert_eq!(
            at(&app, entity),
            world.transform(id).translation,
            "the drawn position differs from the body's"
        );
    }
}

/// Returns the resident memory of the process, kB; `None` if the system does not report it.
fn memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmRSS"))?;
    line.split_whitespace().nth(1)?.parse().ok()
}

/// The test runs in a separate process, because memory is counted by process.
#[test]
fn thousand_spawns_per_frame_do_not_leak() {
    const ALONE: &str = "SINEW_TEST_ALONE";
    if std::env::var_os(ALONE).is_none() {
        let mut alone =
            std::process::Command::new(std::env::current_exe().expect("the path of the test is known"));
        alone.args(["--exact", "thousand_spawns_per_frame_do_not_leak", "--nocapture"]);
        assert!(alone.env(ALONE, "1").status().expect("the process starts").success());
        return;
    }
    let mut app = app();
    ground(&mut app);
    let mut alive: Vec<Entity> = Vec::new();
    let mut warm = None;
    for frame in 0..600 {
        for entity in alive.drain(..) {
            app.world_mut().despawn(entity);
        }
        for i in 0..1000 {
            let place = Vec3::new((i % 32) as f32, 0.2 + (frame % 3) as f32, (i / 32) as f32);
            alive.push(app.world_mut().spawn(ball(place)).id());
        }
        app.update();
        assert_eq!(physics(&app).body_ids().count(), 1001, "frame {frame}");
        assert_eq!(physics(&app).len(), 1001, "frame {frame}");
        if frame == 200 {
            warm = memory();
        }
    }
    if let (Some(warm), Some(end)) = (warm, memory()) {
        println!("memory: {warm} kB at frame 200, {end} kB at the end");
        assert!(end < warm + 4000, "memory: {warm} kB at frame 200, {end} kB at the end");
    }
}

#[test]
fn children_follow_their_bodies() {
    let mut app = app();
    let slant = Quat::from_rotation_y(0.7);
    let root = Transform { translation: Vec3::new(3.0, 1.0, 0.0), rotation: slant, scale: Vec3::splat(2.0) };
    let root = app.world_mut().spawn(root).id();
    let wide = Transform { scale: Vec3::new(1.0, 3.0, 1.0), ..Transform::default() };
    let middle = app.world_mut().spawn((wide, ChildOf(root))).id();
    let child = app.world_mut().spawn((ball(Vec3::new(0.5, 2.0, 0.0)), ChildOf(middle))).id();
    // A child body of a body: both move independently.
    let below = app.world_mut().spawn((ball(Vec3::X * 2.0), ChildOf(child))).id();
    let global = |app: &App, entity: Entity| {
        let mut affine =
            app.world().get::<Transform>(entity).expect("the entity has this component").compute_affine();
        let mut of = app.world().get::<ChildOf>(entity).map(ChildOf::parent);
        while let Some(parent) = of {
            affine =
                app.world().get::<Transform>(parent).expect("the entity has this component").compute_affine()
                    * affine;
            of = app.world().get::<ChildOf>(parent).map(ChildOf::parent);
        }
        Vec3::from(affine.translation)
    };
    let start = [global(&app, child), global(&app, below)];
    run(&mut app, 30);
    let fallen = 0.5 * 9.81 * 0.5 * 0.5;
    for (entity, start) in [child, below].into_iter().zip(start) {
        let way = start - global(&app, entity);
        assert!((way - Vec3::Y * fallen).length() < 0.1, "{way}");
        let id = app.world().get::<BodyHandle>(entity).expect("the entity has this component").id();
        let body = physics(&app).transform(id).translation;
        assert!((body - global(&app, entity)).length() < 1e-4);
    }
    // With another parent, and with none, the body keeps its pose.
    for parent in [Some(root), None] {
        let before = global(&app, child);
        match parent {
            Some(parent) => app.world_mut().entity_mut(child).insert(ChildOf(parent)),
            None => app.world_mut().entity_mut(child).remove::<ChildOf>(),
        };
        run(&mut app, 1);
        let way = before - global(&app, child);
        assert!(way.length() < 0.2, "the body moved {way}, more than a step of fall");
    }
}

#[derive(Resource, Default)]
struct Heard(Vec<(&'static str, Entity, Entity)>);

#[test]
fn messages_and_observers_report_the_same() {
    let mut app = app();
    let floor = ground(&mut app);
    let ball = app.world_mut().spawn(ball(Vec3::Y * 2.0)).id();
    app.init_resource::<Heard>();
    app.add_observer(|touch: On<TouchBegan>, mut heard: ResMut<Heard>| {
        heard.0.push(("observed", touch.a, touch.b));
    });
    app.add_observer(|touch: On<TouchEnded>, mut heard: ResMut<Heard>| {
        heard.0.push(("observed the end", touch.a, touch.b));
    });
    app.add_systems(FixedUpdate, |mut read: MessageReader<TouchBegan>, mut heard: ResMut<Heard>| {
        heard.0.extend(read.read().map(|touch| ("read", touch.a, touch.b)));
    });
    run(&mut app, 90);
    app.world_mut().despawn(ball);
    run(&mut app, 2);
    let heard = &app.world().resource::<Heard>().0;
    let due = [("observed", floor, ball), ("read", floor, ball), ("observed the end", floor, ball)];
    assert_eq!(heard, &due);
    assert_eq!(physics(&app).len(), 1, "the body's entity remains in the map");
}

#[test]
fn changes_of_components_reach_the_world() {
    let mut app = app();
    let ball = app.world_mut().spawn((ball(Vec3::Y * 5.0), Velocity::default())).id();
    run(&mut app, 2);
    let id = app.world().get::<BodyHandle>(ball).expect("the entity has this component").id();
    // Changes the position.
    app.world_mut().get_mut::<Transform>(ball).expect("the entity has this component").translation =
        Vec3::X * 7.0;
    run(&mut app, 1);
    assert!((at(&app, ball) - Vec3::X * 7.0).length() < 0.05, "{}", at(&app, ball));
    // Changes the velocity, which gravity then changes in the step.
    app.world_mut().get_mut::<Velocity>(ball).expect("the entity has this component").linear = Vec3::Z * 3.0;
    run(&mut app, 1);
    let velocity = app.world().get::<Velocity>(ball).expect("the entity has this component").linear;
    assert!((velocity - Vec3::new(0.0, -9.81 * DT, 3.0)).length() < 1e-3, "{velocity}");
    // Changes the kind.
    *app.world_mut().get_mut::<RigidBody>(ball).expect("the entity has this component") = RigidBody::Static;
    let before = at(&app, ball);
    run(&mut app, 30);
    assert_eq!((physics(&app).kind(id), at(&app, ball)), (BodyKind::Static, before));
    *app.world_mut().get_mut::<RigidBody>(ball).expect("the entity has this component") = RigidBody::Dynamic;
    // Changes the shapes; the mass follows.
    let light = physics(&app).shape_ids(id).count();
    let shapes = vec![Shape::sphere(0.5).into(), Shape::cuboid(Vec3::splat(0.5)).into()];
    *app.world_mut().get_mut::<Collider>(ball).expect("the entity has this component") = Collider(shapes);
    run(&mut app, 1);
    assert_eq!((light, physics(&app).shape_ids(id).count()), (1, 2));
    let mass = 1000.0 * (1.0 + 4.0 / 3.0 * core::f32::consts::PI * 0.125);
    assert!((physics(&app).mass(id).mass - mass).abs() < 0.5);
    // Removes the body.
    app.world_mut().entity_mut(ball).remove::<RigidBody>();
    run(&mut app, 1);
    assert!(!physics(&app).contains(id) && app.world().get::<BodyHandle>(ball).is_none());
}

#[test]
fn joints_and_fields_are_added_changed_and_removed() {
    let mut app = app();
    let hook = app.world_mut().spawn((RigidBody::Static, Transform::from_xyz(0.0, 3.0, 0.0))).id();
    let bob = app.world_mut().spawn(ball(Vec3::new(1.0, 3.0, 0.0))).id();
    let limit = Some(Range { lo: -0.5, hi: 0.5 });
    let hinge =
        Joint { a: hook, b: bob, anchor: Vec3::Y * 3.0, axis: Vec3::Z, kind: JointKind::Hinge { limit } };
    let hinge = app.world_mut().spawn(hinge).id();
    run(&mut app, 120);
    let sunk = 3.0 - at(&app, bob).y;
    assert!((sunk - math::trig::sin(0.5)).abs() < 0.02, "the slider is not at its limit: {sunk}");
    app.world_mut().get_mut::<Joint>(hinge).expect("the entity has this component").kind =
        JointKind::Hinge { limit: None };
    run(&mut app, 20);
    assert!(3.0 - at(&app, bob).y > 0.6, "the pendulum does not swing further");
    let up = UniformGravity { acceleration: Vec3::Y * 20.0 };
    let field = app.world_mut().spawn(Field(FieldDef::new(FieldKind::Uniform(up)))).id();
    app.world_mut().despawn(hinge);
    let before = at(&app, bob).y;
    run(&mut app, 90);
    assert!(at(&app, bob).y > before + 2.0, "it flies");
    app.world_mut().despawn(field);
    app.world_mut().despawn(hook);
    run(&mut app, 1);
    let physics = physics(&app);
    assert_eq!((physics.field_ids().count(), physics.joint_ids().count(), physics.len()), (0, 0, 1));
}

#[test]
fn interpolated_poses_lie_between_two_steps() {
    let mut app = app();
    app.insert_resource(Interpolation::On);
    let frame = Duration::from_nanos(16_666_667 / 4);
    app.insert_resource(TimeUpdateStrategy::ManualDuration(frame));
    let rise = Velocity { linear: Vec3::X * 6.0, angular: Vec3::ZERO };
    let ball = app.world_mut().spawn((ball(Vec3::ZERO), rise)).id();
    run(&mut app, 40);
    let mut last = at(&app, ball).x;
    for _ in 0..40 {
        app.update();
        let way = at(&app, ball).x - last;
        last = at(&app, ball).x;
        assert!((way - 6.0 * DT / 4.0).abs() < 1e-3, "unequal motion per frame: {way}");
    }
    assert_eq!(app.world().resource::<Time<Fixed>>().timestep(), Duration::from_nanos(16_666_667));
}

#[test]
fn user_systems_run_between_the_sets() {
    let mut app = app();
    let ball = app.world_mut().spawn(ball(Vec3::Y)).id();
    app.init_resource::<Heard>();
    let before = move |physics: Res<Physics>, mut heard: ResMut<Heard>| {
        heard.0.push((if physics.is_empty() { "none" } else { "one" }, ball, ball));
    };
    app.add_systems(bevy_app::FixedPostUpdate, before.before(PhysicsSystems::Prepare));
    app.add_systems(
        bevy_app::FixedPostUpdate,
        (move |physics: Res<Physics>, mut heard: ResMut<Heard>| {
            heard.0.push((if physics.step_count() == 0 { "not yet" } else { "late" }, ball, ball));
        })
        .after(PhysicsSystems::Prepare)
        .before(PhysicsSystems::Step),
    );
    run(&mut app, 1);
    let heard: Vec<&str> = app.world().resource::<Heard>().0.iter().map(|heard| heard.0).collect();
    assert_eq!(heard, ["one", "not yet"]);
}
