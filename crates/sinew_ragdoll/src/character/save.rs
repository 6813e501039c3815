//! Saves a character's own state, in addition to the world's snapshot.

use super::activity::{Activity, Flinch};
use super::clearance::{Depths, PARTS, Passage};
use super::distances::Detail;
use super::figure::Moment;
use super::gait::Gait;
use super::get_up::{Rising, Way};
use super::grasp::Grasp;
use super::hold::{Grips, Hold};
use super::legs::Planting;
use super::limp::{Clearing, Lying, Stillness};
use super::physique::Physique;
use super::prepare::Preparing;
use super::stumble::{Balance, Stumble};
use super::tread::{Tread, Treads};
use super::{AfterSettling, Character, CharacterDef, CharacterEvent, State};
use crate::garments::Worn;
use crate::ragdoll::Ragdoll;
use crate::springs::SpringSwing;
use sinew_anim::{Animator, Inertia, LocalTransform, TrackId};
use sinew_math::{ReadError, Reader, Vec3, Writer};
use sinew_physics::{BodyId, JointId, MoverId, Velocity};

/// First bytes of a saved character; the last one is the version.
const MAGIC: &[u8; 8] = b"sinew-c\x0b";
/// Flag of a held body whose grip pulls; the state of the grip follows in the bytes.
const GRASPS: u8 = 2;
/// Number of bytes in which an unreported event is saved.
const EVENT_BYTES: usize = 17;
/// Number of bytes in which a local transform is saved.
const LOCAL_BYTES: usize = 40;
/// Error for bytes that do not fit the definition.
const OF_ANOTHER: &str = "these bytes are of a character with another definition";

impl Character {
    /// Writes all state that affects the future, without the definition.
    pub fn save(&self, w: &mut Writer) {
        w.raw(MAGIC);
        save_activity(w, &self.activity);
        w.bool(self.after_settling == AfterSettling::GetUp);
        w.u8(self.detail.map_or(u8::MAX, |detail| detail as u8));
        self.gait.save(w, &self.def);
        w.transform(self.figure.place);
        save_pose(w, &self.figure.pose);
        w.transform(self.figure.earlier.place);
        save_pose(w, &self.figure.earlier.pose);
        let Planting { heights, rates, slopes, slope_rates } = self.feet.planting;
        [heights, rates, slopes, slope_rates].as_flattened().iter().for_each(|&x| w.f32(x));
        w.bool(self.feet.treads.is_some());
        if let Some(treads) = &self.feet.treads {
            treads.save(w);
        }
        w.bool(self.feet.is_passing());
        if self.feet.is_passing() {
            self.feet.passage.save(w);
        }
        self.feet.walls.0.iter().for_each(|&offset| w.vec3(offset));
        save_physique(w, &self.physique);
        self.grips.save(w);
        if !self.def.springs().is_empty() {
            self.wear.springs.save(w);
        }
        if !self.def.garments().is_empty() {
            self.wear.garments.save(w);
        }
        let untold = self.events.untold();
        w.count(untold.len());
        untold.iter().for_each(|event| event.save(w));
    }

