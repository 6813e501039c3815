//! Random lives of characters that lose limbs, are grabbed and let go: nothing panics, all stays finite, and a copy in a fresh world has the same future.

use crate::actor::{shared, walker};
use crate::in_world::level;
use sinew_math::{Random, Reader, Rotation, Transform, Vec3, Writer};
use sinew_physics::{BodyId, BodyKind, World};
use sinew_ragdoll::{Character, CharacterDef, Detail, Grab, GrabPoint, Limb, Preset};
use std::sync::Arc;

/// A world and all who are in it.
struct Life {
    def: Arc<CharacterDef>,
    world: World,
    cast: Vec<Character>,
    limbs: Vec<Limb>,
    points: Vec<GrabPoint>,
}

impl Life {
    fn new(def: &Arc<CharacterDef>) -> Self {
        let (world, def) = (level(), def.clone());
        Self { def, world, cast: Vec::new(), limbs: Vec::new(), points: Vec::new() }
    }

    fn save(&self) -> Vec<u8> {
        let mut w = Writer::new();
        self.world.save(&mut w);
        self.cast.iter().for_each(|character| character.save(&mut w));
        self.limbs.iter().for_each(|limb| limb.save(&mut w));
        self.points.iter().for_each(|point| point.save(&mut w));
        w.into_bytes()
    }

    /// All of it in a fresh world.
    fn copy(&self) -> Self {
        let bytes = self.save();
        let mut r = Reader::new(&bytes);
        let mut copy = Self::new(&self.def);
        copy.world = World::new(self.world.def().clone());
        copy.world.load(&mut r).expect("it is a snapshot");
        for _ in &self.cast {
            let mut character = Character::new(self.def.clone(), Transform::IDENTITY, 0.0);
            character.load(&mut r).expect("it is a character");
            copy.cast.push(character);
        }
        copy.limbs.extend(self.limbs.iter().map(|_| Limb::load(&self.def, &mut r).expect("it is a limb")));
        copy.points.extend(self.points.iter().map(|_| GrabPoint::load(&mut r).expect("it is a point")));
        r.finish().expect("there is no more");
        copy
    }

    fn bone(&self, random: &mut Random) -> String {
        let bodies = &self.def.ragdoll.bodies;
        bodies[1 + random.index(bodies.len() - 1)].role.clone()
    }

    /// A body of whoever.
    fn any_body(&self, random: &mut Random) -> Option<BodyId> {
        let all: Vec<BodyId> =
            self.world.body_ids().filter(|&body| self.world.kind(body) != BodyKind::Static).collect();
        if all.is_empty() { None } else { Some(all[random.index(all.len())]) }
    }

    /// One deed, by chance.
    fn act(&mut self, random: &mut Random) {
        let deed = random.index(17);
        if self.cast.is_empty() || deed == 0 && self.cast.len() < 3 {
            let turn = Rotation::from_axis_angle(Vec3::Y, random.range(-3.0, 3.0));
            let place = Vec3::new(random.range(-1.0, 1.0), 0.0, random.range(-1.0, 1.0));
            self.cast.push(Character::spawn(&mut self.world, &self.def, Transform::new(place, turn)));
            return;
        }
        let who = random.index(self.cast.len());
        let bone = self.bone(random);
        let (world, character) = (&mut self.world, &mut self.cast[who]);
        match deed {
            1 => {
                let body = random.index(self.def.ragdoll.bodies.len());
                character.hit(world, body, random.in_cube() * 80.0);
            }
            2 => character.go_limp(world),
            3 | 4 => self.limbs.extend(character.detach(world, &bone)),
            5 => {
                let preset = [Preset::Powered, Preset::Animated, Preset::Flinching][random.index(3)];
                character.set_preset(world, preset);
            }
            6..=8 => {
                let Some(held) = self.any_body(random) else { return };
                let grab = Grab { reach: 0.8, drops: random.index(2) == 0, ..Grab::HAND };
                let hand = if character_has(&self.cast[who], &bone) { bone } else { "hips".into() };
                self.cast[who].grab(&mut self.world, &hand, held, &grab);
            }
            9 => {
                let held: Vec<BodyId> = character.held().collect();
                held.into_iter().for_each(|held| _ = character.release(world, held));
            }
            10 => {
                let Some(held) = self.any_body(random) else { return };
                let at = self.world.center_of_mass(held);
                self.points.extend(GrabPoint::take(&mut self.world, held, at, &Grab::POINT));
            }
            11 if !self.points.is_empty() => {
                let point = random.index(self.points.len());
                if random.index(2) == 0 {
                    self.points.swap_remove(point).release(world);
                } else {
                    let to = self.points[point].target() + random.in_cube() * 2.0;
                    self.points[point].set_target(to);
                }
            }
            12 if !self.limbs.is_empty() => {
                let limb = random.index(self.limbs.len());
                if random.index(3) == 0 {
                    self.limbs.swap_remove(limb).despawn(world);
                } else if let Some(off) = self.limbs[limb].detach(world, &bone) {
                    self.limbs.push(off);
                }
            }
            13 => {
                let detail = [Detail::Full, Detail::Keyed, Detail::HitBodies, Detail::Frozen];
                character.set_level_of_detail(world, detail[random.index(4)]);
            }
            14 if random.index(4) == 0 => self.cast.swap_remove(who).despawn(&mut self.world),
            15 => {
                let Some(body) = self.any_body(random) else { return };
                let kinds = [BodyKind::Dynamic, BodyKind::Kinematic, BodyKind::Static];
                self.world.set_kind(body, kinds[random.index(3)]);
            }
            _ => character.set_move(random.in_cube()),
        }
    }

    fn step(&mut self) {
        let world = &mut self.world;
        self.points.retain_mut(|point| point.update(world));
        world.step();
        self.cast.iter_mut().for_each(|character| character.update(world));
    }
}

fn character_has(character: &Character, bone: &str) -> bool {
    character.def().body_named(bone).is_some_and(|body| character.has_body(body))
}

#[test]
fn random_lives_are_the_same_in_a_fresh_world() {
    let def = shared(walker());
    let seeds = if std::env::var_os("SINEW_FULL").is_some() { 200 } else { 12 };
    for seed in 0..seeds {
        let mut random = Random::new(seed);
        let mut life = Life::new(&def);
        let mut copy: Option<(Life, Random)> = None;
        for step in 0..400 {
            if step % 8 == 0 {
                life.act(&mut random);
                if let Some((copy, random)) = &mut copy {
                    copy.act(random);
                }
            }
            life.step();
            if let Some((copy, _)) = &mut copy {
                copy.step();
                assert_eq!(copy.save(), life.save(), "seed {seed}, step {step}");
            }
            let world = &life.world;
            let is_finite = |body: BodyId| {
                let velocity = world.velocity(body);
                world.transform(body).is_finite()
                    && velocity.linear.is_finite()
                    && velocity.angular.is_finite()
            };
            assert!(world.body_ids().all(is_finite), "seed {seed}, step {step}");
            let poses = life.cast.iter().flat_map(Character::pose);
            assert!(poses.into_iter().all(|local| local.rotation.is_finite()), "seed {seed}, step {step}");
            if step % 100 == 57 {
                copy = Some((life.copy(), random.clone()));
            }
        }
    }
}
