//! Movers, particles, and Bevy's threads.

use super::*;
use bevy_sinew::physics::particles::RopeDef;
use bevy_tasks::{ComputeTaskPool, TaskPoolBuilder};

fn mover(app: &mut App, place: Vec3, walk: Vec3) -> Entity {
    let walk = Walk { velocity: walk, jump: 0.0 };
    app.world_mut().spawn((Mover(MoverDef::default()), walk, Transform::from_translation(place))).id()
}

#[test]
fn movers_have_the_same_bits_as_in_the_library() {
    let mut app = app();
    let mut world = PhysicsWorld::new(WorldDef::default());
    let floor = ground(&mut app);
    world.add_body(&BodyDef { user_data: floor.to_bits(), ..BodyDef::fixed(Shape::HalfSpace) });
    let place = Vec3::new(2.0, 0.25, 0.0);
    let crate_ = app.world_mut().spawn(ball(place)).id();
    let shapes = app.world().get::<Collider>(crate_).expect("the entity has this component").0.clone();
    let def = BodyDef::dynamic(shapes[0].clone()).at(place);
    world.add_body(&BodyDef { user_data: crate_.to_bits(), ..def });
    let place = Vec3::new(0.0, 0.5, 0.0);
    let entity = mover(&mut app, place, Vec3::X * 2.0);
    let id = world.add_mover(&MoverDef { user_data: entity.to_bits(), ..MoverDef::at(place) });
    for step in 0..180 {
        if step == 90 {
            app.world_mut().get_mut::<Walk>(entity).expect("the entity has this component").jump = 4.0;
            world.mover_jump(id, 4.0);
        }
        world.set_mover_walk(id, Vec3::X * 2.0);
        app.update();
        world.step();
        if step == 90 {
            assert!(
                !app.world().get::<MoverState>(entity).expect("the entity has this component").grounded,
                "it jumps"
            );
        }
        assert_eq!(physics(&app).hash(), world.hash(), "step {step}");
        assert_eq!(at(&app, entity), world.mover(id).position());
    }
    assert!(
        at(&app, entity).x > 4.0 && at(&app, crate_).x > 3.0,
        "the mover did not walk or did not push the crate"
    );
}

#[test]
fn movers_teleport_crouch_and_despawn() {
    let mut app = app();
    ground(&mut app);
    let entity = mover(&mut app, Vec3::ZERO, Vec3::ZERO);
    run(&mut app, 5);
    app.world_mut().get_mut::<Transform>(entity).expect("the entity has this component").translation =
        Vec3::X * 9.0;
    app.world_mut().get_mut::<Mover>(entity).expect("the entity has this component").0.height = 1.0;
    run(&mut app, 2);
    let id = app.world().get::<MoverHandle>(entity).expect("the entity has this component").id();
    assert!((at(&app, entity) - Vec3::X * 9.0).length() < 0.01);
    assert_eq!(physics(&app).mover(id).def().height, 1.0);
    app.world_mut().entity_mut(entity).remove::<Mover>();
    run(&mut app, 1);
    assert!(!physics(&app).contains_mover(id) && app.world().get::<MoverHandle>(entity).is_none());
}

#[test]
fn rope_attached_to_entities_is_removed_with_them() {
    let mut app = app();
    let top = Vec3::Y * 3.0;
    let hook = app.world_mut().spawn((RigidBody::Static, Transform::from_translation(top))).id();
    let load = app.world_mut().spawn(ball(Vec3::new(1.25, 3.0, 0.0))).id();
    let to = top + Vec3::X;
    let rope = RopeDef { from: top, to, links: 10, mass: 0.1, stiffness: 1e5, radius: 0.01 }.build();
    let hangs = vec![
        Hang { particle: rope.first, body: hook, point: Vec3::ZERO },
        Hang { particle: rope.last, body: load, point: Vec3::X * -0.25 },
    ];
    let rope = app.world_mut().spawn(Particles { def: rope.group, hangs }).id();
    run(&mut app, 60);
    let reach = (at(&app, load) - top).length();
    assert!((1.1..1.4).contains(&reach) && at(&app, load).y < 2.8, "it swings: {reach}");
    let id = app.world().get::<ParticlesHandle>(rope).expect("the entity has this component").id();
    assert_eq!(physics(&app).group_ids().collect::<Vec<_>>(), [id]);
    app.world_mut().despawn(hook);
    run(&mut app, 1);
    assert_eq!(physics(&app).group_ids().count(), 0, "particles remain although their body is removed");
    app.world_mut().despawn(rope);
    run(&mut app, 1);
}

#[test]
fn bevys_threads_do_not_change_the_bits() {
    ComputeTaskPool::get_or_init(|| TaskPoolBuilder::new().num_threads(3).build());
    let hashes = [StepThreads::Bevy, StepThreads::One].map(|threads| {
        let mut app = app();
        app.insert_resource(threads);
        ground(&mut app);
        for i in 0..120 {
            let place = Vec3::new((i % 10) as f32, 0.25 + (i / 50) as f32 * 0.6, (i / 10 % 5) as f32) * 0.7;
            app.world_mut().spawn(ball(place));
        }
        run(&mut app, 90);
        physics(&app).hash()
    });
    assert_eq!(hashes[0], hashes[1]);
}
