//! A character's own state, beside the world's snapshot.

use super::clearance::{Depths, PARTS, Passage};
use super::distances::Detail;
use super::grasp::Grasp;
use super::in_world::Presence;
use super::memory::{Clearing, Hold, Planting, Preparation, Rising, Stillness};
use super::stumble::Stumble;
use super::{Character, CharacterEvent, Earlier, State};
use crate::drive::Drives;
use crate::garments::Worn;
use crate::ragdoll::Ragdoll;
use crate::springs::SpringSwing;
use sinew_anim::{Animator, Inertia, LocalTransform, TrackId};
use sinew_math::{ReadError, Reader, Writer};
use sinew_physics::{BodyId, JointId, MoverId, Velocity};

/// First bytes; the last is the version.
const MAGIC: &[u8; 8] = b"sinew-c\x06";
/// Bit of a state: the character has its share of a world.
const IN_WORLD: u8 = 0x80;
/// Bit of a state: its springs follow at the end.
const WEARS: u8 = 0x40;
/// Bit of a state: its garments follow at the end.
const DRESSED: u8 = 0x20;
/// Bit of a state: what was cut off follows after it.
const LOST: u8 = 0x10;
/// Bit of what is held: a grip that pulls follows.
const GRASPS: u8 = 2;
/// Bit of a state: the way from one pose to another follows at the end.
const PASSING: u8 = 0x08;
/// In the place of a state: events that no update has told of come before it.
const UNTOLD: u8 = 7;
/// Bytes of such an event.
const EVENT_BYTES: usize = 17;
/// All bits of a state.
const FLAGS: u8 = IN_WORLD | WEARS | DRESSED | LOST | PASSING;
/// Number of the state of a limp character that is on its way out of a wall, which follows at the end.
const CLEARING: u8 = 6;
/// Bytes of a local transform.
const LOCAL_BYTES: usize = 40;

impl Character {
    /// Writes what decides the future, and nothing that its definition holds.
    pub fn save(&self, w: &mut Writer) {
        w.raw(MAGIC);
        self.save_untold(w);
        let state = self.number_of_state();
        let in_world = if self.presence.is_some() { IN_WORLD } else { 0 };
        let wears = if self.def.springs().is_empty() { 0 } else { WEARS };
        let dressed = if self.def.garments().is_empty() { 0 } else { DRESSED };
        let is_whole = self.lost.is_empty() && self.parting.is_empty() && self.freed.is_empty();
        let lost = if is_whole { 0 } else { LOST };
        let passing = if self.is_passing() { PASSING } else { 0 };
        w.u8(state | in_world | wears | dressed | lost | passing);
        if lost != 0 {
            self.save_lost(w);
        }
        w.transform(self.world_from_character);
        w.f32(self.climbing);
        w.vec3(self.lean);
        let Planting { heights, rates, slopes, slope_rates } = self.planting;
        [heights, rates, slopes, slope_rates].as_flattened().iter().for_each(|&x| w.f32(x));
        self.animator.save(self.def.set(), w);
        save_rising(w, self.rising);
        save_pose(w, &self.pose);
        w.transform(self.earlier.world_from_character);
        save_pose(w, &self.earlier.pose);
        save_pose(w, self.physical.base());
        self.lingering.save(w);
        w.u32(self.stillness.steps);
        w.u32(self.stillness.calm_steps);
        w.bool(self.stillness.settled);
        w.bool(self.stillness.touched);
        w.bool(self.stillness.free);
        self.drives.save(w);
        w.u32(self.preparation.get_up);
        w.u32(self.preparation.start);
        w.f32(self.preparation.seconds);
        w.bool(self.ragdoll.is_some());
        if let Some(ragdoll) = &self.ragdoll {
            ragdoll.bodies.iter().for_each(|body| w.u64(body.to_bits()));
            ragdoll.joints.iter().for_each(|joint| w.u64(joint.to_bits()));
            w.count(ragdoll.colliding.len());
            for (a, b) in &ragdoll.colliding {
                w.u64(a.to_bits());
                w.u64(b.to_bits());
            }
        }
        if let Some(presence) = &self.presence {
            presence.save(w);
            w.f32(self.flinching);
            w.f32(self.speed);
        }
        if wears != 0 {
            self.swing.save(w);
        }
        if dressed != 0 {
            self.worn.save(w);
        }
        if passing != 0 {
            self.passage.save(w);
        }
        if self.is_clearing() {
            self.clearing.save(w);
        }
    }

