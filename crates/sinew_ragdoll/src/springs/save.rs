//! Springs in snapshots.

use super::{SpringRig, SpringSwing};
use sinew_math::{Affine, Mat3, ReadError, Reader, Writer};

impl SpringSwing {
    /// Writes what decides the future, and what is shown.
    pub fn save(&self, w: &mut Writer) {
        w.bool(self.started);
        if !self.started {
            return;
        }
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

    /// Springs of the same rig as they were saved.
    ///
    /// # Errors
    /// If the bytes end too early, or the phase is none.
    pub fn load(rig: &SpringRig, r: &mut Reader<'_>) -> Result<Self, ReadError> {
        let mut swing = Self::default();
        if !r.bool()? {
            return Ok(swing);
        }
        swing.started = true;
        swing.phase = r.f32()?;
        if !(0.0..1.0).contains(&swing.phase) {
            return Err(r.error("a part of a tick that is none"));
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
        Ok(swing)
    }
}
