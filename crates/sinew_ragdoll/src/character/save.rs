//! A character's own state, beside the world's snapshot.

use super::animate::Motion;
use super::limp::Stillness;
use super::{Character, State};
use crate::ragdoll::Ragdoll;
use sinew_anim::{LocalTransform, SampleCache, Wrap};
use sinew_math::{ReadError, Reader, Writer};
use sinew_physics::{BodyId, JointId};

/// First bytes; the last is the version.
const MAGIC: &[u8; 8] = b"sinew-c\x01";
/// Bytes of a local transform.
const LOCAL_BYTES: usize = 40;

impl Character {
    /// Writes what decides the future, and nothing that its definition holds.
    pub fn save(&self, w: &mut Writer) {
        w.raw(MAGIC);
        w.u8(match self.state {
            State::Animated => 0,
            State::Limp => 1,
            State::GettingUp => 2,
        });
        w.transform(self.world_from_character);
        w.vec3(self.root_velocity);
        save_motion(w, &self.motion);
        save_pose(w, &self.pose);
        save_pose(w, self.physical.base());
        w.u32(self.stillness.steps);
        w.u32(self.stillness.calm_steps);
        w.bool(self.stillness.settled);
        w.bool(self.stillness.touched);
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
        let state = match r.u8()? {
            0 => State::Animated,
            1 => State::Limp,
            2 => State::GettingUp,
            _ => return Err(r.error("unknown state of a character")),
        };
        let (world_from_character, root_velocity) = (r.transform()?, r.vec3()?);
        let motion = self.load_motion(r)?;
        let joints = self.def.rig.joints.len();
        let pose = load_pose(r, joints)?;
        let base = load_pose(r, joints)?;
        let stillness =
            Stillness { steps: r.u32()?, calm_steps: r.u32()?, settled: r.bool()?, touched: r.bool()? };
        let ragdoll = if r.bool()? { Some(self.load_ragdoll(r)?) } else { None };
        let fits = pose.len() == joints
            && (state == State::Limp) == ragdoll.is_some()
            && (state != State::Limp || base.len() == joints)
            && (motion.fade == 0.0 || motion.from.len() == joints);
        if !fits {
            return Err(r.error("is of another character"));
        }
        (self.state, self.motion, self.stillness) = (state, motion, stillness);
        (self.world_from_character, self.root_velocity) = (world_from_character, root_velocity);
        (self.pose, self.ragdoll) = (pose, ragdoll);
        if !base.is_empty() {
            self.physical.rebase(self.def.mapping(), &self.def.rig, &base);
        }
        self.events.clear();
        Ok(())
    }

    fn load_motion(&self, r: &mut Reader<'_>) -> Result<Motion, ReadError> {
        let clip = match r.u32()? {
            u32::MAX => None,
            clip if (clip as usize) < self.def.clips.len() => Some(clip as usize),
            _ => return Err(r.error("plays a clip that is not there")),
        };
        let wrap = if r.bool()? { Wrap::Loop } else { Wrap::Clamp };
        let (phase, time, fade, ends) = (r.f32()?, r.f32()?, r.f32()?, r.f32()?);
        let from = load_pose(r, self.def.rig.joints.len())?;
        Ok(Motion { clip, wrap, phase, time, from, fade, ends, cache: SampleCache::default() })
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

fn save_motion(w: &mut Writer, motion: &Motion) {
    w.u32(motion.clip.map_or(u32::MAX, |clip| clip as u32));
    w.bool(motion.wrap == Wrap::Loop);
    w.f32(motion.phase);
    w.f32(motion.time);
    w.f32(motion.fade);
    w.f32(motion.ends);
    save_pose(w, &motion.from);
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
