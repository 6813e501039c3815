//! Deeds that change bodies and shapes.

use super::{Deed, parts};
use crate::actor::{Actor, owner};
use crate::code;
use crate::numbers::{Numbers, Temper};
use sinew_math::{Rotation, Transform, Vec3};
use sinew_physics::*;

pub const ALL: &[Deed] = &[
    Deed::new("add_body", 12, add),
    Deed::new("wall", 2, wall),
    Deed::new("remove_body", 4, remove),
    Deed::new("replace", 2, replace),
    Deed::new("clear_place", 1, clear_place),
    Deed::new("set_kind", 4, set_kind),
    Deed::new("set_transform", 3, teleport),
    Deed::new("nudge", 3, nudge),
    Deed::new("set_velocity", 3, set_velocity),
    Deed::new("stop", 2, stop),
    Deed::new("move_to", 3, move_to),
    Deed::new("lead_all", 1, lead_all),
    Deed::new("wake", 1, wake),
    Deed::new("put_to_sleep", 3, put_to_sleep),
    Deed::new("set_sleeping", 1, set_sleeping),
    Deed::new("set_quality", 1, set_quality),
    Deed::new("set_world_quality", 1, set_world_quality),
    Deed::new("set_gravity", 1, set_gravity),
    Deed::new("set_gravity_scale", 1, set_gravity_scale),
    Deed::new("set_damping", 1, set_damping),
    Deed::new("set_mass", 1, set_mass),
    Deed::new("set_mass_of_shapes", 1, set_mass_of_shapes),
    Deed::new("set_user_data", 1, set_user_data),
    Deed::new("add_shape", 2, add_shape),
    Deed::new("set_shape", 2, set_shape),
    Deed::new("scale", 2, scale),
    Deed::new("remove_shape", 2, remove_shape),
    Deed::new("set_material", 1, set_material),
    Deed::new("set_filter", 2, set_filter),
    Deed::new("set_sensing", 2, set_sensing),
    Deed::new("set_contact_rule", 2, set_contact_rule),
    Deed::new("disable_pair", 1, disable_pair),
    Deed::new("enable_pair", 1, enable_pair),
    Deed::new("set_pair_function", 1, set_pair_function),
    Deed::new("own_body", 1, own),
    Deed::new("disown_body", 1, disown),
];

fn add(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let at = n.place();
    let def = parts::body(n, at);
    parts::is_valid(&def).then(|| _ = a.add_body(&def))
}

/// Adds boxes in layers, which soon fall asleep.
fn wall(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let (count, corner) = (4 + n.index(9), Vec3::new(n.between(-2.0, 2.0), 0.0, n.between(-2.0, 2.0)));
    for i in 0..count {
        let (layer, along) = (i % 5, i / 5);
        let at = corner + Vec3::new(along as f32 * 0.41, 0.2 + layer as f32 * 0.405, 0.0);
        a.add_body(&BodyDef::dynamic(Shape::cuboid(Vec3::splat(0.2))).at(at));
    }
    Some(())
}

fn remove(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.removable(n)?;
    call!(a.remove_body(id));
    Some(())
}

/// Removes a body and adds another, which gets its index.
fn replace(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.removable(n)?;
    let at = if n.chance(0.5) { a.world.transform(id).translation } else { n.place() };
    let def = parts::body(n, at);
    call!(a.remove_body(id));
    parts::is_valid(&def).then(|| _ = a.add_body(&def))
}

/// Removes all bodies near a point.
fn clear_place(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let at = n.place();
    for (_, id) in a.bodies.clone() {
        let near = a.world.contains(id) && (a.world.center_of_mass(id) - at).length() < 0.8;
        if near && !crate::actor::is_worn(&a.world, id) && a.world.body_owner(id).is_none() {
            call!(a.remove_body(id));
        }
    }
    Some(())
}

fn set_kind(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.any_body(n)?;
    let kind = n.one_of(&[BodyKind::Static, BodyKind::Kinematic, BodyKind::Dynamic]);
    let solid = kind != BodyKind::Dynamic || parts::weighs(&a.world, id, None);
    solid.then(|| call!(a.set_kind(id, kind)))
}

fn teleport(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.any_body(n)?;
    let pose = n.pose();
    call!(a.set_transform(id, pose));
    Some(())
}

