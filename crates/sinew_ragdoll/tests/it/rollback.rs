//! Rollback: repeating eight frames with the same inputs gives the same bits, while characters in every state are added
//! and removed.

use crate::actor::{floor, shared, walker};
use sinew_math::hash::hash_bytes;
use sinew_math::{Reader, Rotation, Transform, Vec3, Writer};
use sinew_physics::{BodyDef, BodyId, Shape, World, WorldDef};
use sinew_ragdoll::{Character, CharacterDef, Detail, Grip, Preset, State};
use std::collections::BTreeSet;
use std::sync::Arc;

/// A game: the world and its named characters.
struct Game {
    def: Arc<CharacterDef>,
    world: World,
    cast: Vec<(u32, Character)>,
    sword: BodyId,
}

/// The characters present, and the bytes of a frame.
struct Frame {
    names: Vec<u32>,
    bytes: Vec<u8>,
}

impl Game {
    fn new(def: &Arc<CharacterDef>) -> Self {
        let mut world = World::new(WorldDef::default());
        world.add_body(&floor());
        let blade = Shape::Box { half_extents: Vec3::new(0.02, 0.02, 0.3) };
        let sword = world.add_body(&BodyDef::dynamic(blade).at(Vec3::new(0.0, 1.0, -3.0)));
        Self { def: def.clone(), world, cast: Vec::new(), sword }
    }

    fn actor(&mut self, name: u32) -> Option<(&mut World, &mut Character)> {
        let found = self.cast.iter_mut().find(|(other, _)| *other == name)?;
        Some((&mut self.world, &mut found.1))
    }

    /// Actions of a frame, determined by its number.
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
            5 => {
                let detail = [Detail::Full, Detail::Keyed, Detail::Full, Detail::HitBodies];
                if let Some((world, actor)) = self.actor((frame / 45) % 6) {
                    actor.set_level_of_detail(world, detail[(frame / 45) as usize % 4]);
                }
            }
            10 => self.hand_over(frame / 45),
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

    /// Takes the sword from its holder and gives it to the next character with hands.
    fn hand_over(&mut self, round: u32) {
        let sword = self.sword;
        for (_, actor) in &mut self.cast {
            actor.release(&mut self.world, sword);
        }
        let armed = self.actor(round % 5).filter(|(_, actor)| !actor.bodies().is_empty());
        if let Some((world, actor)) = armed {
            actor.hold(
                world,
                "rightHand",
                sword,
                &Grip { drops: round.is_multiple_of(2), ..Grip::default() },
            );
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
        self.world.load(&mut reader).expect("the snapshot is valid");
        self.cast.clear();
        for &name in &frame.names {
            let mut actor = Character::new(self.def.clone(), Transform::IDENTITY, 0.0);
            actor.load(&mut reader).expect("the snapshot is valid");
            self.cast.push((name, actor));
        }
    }
}

#[test]
fn repeating_eight_frames_gives_the_same_bits() {
    const BACK: u32 = 8;
    let def = shared(walker());
    let mut game = Game::new(&def);
    let (mut frames, mut hashes, mut states) = (Vec::new(), Vec::new(), BTreeSet::new());
    let (mut held, mut stumbled) = (BTreeSet::new(), 0);
    for frame in 0..900 {
        frames.push(game.save());
        hashes.push(game.step(frame));
        for (_, actor) in &game.cast {
            states.insert(format!("{:?}", actor.state()));
            held.extend((actor.held().count() > 0).then(|| format!("{:?}", actor.state())));
            stumbled += u32::from(actor.stumbles());
        }
        // Every 11 frames the latest inputs are treated as mispredicted.
        if frame % 11 == 10 {
            let from = frame + 1 - BACK;
            game.load(&frames[from as usize]);
            for again in from..=frame {
                assert_eq!(
                    game.step(again),
                    hashes[again as usize],
                    "frame {again} of the repetition from frame {from}"
                );
            }
        }
        if frames.len() as u32 > BACK {
            frames[frame as usize - BACK as usize].bytes.clear();
        }
    }
    let all =
        [State::Animated, State::Limp, State::Preparing, State::GettingUp, State::Flinching, State::Powered];
    assert_eq!(states.len(), all.len(), "not every state occurred: {states:?}");
    assert!(held.len() >= 3 && stumbled > 20, "held in states {held:?}, stumbled for {stumbled} frames");
}