    /// Restores a saved state of a character of the same definition. Its bodies come from the world's snapshot of the
    /// same time.
    ///
    /// # Errors
    /// If the bytes are not a saved character of this definition and version; the character then does not change.
    pub fn load(&mut self, r: &mut Reader<'_>) -> Result<(), ReadError> {
        if r.raw(MAGIC.len())? != MAGIC {
            return Err(ReadError { at: 0, what: "these bytes are not a character saved by this version" });
        }
        let def = self.def.clone();
        let (joints, count) = (def.rig.joints.len(), def.ragdoll.bodies.len());
        let mut loaded = self.clone();
        loaded.activity = load_activity(&def, r)?;
        loaded.after_settling = if r.bool()? { AfterSettling::GetUp } else { AfterSettling::StayDown };
        loaded.detail = load_detail(r)?;
        loaded.gait = Gait::load(&def, r)?;
        let place = r.transform()?;
        let pose = load_pose(r, joints)?;
        let earlier = Moment { place: r.transform()?, pose: load_pose(r, joints)? };
        let mut pair = || Ok([r.f32()?, r.f32()?]);
        loaded.feet.planting =
            Planting { heights: pair()?, rates: pair()?, slopes: pair()?, slope_rates: pair()? };
        loaded.feet.treads = if r.bool()? { Some(Treads::load(r)?) } else { None };
        loaded.feet.passage = if r.bool()? { Passage::load(r)? } else { Passage::default() };
        for offset in &mut loaded.feet.walls.0 {
            *offset = r.vec3()?;
        }
        loaded.physique = load_physique(&def, r)?;
        loaded.grips = Grips::load(r, count)?;
        let (springs, garments) = (def.springs(), def.garments());
        loaded.wear.springs =
            if springs.is_empty() { SpringSwing::new() } else { SpringSwing::load(springs, r)? };
        loaded.wear.garments = if garments.is_empty() { Worn::default() } else { Worn::load(garments, r)? };
        let count = r.count(EVENT_BYTES)?;
        let untold = (0..count).map(|_| CharacterEvent::load(r)).collect::<Result<Vec<_>, _>>()?;
        let has_bodies = !matches!(loaded.activity, Activity::Animated | Activity::GettingUp(_));
        let is_based = loaded.physique.physical.base().len() == joints;
        let fits = [pose.len(), earlier.pose.len()] == [joints; 2]
            && has_bodies == loaded.physique.ragdoll.is_some()
            && (is_based || !has_bodies);
        if !fits {
            return Err(r.error(OF_ANOTHER));
        }
        (loaded.figure.place, loaded.figure.pose, loaded.figure.earlier) = (place, pose, earlier);
        loaded.show_loaded();
        loaded.events.list = untold;
        *self = loaded;
        Ok(())
    }

    /// Computes the shown pose at the time of saving.
    fn show_loaded(&mut self) {
        let state = self.activity.state();
        self.feet.pose.clear();
        if self.feet.are_placed() && matches!(state, State::Animated | State::GettingUp) {
            self.feet.show(&self.def, state, &self.figure, &mut self.scratch.model);
        }
        let pose = self.feet.led(&self.figure.pose);
        self.wear.show_loaded(&self.def, pose);
        self.keep_shown();
        self.events.clear();
        self.scratch.posed.clear();
    }
}

fn save_activity(w: &mut Writer, activity: &Activity) {
    match activity {
        Activity::Animated => w.u8(0),
        Activity::Limp(Lying { stillness, clearing }) => {
            w.u8(1);
            stillness.save(w);
            w.bool(activity.is_clearing());
            if activity.is_clearing() {
                clearing.save(w);
            }
        }
        Activity::GettingUp(Rising { way, lean }) => {
            w.u8(2);
            w.vec3(*lean);
            match *way {
                Way::ByClip(track) => {
                    w.u8(0);
                    w.u64(track.to_bits());
                }
                Way::Without(seconds) => {
                    w.u8(1);
                    w.f32(seconds);
                }
            }
        }
        Activity::Preparing(Preparing { stillness, get_up, start, seconds }) => {
            w.u8(3);
            stillness.save(w);
            w.u32(*get_up);
            w.u32(*start);
            w.f32(*seconds);
        }
        Activity::Flinching(Flinch { seconds }) => {
            w.u8(4);
            w.f32(*seconds);
        }
        Activity::Powered(Balance { stumble }) => {
            w.u8(5);
            w.bool(stumble.is_some());
            stumble.iter().for_each(|stumble| stumble.save(w));
        }
    }
}

