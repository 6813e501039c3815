//! Movers in snapshots: settings and state, field by field.

use super::{Bearer, Footing, Mover, MoverDef};
use crate::arena::Arena;
use crate::body::Body;
use crate::body::snapshot::{load_filter, save_filter};
use crate::id::{BodyId, MoverId};
use sinew_math::{ReadError, Reader, Writer};

/// Bit in the tag of the ground: a pass-through momentum follows.
const LETS_PASS: u8 = 0x80;

impl Mover {
    pub(crate) fn save(&self, w: &mut Writer) {
        let def = &self.def;
        w.vec3(def.position);
        w.vec3(def.up);
        for x in [
            def.radius,
            def.height,
            def.mass,
            def.push_force,
            def.step_height,
            def.slope_limit,
            def.ground_acceleration,
            def.air_acceleration,
            def.gravity_scale,
            def.skin,
        ] {
            w.f32(x);
        }
        save_filter(w, def.filter);
        w.u64(def.user_data);
        [self.position, self.previous, self.velocity, self.walk].into_iter().for_each(|v| w.vec3(v));
        w.f32(self.yaw);
        w.f32(self.jump);
        // The momentum is written only if it is above 0.
        let passes = if def.lets_pass > 0.0 { LETS_PASS } else { 0 };
        let Some(Footing { on, point, normal, velocity }) = self.ground else {
            w.u8(passes);
            return self.save_passing(w);
        };
        match on {
            Bearer::Shape { body, shape } => {
                w.u8(1 | passes);
                w.u64(body.to_bits());
                w.u32(shape);
            }
            Bearer::Mover(mover) => {
                w.u8(2 | passes);
                w.u64(mover.to_bits());
            }
        }
        [point, normal, velocity].into_iter().for_each(|v| w.vec3(v));
        self.save_passing(w);
    }

    fn save_passing(&self, w: &mut Writer) {
        if self.def.lets_pass > 0.0 {
            w.f32(self.def.lets_pass);
        }
    }

    pub(crate) fn load(r: &mut Reader<'_>, bodies: &Arena<Body>) -> Result<Self, ReadError> {
        let def = load_def(r)?;
        let mut mover = Self::new(&def);
        (mover.position, mover.previous) = (r.vec3()?, r.vec3()?);
        (mover.velocity, mover.walk) = (r.vec3()?, r.vec3()?);
        (mover.yaw, mover.jump) = (r.f32()?, r.f32()?);
        let tag = r.u8()?;
        mover.ground = load_footing(r, tag & !LETS_PASS, bodies)?;
        if tag & LETS_PASS != 0 {
            mover.def.lets_pass = r.f32()?;
            mover.def.check().map_err(|error| r.error(error.what()))?;
        }
        let finite =
            [mover.position, mover.previous, mover.velocity, mover.walk].iter().all(|v| v.is_finite());
        if !finite || !mover.yaw.is_finite() || !(0.0..f32::INFINITY).contains(&mover.jump) {
            return Err(r.error("a mover whose state is not finite"));
        }
        Ok(mover)
    }
}

fn load_def(r: &mut Reader<'_>) -> Result<MoverDef, ReadError> {
    let def = MoverDef {
        position: r.vec3()?,
        up: r.vec3()?,
        radius: r.f32()?,
        height: r.f32()?,
        mass: r.f32()?,
        push_force: r.f32()?,
        step_height: r.f32()?,
        slope_limit: r.f32()?,
        ground_acceleration: r.f32()?,
        air_acceleration: r.f32()?,
        gravity_scale: r.f32()?,
        skin: r.f32()?,
        filter: load_filter(r)?,
        user_data: r.u64()?,
        lets_pass: 0.0,
    };
    def.check().map_err(|error| r.error(error.what()))?;
    Ok(def)
}

fn load_footing(r: &mut Reader<'_>, tag: u8, bodies: &Arena<Body>) -> Result<Option<Footing>, ReadError> {
    let on = match tag {
        0 => return Ok(None),
        1 => {
            let (body, shape) = (BodyId::from_bits(r.u64()?), r.u32()?);
            let there = bodies.get(body);
            if there.is_none_or(|body| shape as usize >= body.shapes.len()) {
                return Err(r.error("a mover stands on a shape that is not there"));
            }
            Bearer::Shape { body, shape }
        }
        2 => Bearer::Mover(MoverId::from_bits(r.u64()?)),
        _ => return Err(r.error("unknown ground of a mover")),
    };
    let footing = Footing { on, point: r.vec3()?, normal: r.vec3()?, velocity: r.vec3()? };
    if [footing.point, footing.normal, footing.velocity].iter().all(|v| v.is_finite()) {
        Ok(Some(footing))
    } else {
        Err(r.error("a mover's ground is not finite"))
    }
}