    fn number_of_state(&self) -> u8 {
        match self.state {
            State::Animated => 0,
            State::Limp if self.is_clearing() => CLEARING,
            State::Limp => 1,
            State::GettingUp => 2,
            State::Preparing => 3,
            State::Flinching => 4,
            State::Powered => 5,
        }
    }

    /// Writes what calls have brought about since the last update, if anything.
    fn save_untold(&self, w: &mut Writer) {
        let untold = &self.events[self.told..];
        if !untold.is_empty() {
            w.u8(UNTOLD);
            w.count(untold.len());
            untold.iter().for_each(|event| event.save(w));
        }
    }

    /// Brings back a saved state of a character of the same definition. Its bodies are those of the world's snapshot
    /// that was saved at the same time.
    ///
    /// # Errors
    /// If the bytes are not those of a character of this definition and version; the character is then as it was.
    pub fn load(&mut self, r: &mut Reader<'_>) -> Result<(), ReadError> {
        if r.raw(MAGIC.len())? != MAGIC {
            return Err(ReadError { at: 0, what: "is not a character of this version" });
        }
        let (tag, untold) = load_untold(r)?;
        let state = match tag & !FLAGS {
            0 => State::Animated,
            1 | CLEARING => State::Limp,
            2 => State::GettingUp,
            3 => State::Preparing,
            4 => State::Flinching,
            5 => State::Powered,
            _ => return Err(r.error("unknown state of a character")),
        };
        let Apart { lost, parting, freed } =
            if tag & LOST != 0 { self.load_lost(r)? } else { Default::default() };
        let (world_from_character, climbing, lean) = (r.transform()?, r.f32()?, r.vec3()?);
        let mut pair = || Ok([r.f32()?, r.f32()?]);
        let planting = Planting { heights: pair()?, rates: pair()?, slopes: pair()?, slope_rates: pair()? };
        let animator = Animator::load(self.def.set(), r)?;
        let rising = load_rising(r)?;
        let joints = self.def.rig.joints.len();
        let pose = load_pose(r, joints)?;
        let earlier = Earlier { world_from_character: r.transform()?, pose: load_pose(r, joints)? };
        let base = load_pose(r, joints)?;
        let lingering = Inertia::load(r, joints)?;
        let stillness = load_stillness(r)?;
        let mut drives = Drives::new(&self.def.ragdoll);
        drives.load(r)?;
        let preparation = self.load_preparation(r)?;
        let ragdoll = if r.bool()? { Some(self.load_ragdoll(r)?) } else { None };
        let presence =
            if tag & IN_WORLD != 0 { Some(Presence::load(r, self.def.ragdoll.bodies.len())?) } else { None };
        let (flinching, speed) = if presence.is_some() { (r.f32()?, r.f32()?) } else { (0.0, self.speed) };
        let springs = self.def.springs();
        let swing = if tag & WEARS != 0 { SpringSwing::load(springs, r)? } else { SpringSwing::new() };
        let garments = self.def.garments();
        let worn = if tag & DRESSED != 0 { Worn::load(garments, r)? } else { Worn::default() };
        let passage = if tag & PASSING != 0 { Passage::load(r)? } else { Passage::default() };
        let is_clearing = tag & !FLAGS == CLEARING;
        let clearing =
            if is_clearing { Clearing::load(r, self.def.ragdoll.bodies.len())? } else { Clearing::default() };
        let has_bodies = !matches!(state, State::Animated | State::GettingUp);
        let fits = pose.len() == joints
            && springs.is_empty() == (tag & WEARS == 0)
            && garments.is_empty() == (tag & DRESSED == 0)
            && earlier.pose.len() == joints
            && has_bodies == ragdoll.is_some()
            && (state != State::Preparing || !self.def.moves().get_ups.is_empty())
            && (ragdoll.is_none() || base.len() == joints);
        if !fits {
            return Err(r.error("is of another character"));
        }
        (self.state, self.animator, self.rising, self.stillness) = (state, animator, rising, stillness);
        self.lingering = lingering;
        (self.drives, self.preparation, self.lean) = (drives, preparation, lean);
        (self.world_from_character, self.climbing) = (world_from_character, climbing);
        (self.planting, self.passage, self.clearing) = (planting, passage, clearing);
        (self.pose, self.earlier, self.ragdoll) = (pose, earlier, ragdoll);
        (self.presence, self.flinching, self.speed) = (presence, flinching, speed);
        (self.lost, self.parting, self.freed) = (lost, parting, freed);
        self.keep_own();
        (self.swing, self.worn) = (swing, worn);
        self.show_loaded(&base);
        self.keep_shown();
        (self.events, self.told) = (untold, 0);
        self.scratch.posed.clear();
        Ok(())
    }