fn load_activity(def: &CharacterDef, r: &mut Reader<'_>) -> Result<Activity, ReadError> {
    Ok(match r.u8()? {
        0 => Activity::Animated,
        1 => {
            let stillness = Stillness::load(r)?;
            let clearing =
                if r.bool()? { Clearing::load(r, def.ragdoll.bodies.len())? } else { Clearing::default() };
            Activity::Limp(Lying { stillness, clearing })
        }
        2 => {
            let lean = r.vec3()?;
            let way = match r.u8()? {
                0 => Way::ByClip(TrackId::from_bits(r.u64()?)),
                1 => Way::Without(r.f32()?),
                _ => return Err(r.error("unknown method of getting up")),
            };
            Activity::GettingUp(Rising { way, lean })
        }
        3 => {
            let stillness = Stillness::load(r)?;
            let preparing = Preparing { stillness, get_up: r.u32()?, start: r.u32()?, seconds: r.f32()? };
            let get_up = def.moves().get_ups.get(preparing.get_up as usize);
            if get_up.is_none_or(|get_up| preparing.start as usize >= get_up.starts.len()) {
                return Err(r.error("the character prepares for a clip that its definition does not contain"));
            }
            Activity::Preparing(preparing)
        }
        4 => Activity::Flinching(Flinch { seconds: r.f32()? }),
        5 => {
            let stumble = if r.bool()? { Some(Stumble::load(r)?) } else { None };
            Activity::Powered(Balance { stumble })
        }
        _ => return Err(r.error("unknown state of the character")),
    })
}

fn load_detail(r: &mut Reader<'_>) -> Result<Option<Detail>, ReadError> {
    Ok(match r.u8()? {
        0 => Some(Detail::Frozen),
        1 => Some(Detail::Keyed),
        2 => Some(Detail::HitBodies),
        3 => Some(Detail::Full),
        u8::MAX => None,
        _ => return Err(r.error("unknown level of detail of the character")),
    })
}

impl Treads {
    fn save(&self, w: &mut Writer) {
        for Tread { offset, home, slip, points, ground, floor, stands } in self.feet {
            [offset, home, slip, points[0], points[1], floor].into_iter().for_each(|v| w.vec3(v));
            w.f32(ground);
            w.bool(stands);
        }
        w.f32(self.level);
        w.f32(self.lowering);
        w.bool(self.aloft);
    }

    fn load(r: &mut Reader<'_>) -> Result<Self, ReadError> {
        let mut foot = || -> Result<Tread, ReadError> {
            let (offset, home, slip) = (r.vec3()?, r.vec3()?, r.vec3()?);
            let (points, floor) = ([r.vec3()?, r.vec3()?], r.vec3()?);
            Ok(Tread { offset, home, slip, points, floor, ground: r.f32()?, stands: r.bool()? })
        };
        Ok(Self { feet: [foot()?, foot()?], level: r.f32()?, lowering: r.f32()?, aloft: r.bool()? })
    }
}

impl Stillness {
    fn save(&self, w: &mut Writer) {
        w.u32(self.steps);
        w.u32(self.calm_steps);
        [self.settled, self.touched, self.free].into_iter().for_each(|x| w.bool(x));
    }

    fn load(r: &mut Reader<'_>) -> Result<Self, ReadError> {
        let (steps, calm_steps) = (r.u32()?, r.u32()?);
        let (settled, touched, free) = (r.bool()?, r.bool()?, r.bool()?);
        Ok(Self { steps, calm_steps, settled, touched, free })
    }
}

impl Gait {
    fn save(&self, w: &mut Writer, def: &CharacterDef) {
        self.animator.save(def.set(), w);
        w.u64(self.mover.map_or(u64::MAX, MoverId::to_bits));
        for wish in [self.wish, self.facing] {
            w.bool(wish.is_some());
            w.vec3(wish.unwrap_or_default());
        }
        w.vec3(self.velocity);
        w.vec3(self.beside);
        w.vec3(self.shoved);
        [self.yaw, self.speed, self.climbing, self.pace, self.air].into_iter().for_each(|x| w.f32(x));
        w.bool(self.falls);
    }

