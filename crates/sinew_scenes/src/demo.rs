//! The demo on the embedded character and world: the mannequin walks out of the cabin, is hit in the back at the top of
//! the stairs, falls down, gets up and walks on. Only the hit is scripted.

use crate::cabin::{Prop, Site};
use crate::mannequin::{Mannequin, mannequin};
use sinew::anim::analyze;
use sinew::math::{Transform, Vec3};
use sinew::physics::BodyDef;
use sinew::ragdoll::{BakeHit, BakeInput, BuildOptions, CharacterDef, Locomotion, MotionSet, build};
use std::sync::Arc;

/// Length in seconds: the walk, the fall, getting up, and a few steps.
const SECONDS: f32 = 10.5;
/// Distance before the edge of the porch at which the mannequin is hit, metres.
const HIT_BEFORE_EDGE: f32 = 0.45;
/// Impulse of the hit in the back, N·s: a shove with both hands.
const IMPULSE: Vec3 = Vec3::new(0.0, 0.0, 110.0);
const HIT_ROLE: &str = "chest";

/// The demo, ready to be simulated or changed.
#[derive(Clone, Debug)]
pub struct Demo {
    /// The mannequin with its walk and both ways to get up.
    pub character: Arc<CharacterDef>,
    /// Transform of the character to the world at its start.
    pub world_from_character: Transform,
    /// Props of the world.
    pub props: Vec<Prop>,
    /// The static bodies of `props`.
    pub bodies: Vec<BodyDef>,
    /// Hits on the mannequin.
    pub hits: Vec<BakeHit>,
}

impl Demo {
    /// Creates the demo in one of the worlds; only [`Site::CabinWithStairs`] has stairs to fall down.
    pub fn new(site: Site) -> Self {
        let (character, walk_speed) = walking_mannequin();
        let (props, spawn) = (site.props(), site.spawn());
        let body = character.body_named(HIT_ROLE).expect("the mannequin has a chest");
        let time = (spawn.walk_length - HIT_BEFORE_EDGE) / walk_speed;
        Self {
            character: Arc::new(character),
            world_from_character: spawn.world_from_character,
            bodies: props.iter().map(|prop| prop.body.clone()).collect(),
            props,
            hits: vec![BakeHit { time, body, impulse: IMPULSE }],
        }
    }

    /// Returns the input of [`bake`](sinew::ragdoll::bake()).
    pub fn input(&self) -> BakeInput<'_> {
        BakeInput {
            world_from_character: self.world_from_character,
            bodies: &self.bodies,
            hits: &self.hits,
            seconds: SECONDS,
            name: "fall",
            ..BakeInput::new(self.character.clone())
        }
    }
}

/// Returns the character and its walking speed, m/s.
pub(crate) fn walking_mannequin() -> (CharacterDef, f32) {
    let Mannequin { rig, clips, motions } = mannequin();
    let analysis = analyze(&rig).expect("the mannequin has a skin");
    let (ragdoll, _) = build(&rig, &analysis, &BuildOptions::default()).expect("the rig can be built");
    let mut character = CharacterDef::new(rig, ragdoll, &analysis.bind_model);
    let speed = motions.walk_speed;
    let motions = MotionSet {
        clips,
        looped: Some(motions.walk),
        get_ups: vec![motions.get_up_supine, motions.get_up_prone],
        locomotion: Locomotion::Forward { speed },
        ..MotionSet::default()
    };
    character.set_motions(motions).expect("the mannequin's clips are valid");
    (character, speed)
}
