//! Springs in snapshots.

use super::step::Mode;
use super::{SpringRig, SpringSwing};
use sinew_math::{Affine, Mat3, ReadError, Reader, Writer};

impl SpringSwing {
    /// Writes all state that affects the future, and the shown state.
    pub fn save(&self, w: &mut Writer) {
        w.u8(self.mode as u8);
        match self.mode {
            Mode::Fresh | Mode::Away => {}
            Mode::Swinging => self.save_swing(w),
            Mode::Easing => {
                for (&offset, &turn) in self.offsets.iter().zip(&self.turns) {
                    w.vec3(offset);
                    w.rotation(turn);
                }
            }
        }
    }

    fn save_swing(&self, w: &mut Writer) {
        w.f32(self.phase);
        for ((&tip, &way), &turn) in self.tips.iter().zip(&self.ways).zip(&self.turns) {
            w.vec3(tip);
            w.vec3(way);
            w.rotation(turn);
        }
        w.f32(self.stride);
        for places in [&self.before, &self.earlier] {
            for at in places {
                let m = &at.linear;
                [m.x_axis, m.y_axis, m.z_axis, at.translation].into_iter().for_each(|v| w.vec3(v));
            }
        }
    }

    /// Restores springs of the same rig.
    ///
    /// # Errors
    /// If the bytes end too early, the phase is invalid, or a remaining rotation is not finite.
    pub fn load(rig: &SpringRig, r: &mut Reader<'_>) -> Result<Self, ReadError> {
        let mut swing = Self::default();
        swing.mode = match r.u8()? {
            0 => Mode::Fresh,
            1 => Mode::Swinging,
            2 => Mode::Easing,
            3 => Mode::Away,
            _ => return Err(r.error("unknown motion state of the springs")),
        };
        match swing.mode {
            Mode::Fresh | Mode::Away => {}
            Mode::Swinging => swing.load_swing(rig, r)?,
            Mode::Easing => {
                for _ in &rig.bones {
                    let offset = r.vec3()?;
                    if !offset.is_finite() {
                        return Err(r.error("a remaining rotation of the springs is not finite"));
                    }
                    swing.offsets.push(offset);
                    swing.turns.push(r.rotation()?);
                }
            }
        }
        Ok(swing)
    }

    fn load_swing(&mut self, rig: &SpringRig, r: &mut Reader<'_>) -> Result<(), ReadError> {
        let swing = self;
        swing.phase = r.f32()?;
        if !(0.0..1.0).contains(&swing.phase) {
            return Err(r.error("the elapsed share of a tick is not between 0 and 1"));
        }
        for _ in &rig.bones {
            swing.tips.push(r.vec3()?);
            swing.ways.push(r.vec3()?);
            swing.turns.push(r.rotation()?);
        }
        swing.stride = r.f32()?;
        for places in [&mut swing.before, &mut swing.earlier] {
            for _ in 0..rig.stills {
                let linear = Mat3::from_cols(r.vec3()?, r.vec3()?, r.vec3()?);
                places.push(Affine { linear, translation: r.vec3()? });
            }
        }
        Ok(())
    }
}
