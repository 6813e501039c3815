//! Deeds that change joints.

use super::{Deed, parts};
use crate::actor::{Actor, owner};
use crate::code;
use crate::numbers::Numbers;
use sinew_math::{Range, SwingTwistLimit, Transform, Vec3};
use sinew_physics::*;

pub const ALL: &[Deed] = &[
    Deed::new("add_joint", 4, add),
    Deed::new("add_joint_by_name", 9, add_by_name),
    Deed::new("chain", 2, chain),
    Deed::new("remove_joint", 2, remove),
    Deed::new("own_joint", 1, own),
    Deed::new("disown_joint", 2, disown),
    Deed::new("set_joint", 2, set),
    Deed::new("set_motor", 3, set_motor),
    Deed::new("set_joint_friction", 1, set_friction),
    Deed::new("set_joint_state", 2, set_state),
    Deed::new("drag", 1, drag),
];

fn range(n: &mut Numbers, most: f32) -> Range {
    let (lo, hi) = (-n.between(0.0, most), n.between(0.0, most));
    Range { lo, hi }
}

fn kind(n: &mut Numbers) -> JointKind {
    let limited = n.chance(0.5);
    let cone = SwingTwistLimit { swing_y: range(n, 1.0), swing_z: range(n, 1.0), twist: range(n, 1.0) };
    match n.index(8) {
        0 | 1 => JointKind::Ball { limit: limited.then_some(cone) },
        2 => JointKind::Hinge { limit: limited.then(|| range(n, 1.5)) },
        3 => JointKind::Universal { limit: limited.then_some(cone) },
        4 => JointKind::Slider { limit: limited.then(|| range(n, 0.5)) },
        5 => JointKind::Distance { range: Range { lo: 0.0, hi: n.between(0.2, 2.0) } },
        6 => {
            let mut axis = |most| match n.index(3) {
                0 => AxisMotion::Locked,
                1 => AxisMotion::Free,
                _ => AxisMotion::Limited(range(n, most)),
            };
            let linear = [axis(0.3), axis(0.3), axis(0.3)];
            JointKind::SixDof(SixDof { linear, twist: axis(1.0), swing_y: axis(1.0), swing_z: axis(1.0) })
        }
        _ => JointKind::Fixed,
    }
}

fn softness(n: &mut Numbers) -> Softness {
    if n.chance(0.5) {
        Softness::Stiffness { stiffness: n.between(0.0, 2000.0), damping: n.between(0.0, 50.0) }
    } else {
        Softness::Frequency { hertz: n.between(0.0, 10.0), damping_ratio: n.between(0.0, 1.0) }
    }
}

fn motor(n: &mut Numbers) -> Motor {
    let cap = if n.chance(0.2) { f32::INFINITY } else { n.least(0.0, 500.0) };
    match n.index(3) {
        0 => Motor::spin(n.signed(5.0), cap),
        1 => Motor::push(n.signed(2.0), cap),
        _ => {
            let target = Transform::new(n.vector(0.3), n.rotation());
            Motor { max_force: cap, max_torque: cap, ..Motor::toward(target, softness(n)) }
        }
    }
}

/// Returns a joint definition with random features added.
fn furnished(n: &mut Numbers, mut def: JointDef) -> JointDef {
    if n.chance(0.3) {
        def.motor = Some(motor(n));
    }
    if n.chance(0.15) {
        def.spring =
            Some(Spring { softness: softness(n), rest: Transform::new(n.vector(0.2), n.rotation()) });
    }
    if n.chance(0.1) {
        def.weld = Some(softness(n));
    }
    if n.chance(0.1) {
        def.limit_softness = Some(softness(n));
    }
    if n.chance(0.1) {
        def.soft_zone = Some(SoftZone { width: n.between(0.0, 0.2), softness: softness(n) });
    }
    if n.chance(0.2) {
        def.friction_torque = n.least(0.0, 5.0);
    }
    if n.chance(0.2) {
        def.strength = Strength { force: n.least(0.0, 2000.0), torque: f32::INFINITY };
    }
    if n.chance(0.2) {
        def.collision = JointCollision::Enabled;
    }
    def
}

/// Returns two bodies near each other, at least one of them dynamic, and a point between them.
fn ends(a: &Actor, n: &mut Numbers) -> Option<(BodyId, BodyId, Vec3)> {
    let p = a.dynamic(n)?;
    let q = if n.chance(0.15) { a.floor } else { a.any_body(n)? };
    let (at, other) = (a.world.center_of_mass(p), a.world.center_of_mass(q));
    let place = if q == a.floor { at } else { (at + other) * 0.5 };
    let near = q == a.floor || (at - other).length() < 2.0;
    let (p, q) = if n.chance(0.5) { (p, q) } else { (q, p) };
    (p != q && near && place.length() < 1e4).then_some((p, q, place))
}

fn add(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let (p, q, place) = ends(a, n)?;
    let frame = Transform::new(place, n.rotation());
    let kind = kind(n);
    let def = JointDef::new(p, q, a.world.transform(p), a.world.transform(q), frame, kind);
    let def = furnished(n, def);
    a.add_joint(&def);
    Some(())
}