    /// The pose with what it wears, as it was shown when it was saved.
    fn show_loaded(&mut self, base: &[LocalTransform]) {
        if !base.is_empty() {
            self.physical.rebase(self.def.mapping(), &self.def.rig, base);
        }
        if self.is_planted() {
            self.show_planted();
        }
        self.swung.clear();
        if !(self.swing.turns().is_empty() && self.worn.turns.is_empty()) {
            self.swung = self.pose_without_springs().to_vec();
            self.show_springs();
            self.show_garments();
        }
    }

    fn save_lost(&self, w: &mut Writer) {
        w.count(self.lost.len());
        for &(body, id) in &self.lost {
            w.u32(body as u32);
            w.u64(id.to_bits());
        }
        w.count(self.parting.len());
        self.parting.iter().flat_map(|&(a, b)| [a, b]).for_each(|body| w.u64(body.to_bits()));
        w.count(self.freed.len());
        self.freed.iter().for_each(|body| w.u64(body.to_bits()));
    }

    /// Limbs that were cut off or let go.
    fn load_lost(&self, r: &mut Reader<'_>) -> Result<Apart, ReadError> {
        let (mut lost, mut parting): (Vec<(usize, BodyId)>, _) = (Vec::new(), Vec::new());
        for _ in 0..r.count(12)? {
            lost.push((r.u32()? as usize, BodyId::from_bits(r.u64()?)));
        }
        let bodies = self.def.ragdoll.bodies.len();
        let fits = lost.iter().all(|&(body, _)| (1..bodies).contains(&body));
        if !fits || !lost.is_sorted_by(|a, b| a.0 < b.0) {
            return Err(r.error("has lost what it never had"));
        }
        for _ in 0..r.count(16)? {
            parting.push((BodyId::from_bits(r.u64()?), BodyId::from_bits(r.u64()?)));
        }
        let mut freed = Vec::new();
        for _ in 0..r.count(8)? {
            freed.push(BodyId::from_bits(r.u64()?));
        }
        Ok(Apart { lost, parting, freed })
    }

    fn load_preparation(&self, r: &mut Reader<'_>) -> Result<Preparation, ReadError> {
        let preparation = Preparation { get_up: r.u32()?, start: r.u32()?, seconds: r.f32()? };
        let get_up = self.def.moves().get_ups.get(preparation.get_up as usize);
        let is_there = get_up.is_some_and(|get_up| (preparation.start as usize) < get_up.starts.len());
        if is_there || preparation == Preparation::default() {
            return Ok(preparation);
        }
        Err(r.error("prepares for a clip that is not there"))
    }

    fn load_ragdoll(&self, r: &mut Reader<'_>) -> Result<Ragdoll, ReadError> {
        let def = &self.def.ragdoll;
        let mut ragdoll = Ragdoll::default();
        for _ in &def.bodies {
            ragdoll.bodies.push(BodyId::from_bits(r.u64()?));
        }
        for _ in &def.joints {
            ragdoll.joints.push(JointId::from_bits(r.u64()?));
        }
        for _ in 0..r.count(16)? {
            ragdoll.colliding.push((BodyId::from_bits(r.u64()?), BodyId::from_bits(r.u64()?)));
        }
        Ok(ragdoll)
    }
}

