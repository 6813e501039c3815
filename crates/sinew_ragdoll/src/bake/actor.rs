//! A character of a bake: applies its scheduled pushes and measures its fall.

use super::frames::Frames;
use super::{BakeDrive, BakeInput, Baked, HitEffect, keys};
use crate::character::{Character, CharacterDef, CharacterEvent, InWorld, State, Toughness};
use crate::quality::QualityMeter;
use sinew_anim::{Reduced, reduce_keys};
use sinew_math::{Transform, Vec3, max};
use sinew_physics::{BodyId, Velocity, World};
use std::sync::Arc;

/// A character of a bake.
pub(super) struct Actor<'a> {
    pub character: Character,
    pub meter: QualityMeter,
    frames: Frames,
    /// Start pose of the character, and its start time in the looped clip, seconds.
    start: Transform,
    phase: f32,
    /// Pushes that are not applied yet, the latest first.
    pending: Vec<(f32, Push<'a>)>,
    events: Vec<(f32, CharacterEvent)>,
    /// Number of events of pushes that are already recorded; the next update reports them again.
    ahead: usize,
}

/// Creates the character. It gets bodies in the world from the start in three cases: pushes or drives may move a part
/// of it, other characters may hit it, or it wears garments, which need bodies.
fn spawned(input: &BakeInput<'_>, is_alone: bool, world: &mut World) -> Character {
    let falls = input.hit_effect == HitEffect::Falls;
    if falls && is_alone && input.drives.is_empty() && input.character.garments().is_empty() {
        return Character::new(input.character.clone(), input.world_from_character, input.phase);
    }
    let mut def = CharacterDef::clone(&input.character);
    // The character follows its clips and reacts only to the scheduled hits.
    def.in_world = InWorld { mover: None, feels: f32::INFINITY, ..def.in_world };
    if falls {
        def.in_world.toughness = Toughness::None;
    }
    let mut character = Character::new(Arc::new(def), input.world_from_character, input.phase);
    character.enter(world);
    character
}

/// A scheduled action of the bake.
#[derive(Clone, Copy)]
enum Push<'a> {
    Limp { topple: Vec3 },
    Hit { body: usize, impulse: Vec3 },
    Drive(BakeDrive<'a>),
    Return { seconds: f32 },
}

impl<'a> Actor<'a> {
    /// Creates the actor. `is_alone` is true for the only character of the bake.
    pub fn new(input: &BakeInput<'a>, is_alone: bool, world: &mut World) -> Self {
        let limp = input.limp_at.map(|time| (time, Push::Limp { topple: input.topple }));
        let hits =
            input.hits.iter().map(|hit| (hit.time, Push::Hit { body: hit.body, impulse: hit.impulse }));
        let drives = input.drives.iter().map(|drive| (drive.time, Push::Drive(*drive)));
        let returns =
            input.returns.map(|back| (back.time - back.seconds, Push::Return { seconds: back.seconds }));
        let mut pending: Vec<_> = limp.into_iter().chain(drives).chain(hits).chain(returns).collect();
        // The sort is stable, so that simultaneous pushes keep their order.
        pending.sort_by(|a, b| a.0.total_cmp(&b.0));
        pending.reverse();
        Self {
            character: spawned(input, is_alone, world),
            meter: QualityMeter::new(&input.character.ragdoll, input.seconds),
            frames: Frames::new(input),
            start: input.world_from_character,
            phase: input.phase,
            pending,
            events: Vec::new(),
            ahead: 0,
        }
    }

    /// Applies the pushes that are due at the start, and records the first frame.
    pub fn begin(&mut self, world: &mut World) {
        self.push_due(world);
        self.frames.add_until(&self.character, world.time() as f32);
    }

    /// Measures the last step of the world.
    pub fn measure(&mut self, world: &World) {
        match (self.character.ragdoll(), self.character.state()) {
            (Some(ragdoll), State::Limp) => self.meter.after_step(world, ragdoll),
            // Clips move the bodies; their motion is not measured as physics.
            (Some(_), State::Flinching) => {}
            (Some(ragdoll), _) => self.meter.after_driven_step(world, ragdoll),
            (None, _) => {}
        }
    }

