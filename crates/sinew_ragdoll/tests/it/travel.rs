//! Looped clips with root motion: they continue over cycles, and a fall at any frame starts with the speed of the walk.

use crate::actor::{floor, shared, walker};
use sinew_anim::Property;
use sinew_math::{Transform, Vec3, max};
use sinew_physics::{BodyDef, Shape, World, WorldDef};
use sinew_ragdoll::{Character, CharacterDef, Locomotion, MotionSet};
use sinew_scenes::mannequin::Path;
use sinew_scenes::mannequin::drills::{Cycle, walking};
use std::sync::Arc;

fn world() -> World {
    let mut world = World::new(WorldDef::default());
    world.add_body(&floor());
    world
}

/// Returns the mannequin with a walk whose root moves along a path.
fn travelling(path: Path, locomotion: Locomotion) -> (Arc<CharacterDef>, Cycle) {
    let cycle = walking(path);
    let mut def = walker();
    let mut motions = MotionSet { locomotion, ..def.motions().clone() };
    motions.clips[0] = cycle.clip.clone();
    def.set_motions(motions).expect("the clip can be played");
    (shared(def), cycle)
}

fn places(character: &Character) -> Vec<Vec3> {
    let def = character.def();
    let mut model = Vec::new();
    sinew_anim::local_to_model(&def.rig, character.pose(), &character.world_from_model(), &mut model);
    def.ragdoll.bodies.iter().map(|body| model[body.joint].translation).collect()
}

#[test]
fn travelling_clip_continues_past_its_end() {
    for path in [Path::Straight, Path::Circle(2.0)] {
        let (def, cycle) = travelling(path, Locomotion::ByClip);
        let mut world = world();
        let mut character = Character::new(def.clone(), Transform::IDENTITY, 0.0);
        let (mut last, mut fastest) = (places(&character), 0.0);
        for _ in 0..300 {
            world.step();
            character.update(&mut world);
            let now = places(&character);
            let speeds = now.iter().zip(&last).map(|(a, b)| (*a - *b).length() * 60.0);
            fastest = speeds.fold(fastest, max);
            last = now;
        }
        let way = cycle.speed * 300.0 / 60.0;
        let expected = path.at(way).translation;
        let at = last[0] * Vec3::new(1.0, 0.0, 1.0);
        assert!((at - expected).length() < 0.05, "{path:?}: at {at}, expected {expected}");
        assert!(fastest < 6.0, "{path:?}: a joint moves at {fastest} m/s");
    }
    // Played in place, the character returns to the start of each cycle.
    let (def, cycle) = travelling(Path::Straight, Locomotion::InPlace);
    let mut world = world();
    let mut character = Character::new(def, Transform::IDENTITY, 0.0);
    let laps = (2.0 * cycle.clip.duration * 60.0).round() as usize;
    for _ in 0..laps {
        world.step();
        character.update(&mut world);
    }
    assert!(places(&character)[0].z < cycle.speed * cycle.clip.duration + 0.1);
}

#[test]
fn fall_around_the_seam_keeps_the_walking_speed() {
    for locomotion in [Locomotion::ByClip, Locomotion::InPlace] {
        let (def, cycle) = travelling(Path::Straight, locomotion);
        let total = def.ragdoll.total_mass;
        // Phases are in sixteenths of a frame around the seam, and two are far from it.
        let near = (-24..=24).map(|i| cycle.clip.duration + i as f32 / (16.0 * 60.0));
        for phase in near.chain([0.31, 0.77]) {
            let mut world = world();
            let mut character = Character::new(def.clone(), Transform::IDENTITY, phase);
            character.go_limp(&mut world);
            let bodies = &character.ragdoll().expect("the character is limp").bodies;
            let velocity = |id| world.velocity(id).linear;
            let fastest = bodies.iter().map(|&id| velocity(id).length()).fold(0.0, max);
            assert!(fastest < 5.0, "{locomotion:?} at {phase} s: a joint moves at {fastest} m/s");
            let momentum: Vec3 = bodies.iter().map(|&id| velocity(id) * world.mass(id).mass).sum();
            let speed = momentum.z / total;
            assert!(
                (speed - cycle.speed).abs() < 0.1 * cycle.speed,
                "{locomotion:?} at {phase} s: speed {speed} m/s"
            );
        }
    }
}

/// In the past a capture that begins 5 m from its origin walked 5 m beside its supporting ground.
#[test]
fn clip_that_begins_elsewhere_starts_at_the_place_of_the_character() {
    let at = |beside: Vec3| {
        let cycle = walking(Path::Straight);
        let mut def = walker();
        let mut motions = MotionSet { locomotion: Locomotion::ByClip, ..def.motions().clone() };
        motions.clips[0] = cycle.clip.clone();
        let root = def.rig.joints.iter().position(|joint| joint.parent.is_none());
        let own = motions.clips[0].channels.iter_mut();
        let mut moved =
            own.filter(|channel| Some(channel.joint) == root && channel.property == Property::Translation);
        let values = &mut moved.next().expect("its root moves").values;
        for place in values.chunks_exact_mut(3) {
            place.iter_mut().zip(beside.to_array()).for_each(|(number, by)| *number += by);
        }
        def.set_motions(motions).expect("the clip can be played");
        let mut world = World::new(WorldDef::default());
        // Add a platform of 1 m under the character's position alone.
        world.add_body(&BodyDef {
            position: Vec3::Y * 0.5,
            ..BodyDef::fixed(Shape::Box { half_extents: Vec3::new(2.0, 0.5, 4.0) })
        });
        let mut character = Character::new(shared(def), Transform::from_translation(Vec3::Y), 0.0);
        for _ in 0..60 {
            world.step();
            character.update(&mut world);
        }
        places(&character)
    };
    let (near, far) = (at(Vec3::ZERO), at(Vec3::new(5.0, 0.0, -5.0)));
    let most = near.iter().zip(&far).map(|(a, b)| (*a - *b).length()).fold(0.0, max);
    assert!(most < 0.02, "a joint is {most} m from its target");
}