    fn load(def: &CharacterDef, r: &mut Reader<'_>) -> Result<Self, ReadError> {
        let animator = Animator::load(def.set(), r)?;
        let mover = load_id(r)?.map(MoverId::from_bits);
        let mut wish = || {
            Ok::<Option<Vec3>, ReadError>(if r.bool()? { Some(r.vec3()?) } else { r.vec3().map(|_| None)? })
        };
        let (wish, facing) = (wish()?, wish()?);
        let (velocity, beside, shoved) = (r.vec3()?, r.vec3()?, r.vec3()?);
        let [yaw, speed, climbing, pace, air] = [r.f32()?, r.f32()?, r.f32()?, r.f32()?, r.f32()?];
        let falls = r.bool()?;
        let (blown, pulled) = (Vec3::ZERO, Vec3::ZERO);
        Ok(Self {
            animator,
            mover,
            wish,
            facing,
            yaw,
            velocity,
            speed,
            climbing,
            lifted: 0.0,
            pace,
            air,
            beside,
            shoved,
            blown,
            pulled,
            falls,
        })
    }
}

fn load_id(r: &mut Reader<'_>) -> Result<Option<u64>, ReadError> {
    Ok(Some(r.u64()?).filter(|&bits| bits != u64::MAX))
}

fn save_pairs(w: &mut Writer, pairs: &[(BodyId, BodyId)]) {
    w.count(pairs.len());
    pairs.iter().flat_map(|&(a, b)| [a, b]).for_each(|body| w.u64(body.to_bits()));
}

fn load_pairs(r: &mut Reader<'_>) -> Result<Vec<(BodyId, BodyId)>, ReadError> {
    let count = r.count(16)?;
    (0..count).map(|_| Ok((BodyId::from_bits(r.u64()?), BodyId::from_bits(r.u64()?)))).collect()
}

fn save_bodies(w: &mut Writer, bodies: &[BodyId]) {
    w.count(bodies.len());
    bodies.iter().for_each(|body| w.u64(body.to_bits()));
}

fn load_bodies(r: &mut Reader<'_>) -> Result<Vec<BodyId>, ReadError> {
    let count = r.count(8)?;
    (0..count).map(|_| Ok(BodyId::from_bits(r.u64()?))).collect()
}

fn save_physique(w: &mut Writer, physique: &Physique) {
    save_bodies(w, &physique.hit);
    w.count(physique.before.len());
    physique.before.iter().for_each(|&pose| w.transform(pose));
    w.bool(physique.ragdoll.is_some());
    if let Some(ragdoll) = &physique.ragdoll {
        ragdoll.bodies.iter().for_each(|body| w.u64(body.to_bits()));
        ragdoll.joints.iter().for_each(|joint| w.u64(joint.to_bits()));
        save_pairs(w, &ragdoll.colliding);
    }
    physique.drives.save(w);
    save_pose(w, physique.physical.base());
    physique.lingering.save(w);
    w.count(physique.lost.len());
    for &(body, id) in &physique.lost {
        w.u32(body as u32);
        w.u64(id.to_bits());
    }
    save_pairs(w, &physique.parting);
}

fn load_physique(def: &CharacterDef, r: &mut Reader<'_>) -> Result<Physique, ReadError> {
    let (joints, count) = (def.rig.joints.len(), def.ragdoll.bodies.len());
    let mut physique = Physique::new(def);
    physique.hit = load_bodies(r)?;
    for _ in 0..r.count(28)? {
        physique.before.push(r.transform()?);
    }
    if [physique.hit.len(), physique.before.len()].iter().any(|&len| len != 0 && len != count) {
        return Err(r.error(OF_ANOTHER));
    }
    physique.ragdoll = if r.bool()? { Some(load_ragdoll(def, r)?) } else { None };
    physique.drives.load(r)?;
    let base = load_pose(r, joints)?;
    physique.lingering = Inertia::load(r, joints)?;
    for _ in 0..r.count(12)? {
        physique.lost.push((r.u32()? as usize, BodyId::from_bits(r.u64()?)));
    }
    let fits = physique.lost.iter().all(|&(body, _)| (1..count).contains(&body));
    if !fits || !physique.lost.is_sorted_by(|a, b| a.0 < b.0) {
        return Err(r.error("a detached body is not part of the definition"));
    }
    physique.parting = load_pairs(r)?;
    if !base.is_empty() {
        physique.physical.rebase(def.mapping(), &def.rig, &base);
    }
    physique.keep_own();
    Ok(physique)
}

