//! Writes and reads contacts.

use crate::arena::Arena;
use crate::body::Body;
use crate::body::snapshot::body_index;
use crate::collide::{MAX_POINTS, Manifold, ManifoldPoint};
use crate::contact::recycled::Recycled;
use crate::contact::{Contact, ContactKey, ContactMemory, Effect, PointImpulse};
use sinew_math::{ReadError, Reader, Vec3, Writer};

pub(crate) fn save_contact(w: &mut Writer, contact: &Contact) {
    let ContactKey { a, b, shape_a, shape_b, part } = contact.key;
    for x in [a, b, shape_a, shape_b, part] {
        w.u32(x);
    }
    w.u8(contact.effect as u8);
    w.bool(contact.touching);
    w.bool(contact.sensed);
    w.bool(contact.passes);
    w.vec3(contact.manifold.normal);
    w.count(contact.manifold.count);
    for (point, impulse) in contact.manifold.points().iter().zip(&contact.memory.points) {
        w.vec3(point.position);
        w.f32(point.separation);
        w.u32(point.feature);
        w.f32(impulse.now);
        w.f32(impulse.before);
        w.f32(impulse.lasting);
        w.f32(impulse.total);
    }
    w.vec3(contact.memory.friction);
    w.f32(contact.memory.twist);
    w.vec3(contact.memory.rolling);
    w.vec3(contact.memory.total_friction);
    contact.kept.save(w);
}

pub(crate) fn load_contact(r: &mut Reader<'_>, bodies: &Arena<Body>) -> Result<Contact, ReadError> {
    let (a, b) = (body_index(r, bodies)?, body_index(r, bodies)?);
    let key = ContactKey { a, b, shape_a: r.u32()?, shape_b: r.u32()?, part: r.u32()? };
    let shapes = |body: u32| bodies.at(body).shapes.len() as u32;
    if key.shape_a >= shapes(a) || key.shape_b >= shapes(b) {
        return Err(r.error("a contact names a shape that is not there"));
    }
    let effect = match r.u8()? {
        0 => Effect::Push,
        1 => Effect::Sense,
        2 => Effect::Pass,
        _ => return Err(r.error("unknown effect of a contact")),
    };
    let (touching, sensed, passes) = (r.bool()?, r.bool()?, r.bool()?);
    let mut manifold = Manifold { normal: r.vec3()?, ..Manifold::default() };
    manifold.count = r.count(24)?;
    if manifold.count > MAX_POINTS {
        return Err(r.error("a contact has too many points"));
    }
    let mut memory = ContactMemory::default();
    for i in 0..manifold.count {
        manifold.points[i] = ManifoldPoint { position: r.vec3()?, separation: r.f32()?, feature: r.u32()? };
        let (now, before, lasting, total) = (r.f32()?, r.f32()?, r.f32()?, r.f32()?);
        memory.points[i] = PointImpulse { now, before, lasting, total };
    }
    let friction: Vec3 = r.vec3()?;
    memory.friction = friction;
    memory.twist = r.f32()?;
    memory.rolling = r.vec3()?;
    memory.total_friction = r.vec3()?;
    let kept = Recycled::load(r)?;
    let is_surface = |body: u32, shape: u32| bodies.at(body).shapes[shape as usize].shape.surface().is_some();
    let has_surface = is_surface(a, key.shape_a) || is_surface(b, key.shape_b);
    Ok(Contact { manifold, memory, effect, touching, sensed, passes, has_surface, kept, ..Contact::new(key) })
}
