//! Random falls for data sets: pose, hit and ground from a seed, the same bits on every machine.

use sinew::anim::{Channel, Clip, Interpolation, LocalTransform, Property, Rig};
use sinew::math::{Random, Transform, Vec3, min};
use sinew::physics::BodyDef;
use sinew::ragdoll::mapping::Physical;
use sinew::ragdoll::quality::{judge_bake, random_ground, random_pose};
use sinew::ragdoll::{
    AfterSettling, BakeHit, BakeInput, Baked, CharacterDef, Locomotion, MotionSet, Verdict, bake,
};
use std::sync::Arc;

/// Options of random falls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FallOptions {
    /// Duration, seconds. Default 3.
    pub seconds: f32,
    /// Frames per second of the clip, at least 1. Default 30.
    pub fps: f32,
    /// Largest impulse of the hit, N·s. Default 120, a shove with both hands.
    pub impulse: f32,
}

impl Default for FallOptions {
    fn default() -> Self {
        Self { seconds: 3.0, fps: 30.0, impulse: 120.0 }
    }
}

/// A random fall and its results.
#[derive(Clone, Debug)]
pub struct RandomFall {
    /// The hit.
    pub hit: BakeHit,
    /// Static bodies onto which the character falls.
    pub ground: Vec<BodyDef>,
    /// Clip, frames, metrics and hash.
    pub baked: Baked,
    /// Verdict on the result: good, usable or bad.
    pub verdict: Verdict,
    /// Reasons for the verdict, one sentence each.
    pub reasons: Vec<String>,
}

/// Drops a character from a random pose within its limits, with a random orientation and its lowest point 1.3 m to 2.5 m above the floor,
/// on random ground. The character gets a random hit within the first half.
///
/// # Panics
/// If an option is not finite or negative, or the frame rate is below 1.
pub fn random_fall(character: &CharacterDef, seed: u64, options: &FallOptions) -> RandomFall {
    let mut random = Random::new(seed);
    let ground = random_ground(&mut random);
    let bodies = random_pose(&character.ragdoll, &mut random);
    let turn = random.rotation();
    let lowest = bodies.iter().zip(&character.ragdoll.bodies).fold(f32::INFINITY, |lowest, (&at, body)| {
        let turned = Transform::new(Vec3::ZERO, turn) * at;
        min(lowest, body.shape.aabb(&turned).min.y)
    });
    let stands = Transform::new(Vec3::Y * (random.range(1.3, 2.5) - lowest), turn);
    let hit = BakeHit {
        time: random.range(0.0, 0.5) * options.seconds,
        body: random.index(bodies.len()),
        impulse: random.direction() * (random.unit() * options.impulse),
    };
    let mut posed = character.clone();
    posed.after_settling = AfterSettling::StayDown;
    let clips = vec![still(character, &bodies)];
    // The pose is used exactly as given, without ground contact.
    let locomotion = Locomotion::Exact;
    let motions = MotionSet { clips, looped: Some(0), locomotion, ..MotionSet::default() };
    posed.set_motions(motions).expect("a pose can be played");
    let baked = bake(&BakeInput {
        world_from_character: stands,
        bodies: &ground,
        hits: &[hit],
        limp_at: Some(0.0),
        seconds: options.seconds,
        fps: options.fps,
        name: "fall",
        ..BakeInput::new(Arc::new(posed))
    });
    let (verdict, reasons) = judge_bake(&baked.quality);
    RandomFall { hit, ground, baked, verdict, reasons }
}

/// Makes a constant clip, with bodies at the given poses in character space.
fn still(character: &CharacterDef, bodies: &[Transform]) -> Clip {
    let rig: &Rig = &character.rig;
    let mut pose: Vec<LocalTransform> = character.rest().to_vec();
    let mut physical = Physical::default();
    physical.rebase(character.mapping(), rig, character.rest());
    physical.pose(character.mapping(), rig, Transform::IDENTITY, bodies, &mut pose);
    let channel = |joint: usize, property: Property, value: &[f32]| Channel {
        joint,
        property,
        interpolation: Interpolation::Linear,
        times: vec![0.0, 1.0],
        values: [value, value].concat(),
    };
    let mut channels = Vec::new();
    for (joint, local) in
        pose.iter().enumerate().filter(|&(joint, _)| character.mapping().moves_bodies(joint))
    {
        let q = local.rotation;
        channels.push(channel(joint, Property::Translation, &local.translation.to_array()));
        channels.push(channel(joint, Property::Rotation, &[q.x, q.y, q.z, q.w]));
    }
    Clip { name: "pose".to_owned(), duration: 1.0, channels }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::embedded;

    #[test]
    fn falls_start_in_their_pose_end_on_their_ground_and_depend_only_on_the_seed() {
        let file = embedded();
        let (ragdoll, _) = file.build(&crate::Wishes::default()).expect("the ragdoll can be built");
        let character =
            file.character(&ragdoll, &crate::Motions::default()).expect("the character has motions");
        let options = FallOptions { seconds: 2.0, ..FallOptions::default() };
        let mut hashes = Vec::new();
        for seed in 0..6 {
            let fall = random_fall(&character, seed, &options);
            let mut due = Vec::new();
            let mut random = Random::new(seed);
            random_ground(&mut random);
            let pose = random_pose(&character.ragdoll, &mut random);
            let first = &fall.baked.frames[0].pose;
            let mapping = character.mapping();
            assert!(mapping.bodies_from_pose(first, Transform::IDENTITY, &mut Vec::new(), &mut due));
            for (body, (due, at)) in due.iter().zip(&pose).enumerate() {
                let off = (due.translation - at.translation).length();
                assert!(off < 2e-3, "fall {seed}: body {body} starts {off} m away from its pose");
            }
            assert_eq!(fall.baked.quality.nan, 0);
            assert!(fall.baked.quality.first_contact_s.is_some(), "fall {seed}: no contact");
            assert_eq!(fall.baked.hash, random_fall(&character, seed, &options).baked.hash);
            hashes.push(fall.baked.hash);
        }
        hashes.dedup();
        assert_eq!(hashes.len(), 6, "seeds differ");
    }
}
