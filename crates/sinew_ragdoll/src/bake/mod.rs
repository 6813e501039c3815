//! A simulated stretch of a character's life, back as a clip on the user's own rig.
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

mod keys;

use crate::character::{Character, CharacterDef, CharacterEvent, InWorld, State, Toughness, moved};
use crate::quality::{FallQuality, QualityMeter};
use sinew_anim::{Clip, KeyBound, KeyError, LocalTransform, Reduced, reduce_keys};
use sinew_math::hash::hash_bytes;
use sinew_math::{Affine, Transform, Vec3, Writer, clamp, max};
use sinew_physics::{BodyDef, BodyId, Velocity, World, WorldDef};
use std::sync::Arc;

/// A push at a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BakeHit {
    /// Seconds from the start.
    pub time: f32,
    /// Body, by index in the definition.
    pub body: usize,
    /// N·s, world axes, at the body's centre of mass.
    pub impulse: Vec3,
}

/// Input of a bake.
#[derive(Clone, Debug)]
pub struct BakeInput<'a> {
    /// The character.
    pub character: Arc<CharacterDef>,
    /// Pose of the character in the world at the start.
    pub world_from_character: Transform,
    /// Seconds into its looped clip at the start. Default 0.
    pub phase: f32,
    /// Settings of the world. Its step is the simulation's.
    pub world: WorldDef,
    /// Bodies of the world besides the character's own.
    pub bodies: &'a [BodyDef],
    /// Pushes, in any order.
    pub hits: &'a [BakeHit],
    /// Effect of pushes. Default: each one fells.
    pub hit_effect: HitEffect,
    /// When it goes limp without a push, seconds; `None`: only by a hit.
    pub limp_at: Option<f32>,
    /// Length, seconds.
    pub seconds: f32,
    /// Frames per second of the clip, at least 1.
    pub fps: f32,
    /// Extra velocity of its highest point when it goes limp at [`limp_at`](Self::limp_at), m/s, world axes: the whole
    /// body rotates about the ground under it. Default zero. A body with broad feet stays upright without it.
    pub topple: Vec3,
    /// Largest distance of any joint of the clip from the frames, metres and radians; keys that are not needed for that
    /// are dropped.
    pub key_bound: KeyBound,
    /// Name of the clip.
    pub name: &'a str,
}

/// Effect of a push in a bake.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum HitEffect {
    /// It fells. Default.
    #[default]
    Falls,
    /// It makes the limb flinch, or fells, by [`InWorld::toughness`](crate::InWorld::toughness).
    FlinchesOrFalls,
}

/// The bound on the keys that [`BakeInput::new`] sets: a tenth of a millimetre and a hundredth of a degree.
pub const KEY_BOUND: KeyBound = KeyBound { distance: 1e-4, angle: 1.745_329_3e-4 };