fn add_by_name(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let (p, q, at) = ends(a, n)?;
    let axis = n.direction();
    let length = n.between(0.1, 2.0);
    let other = a.world.center_of_mass(q);
    if other.length() > 1e4 {
        return None;
    }
    let def = match n.index(11) {
        0 => call!(a.ball(p, q, at)),
        1 => call!(a.hinge(p, q, at, axis)),
        2 => call!(a.universal(p, q, at, axis)),
        3 => call!(a.slider(p, q, at, axis)),
        4 => call!(a.fixed(p, q)),
        5 => call!(a.distance(p, q, at, other, Range { lo: 0.0, hi: length })),
        6 => return by_axis_locks(a, n, p, q),
        kind => {
            let id = match kind {
                7 => call!(a.add_ball(p, q, at)),
                8 => call!(a.add_hinge(p, q, at, axis)),
                9 => call!(a.add_slider(p, q, at, axis)),
                _ if n.chance(0.5) => call!(a.add_fixed(p, q)),
                _ => call!(a.add_rope(p, q, at, other, length)),
            };
            a.name_joint(id);
            return Some(());
        }
    };
    // The recorded program computes the same definition from these numbers.
    if let Some(lines) = &mut a.lines {
        lines.pop();
    }
    let def = furnished(n, def);
    a.add_joint(&def);
    Some(())
}

fn by_axis_locks(a: &mut Actor, n: &mut Numbers, p: BodyId, q: BodyId) -> Option<()> {
    let locks = n.one_of(&[LockedAxes::ROTATIONS, LockedAxes::PLANE_XY, LockedAxes::TRANSLATION_Y]);
    if a.world.kind(q) != BodyKind::Dynamic {
        return None;
    }
    a.count("axis_locks");
    let def = a.world.axis_locks(p, q, locks);
    a.add_joint(&def);
    Some(())
}

/// Adds links that hang on each other and on another body.
fn chain(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let start = n.place() + Vec3::Y;
    let way = n.direction() * 0.3;
    let kind = kind(n);
    let mut last = n.chance(0.6).then_some(a.floor);
    for i in 0..2 + n.index(8) {
        let at = start + way * i as f32;
        let def = BodyDef::dynamic(parts::shape(n, 0.05, 0.15)).at(at);
        let link = a.add_body(&def);
        if let Some(last) = last {
            let frame = Transform::from_translation(at - way * 0.5);
            let (p, q) = (a.world.transform(last), a.world.transform(link));
            a.add_joint(&JointDef::new(last, link, p, q, frame, kind));
        }
        last = Some(link);
    }
    Some(())
}

/// Connects a body to a kinematic or static one by a joint that pulls it.
fn drag(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let body = a.dynamic(n)?;
    let hand = a.body(n, |world, id| world.kind(id) != BodyKind::Dynamic)?;
    let near = (a.world.center_of_mass(body) - a.world.center_of_mass(hand)).length() < 5.0;
    let def = JointDef::drag(
        hand,
        body,
        Vec3::new(0.0, n.between(0.0, 0.2), 0.0),
        softness(n),
        n.least(0.0, 500.0),
    );
    near.then(|| _ = a.add_joint(&def))
}

fn remove(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.joint(n)?;
    if a.world.joint_owner(id).is_none() {
        call!(a.remove_joint(id));
    }
    Some(())
}

fn set(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.joint(n)?;
    let old = a.world.joint(id);
    let kind = if n.chance(0.5) { old.kind } else { kind(n) };
    let plain = JointDef {
        state: old.state,
        ..JointDef::between(old.body_a, old.body_b, old.frame_a, old.frame_b, kind)
    };
    let def = furnished(n, plain);
    a.tell("set_joint", &[code::Code::code(&id), format!("&{}", code::joint_def(&def))]);
    a.count("set_joint");
    a.world.set_joint(id, &def);
    Some(())
}

fn set_motor(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.joint(n)?;
    let motor = n.chance(0.8).then(|| motor(n));
    call!(a.set_motor(id, motor));
    Some(())
}

fn set_friction(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.joint(n)?;
    let torque = n.least(0.0, 5.0);
    call!(a.set_joint_friction(id, torque));
    Some(())
}

fn set_state(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.joint(n)?;
    let state = n.one_of(&[JointState::Enabled, JointState::Disabled]);
    a.tell("set_joint_state", &[code::Code::code(&id), format!("JointState::{state:?}")]);
    a.count("set_joint_state");
    a.world.set_joint_state(id, state);
    Some(())
}

fn own(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.joint(n)?;
    a.note_owned("own_joints", &id);
    a.world.own_joints(&owner(), &[id], &[0]);
    ask!(a.joint_owner(id));
    Some(())
}

fn disown(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.joint(n)?;
    call!(a.disown_joint(id));
    ask!(a.joint_owner(id));
    Some(())
}
