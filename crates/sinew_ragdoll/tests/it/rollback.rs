//! Rollback: the same inputs after going back eight frames give the same bits, with characters in every state that come and go.

use crate::actor::{floor, shared, walker};
use sinew_math::hash::hash_bytes;
use sinew_math::{Reader, Rotation, Transform, Vec3, Writer};
use sinew_physics::{World, WorldDef};
use sinew_ragdoll::{Character, CharacterDef, Preset, State};
use std::collections::BTreeSet;
use std::sync::Arc;

/// A game: the world and who is in it, by name.
struct Game {
    def: Arc<CharacterDef>,
    world: World,
    cast: Vec<(u32, Character)>,
}

/// Who there is, beside the bytes of a frame.
struct Frame {
    names: Vec<u32>,
    bytes: Vec<u8>,
}

impl Game {
    fn new(def: &Arc<CharacterDef>) -> Self {
        let mut world = World::new(WorldDef::default());
        world.add_body(&floor());
        Self { def: def.clone(), world, cast: Vec::new() }
    }

    fn actor(&mut self, name: u32) -> Option<(&mut World, &mut Character)> {
        let found = self.cast.iter_mut().find(|(other, _)| *other == name)?;
        Some((&mut self.world, &mut found.1))
    }

    /// Acts of a frame, by its number alone.
    fn act(&mut self, frame: u32) {
        if frame.is_multiple_of(60) && self.cast.len() < 6 {
            let name = frame / 60;
            let turn = Rotation::from_axis_angle(Vec3::Y, name as f32);
            let place = Transform::new(Vec3::new(1.2 * (name % 4) as f32, 0.0, 0.0), turn);
            let character = Character::spawn(&mut self.world, &self.def, place);
            self.cast.push((name, character));
        }
        let (body, hard) = ((frame as usize * 7) % 17, (frame / 45).is_multiple_of(3));
        let impulse =
            Rotation::from_axis_angle(Vec3::Y, frame as f32) * Vec3::Z * if hard { 80.0 } else { 8.0 };
        match frame % 45 {
            20 => {
                if let Some((world, actor)) = self.actor((frame / 45) % 5) {
                    actor.hit(world, body, impulse);
                }
            }
            31 => {
                if let Some((world, actor)) = self.actor((frame / 45) % 3) {
                    actor.set_preset(world, Preset::Powered);
                }
            }
            40 => {
                if let Some((_, actor)) = self.actor((frame / 45) % 4) {
                    actor.set_move(Vec3::X * 0.7);
                }
            }
            _ => {}
        }
        if frame % 400 == 399 {
            let (_, actor) = self.cast.remove(0);
            actor.despawn(&mut self.world);
        }
    }

    fn step(&mut self, frame: u32) -> u64 {
        self.act(frame);
        self.world.step();
        for (_, actor) in &mut self.cast {
            actor.update(&mut self.world);
        }
        hash_bytes(&self.save().bytes)
    }

    fn save(&self) -> Frame {
        let mut w = Writer::new();
        self.world.save(&mut w);
        self.cast.iter().for_each(|(_, actor)| actor.save(&mut w));
        Frame { names: self.cast.iter().map(|(name, _)| *name).collect(), bytes: w.into_bytes() }
    }

    fn load(&mut self, frame: &Frame) {
        let mut reader = Reader::new(&frame.bytes);
        self.world.load(&mut reader).expect("a snapshot");
        self.cast.clear();
        for &name in &frame.names {
            let mut actor = Character::new(self.def.clone(), Transform::IDENTITY, 0.0);
            actor.load(&mut reader).expect("a snapshot");
            self.cast.push((name, actor));
        }
    }
}

#[test]
fn eight_frames_back_and_forth() {
    const BACK: u32 = 8;
    let def = shared(walker());
    let mut game = Game::new(&def);
    let (mut frames, mut hashes, mut states) = (Vec::new(), Vec::new(), BTreeSet::new());
    for frame in 0..900 {
        frames.push(game.save());
        hashes.push(game.step(frame));
        states.extend(game.cast.iter().map(|(_, actor)| format!("{:?}", actor.state())));
        // Every 11 frames what came last is not believed.
        if frame % 11 == 10 {
            let from = frame + 1 - BACK;
            game.load(&frames[from as usize]);
            for again in from..=frame {
                assert_eq!(game.step(again), hashes[again as usize], "frame {again}, again from {from}");
            }
        }
        if frames.len() as u32 > BACK {
            frames[frame as usize - BACK as usize].bytes.clear();
        }
    }
    let all =
        [State::Animated, State::Limp, State::Preparing, State::GettingUp, State::Flinching, State::Powered];
    assert_eq!(states.len(), all.len(), "each state was there: {states:?}");
}