impl<'a> BakeInput<'a> {
    /// Ten seconds at 30 frames a second at the world's origin, nothing in the world and nothing done; keys within
    /// [`KEY_BOUND`].
    pub fn new(character: Arc<CharacterDef>) -> Self {
        Self {
            character,
            world_from_character: Transform::IDENTITY,
            phase: 0.0,
            world: WorldDef::default(),
            bodies: &[],
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
    /// Seconds.
    pub time: f32,
    /// State that decided the pose.
    pub state: State,
    /// Local transform of every joint; see [`Baked::world_from_model`].
    pub pose: Vec<LocalTransform>,
}

/// The result.
#[derive(Clone, Debug, PartialEq)]
pub struct Baked {
    /// Linear keys at frame times for every joint that moves: rotations, and translations that change. It starts where
    /// the file's character stands, and all root motion is in the pelvis.
    pub clip: Clip,
    /// Largest error of the clip's joints against the frames, at the times of frames: metres and radians, within
    /// [`BakeInput::key_bound`].
    pub key_error: KeyError,
    /// Keys of the clip's channels: with one per frame, and as reduced.
    pub keys: [usize; 2],
    /// The frames of the clip.
    pub frames: Vec<Frame>,
    /// From the model space of the file to the world, the same for all frames.
    pub world_from_model: Affine,
    /// The figures.
    pub quality: FallQuality,
    /// Events with their times in seconds.
    pub events: Vec<(f32, CharacterEvent)>,
    /// Number of bodies of the ragdoll.
    pub bodies: usize,
    /// Steps that were simulated.
    pub steps: u64,
    /// Hash of the snapshots of world and character at the end; the world alone says nothing about the fall once the
    /// character is up and its bodies are gone.
    pub hash: u64,
}

impl Baked {
    /// The clip for the character's own file: at the height of the played clip, if its floor is not that of the rest
    /// pose ([`CharacterDef::raised`]).
    pub fn clip_for_file(&self, character: &CharacterDef) -> Clip {
        let down = character.mapping().character_from_model().inverse().vector(Vec3::Y * -character.raised());
        moved(&character.rig, &character.ragdoll, &self.clip, down, down)
    }
}

/// Simulates a character in a world. Same bits on every target and for every frame rate.
///
/// # Panics
/// If a number is not finite, `fps` is below 1, the key bound is negative, or a hit names a missing body.
pub fn bake(input: &BakeInput<'_>) -> Baked {
    assert!(
        input.seconds.is_finite() && input.fps >= 1.0,
        "a bake has a length and a frame rate, not {} s and {} frames a second",
        input.seconds,
        input.fps
    );
    assert!(input.hits.iter().all(|hit| hit.time.is_finite()), "hits have a time: {:?}", input.hits);
    let mut run = Run::new(input);
    let mut frames = Frames::new(input);
    frames.add_until(&run);
    while run.time() < input.seconds {
        run.step();
        frames.add_until(&run);
    }
    let hash = run.hash();
    let rig = &input.character.rig;
    let world_from_model = input.character.mapping().world_from_model(input.world_from_character);
    // Relative to the character's start: far from the world's origin small displacements are lost in rounding.
    let root = input.character.mapping().character_from_model();
    let every_key = keys::clip(rig, input.name, &frames.list);
    let Reduced { clip, error, keys } = reduce_keys(rig, &every_key, &root, input.key_bound);
    Baked {
        clip,
        key_error: error,
        keys,
        frames: frames.list,
        world_from_model,
        quality: run.meter.quality(),
        events: run.events,
        bodies: input.character.ragdoll.bodies.len(),
        steps: run.world.step_count(),
        hash,
    }
}

/// A running bake.
struct Run {
    world: World,
    character: Character,
    meter: QualityMeter,
    /// Pending interventions, the latest first.
    pending: Vec<(f32, Push)>,
    events: Vec<(f32, CharacterEvent)>,
    /// Events of pushes that are recorded already; the next update repeats them.
    ahead: usize,
}

/// The character at its start: in the world, if pushes may make it flinch or it wears garments, because that needs
/// bodies.
fn spawned(input: &BakeInput<'_>, world: &mut World) -> Character {
    let falls = input.hit_effect == HitEffect::Falls;
    if falls && input.character.garments().is_empty() {
        return Character::new(input.character.clone(), input.world_from_character, input.phase);
    }
    let mut def = CharacterDef::clone(&input.character);
    // It follows its clips and feels only what it is told.
    def.in_world = InWorld { mover: None, feels: f32::INFINITY, ..def.in_world };
    if falls {
        def.in_world.toughness = Toughness::None;
    }
    let mut character = Character::new(Arc::new(def), input.world_from_character, input.phase);
    character.enter(world);
    character
}

/// Intervention at a moment: the character goes limp, or is hit.
#[derive(Clone, Copy)]
enum Push {
    Limp { topple: Vec3 },
    Hit { body: usize, impulse: Vec3 },
}

impl Run {
    fn new(input: &BakeInput<'_>) -> Self {
        let mut world = World::new(input.world.clone());
        for body in input.bodies {
            world.add_body(body);
        }
        let hits =
            input.hits.iter().map(|hit| (hit.time, Push::Hit { body: hit.body, impulse: hit.impulse }));
        let mut pending: Vec<_> = input
            .limp_at
            .map(|time| (time, Push::Limp { topple: input.topple }))
            .into_iter()
            .chain(hits)
            .collect();
        // Stable, so that simultaneous pushes keep their order.
        pending.sort_by(|a, b| a.0.total_cmp(&b.0));
        pending.reverse();
        let character = spawned(input, &mut world);
        let mut run = Self {
            world,
            character,
            meter: QualityMeter::new(&input.character.ragdoll, input.seconds),
            pending,
            events: Vec::new(),
            ahead: 0,
        };
        run.push_due();
        run
    }

    fn time(&self) -> f32 {
        self.world.time() as f32
    }

    fn hash(&self) -> u64 {
        let mut w = Writer::new();
        self.world.save(&mut w);
        self.character.save(&mut w);
        hash_bytes(w.as_bytes())
    }

    /// One step of the world, and the interventions due at its end.
    fn step(&mut self) {
        self.meter.before_step(&self.world);
        self.world.step();
        match (self.character.ragdoll(), self.character.state()) {
            (Some(ragdoll), State::Limp) => self.meter.after_step(&self.world, ragdoll),
            // While clips lead the bodies, their motion is not measured.
            (Some(_), State::Flinching) => {}
            (Some(ragdoll), _) => self.meter.after_driven_step(&self.world, ragdoll),
            (None, _) => {}
        }
        self.character.update(&mut self.world);
        self.note_events(self.ahead);
        self.push_due();
    }

    /// Applies pushes whose time has come.
    fn push_due(&mut self) {
        let noted = self.character.events().len();
        // Half a step early is nearer than half a step late.
        let now = self.time() + 0.5 * self.world.def().dt();
        while let Some(&(time, push)) = self.pending.last().filter(|(time, _)| *time <= now) {
            debug_assert!(time <= now);
            self.pending.pop();
            let is_limp = |run: &Self| matches!(run.character.state(), State::Limp | State::Preparing);
            let was_limp = is_limp(self);
            match push {
                Push::Limp { topple } => {
                    self.character.go_limp(&mut self.world);
                    self.topple(topple);
                }
                Push::Hit { body, impulse } => {
                    let work = self.character.hit(&mut self.world, body, impulse);
                    if is_limp(self) {
                        self.meter.pushed(work);
                    }
                }
            }
            if !was_limp && is_limp(self) {
                self.meter.went_limp();
            }
        }
        self.note_events(noted);
        self.ahead = self.character.events().len() - noted;
    }

    /// Rotates a limp body as a whole about the ground under its middle, so that its highest part gets that extra
    /// velocity.
    fn topple(&mut self, velocity: Vec3) {
        let Some(ragdoll) = self.character.ragdoll().filter(|_| velocity != Vec3::ZERO) else { return };
        let ids: Vec<BodyId> = ragdoll.own_bodies().map(|(_, id)| id).collect();
        let center = |world: &World, id: BodyId| world.center_of_mass(id);
        let middle = ids.iter().fold(Vec3::ZERO, |sum, &id| sum + center(&self.world, id)) / ids.len() as f32;
        let ground = Vec3::new(middle.x, self.character.world_from_character().translation.y, middle.z);
        let top = ids.iter().map(|&id| center(&self.world, id).y - ground.y).fold(0.0, max);
        if top <= 0.0 {
            return;
        }
        let about = Vec3::Y.cross(velocity) / top;
        let before = self.world.energy().kinetic;
        for id in ids {
            let own = self.world.velocity(id);
            let linear = own.linear + about.cross(center(&self.world, id) - ground);
            self.world.set_velocity(id, Velocity { linear, angular: own.angular + about });
        }
        self.meter.pushed(self.world.energy().kinetic - before);
    }

    /// Keeps the character's events from the `first` on.
    fn note_events(&mut self, first: usize) {
        let time = self.time();
        for &event in &self.character.events()[first..] {
            if event == CharacterEvent::Up {
                self.meter.got_up(&self.world);
            }
            self.events.push((time, event));
        }
    }
}

/// Resamples steps to frames.
struct Frames {
    list: Vec<Frame>,
    fps: f32,
    seconds: f32,
    world_from_character: Transform,
    /// Pose and time of the last step, for the frames between it and the next.
    last: Vec<LocalTransform>,
    last_time: f32,
    now: Vec<LocalTransform>,
}

impl Frames {
    fn new(input: &BakeInput<'_>) -> Self {
        Self {
            list: Vec::with_capacity(1 + (clamp(input.seconds, 0.0, 3600.0) * input.fps) as usize),
            fps: input.fps,
            seconds: input.seconds,
            world_from_character: input.world_from_character,
            last: Vec::new(),
            last_time: 0.0,
            now: Vec::new(),
        }
    }

    /// Adds the frames between the last step and the present one.
    fn add_until(&mut self, run: &Run) {
        let character = &run.character;
        let time = run.time();
        self.now.clear();
        self.now.extend_from_slice(character.pose());
        // All frames are relative to the character's start.
        character.def().mapping().reframe(
            &mut self.now,
            character.world_from_character(),
            self.world_from_character,
        );
        if self.last.is_empty() {
            self.last.clone_from(&self.now);
        }
        loop {
            let at = self.list.len() as f32 / self.fps;
            if at > time || at > self.seconds {
                break;
            }
            let span = time - self.last_time;
            let t = if span > 0.0 { clamp((at - self.last_time) / span, 0.0, 1.0) } else { 1.0 };
            let pose = self.last.iter().zip(&self.now).map(|(a, b)| between(a, b, t)).collect();
            self.list.push(Frame { time: at, state: character.state(), pose });
        }
        core::mem::swap(&mut self.last, &mut self.now);
        self.last_time = time;
    }
}

fn between(a: &LocalTransform, b: &LocalTransform, t: f32) -> LocalTransform {
    // A resting body has the same bits in all frames.
    if a == b {
        return *a;
    }
    LocalTransform {
        translation: a.translation * (1.0 - t) + b.translation * t,
        rotation: a.rotation.nlerp(b.rotation, t),
        scale: a.scale * (1.0 - t) + b.scale * t,
    }
}
