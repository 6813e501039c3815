//! Writes and reads joints.

use super::def::{
    AxisMotion, Gains, JointCollision, JointKind, JointState, Motor, SixDof, SoftZone, Softness, Spring,
    Strength,
};
use super::{DIRECTIONS, Joint, JointDrive, LimitImpulse, MAX_LIMITS};
use crate::body::Velocity;
use crate::body::owner::OwnerMark;
use crate::spatial::{Vec6, ZERO6};
use sinew_math::{Range, ReadError, Reader, SwingTwistLimit, Writer};

/// Bit of a joint's state: the joint has an owner, which is written after the joint.
const OWNED: u8 = 2;

impl Joint {
    /// Writes the joint, its bodies first, without its owner.
    pub fn save(&self, w: &mut Writer) {
        w.u32(self.a);
        w.u32(self.b);
        w.transform(self.frame_a);
        w.transform(self.frame_b);
        save_kind(w, &self.kind);
        save_drive(w, &self.drive);
        w.f32(self.strength.force);
        w.f32(self.strength.torque);
        w.bool(self.collision == JointCollision::Enabled);
        let owned = if self.owner.is_some() { OWNED } else { 0 };
        w.u8(u8::from(self.is_enabled()) | owned);
        for limit in &self.limits {
            w.vec3(limit.now);
            w.vec3(limit.before);
        }
        for sign in self.saturated {
            w.u8(sign.cast_unsigned());
        }
        save_vec6(w, &self.warm_impulse);
        w.vec3(self.force);
        save_vec6(w, &self.mass);
        save_vec6(w, &self.reaction);
    }

    /// Reads the format of [`save`](Self::save) after the bodies; the owner, if any, follows.
    pub fn load(r: &mut Reader<'_>, a: u32, b: u32) -> Result<Self, ReadError> {
        let (frame_a, frame_b) = (r.transform()?, r.transform()?);
        let kind = load_kind(r)?;
        let drive = load_drive(r)?;
        let strength = Strength { force: r.f32()?, torque: r.f32()? };
        let collision = if r.bool()? { JointCollision::Enabled } else { JointCollision::Disabled };
        let tag = r.u8()?;
        let state = match tag & !OWNED {
            0 => JointState::Disabled,
            1 => JointState::Enabled,
            _ => return Err(r.error("a joint neither enabled nor disabled")),
        };
        let owner = (tag & OWNED != 0).then(OwnerMark::default);
        let mut limits = [LimitImpulse::default(); MAX_LIMITS];
        for limit in &mut limits {
            *limit = LimitImpulse { now: r.vec3()?, before: r.vec3()? };
        }
        let mut saturated = [0; DIRECTIONS];
        for sign in &mut saturated {
            *sign = r.u8()?.cast_signed().signum();
        }
        let warm_impulse = load_vec6(r)?;
        let force = r.vec3()?;
        let mass = load_vec6(r)?;
        let reaction = load_vec6(r)?;
        Ok(Self {
            a,
            b,
            frame_a,
            frame_b,
            kind,
            drive,
            strength,
            collision,
            state,
            limits,
            saturated,
            warm_impulse,
            force,
            mass,
            reaction,
            owner,
        })
    }
}

fn save_vec6(w: &mut Writer, v: &Vec6) {
    for &x in &v[..DIRECTIONS] {
        w.f32(x);
    }
}

fn load_vec6(r: &mut Reader<'_>) -> Result<Vec6, ReadError> {
    let mut v = ZERO6;
    for x in &mut v[..DIRECTIONS] {
        *x = r.f32()?;
    }
    Ok(v)
}

fn save_option<T>(w: &mut Writer, item: Option<T>, save: impl FnOnce(&mut Writer, T)) {
    w.bool(item.is_some());
    if let Some(item) = item {
        save(w, item);
    }
}

