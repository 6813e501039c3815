//! Characters, detached limbs and grab points kept beside a world.

use crate::actor::{Actor, Twin, pick};
use crate::characters;
use crate::deeds::Deed;
use crate::grips;
use crate::numbers::{Numbers, Temper};
use crate::watch::Fault;
use core::ops::Range;
use sinew_math::{Reader, Transform, Writer};
use sinew_physics::{BodyId, BodyKind, Sleeping, World};
use sinew_ragdoll::{Character, CharacterDef, GrabPoint, Limb};
use sinew_scenes::maned::{HAIR, maned};
use sinew_scenes::skirted::skirted;
use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

/// Types whose public methods the lives call.
pub const CALLED: &[&str] = &["Character", "Limb", "GrabPoint"];
/// Action tables besides those of the world, and actions that can start a life.
pub const DEEDS: &[&[Deed]] = &[characters::ALL, grips::ALL];
pub const MAKERS: &[&str] = &["spawn", "spawn", "spawn", "spawn"];
/// Steps in which actions happen.
pub const BUSY: Range<u32> = 40..160;

/// Largest number of characters at a time.
pub const MOST: usize = 3;
/// Allowed depth of a body below the floor (metres); steps for which a body may be pressed there; rise within a step
/// that counts as leaving (metres); half the width of the narrowest floor (metres).
const DEPTH: f32 = 0.05;
const PRESSED: u32 = 60;
const RISES: f32 = 1e-3;
const WIDTH: f32 = 6.0;
/// Number of steps after the last action from which limbs are checked.
const SETTLED: u32 = 20;
/// Bounds on the speed (m/s; unstoppable slabs press limbs out at up to 35) and joint gap (metres) of limbs once
/// settled.
const FAST: f32 = 60.0;
const GAP: f32 = 0.02;

/// Kinds of characters: plain, with spring-bone hair, with a cloth skirt.
pub fn kinds() -> &'static [Arc<CharacterDef>; 3] {
    static KINDS: OnceLock<[Arc<CharacterDef>; 3]> = OnceLock::new();
    KINDS.get_or_init(|| {
        [sinew::mannequin::character(), maned(&HAIR), skirted(|_| ())].map(|mut def| {
            def.in_world.tells_contacts = true;
            Arc::new(def)
        })
    })
}

/// A character of a random life.
#[derive(Clone)]
pub struct Member {
    /// Name that is stable when earlier actions are left out.
    pub name: u64,
    /// Index in order of creation.
    pub number: u32,
    pub kind: usize,
    pub character: Character,
}

/// Characters, limbs and grips kept beside a world.
#[derive(Clone, Default)]
pub struct Extension {
    pub cast: Vec<Member>,
    pub limbs: Vec<(u64, usize, Limb)>,
    pub points: Vec<(u64, GrabPoint)>,
    pub born: u32,
    /// True if the game has changed bodies that characters own; their state is then not checked.
    pub is_meddled_with: bool,
    /// Steps for which a body has been below the floor without rising, and its height.
    below: BTreeMap<BodyId, (u32, f32)>,
}

impl Extension {
    pub fn new() -> Self {
        Self::default()
    }

    /// Returns the extension for a copy of the world: cloned for a clone, loaded from bytes otherwise.
    pub fn twin(&self, twin: Twin) -> Self {
        match twin {
            Twin::Clone => self.clone(),
            Twin::Stranger => self.loaded(),
        }
    }

    fn loaded(&self) -> Self {
        let bytes = self.state();
        let mut r = Reader::new(&bytes);
        let cast = self.cast.iter().map(|member| {
            let mut character = Character::new(kinds()[member.kind].clone(), Transform::IDENTITY, 0.0);
            character.load(&mut r).expect("a saved character is valid");
            Member { character, ..member.clone() }
        });
        let cast = cast.collect();
        let limb = |&(name, kind, _): &(u64, usize, Limb)| {
            (name, kind, Limb::load(&kinds()[kind], &mut r).expect("a saved limb is valid"))
        };
        let limbs = self.limbs.iter().map(limb).collect();
        let point =
            |&(name, _): &(u64, GrabPoint)| (name, GrabPoint::load(&mut r).expect("a saved point is valid"));
        let points = self.points.iter().map(point).collect();
        r.finish().expect("there is no more");
        Self {
            cast,
            limbs,
            points,
            below: BTreeMap::new(),
            born: self.born,
            is_meddled_with: self.is_meddled_with,
        }
    }

    pub fn before_step(&mut self, world: &mut World) {
        self.points.retain_mut(|(_, point)| point.update(world));
    }

    pub fn after_step(&mut self, world: &mut World) {
        self.cast.iter_mut().for_each(|member| member.character.update(world));
    }

    /// Returns the serialised state.
    pub fn state(&self) -> Vec<u8> {
        let mut w = Writer::new();
        self.cast.iter().for_each(|member| member.character.save(&mut w));
        self.limbs.iter().for_each(|(.., limb)| limb.save(&mut w));
        self.points.iter().for_each(|(_, point)| point.save(&mut w));
        w.into_bytes()
    }

    /// Returns the events of the last step.
    pub fn events(&self) -> String {
        let with_events = self.cast.iter().filter(|member| !member.character.events().is_empty());
        with_events.map(|member| format!("{} {:?} ", member.number, member.character.events())).collect()
    }