fn load_ragdoll(def: &CharacterDef, r: &mut Reader<'_>) -> Result<Ragdoll, ReadError> {
    let mut ragdoll = Ragdoll::default();
    for _ in &def.ragdoll.bodies {
        ragdoll.bodies.push(BodyId::from_bits(r.u64()?));
    }
    for _ in &def.ragdoll.joints {
        ragdoll.joints.push(JointId::from_bits(r.u64()?));
    }
    ragdoll.colliding = load_pairs(r)?;
    Ok(ragdoll)
}

impl Grips {
    fn save(&self, w: &mut Writer) {
        w.u64(self.bearer.map_or(u64::MAX, BodyId::to_bits));
        save_bodies(w, &self.freed);
        w.count(self.holds.len());
        for Hold { held, joint, body, drops, grasp } in &self.holds {
            w.u64(held.to_bits());
            w.u64(joint.to_bits());
            w.u32(*body);
            w.u8(u8::from(*drops) | if grasp.is_some() { GRASPS } else { 0 });
            grasp.iter().for_each(|grasp| grasp.save(w));
        }
    }

    fn load(r: &mut Reader<'_>, most: usize) -> Result<Self, ReadError> {
        let bearer = load_id(r)?.map(BodyId::from_bits);
        let mut grips = Self { bearer, freed: load_bodies(r)?, holds: Vec::new() };
        for _ in 0..r.count(21)? {
            let (held, joint) = (BodyId::from_bits(r.u64()?), JointId::from_bits(r.u64()?));
            let (body, tag) = (r.u32()?, r.u8()?);
            let grasp = if tag & GRASPS != 0 { Some(Grasp::load(r)?) } else { None };
            let drops = tag & 1 != 0;
            if body as usize >= most || tag > (GRASPS | 1) {
                return Err(r.error(OF_ANOTHER));
            }
            grips.holds.push(Hold { held, joint, body, drops, grasp });
        }
        Ok(grips)
    }
}

impl Passage {
    fn save(&self, w: &mut Writer) {
        let Self { from, to, ankles, far, age, seconds, rises, rise_rates } = self;
        let parts = [from, to, rises, rise_rates].into_iter().flatten();
        parts.chain(far).chain([age, seconds]).for_each(|&x| w.f32(x));
        ankles.iter().for_each(|&ankle| w.transform(ankle));
    }

    fn load(r: &mut Reader<'_>) -> Result<Self, ReadError> {
        let mut numbers = [0.0; 4 * PARTS + 4];
        for number in &mut numbers {
            *number = r.f32()?;
        }
        let part = |first: usize| -> Depths { core::array::from_fn(|part| numbers[first + part]) };
        let [left, right, age, seconds] = core::array::from_fn(|k| numbers[4 * PARTS + k]);
        let ankles = [r.transform()?, r.transform()?];
        let [from, to, rises, rise_rates] = [0, 1, 2, 3].map(|k| part(k * PARTS));
        Ok(Self { from, to, ankles, far: [left, right], age, seconds, rises, rise_rates })
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
            return Err(r.error(OF_ANOTHER));
        }
        let mut velocities = Vec::with_capacity(count);
        for _ in 0..count {
            velocities.push(Velocity { linear: r.vec3()?, angular: r.vec3()? });
        }
        let are_finite = |v: &Velocity| v.linear.is_finite() && v.angular.is_finite();
        if !way.is_finite() || !velocities.iter().all(are_finite) {
            return Err(r.error("a displacement or a velocity is not finite"));
        }
        Ok(Self { way, velocities })
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

/// Reads a pose of `joints` joints, or an empty one.
fn load_pose(r: &mut Reader<'_>, joints: usize) -> Result<Vec<LocalTransform>, ReadError> {
    let count = r.count(LOCAL_BYTES)?;
    if count != 0 && count != joints {
        return Err(r.error("the pose has another number of joints than the rig"));
    }
    let mut pose = Vec::with_capacity(count);
    for _ in 0..count {
        pose.push(LocalTransform { translation: r.vec3()?, rotation: r.rotation()?, scale: r.vec3()? });
    }
    Ok(pose)
}