/// Moves a body by a small displacement, or by none.
fn nudge(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.any_body(n)?;
    let pose = a.world.transform(id);
    let by = Vec3::new(n.between(-0.05, 0.05), n.between(0.0, 0.05), n.between(-0.05, 0.05));
    let by = if n.chance(0.2) { Vec3::ZERO } else { by };
    call!(a.set_transform(id, Transform { translation: pose.translation + by, ..pose }));
    Some(())
}

fn set_velocity(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.any_body(n)?;
    let velocity = n.velocity();
    call!(a.set_velocity(id, velocity));
    Some(())
}

fn stop(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.any_body(n)?;
    call!(a.set_velocity(id, Velocity::default()));
    Some(())
}

/// Returns whether a velocity within the range of `f32` moves a body to a pose in this time.
fn is_near(a: &Actor, id: BodyId, to: &Transform, seconds: f32) -> bool {
    let way = to.translation - a.world.transform(id).translation;
    (way / seconds).is_finite() && way.length() / seconds < 1e30
}

fn move_to(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.body(n, |world, id| world.kind(id) != BodyKind::Static)?;
    let (to, seconds) = (n.pose(), n.least(0.1, 2.0));
    is_near(a, id, &to, seconds).then(|| call!(a.move_to(id, to, seconds)))
}

fn lead_all(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let count = 1 + n.index(12);
    let ids: Vec<BodyId> =
        (0..count).filter_map(|_| a.body(n, |world, id| world.kind(id) == BodyKind::Kinematic)).collect();
    let poses: Vec<Transform> = ids.iter().map(|&id| a.world.transform(id)).collect();
    let by = Vec3::new(n.between(-0.05, 0.05), n.between(-0.05, 0.05), 0.0);
    let turn = Rotation::from_axis_angle(n.direction(), n.between(0.0, 0.1));
    let ahead = |pose: &Transform| Transform::new(pose.translation + by, turn * pose.rotation);
    let now: Vec<Transform> = poses.iter().map(ahead).collect();
    if ids.is_empty() || !now.iter().all(|pose| pose.translation.length() < 1e10) {
        return None;
    }
    let seconds = a.world.def().dt();
    call!(a.lead_all(&ids, &poses, &now, seconds));
    Some(())
}

fn wake(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.any_body(n)?;
    call!(a.wake(id));
    Some(())
}

fn put_to_sleep(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.any_body(n)?;
    call!(a.put_to_sleep(id));
    Some(())
}

fn set_sleeping(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.any_body(n)?;
    let sleeping = n.one_of(&[Sleeping::On, Sleeping::Off]);
    call!(a.set_sleeping(id, sleeping));
    Some(())
}

fn set_quality(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.any_body(n)?;
    let quality = n.one_of(&[None, Some(Quality::Fast), Some(Quality::Exact)]);
    call!(a.set_quality(id, quality));
    Some(())
}

fn set_world_quality(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let quality = n.one_of(&[Quality::Fast, Quality::Balanced, Quality::Exact]);
    call!(a.set_world_quality(quality));
    Some(())
}

fn set_gravity(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let gravity =
        if n.chance(0.5) { Vec3::NEG_Y * 9.81 } else { Vec3::new(n.signed(1.0), n.signed(10.0), 0.0) };
    call!(a.set_gravity(gravity));
    Some(())
}

fn set_gravity_scale(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.any_body(n)?;
    let scale = n.signed(1.0);
    call!(a.set_gravity_scale(id, scale));
    ask!(a.gravity_scale(id));
    Some(())
}

fn set_damping(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.any_body(n)?;
    let (linear, angular) = (n.least(0.0, 2.0), n.least(0.0, 2.0));
    call!(a.set_linear_damping(id, linear));
    call!(a.set_angular_damping(id, angular));
    Some(())
}

fn set_mass(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.dynamic(n)?;
    let mass = a.world.mass(id);
    let kilograms = n.between(0.1, 50.0);
    let properties =
        mass.scaled_to(if n.temper == Temper::Wild { n.one_of(&[1e-3, 1e6]) } else { kilograms });
    call!(a.set_mass(id, properties));
    Some(())
}

fn set_mass_of_shapes(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.any_body(n)?;
    parts::weighs(&a.world, id, None).then(|| call!(a.set_mass_of_shapes(id)))
}

