//! A fight with rollback: `cargo run -p sinew --example rollback_fight`.
//!
//! One player's inputs come eight frames late. Frames with wrong guesses are repeated, with the bits of a machine that
//! got all inputs in time.

use sinew::prelude::*;
use std::collections::VecDeque;
use std::sync::Arc;

const LATE: usize = 8;

struct Fight {
    world: World,
    fighters: [Character; 2],
}

impl Fight {
    fn new() -> Self {
        let mut world = World::new(WorldDef::default());
        world.add_body(&BodyDef::fixed(Shape::HalfSpace));
        let def = Arc::new(sinew::mannequin::character());
        let fighters = [-1.0, 1.0].map(|side: f32| {
            let turn = Rotation::from_axis_angle(Vec3::Y, -side * core::f32::consts::FRAC_PI_2);
            let place = Transform::new(Vec3::X * (0.6 * side), turn);
            let mut fighter = Character::spawn(&mut world, &def, place);
            fighter.set_preset(&mut world, Preset::Powered);
            fighter.set_move(Vec3::ZERO);
            fighter
        });
        Self { world, fighters }
    }

    /// Advances by one frame: a strike hits the chest of the other fighter.
    fn frame(&mut self, strikes: [bool; 2]) {
        for (who, side) in [(0, 1.0), (1, -1.0)] {
            if strikes[who] {
                self.fighters[1 - who].hit(&mut self.world, 2, Vec3::new(45.0 * side, 0.0, 5.0));
            }
        }
        self.world.step();
        self.fighters.iter_mut().for_each(|fighter| fighter.update(&mut self.world));
    }

    fn save(&self) -> Vec<u8> {
        let mut out = Writer::new();
        self.world.save(&mut out);
        self.fighters.iter().for_each(|fighter| fighter.save(&mut out));
        out.into_bytes()
    }

    fn load(&mut self, bytes: &[u8]) {
        let mut bytes = Reader::new(bytes);
        self.world.load(&mut bytes).expect("the saved state can be loaded");
        self.fighters
            .iter_mut()
            .for_each(|fighter| fighter.load(&mut bytes).expect("the saved state can be loaded"));
    }
}

fn strikes(frame: usize) -> [bool; 2] {
    [frame % 50 == 20, frame % 90 == 65]
}

/// Runs two copies of a fight: one with all inputs in time, and one that gets the inputs of one player late.
pub fn main() {
    let (mut known, mut guessed, mut past, mut again) = (Fight::new(), Fight::new(), VecDeque::new(), 0);
    for frame in 0..300 {
        known.frame(strikes(frame));
        past.push_back(guessed.save());
        guessed.frame([strikes(frame)[0], false]);
        if past.len() > LATE && strikes(frame - LATE)[1] {
            guessed.load(&past[past.len() - 1 - LATE]);
            for late in (0..=LATE).rev() {
                *past.iter_mut().rev().nth(late).expect("a frame") = guessed.save();
                guessed.frame([strikes(frame - late)[0], late == LATE]);
            }
            again += 1;
        }
        past.drain(..past.len().saturating_sub(LATE));
    }
    println!("{again} times done again, both {:016x}", known.world.hash());
    assert_eq!((again, known.world.hash()), (3, guessed.world.hash()));
}
