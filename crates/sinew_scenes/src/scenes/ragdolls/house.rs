//! A character falls limp down the steps of a house: on its triangles, or on boxes that replace them.

use super::limp::Limp;
use crate::framework::instance::Instance;
use crate::framework::ragdolls::{bind_pose, placed, ragdoll_of_mannequin};
use crate::framework::scene::{Chapter, Scene};
use crate::framework::setting::{Setting, Setup};
use sinew::formats::TriangleMesh;
use sinew::math::{Rotation, Vec3};
use sinew::physics::cook::{CookOptions, cook};
use sinew::physics::{BodyDef, BodyKind, NearestToShape, Probe, Shape, ShapeDef, World};
use sinew::ragdoll::RagdollDef;

/// Fall of a user's character in front of a user's house; not listed, because it needs external files.
pub(in crate::scenes) const HOUSE: Scene = Scene {
    chapter: Chapter::Ragdolls,
    name: "house",
    about: "a limp character moves out of a house's door and falls down its steps",
    steps: 720,
    settings: &[
        Setting::level("file", "the house, a GLB or OBJ; its door leads along +z"),
        Setting::character("rig", "the falling character, a GLB; without it the mannequin"),
        Setting::whole("mesh", 1, (0, 1), "1: the house's triangles; 0: boxes in their place"),
        Setting::number(
            "scale",
            3.0,
            (0.01, 100.0),
            "scale of the house, metres for each of the file's units",
        ),
        Setting::number("height", 0.2, (0.0, 100.0), "height of the start, in the file's units"),
        Setting::number(
            "forward",
            1.03,
            (-100.0, 100.0),
            "position of the start along z, in the file's units; farther for a wide character",
        ),
        Setting::number("speed", 2.0, (0.0, 10.0), "speed in the door, m/s"),
        Setting::number("impulse", 60.0, (0.0, 500.0), "forward push on its chest during the fall, N·s"),
    ],
    build: house,
};

fn house(setup: &Setup<'_>) -> Instance {
    let mut world = setup.world();
    let scale = setup.number("scale");
    let level = setup.level();
    let positions = level.positions.iter().map(|&p| p * scale).collect();
    let level = TriangleMesh { positions, ..level.clone() };
    for body in bodies(&level, setup.whole("mesh") == 1) {
        world.add_body(&body);
    }
    let ground = vec![ShapeDef::new(Shape::HalfSpace)];
    world.add_body(&BodyDef { kind: BodyKind::Static, shapes: ground, ..BodyDef::default() });
    let def = setup.character().cloned().unwrap_or_else(ragdoll_of_mannequin);
    let place = Vec3::new(0.0, setup.number("height"), setup.number("forward")) * scale;
    let place = out_of_the_door(&world, &def, place);
    let speed = Vec3::Z * setup.number("speed");
    let mut limp = Limp::spawn_of(def, &mut world, Rotation::IDENTITY, place, speed);
    limp.push = Vec3::Z * setup.number("impulse");
    limp.asleep_within = 10.0;
    Instance::new(world, limp)
}

/// Returns the first position from `place` on along +z where a character in its bind pose has room: otherwise the arms
/// of a wide character would start inside the jambs. Returns `place` if there is none within 2 m.
fn out_of_the_door(world: &World, def: &RagdollDef, place: Vec3) -> Vec3 {
    const ROOM: f32 = 0.03;
    const STRIDE: f32 = 0.05;
    const STRIDES: usize = 40;
    let pose = bind_pose(def);
    let has_room = |place: &Vec3| {
        let mut bodies = def.bodies.iter().zip(placed(def, &pose, Rotation::IDENTITY, *place));
        bodies.all(|(body, at)| {
            let probe = Probe::new(body.shape.clone(), at);
            !world.query().any(&NearestToShape { probe, within: ROOM })
        })
    };
    let mut places = (0..STRIDES).map(|i| place + Vec3::Z * (STRIDE * i as f32));
    places.find(has_room).unwrap_or(place)
}

/// The level as triangles, or as boxes.
fn bodies(level: &TriangleMesh, as_mesh: bool) -> Vec<BodyDef> {
    if as_mesh {
        return vec![level.to_body().expect("a loaded level has triangles")];
    }
    let cooked = cook(&level.positions, &level.triangles, &CookOptions::default(), &mut |_| {});
    cooked.expect("a loaded level has triangles").boxes.iter().map(BodyDef::fixed_box).collect()
}