fn set_user_data(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.any_body(n)?;
    let data = n.index(4) as u64;
    call!(a.set_user_data(id, data));
    Some(())
}

fn add_shape(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.any_body(n)?;
    let def = parts::shape_def(n);
    let update = if n.chance(0.5) && parts::weighs(&a.world, id, None) {
        MassUpdate::FromShapes
    } else {
        MassUpdate::Keep
    };
    if def.check().is_err() {
        return None;
    }
    a.tell(
        "add_shape",
        &[code::Code::code(&id), format!("&{}", code::shape_def(&def)), code::Code::code(&update)],
    );
    a.count("add_shape");
    a.world.add_shape(id, &def, update);
    Some(())
}

fn put_shape(a: &mut Actor, id: ShapeId, def: &ShapeDef, update: MassUpdate) -> Option<()> {
    def.check().ok()?;
    let others = parts::weighs(&a.world, id.body, Some(id.shape));
    let update = if others { update } else { MassUpdate::Keep };
    a.tell(
        "set_shape",
        &[code::Code::code(&id), format!("&{}", code::shape_def(def)), code::Code::code(&update)],
    );
    a.count("set_shape");
    a.world.set_shape(id, def, update);
    Some(())
}

fn set_shape(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let body = a.any_body(n)?;
    let id = a.shape(n, body)?;
    let def = parts::shape_def(n);
    let update = n.one_of(&[MassUpdate::FromShapes, MassUpdate::Keep]);
    put_shape(a, id, &def, update)
}

/// Scales all shapes of a body.
fn scale(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let body = a.any_body(n)?;
    let factor = n.one_of(&[0.5, 0.9, 1.0, 1.1, 2.0]);
    for id in a.world.shape_ids(body).collect::<Vec<_>>() {
        let mut def = a.world.shape_def(id);
        def.shape = parts::scaled(&def.shape, factor)?;
        def.body_from_shape.translation *= factor;
        put_shape(a, id, &def, MassUpdate::FromShapes)?;
    }
    Some(())
}

fn remove_shape(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let body = a.any_body(n)?;
    let id = a.shape(n, body)?;
    let update = n.one_of(&[MassUpdate::FromShapes, MassUpdate::Keep]);
    let update = if parts::weighs(&a.world, body, Some(id.shape)) { update } else { MassUpdate::Keep };
    call!(a.remove_shape(id, update));
    Some(())
}

fn some_shape(a: &Actor, n: &mut Numbers) -> Option<ShapeId> {
    let body = a.any_body(n)?;
    a.shape(n, body)
}

fn set_material(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = some_shape(a, n)?;
    let material = parts::material(n);
    material.check().is_ok().then(|| call!(a.set_material(id, material)))
}

fn set_filter(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = some_shape(a, n)?;
    let filter = parts::filter(n);
    call!(a.set_filter(id, filter));
    Some(())
}

fn set_sensing(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = some_shape(a, n)?;
    let sensing = n.one_of(&[Sensing::Solid, Sensing::Sensor]);
    call!(a.set_sensing(id, sensing));
    Some(())
}

fn set_contact_rule(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = some_shape(a, n)?;
    let rule = parts::rule(n);
    rule.check().is_ok().then(|| call!(a.set_contact_rule(id, rule)))
}

fn disable_pair(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let (p, q) = (a.any_body(n)?, a.any_body(n)?);
    (p != q).then(|| call!(a.disable_pair(p, q)))
}

fn enable_pair(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let (p, q) = (a.any_body(n)?, a.any_body(n)?);
    (p != q).then(|| call!(a.enable_pair(p, q)))
}

fn set_pair_function(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let number = n.one_of(&[None, Some(crate::functions::NUMBER)]);
    call!(a.set_pair_function(number));
    ask!(a.pair_function());
    Some(())
}

/// Assigns a body to an owner, after which it cannot be removed until it is disowned.
fn own(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.removable(n)?;
    a.note_owned("own_bodies", &id);
    a.world.own_bodies(&owner(), &[id], &[0]);
    ask!(a.body_owner(id));
    Some(())
}

fn disown(a: &mut Actor, n: &mut Numbers) -> Option<()> {
    let id = a.any_body(n)?;
    call!(a.disown_body(id));
    ask!(a.body_owner(id));
    Some(())
}