fn load_option<T>(
    r: &mut Reader<'_>,
    load: impl FnOnce(&mut Reader<'_>) -> Result<T, ReadError>,
) -> Result<Option<T>, ReadError> {
    if r.bool()? { load(r).map(Some) } else { Ok(None) }
}

fn save_range(w: &mut Writer, range: Range) {
    w.f32(range.lo);
    w.f32(range.hi);
}

fn load_range(r: &mut Reader<'_>) -> Result<Range, ReadError> {
    Ok(Range::new(r.f32()?, r.f32()?))
}

fn save_cone(w: &mut Writer, limit: SwingTwistLimit) {
    save_range(w, limit.swing_y);
    save_range(w, limit.swing_z);
    save_range(w, limit.twist);
}

fn load_cone(r: &mut Reader<'_>) -> Result<SwingTwistLimit, ReadError> {
    Ok(SwingTwistLimit { swing_y: load_range(r)?, swing_z: load_range(r)?, twist: load_range(r)? })
}

fn save_motion(w: &mut Writer, motion: AxisMotion) {
    match motion {
        AxisMotion::Locked => w.u8(0),
        AxisMotion::Free => w.u8(1),
        AxisMotion::Limited(range) => {
            w.u8(2);
            save_range(w, range);
        }
    }
}

fn load_motion(r: &mut Reader<'_>) -> Result<AxisMotion, ReadError> {
    Ok(match r.u8()? {
        0 => AxisMotion::Locked,
        1 => AxisMotion::Free,
        2 => AxisMotion::Limited(load_range(r)?),
        _ => return Err(r.error("unknown motion of a joint's axis")),
    })
}

fn save_kind(w: &mut Writer, kind: &JointKind) {
    match *kind {
        JointKind::Ball { limit } => {
            w.u8(0);
            save_option(w, limit, save_cone);
        }
        JointKind::Hinge { limit } => {
            w.u8(1);
            save_option(w, limit, save_range);
        }
        JointKind::Universal { limit } => {
            w.u8(2);
            save_option(w, limit, save_cone);
        }
        JointKind::Fixed => w.u8(3),
        JointKind::Slider { limit } => {
            w.u8(4);
            save_option(w, limit, save_range);
        }
        JointKind::Distance { range } => {
            w.u8(5);
            save_range(w, range);
        }
        JointKind::SixDof(six) => {
            w.u8(6);
            let [x, y, z] = six.linear;
            for motion in [x, y, z, six.twist, six.swing_y, six.swing_z] {
                save_motion(w, motion);
            }
        }
    }
}

fn load_kind(r: &mut Reader<'_>) -> Result<JointKind, ReadError> {
    Ok(match r.u8()? {
        0 => JointKind::Ball { limit: load_option(r, load_cone)? },
        1 => JointKind::Hinge { limit: load_option(r, load_range)? },
        2 => JointKind::Universal { limit: load_option(r, load_cone)? },
        3 => JointKind::Fixed,
        4 => JointKind::Slider { limit: load_option(r, load_range)? },
        5 => JointKind::Distance { range: load_range(r)? },
        6 => JointKind::SixDof(SixDof {
            linear: [load_motion(r)?, load_motion(r)?, load_motion(r)?],
            twist: load_motion(r)?,
            swing_y: load_motion(r)?,
            swing_z: load_motion(r)?,
        }),
        _ => return Err(r.error("unknown kind of joint")),
    })
}

fn save_softness(w: &mut Writer, softness: Softness) {
    let (kind, x, y) = match softness {
        Softness::Stiffness { stiffness, damping } => (0, stiffness, damping),
        Softness::Frequency { hertz, damping_ratio } => (1, hertz, damping_ratio),
    };
    w.u8(kind);
    w.f32(x);
    w.f32(y);
}

fn load_softness(r: &mut Reader<'_>) -> Result<Softness, ReadError> {
    Ok(match r.u8()? {
        0 => Softness::Stiffness { stiffness: r.f32()?, damping: r.f32()? },
        1 => Softness::Frequency { hertz: r.f32()?, damping_ratio: r.f32()? },
        _ => return Err(r.error("unknown softness")),
    })
}

fn save_motor(w: &mut Writer, motor: Motor) {
    let position = match motor.gains {
        Gains::Velocity => None,
        Gains::Position(softness) => Some(softness),
    };
    save_option(w, position, save_softness);
    w.transform(motor.target);
    w.vec3(motor.velocity.linear);
    w.vec3(motor.velocity.angular);
    w.f32(motor.max_force);
    w.f32(motor.max_torque);
}

fn load_motor(r: &mut Reader<'_>) -> Result<Motor, ReadError> {
    Ok(Motor {
        gains: load_option(r, load_softness)?.map_or(Gains::Velocity, Gains::Position),
        target: r.transform()?,
        velocity: Velocity { linear: r.vec3()?, angular: r.vec3()? },
        max_force: r.f32()?,
        max_torque: r.f32()?,
    })
}

fn save_drive(w: &mut Writer, drive: &JointDrive) {
    save_option(w, drive.weld, save_softness);
    save_option(w, drive.limit_softness, save_softness);
    save_option(w, drive.soft_zone, |w, zone| {
        w.f32(zone.width);
        save_softness(w, zone.softness);
    });
    save_option(w, drive.spring, |w, spring| {
        save_softness(w, spring.softness);
        w.transform(spring.rest);
    });
    save_option(w, drive.motor, save_motor);
    w.f32(drive.friction);
}

fn load_drive(r: &mut Reader<'_>) -> Result<JointDrive, ReadError> {
    Ok(JointDrive {
        weld: load_option(r, load_softness)?,
        limit_softness: load_option(r, load_softness)?,
        soft_zone: load_option(r, |r| Ok(SoftZone { width: r.f32()?, softness: load_softness(r)? }))?,
        spring: load_option(r, |r| Ok(Spring { softness: load_softness(r)?, rest: r.transform()? }))?,
        motor: load_option(r, load_motor)?,
        friction: r.f32()?,
    })
}
