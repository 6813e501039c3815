//! Getting up where the floor is not level.

use crate::actor::{floor, shared, walker};
use sinew_anim::local_to_model;
use sinew_math::{Rotation, Transform, Vec3, max, min};
use sinew_physics::ray::Ray;
use sinew_physics::{BodyDef, BodyKind, BodyKinds, QueryFilter, Shape, ShapeDef, World, WorldDef};
use sinew_ragdoll::{Character, CharacterDef, State};
use std::sync::Arc;

fn fixed(half_extents: Vec3, position: Vec3, rotation: Rotation) -> BodyDef {
    let shapes = vec![ShapeDef::new(Shape::Box { half_extents })];
    BodyDef { kind: BodyKind::Static, position, rotation, shapes, ..BodyDef::default() }
}

/// A plane that falls toward +Z.
fn slope(degrees: f32) -> Vec<BodyDef> {
    let turn = Rotation::from_axis_angle(Vec3::X, degrees.to_radians());
    vec![fixed(Vec3::new(20.0, 1.0, 20.0), turn * Vec3::NEG_Y, turn)]
}

/// Steps of 17 by 30 cm that go down toward +Z.
fn stairs() -> Vec<BodyDef> {
    let step = |k: i32| {
        let top = -0.17 * k as f32;
        fixed(Vec3::new(10.0, 1.0, 0.15), Vec3::new(0.0, top - 1.0, 0.3 * k as f32), Rotation::IDENTITY)
    };
    (-20..20).map(step).collect()
}

fn height(world: &World, at: Vec3) -> f32 {
    let ray = Ray { origin: Vec3::new(at.x, at.y + 1.0, at.z), direction: Vec3::Y * -10.0 };
    let hit = world.query().filter(QueryFilter::of(BodyKinds::STATIC)).first(&ray);
    hit.map_or(f32::NEG_INFINITY, |hit| hit.point.y)
}

/// How deep joints are in the ground while it gets up, at most, and how high its lower foot is over it; metres.
fn gets_up(def: &Arc<CharacterDef>, ground: &[BodyDef], push: Vec3) -> [f32; 2] {
    let mut world = World::new(WorldDef::default());
    ground.iter().for_each(|body| {
        world.add_body(body);
    });
    let mut character = Character::new(def.clone(), Transform::IDENTITY, 0.2);
    character.hit(&mut world, def.body_named("chest").expect("it has a chest"), push);
    let joint = |name: &str| def.rig.joints.iter().position(|joint| joint.name == name).expect("a joint");
    let watched =
        ["hips", "head", "leftHand", "rightHand", "leftLowerLeg", "rightLowerLeg", "leftFoot", "rightFoot"];
    let feet = ["leftToes", "rightToes"].map(joint);
    let watched = watched.map(joint);
    let (mut deepest, mut highest, mut rising, mut model) = (0.0, 0.0, 0, Vec::new());
    for _ in 0..900 {
        world.step();
        character.update(&mut world);
        rising = if character.state() == State::GettingUp { rising + 1 } else { 0 };
        // The pose of the bodies has died away.
        if rising > 25 {
            local_to_model(&def.rig, character.pose(), &character.world_from_model(), &mut model);
            let over = |joint: usize| model[joint].translation.y - height(&world, model[joint].translation);
            deepest = watched.iter().fold(deepest, |deepest, &joint| max(deepest, -over(joint)));
        }
        if rising > 120 {
            let over = |joint: usize| model[joint].translation.y - height(&world, model[joint].translation);
            highest = max(highest, min(over(feet[0]), over(feet[1])));
        }
    }
    assert_eq!(character.state(), State::Animated, "it is up");
    [deepest, highest]
}

#[test]
fn nobody_sinks_into_a_slope_or_floats_over_it() {
    let def = shared(walker());
    let grounds =
        [("floor", vec![floor()]), ("10°", slope(10.0)), ("20°", slope(20.0)), ("stairs", stairs())];
    for (name, ground) in grounds {
        let mut worst = [0.0_f32; 2];
        for push in [Vec3::Z * 60.0, Vec3::Z * -60.0, Vec3::X * 60.0, Vec3::new(-40.0, 0.0, 40.0)] {
            let [deepest, highest] = gets_up(&def, &ground, push);
            worst = [max(worst[0], deepest), max(worst[1], highest)];
        }
        println!("{name}: joints {:.3} m deep, lower foot {:.3} m high", worst[0], worst[1]);
        // Who gets up across the edge of a step has both feet over the lower one: nothing bends a leg for it yet.
        let highest = if name == "stairs" { 0.2 } else { 0.15 };
        assert!(worst[0] < 0.15 && worst[1] < highest, "{name}: {worst:?}");
    }
}
