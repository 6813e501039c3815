//! Bakes a simulated character to a clip on the user's own rig.
//!
//! ```
//! use sinew_math::Vec3;
//! use sinew_physics::{BodyDef, Shape};
//! use sinew_ragdoll::{BakeInput, BakeHit, bake};
//! use std::sync::Arc;
//!
//! let character = Arc::new(sinew::mannequin::character());
//! let ground = [BodyDef::fixed(Shape::HalfSpace)];
//! let hits = [BakeHit { time: 0.2, body: 0, impulse: Vec3::new(0.0, 0.0, -150.0) }];
//! let input = BakeInput { bodies: &ground, hits: &hits, seconds: 0.5, ..BakeInput::new(character) };
//! let baked = bake(&input);
//! assert_eq!((baked.frames.len(), baked.clip.duration), (16, 0.5)); // at 30 frames a second
//! ```

mod actor;
mod frames;
mod keys;
mod mover;
mod run;

pub use mover::BakeMover;

use crate::character::{CharacterDef, CharacterEvent, Part, State, moved};
use crate::drive::DriveMode;
use crate::quality::FallQuality;
use core::ops::ControlFlow;
use run::Run;
use sinew_anim::{Clip, KeyBound, KeyError, LocalTransform};
use sinew_math::{Affine, Transform, Vec3};
use sinew_physics::{BodyDef, FieldDef, WorldDef};
use std::sync::Arc;

/// A push at a given time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BakeHit {
    /// Time since the start, seconds.
    pub time: f32,
    /// Index of the pushed body in the definition.
    pub body: usize,
    /// Impulse at the body's centre of mass, N·s, world axes.
    pub impulse: Vec3,
}

/// Change of the drive of a part of the character at a given time, by
/// [`Character::set_drive`](crate::Character::set_drive). The change applies while the character stands;
/// [`CharacterDef::falling`] sets the drive of a fallen character.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BakeDrive<'a> {
    /// Time since the start, seconds.
    pub time: f32,
    /// Bodies whose drive changes.
    pub part: Part<'a>,
    /// Mode of these drives from then on.
    pub mode: DriveMode,
    /// Time in which half of the change is made, seconds.
    pub half_life: f32,
}

/// Return to the looped clip by [`Character::return_to_clip`](crate::Character::return_to_clip), at the position where
/// the character started and at the clip time that the character would have reached without interruption.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BakeReturn {
    /// Time from the start at which the pose equals that of the clip, seconds.
    pub time: f32,
    /// Duration of the preceding blend from the simulated pose, seconds.
    pub seconds: f32,
}

/// Input of a bake.
#[derive(Clone, Debug)]
pub struct BakeInput<'a> {
    /// The character.
    pub character: Arc<CharacterDef>,
    /// Pose of the character in the world at the start.
    pub world_from_character: Transform,
    /// Start time in the character's looped clip, seconds. Default 0.
    pub phase: f32,
    /// Settings of the world, with the step of the simulation.
    pub world: WorldDef,
    /// Bodies of the world besides the character's own.
    pub bodies: &'a [BodyDef],
    /// Keyframed bodies of the world.
    pub movers: &'a [BakeMover<'a>],
    /// Wind, water and other fields of the world.
    pub fields: &'a [FieldDef],
    /// Changes of drives, in any order. With any change, the character has its bodies in the world from the start.
    pub drives: &'a [BakeDrive<'a>],
    /// Return to the looped clip; `None`: the character returns only by getting up.
    pub returns: Option<BakeReturn>,
    /// Pushes, in any order.
    pub hits: &'a [BakeHit],
    /// Effect of pushes. Default: each push makes the character fall.
    pub hit_effect: HitEffect,
    /// Time at which the character goes limp without a push, seconds; `None`: only hits make it limp.
    pub limp_at: Option<f32>,
    /// Length of the bake, seconds.
    pub seconds: f32,
    /// Frames per second of the clip, at least 1.
    pub fps: f32,
    /// Extra velocity of the character's highest point when it goes limp at [`limp_at`](Self::limp_at), m/s, world
    /// axes: the whole body rotates about the ground under it. Default zero. With zero a body with broad feet stays
    /// upright.
    pub topple: Vec3,
    /// Largest error of any joint of the clip against the frames, metres and radians; keys not needed for this bound
    /// are removed.
    pub key_bound: KeyBound,
    /// Name of the clip.
    pub name: &'a str,
}

/// Effect of a push in a bake.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum HitEffect {
    /// The character falls. Default.
    #[default]
    Falls,
    /// The limb flinches or the character falls, depending on [`InWorld::toughness`](crate::InWorld::toughness).
    FlinchesOrFalls,
}

/// Key error bound set by [`BakeInput::new`]: a tenth of a millimetre and a hundredth of a degree.
pub const KEY_BOUND: KeyBound = KeyBound { distance: 1e-4, angle: 1.745_329_3e-4 };