/// Reads what comes first: a state, and events that no update has told of.
fn load_untold(r: &mut Reader<'_>) -> Result<(u8, Vec<CharacterEvent>), ReadError> {
    let tag = r.u8()?;
    if tag != UNTOLD {
        return Ok((tag, Vec::new()));
    }
    let events = (0..r.count(EVENT_BYTES)?).map(|_| CharacterEvent::load(r)).collect::<Result<_, _>>()?;
    Ok((r.u8()?, events))
}

/// Limbs that were cut off or let go.
#[derive(Default)]
struct Apart {
    lost: Vec<(usize, BodyId)>,
    parting: Vec<(BodyId, BodyId)>,
    freed: Vec<BodyId>,
}

impl Passage {
    fn save(&self, w: &mut Writer) {
        let Self { from, to, ankles, far, age, seconds } = self;
        from.iter().chain(to).chain(far).chain([age, seconds]).for_each(|&x| w.f32(x));
        ankles.iter().for_each(|&ankle| w.transform(ankle));
    }

    fn load(r: &mut Reader<'_>) -> Result<Self, ReadError> {
        let mut numbers = [0.0; 2 * PARTS + 4];
        for number in &mut numbers {
            *number = r.f32()?;
        }
        let part = |first: usize| -> Depths { core::array::from_fn(|part| numbers[first + part]) };
        let [left, right, age, seconds] = core::array::from_fn(|k| numbers[2 * PARTS + k]);
        let ankles = [r.transform()?, r.transform()?];
        Ok(Self { from: part(0), to: part(PARTS), ankles, far: [left, right], age, seconds })
    }
}

impl Clearing {
    fn save(&self, w: &mut Writer) {
        w.vec3(self.way);
        w.count(self.velocities.len());
        for velocity in &self.velocities {
            w.vec3(velocity.linear);
            w.vec3(velocity.angular);
        }
    }

    fn load(r: &mut Reader<'_>, bodies: usize) -> Result<Self, ReadError> {
        let way = r.vec3()?;
        let count = r.count(24)?;
        if count == 0 || count > bodies {
            return Err(r.error("is of another character"));
        }
        let mut velocities = Vec::with_capacity(count);
        for _ in 0..count {
            velocities.push(Velocity { linear: r.vec3()?, angular: r.vec3()? });
        }
        let are_finite = |v: &Velocity| v.linear.is_finite() && v.angular.is_finite();
        if !way.is_finite() || !velocities.iter().all(are_finite) {
            return Err(r.error("a way or a velocity that is not finite"));
        }
        Ok(Self { way, velocities })
    }
}

impl Presence {
    fn save(&self, w: &mut Writer) {
        w.u64(self.mover.map_or(u64::MAX, MoverId::to_bits));
        w.u64(self.bearer.map_or(u64::MAX, BodyId::to_bits));
        w.count(self.bodies.len());
        self.bodies.iter().for_each(|body| w.u64(body.to_bits()));
        w.count(self.before.len());
        self.before.iter().for_each(|&pose| w.transform(pose));
        for wish in [self.wish, self.facing] {
            w.bool(wish.is_some());
            w.vec3(wish.unwrap_or_default());
        }
        w.vec3(self.velocity);
        [self.yaw, self.pace, self.air].into_iter().for_each(|x| w.f32(x));
        w.vec3(self.beside);
        w.bool(self.falls);
        w.u8(self.detail as u8);
        w.count(self.holds.len());
        for Hold { held, joint, body, drops, grasp } in &self.holds {
            w.u64(held.to_bits());
            w.u64(joint.to_bits());
            w.u32(*body);
            w.u8(u8::from(*drops) | if grasp.is_some() { GRASPS } else { 0 });
            grasp.iter().for_each(|grasp| grasp.save(w));
        }
        w.bool(self.stumble.is_some());
        if let Some(stumble) = &self.stumble {
            stumble.save(w);
        }
    }

