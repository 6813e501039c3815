//! Characters: compared with the library alone, on the joints of a scene, and after removal.

use super::*;
use bevy_sinew::sinew::anim::{Rig, local_to_model};
use bevy_sinew::sinew::mannequin;
use bevy_sinew::sinew::ragdoll::{Character, CharacterDef, CharacterEvent, State};
use std::sync::Arc;

#[path = "../../examples/character.rs"]
mod character;
#[path = "../../examples/crowd.rs"]
mod crowd;
#[path = "../../examples/shooter.rs"]
mod shooter;

#[test]
fn character_falls_and_gets_up() {
    character::main();
}

#[test]
fn target_flinches_and_falls() {
    shooter::main();
}

#[test]
fn crowd_detail_follows_distance() {
    crowd::main();
}

/// Spawns the joints of a rig as entities, like a loader; a mesh of the same name stands before each joint's
/// children.
pub fn scene(app: &mut App, root: Entity, rig: &Rig) -> Vec<Entity> {
    let mut joints: Vec<Entity> = Vec::new();
    for joint in &rig.joints {
        let parent = joint.parent.map_or(root, |parent| joints[parent]);
        let name = Name::new(joint.name.clone());
        joints.push(app.world_mut().spawn((name, Transform::default(), ChildOf(parent))).id());
    }
    joints
}

fn hero(app: &mut App, def: &Arc<CharacterDef>, place: Vec3) -> Entity {
    app.world_mut().spawn((CharacterBody(def.clone()), Transform::from_translation(place))).id()
}

fn handle(app: &App, entity: Entity) -> &CharacterHandle {
    app.world().get::<CharacterHandle>(entity).expect("the entity has this component")
}

fn hit(app: &mut App, entity: Entity, impulse: Vec3) {
    app.world_mut().resource_scope(|world, mut physics: Mut<Physics>| {
        let mut handle = world.get_mut::<CharacterHandle>(entity).expect("the entity has this component");
        let chest = handle.def().body_named("chest").expect("the character has this body");
        handle.hit(&mut physics, chest, impulse);
    });
}

#[test]
fn characters_have_the_same_bits_as_in_the_library() {
    let mut app = app();
    let mut world = PhysicsWorld::new(WorldDef::default());
    let floor = ground(&mut app);
    world.add_body(&BodyDef { user_data: floor.to_bits(), ..BodyDef::fixed(Shape::HalfSpace) });
    let def = Arc::new(mannequin::character());
    let places = [Vec3::ZERO, Vec3::X * 2.0];
    let entities = places.map(|place| hero(&mut app, &def, place));
    let mut characters = places.map(|place| {
        let at = math::Transform::from_translation(place);
        Character::spawn(&mut world, &def, at)
    });
    let mut fell = false;
    for step in 0..400 {
        fell |= characters[1].state() == State::Limp;
        if step == 60 {
            hit(&mut app, entities[1], Vec3::new(60.0, 0.0, -60.0));
            let chest = def.body_named("chest").expect("the character has this body");
            characters[1].hit(&mut world, chest, Vec3::new(60.0, 0.0, -60.0));
        }
        app.update();
        world.step();
        characters.iter_mut().for_each(|character| character.update(&mut world));
        assert_eq!(physics(&app).hash(), world.hash(), "step {step}");
        for (entity, character) in entities.iter().zip(&characters) {
            assert_eq!(handle(&app, *entity).pose(), character.pose(), "step {step}");
        }
    }
    assert_eq!(handle(&app, entities[0]).state(), State::Animated);
    assert!(fell, "the other character never fell");
}

#[test]
fn scene_joints_follow_the_pose() {
    let mut app = app();
    ground(&mut app);
    let def = Arc::new(mannequin::character());
    let entity = hero(&mut app, &def, Vec3::new(1.0, 0.0, 2.0));
    run(&mut app, 3);
    // The scene is added after the character.
    let joints = scene(&mut app, entity, &def.rig);
    run(&mut app, 30);
    let found = &app.world().get::<CharacterJoints>(entity).expect("the joints were found").0;
    assert_eq!(found, &joints.iter().copied().map(Some).collect::<Vec<_>>());
    hit(&mut app, entity, Vec3::Z * -120.0);
    run(&mut app, 30);
    assert_eq!(handle(&app, entity).state(), State::Limp);
    // Compares matrices from the joints' own transforms with the skinning matrices of the character.
    let character = handle(&app, entity);
    let root = character.world_from_model();
    let mut model = Vec::new();
    local_to_model(&def.rig, character.pose(), &root, &mut model);
    for (index, &joint) in joints.iter().enumerate() {
        let mut global =
            app.world().get::<Transform>(joint).expect("the entity has this component").compute_affine();
        let mut of = app.world().get::<ChildOf>(joint).map(ChildOf::parent);
        while let Some(parent) = of {
            global =
                app.world().get::<Transform>(parent).expect("the entity has this component").compute_affine()
                    * global;
            of = app.world().get::<ChildOf>(parent).map(ChildOf::parent);
        }
        let off = (Vec3::from(global.translation) - model[index].translation).length();
        assert!(off < 1e-4, "{}: {off} m", def.rig.joints[index].name);
    }
}

#[test]
fn characters_teleport_report_and_despawn() {
    let mut app = app();
    ground(&mut app);
    app.init_resource::<Heard>();
    app.add_observer(|told: On<CharacterTold>, mut heard: ResMut<Heard>| {
        if told.event == CharacterEvent::WentLimp {
            heard.0.push(("limp", told.character, told.character));
        }
    });
    let def = Arc::new(mannequin::character());
    let entity = hero(&mut app, &def, Vec3::ZERO);
    run(&mut app, 5);
    let limb = handle(&app, entity).bodies()[0];
    assert_eq!(physics(&app).entity(limb), Some(entity));
    app.world_mut().get_mut::<Transform>(entity).expect("the entity has this component").translation =
        Vec3::X * 5.0;
    run(&mut app, 1);
    let place = handle(&app, entity).world_from_character().translation;
    assert!((place - Vec3::X * 5.0).length() < 0.1, "{place}");
    hit(&mut app, entity, Vec3::Z * -120.0);
    run(&mut app, 2);
    assert_eq!(app.world().resource::<Heard>().0, [("limp", entity, entity)]);
    app.world_mut().despawn(entity);
    run(&mut app, 1);
    let physics = physics(&app);
    let left = (physics.body_ids().count(), physics.joint_ids().count(), physics.mover_ids().count());
    assert_eq!(left, (1, 0, 0), "only the ground may remain");
    assert_eq!(physics.entity(limb), None);
}