impl<'a> BakeInput<'a> {
    /// Returns an input of ten seconds at 30 frames a second at the world's origin, in an empty world without pushes,
    /// with keys within [`KEY_BOUND`].
    pub fn new(character: Arc<CharacterDef>) -> Self {
        Self {
            character,
            world_from_character: Transform::IDENTITY,
            phase: 0.0,
            world: WorldDef::default(),
            bodies: &[],
            movers: &[],
            fields: &[],
            drives: &[],
            returns: None,
            hits: &[],
            hit_effect: HitEffect::Falls,
            limp_at: None,
            seconds: 10.0,
            fps: 30.0,
            topple: Vec3::ZERO,
            key_bound: KEY_BOUND,
            name: "sinew",
        }
    }
}

/// A frame of a bake.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Time since the start, seconds.
    pub time: f32,
    /// State of the character, which determined the pose.
    pub state: State,
    /// Local transform of every joint; see [`Baked::world_from_model`].
    pub pose: Vec<LocalTransform>,
}

/// The result of a bake.
#[derive(Clone, Debug, PartialEq)]
pub struct Baked {
    /// Linear keys at frame times for every joint that moves: rotations, and translations that change. The clip starts
    /// at the position of the file's character. The pelvis contains all root motion.
    pub clip: Clip,
    /// Largest error of the clip's joints against the frames, at the frame times: metres and radians, within
    /// [`BakeInput::key_bound`].
    pub key_error: KeyError,
    /// Number of keys in the clip's channels: first with one key per frame, then after reduction.
    pub keys: [usize; 2],
    /// The frames of the clip.
    pub frames: Vec<Frame>,
    /// Transform from the model space of the file to the world, the same for all frames.
    pub world_from_model: Affine,
    /// Quality metrics of the falls.
    pub quality: FallQuality,
    /// Events with their times in seconds.
    pub events: Vec<(f32, CharacterEvent)>,
    /// Number of bodies of the ragdoll.
    pub bodies: usize,
    /// Number of simulated steps.
    pub steps: u64,
    /// Hash of the snapshots of world and character at the end. The world's hash alone would miss the fall once the
    /// character has got up and its bodies are removed.
    pub hash: u64,
}

impl Baked {
    /// Returns the clip for the character's own file. The clip is moved back to its position in the file, if the played
    /// clip has another floor than the rest pose ([`CharacterDef::raised`]) or begins elsewhere.
    pub fn clip_for_file(&self, character: &CharacterDef) -> Clip {
        let back = character.mapping().character_from_model().inverse().vector(-character.shift());
        moved(&character.rig, &character.ragdoll, &self.clip, back, back)
    }
}

/// Simulates a character in a world. The result has the same bits on every target. The frame rate does not affect the simulation.
///
/// # Panics
/// If a number is not finite, `fps` is below 1, the key bound is negative, or a hit or drive has the index of a body
/// that does not exist.
pub fn bake(input: &BakeInput<'_>) -> Baked {
    let mut baked = bake_together(core::slice::from_ref(input), &mut |_| ControlFlow::Continue(()));
    baked.as_mut().and_then(Vec::pop).expect("nothing stops it, and there is one for each input")
}

/// Bakes several characters in one world, where they collide with each other. The world contains the bodies, movers and fields of all
/// inputs. `watch` is called with the simulated seconds after every step; if it breaks, the bake ends and the result is `None`.
///
/// Metrics of the whole world (energy, work) are the same for all characters.
///
/// # Panics
/// Panics like [`bake`], or if the inputs differ in their world or their length.
pub fn bake_together(
    inputs: &[BakeInput<'_>],
    watch: &mut dyn FnMut(f32) -> ControlFlow<()>,
) -> Option<Vec<Baked>> {
    let Some(first) = inputs.first() else { return Some(Vec::new()) };
    for input in inputs {
        input.check();
        assert!(input.world == first.world, "characters of one bake are in one world");
        assert!(input.seconds == first.seconds, "a bake has one length");
    }
    let mut run = Run::new(inputs);
    while run.time() < first.seconds {
        run.step();
        if watch(run.time()).is_break() {
            return None;
        }
    }
    Some(run.finish(inputs))
}

impl BakeInput<'_> {
    fn check(&self) {
        assert!(
            self.seconds.is_finite() && self.fps >= 1.0,
            "a bake must have a length and a frame rate, not {} s and {} frames a second",
            self.seconds,
            self.fps
        );
        assert!(self.hits.iter().all(|hit| hit.time.is_finite()), "hits have a time: {:?}", self.hits);
        assert!(
            self.drives.iter().all(|drive| drive.time.is_finite()),
            "drives have a time: {:?}",
            self.drives
        );
        let is_moment =
            |back: BakeReturn| back.time.is_finite() && (0.0..f32::INFINITY).contains(&back.seconds);
        assert!(self.returns.is_none_or(is_moment), "a return has a time and a length: {:?}", self.returns);
        self.movers.iter().for_each(BakeMover::check);
    }
}