    /// Updates the character after a step of the world, and applies the pushes that are due at the step's end.
    pub fn update(&mut self, world: &mut World) {
        let was_limp = self.is_limp();
        self.character.update(world);
        if !was_limp && self.is_limp() {
            self.meter.went_limp();
        }
        self.note_events(self.ahead, world);
        self.push_due(world);
        self.frames.add_until(&self.character, world.time() as f32);
    }

    /// Applies all pushes that are due.
    fn push_due(&mut self, world: &mut World) {
        let noted = self.character.events().len();
        // Half a step early is closer than half a step late.
        let now = world.time() as f32 + 0.5 * world.def().dt();
        while let Some(&(time, push)) = self.pending.last().filter(|(time, _)| *time <= now) {
            debug_assert!(time <= now);
            self.pending.pop();
            let was_limp = self.is_limp();
            match push {
                // A character that has fallen already, over an edge, is not pushed.
                Push::Limp { .. } if was_limp => self.character.go_limp(world),
                Push::Limp { topple } => {
                    self.character.go_limp(world);
                    self.topple(topple, world);
                }
                Push::Hit { body, impulse } => {
                    let work = self.character.hit(world, body, impulse);
                    if self.is_limp() {
                        self.meter.pushed(work);
                    }
                }
                Push::Drive(BakeDrive { part, mode, half_life, .. }) => {
                    self.character.set_drive(world, part, mode, half_life);
                }
                Push::Return { seconds } => {
                    let phase = self.phase + world.time() as f32;
                    self.character.return_to_clip(world, self.start, phase, seconds);
                }
            }
            if !was_limp && self.is_limp() {
                self.meter.went_limp();
            }
        }
        self.note_events(noted, world);
        self.ahead = self.character.events().len() - noted;
    }

    fn is_limp(&self) -> bool {
        matches!(self.character.state(), State::Limp | State::Preparing)
    }

    /// Rotates a limp body as a whole about the ground under its centre, so that its highest part gains the given velocity.
    fn topple(&mut self, velocity: Vec3, world: &mut World) {
        let Some(ragdoll) = self.character.ragdoll().filter(|_| velocity != Vec3::ZERO) else { return };
        let ids: Vec<BodyId> = ragdoll.own_bodies().map(|(_, id)| id).collect();
        let center = |world: &World, id: BodyId| world.center_of_mass(id);
        let middle = ids.iter().fold(Vec3::ZERO, |sum, &id| sum + center(world, id)) / ids.len() as f32;
        let ground = Vec3::new(middle.x, self.character.world_from_character().translation.y, middle.z);
        let top = ids.iter().map(|&id| center(world, id).y - ground.y).fold(0.0, max);
        if top <= 0.0 {
            return;
        }
        let about = Vec3::Y.cross(velocity) / top;
        let before = world.energy().kinetic;
        for id in ids {
            let own = world.velocity(id);
            let linear = own.linear + about.cross(center(world, id) - ground);
            world.set_velocity(id, Velocity { linear, angular: own.angular + about });
        }
        self.meter.pushed(world.energy().kinetic - before);
    }

    /// Records the character's events from index `first` on.
    fn note_events(&mut self, first: usize, world: &World) {
        let time = world.time() as f32;
        for &event in &self.character.events()[first..] {
            if event == CharacterEvent::Up {
                self.meter.got_up(world);
            }
            self.events.push((time, event));
        }
    }

    /// Returns clip, frames and metrics. `hash` is the hash of world and character at the end.
    pub fn finish(self, input: &BakeInput<'_>, steps: u64, hash: u64) -> Baked {
        let rig = &input.character.rig;
        let world_from_model = input.character.mapping().world_from_model(input.world_from_character);
        // Frames are relative to the character's start: far from the world's origin, small motions would be lost to rounding.
        let root = input.character.mapping().character_from_model();
        let every_key = keys::clip(rig, input.name, &self.frames.list);
        let Reduced { clip, error, keys } = reduce_keys(rig, &every_key, &root, input.key_bound);
        Baked {
            clip,
            key_error: error,
            keys,
            frames: self.frames.list,
            world_from_model,
            quality: self.meter.quality(),
            events: self.events,
            bodies: input.character.ragdoll.bodies.len(),
            steps,
            hash,
        }
    }
}