    /// Returns true if the extension adds energy that is not accounted for.
    pub fn drives(&self) -> bool {
        !(self.cast.is_empty() && self.points.is_empty())
    }

    /// Checks the extension after a step; `quiet`: steps since the last action.
    ///
    /// # Errors
    /// If an invariant does not hold.
    pub fn look(&mut self, world: &World, temper: Temper, quiet: u32) -> Result<(), Fault> {
        for Member { number, character, .. } in &self.cast {
            let place = character.world_from_character();
            let finite = |local: &sinew_anim::LocalTransform| {
                local.translation.is_finite() && local.rotation.is_finite() && local.scale.is_finite()
            };
            if !place.is_finite() || !character.pose().iter().all(finite) {
                return Err(Fault::NotFinite(format!("the pose of character {number} at {place:?}")));
            }
        }
        if temper == Temper::Calm {
            self.floor(world)?;
            if quiet >= SETTLED && !self.is_meddled_with {
                self.limbs(world)?;
            }
        }
        Ok(())
    }

    /// Returns the dynamic bodies of characters and limbs.
    fn loose<'a>(&'a self, world: &'a World) -> impl Iterator<Item = BodyId> + 'a {
        let own = self.cast.iter().flat_map(|member| own(&member.character));
        let lost = self.limbs.iter().flat_map(|(.., limb)| limb.bodies().iter().copied());
        own.chain(lost).filter(|&body| world.contains(body) && world.kind(body) == BodyKind::Dynamic)
    }

    fn floor(&mut self, world: &World) -> Result<(), Fault> {
        let mut below = BTreeMap::new();
        if world.pair_function().is_none() {
            for body in self.loose(world) {
                let (center, top) = (world.center_of_mass(body), world.bounds(body).max.y);
                let presses = |other: BodyId| world.kind(other) == BodyKind::Kinematic;
                let is_inside = center.x.abs() < WIDTH && center.z.abs() < WIDTH && center.y > -3.0;
                if top < -DEPTH && is_inside && !world.neighbors(body).any(presses) {
                    let (steps, height) = self.below.get(&body).copied().unwrap_or((0, center.y));
                    let steps = if center.y > height + RISES { 0 } else { steps + 1 };
                    if steps > PRESSED {
                        return Err(Fault::Below(format!("{body:?} of a character is at {center}")));
                    }
                    below.insert(body, (steps, center.y));
                }
            }
        }
        self.below = below;
        Ok(())
    }

    fn limbs(&self, world: &World) -> Result<(), Fault> {
        for body in self.loose(world) {
            let speed = world.velocity(body).linear.length();
            if speed > FAST && world.sleeping(body) == Sleeping::On {
                return Err(Fault::Limb(format!("{body:?} of a character moves at {speed} m/s")));
            }
            for joint in world.joints_of(body).filter(|&joint| world.joint_owner(joint).is_some()) {
                let gap = world.joint_gap(joint);
                if gap > GAP {
                    return Err(Fault::Limb(format!("{joint:?} of a character has a gap of {gap} m")));
                }
            }
        }
        Ok(())
    }

    /// Removes all characters, limbs and grips from the world.
    pub fn empty(&mut self, world: &mut World) {
        self.points.drain(..).for_each(|(_, point)| point.release(world));
        self.limbs.drain(..).for_each(|(.., limb)| limb.despawn(world));
        self.cast.drain(..).for_each(|member| member.character.despawn(world));
        let owned = world
            .joint_ids()
            .find(|&joint| world.joint_owner(joint).is_some_and(|(of, _)| is_ours(&of.name)));
        assert!(owned.is_none(), "a joint of a character remains: {owned:?}");
        let owned =
            world.body_ids().find(|&body| world.body_owner(body).is_some_and(|(of, _)| is_ours(&of.name)));
        assert!(owned.is_none(), "a body of a character remains: {owned:?}");
    }
}

/// Returns true for owner names that no other code of the lives uses.
fn is_ours(name: &str) -> bool {
    name != "cart"
}

/// Returns the bodies of a character that are not detached.
pub fn own(character: &Character) -> impl Iterator<Item = BodyId> {
    let bodies = character.bodies().iter().enumerate();
    bodies.filter(|&(index, _)| character.has_body(index)).map(|(_, &body)| body)
}

/// Returns the index of one of the characters, if there are any.
pub fn chosen(a: &Actor, n: &mut Numbers) -> Option<usize> {
    let names: Vec<(u64, usize)> =
        a.more.cast.iter().enumerate().map(|(i, member)| (member.name, i)).collect();
    pick(&names, n.bits(), |_| true)
}

/// Returns a body of a character or a limb.
pub fn part(a: &Actor, n: &mut Numbers) -> Option<BodyId> {
    let limbs = a.more.limbs.iter().map(|(name, _, limb)| (*name, limb.bodies().to_vec()));
    let cast = a.more.cast.iter().map(|member| (member.name, own(&member.character).collect()));
    let all: Vec<(u64, Vec<BodyId>)> = limbs.chain(cast).filter(|(_, bodies)| !bodies.is_empty()).collect();
    let names: Vec<(u64, usize)> = all.iter().enumerate().map(|(i, &(name, _))| (name, i)).collect();
    let of = pick(&names, n.bits(), |_| true)?;
    Some(n.one_of(&all[of].1))
}
