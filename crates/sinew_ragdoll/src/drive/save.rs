//! Saves drives, in addition to the world's snapshot.

use super::level::{Level, Spring};
use super::{Drive, DriveMode, Drives, Muscle, Pin};
use sinew_math::{ReadError, Reader, Writer};
use sinew_physics::{BodyId, JointId};

/// First bytes of saved drives; the last one is the version.
const MAGIC: &[u8; 8] = b"sinew-d\x01";

impl Drives {
    /// Writes all state that affects the future and that neither the world's snapshot nor the definition holds.
    pub fn save(&self, w: &mut Writer) {
        w.raw(MAGIC);
        w.f32(self.recovery);
        w.bool(self.ground.is_some());
        if let Some(ground) = self.ground {
            w.u64(ground.to_bits());
        }
        for drive in &self.drives {
            save_mode(w, drive.mode);
            let Level { muscle, strength, pin, force, torque } = drive.level;
            let springs = [muscle.stiffness, muscle.damping, pin.stiffness, pin.damping];
            let rest = [strength, force, torque, drive.half_life, drive.since, drive.weakness];
            springs.into_iter().chain(rest).for_each(|x| w.f32(x));
            w.bool(drive.keyed);
            w.bool(drive.pin.is_some());
            if let Some(pin) = drive.pin {
                w.u64(pin.to_bits());
            }
        }
    }

    /// Restores saved drives of the same definition.
    ///
    /// # Errors
    /// If the bytes are not a saved state; the drives then do not change.
    pub fn load(&mut self, r: &mut Reader<'_>) -> Result<(), ReadError> {
        if r.raw(MAGIC.len())? != MAGIC {
            return Err(r.error("these bytes are not ragdoll drives saved by this version"));
        }
        let recovery = sound(r)?;
        let ground = if r.bool()? { Some(BodyId::from_bits(r.u64()?)) } else { None };
        let mut drives = Vec::with_capacity(self.drives.len());
        for _ in 0..self.drives.len() {
            let mode = load_mode(r)?;
            let muscle = Spring { stiffness: sound(r)?, damping: sound(r)? };
            let pin = Spring { stiffness: sound(r)?, damping: sound(r)? };
            let level = Level { muscle, pin, strength: sound(r)?, force: sound(r)?, torque: sound(r)? };
            let (half_life, since, weakness) = (sound(r)?, sound(r)?, sound(r)?);
            let keyed = r.bool()?;
            let pin = if r.bool()? { Some(JointId::from_bits(r.u64()?)) } else { None };
            drives.push(Drive { mode, half_life, since, level, weakness, keyed, pin });
        }
        (self.drives, self.ground, self.recovery) = (drives, ground, recovery);
        Ok(())
    }
}

fn save_mode(w: &mut Writer, mode: DriveMode) {
    let (number, muscle, pin) = match mode {
        DriveMode::Limp => (0, None, None),
        DriveMode::Powered(muscle) => (1, Some(muscle), None),
        DriveMode::Pinned(muscle, pin) => (2, Some(muscle), Some(pin)),
        DriveMode::Keyed => (3, None, None),
    };
    w.u8(number);
    if let Some(Muscle { hertz, damping_ratio, strength }) = muscle {
        [hertz, damping_ratio, strength].into_iter().for_each(|x| w.f32(x));
    }
    if let Some(Pin { hertz, damping_ratio, max_force, max_torque }) = pin {
        [hertz, damping_ratio, max_force, max_torque].into_iter().for_each(|x| w.f32(x));
    }
}

fn load_mode(r: &mut Reader<'_>) -> Result<DriveMode, ReadError> {
    let muscle = |r: &mut Reader<'_>| {
        Ok::<_, ReadError>(Muscle { hertz: sound(r)?, damping_ratio: sound(r)?, strength: sound(r)? })
    };
    Ok(match r.u8()? {
        0 => DriveMode::Limp,
        1 => DriveMode::Powered(muscle(r)?),
        2 => {
            let muscle = muscle(r)?;
            let (hertz, damping_ratio) = (sound(r)?, sound(r)?);
            DriveMode::Pinned(
                muscle,
                Pin { hertz, damping_ratio, max_force: sound(r)?, max_torque: sound(r)? },
            )
        }
        3 => DriveMode::Keyed,
        _ => return Err(r.error("unknown drive mode of a body")),
    })
}

/// Reads a number that must be finite and not negative.
fn sound(r: &mut Reader<'_>) -> Result<f32, ReadError> {
    let x = r.f32()?;
    if (0.0..f32::INFINITY).contains(&x) {
        Ok(x)
    } else {
        Err(r.error("a number of a drive is negative or not finite"))
    }
}