    fn load(r: &mut Reader<'_>, most: usize) -> Result<Self, ReadError> {
        let mut id = || Ok::<_, ReadError>(Some(r.u64()?).filter(|&bits| bits != u64::MAX));
        let (mover, bearer) = (id()?.map(MoverId::from_bits), id()?.map(BodyId::from_bits));
        let mut presence = Self { mover, bearer, ..Self::default() };
        for _ in 0..r.count(8)? {
            presence.bodies.push(BodyId::from_bits(r.u64()?));
        }
        for _ in 0..r.count(28)? {
            presence.before.push(r.transform()?);
        }
        if [presence.bodies.len(), presence.before.len()].iter().any(|&count| count != 0 && count != most) {
            return Err(r.error("is of another character"));
        }
        let mut wish =
            || Ok::<_, ReadError>(if r.bool()? { Some(r.vec3()?) } else { r.vec3().map(|_| None)? });
        (presence.wish, presence.facing) = (wish()?, wish()?);
        presence.velocity = r.vec3()?;
        (presence.yaw, presence.pace) = (r.f32()?, r.f32()?);
        (presence.air, presence.beside) = (r.f32()?, r.vec3()?);
        presence.falls = r.bool()?;
        presence.detail = match r.u8()? {
            0 => Detail::Frozen,
            1 => Detail::Keyed,
            2 => Detail::HitBodies,
            3 => Detail::Full,
            _ => return Err(r.error("unknown detail of a character")),
        };
        for _ in 0..r.count(21)? {
            let (held, joint) = (BodyId::from_bits(r.u64()?), JointId::from_bits(r.u64()?));
            let (body, tag) = (r.u32()?, r.u8()?);
            let grasp = if tag & GRASPS != 0 { Some(Grasp::load(r)?) } else { None };
            let drops = tag & 1 != 0;
            if body as usize >= most || tag > (GRASPS | 1) {
                return Err(r.error("is of another character"));
            }
            presence.holds.push(Hold { held, joint, body, drops, grasp });
        }
        presence.stumble = if r.bool()? { Some(Stumble::load(r)?) } else { None };
        Ok(presence)
    }
}

fn save_rising(w: &mut Writer, rising: Rising) {
    match rising {
        Rising::ByClip(track) => {
            w.u8(0);
            w.u64(track.to_bits());
        }
        Rising::Without(seconds) => {
            w.u8(1);
            w.f32(seconds);
        }
    }
}

fn load_stillness(r: &mut Reader<'_>) -> Result<Stillness, ReadError> {
    let (steps, calm_steps) = (r.u32()?, r.u32()?);
    let (settled, touched, free) = (r.bool()?, r.bool()?, r.bool()?);
    Ok(Stillness { steps, calm_steps, settled, touched, free })
}

fn load_rising(r: &mut Reader<'_>) -> Result<Rising, ReadError> {
    match r.u8()? {
        0 => Ok(Rising::ByClip(TrackId::from_bits(r.u64()?))),
        1 => Ok(Rising::Without(r.f32()?)),
        _ => Err(r.error("unknown way of getting up")),
    }
}

fn save_pose(w: &mut Writer, pose: &[LocalTransform]) {
    w.count(pose.len());
    for local in pose {
        w.vec3(local.translation);
        w.rotation(local.rotation);
        w.vec3(local.scale);
    }
}

/// A pose of `joints` joints, or an empty one.
fn load_pose(r: &mut Reader<'_>, joints: usize) -> Result<Vec<LocalTransform>, ReadError> {
    let count = r.count(LOCAL_BYTES)?;
    if count != 0 && count != joints {
        return Err(r.error("a pose of another rig"));
    }
    let mut pose = Vec::with_capacity(count);
    for _ in 0..count {
        pose.push(LocalTransform { translation: r.vec3()?, rotation: r.rotation()?, scale: r.vec3()? });
    }
    Ok(pose)
}
