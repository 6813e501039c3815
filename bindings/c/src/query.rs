//! Queries of a world: rays, overlaps, contacts, events.

use crate::border::{Outcome, SinewStatus, error, fill, give, guard, shared};
use crate::types::{SinewBodyId, SinewPose, SinewShape, SinewVec3};
use crate::world::SinewWorld;
use sinew::physics::ray::Ray;
use sinew::physics::{BodyId, OverlapWith, Probe, Shape};

/// First hit of a ray.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SinewRayHit {
    /// The body that was hit.
    pub body: SinewBodyId,
    /// Point of the hit, world, metres.
    pub point: SinewVec3,
    /// Normal of the surface, outward, unit length.
    pub normal: SinewVec3,
    /// Position of the hit as a fraction of the ray, 0 to 1.
    pub fraction: f32,
}

/// Contact point after the last step.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SinewContact {
    /// The body with the smaller index.
    pub a: SinewBodyId,
    /// The other body.
    pub b: SinewBodyId,
    /// Position between the surfaces, world, metres.
    pub position: SinewVec3,
    /// Normal from A to B, unit length.
    pub normal: SinewVec3,
    /// Gap between the surfaces, metres; negative if they overlap.
    pub separation: f32,
    /// Total impulse of the last step, N·s.
    pub impulse: f32,
}

/// Two bodies.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SinewPair {
    /// The body with the smaller index.
    pub a: SinewBodyId,
    /// The other body.
    pub b: SinewBodyId,
}

/// Kind of events.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SinewEventKind {
    /// The bodies began to touch.
    Begin = 0,
    /// The bodies stopped touching; ids may be stale.
    End = 1,
    /// The bodies hit each other at high speed.
    Hit = 2,
}

/// Casts a ray from `origin` along `way`, whose length is that of the ray. If it hits a body, `found` is 1 and `hit` is filled; else
/// `found` is 0.
///
/// # Safety
/// `world` is null or a world that no other thread changes; `hit` and `found` are null or have room.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_world_ray(
    world: *const SinewWorld,
    origin: SinewVec3,
    way: SinewVec3,
    hit: *mut SinewRayHit,
    found: *mut u32,
) -> SinewStatus {
    guard(|| {
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        let world = unsafe { shared(world, "world") }?.world.get()?;
        let ray = Ray { origin: origin.read("the origin")?, direction: way.read("the way")? };
        let first = world.query().first(&ray);
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        unsafe { give(found, "found", u32::from(first.is_some())) }?;
        let Some(first) = first else { return Ok(()) };
        let (point, normal) = (first.point.into(), first.normal.into());
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        unsafe {
            give(hit, "hit", SinewRayHit { body: first.body.into(), point, normal, fraction: first.fraction })
        }
    })
}

/// Stores the ids of the bodies that a shape at a pose would overlap, ascending.
///
/// # Safety
/// `world` is null or a world that no other thread changes; `ids` has room for `capacity`, `count` is null or points to a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_world_overlap(
    world: *const SinewWorld,
    shape: SinewShape,
    pose: SinewPose,
    ids: *mut SinewBodyId,
    capacity: usize,
    count: *mut usize,
) -> SinewStatus {
    guard(|| {
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        let world = unsafe { shared(world, "world") }?.world.get()?;
        let shape = shape.read()?;
        if shape == Shape::HalfSpace {
            return Err(error(
                SinewStatus::BadArgument,
                "the shape of a query must be bounded: not a half-space",
            ));
        }
        let mut bodies: Vec<BodyId> = Vec::new();
        world.query().bodies(&OverlapWith(Probe::new(shape, pose.read("the pose")?)), &mut bodies);
        bodies.sort_unstable();
        let bodies: Vec<SinewBodyId> = bodies.into_iter().map(SinewBodyId::from).collect();
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        unsafe { fill(&bodies, ids, capacity, count) }
    })
}

/// Stores the points of all contacts, including contacts with a gap, in the order of pairs.
///
/// # Safety
/// `world` is null or a world that no other thread changes; `contacts` has room for `capacity`, `count` is null or points to a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_world_contacts(
    world: *const SinewWorld,
    contacts: *mut SinewContact,
    capacity: usize,
    count: *mut usize,
) -> SinewStatus {
    guard(|| {
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        let world = unsafe { shared(world, "world") }?.world.get()?;
        let mut all = Vec::new();
        for contact in world.contacts() {
            all.extend(contact.points().iter().map(|point| SinewContact {
                a: contact.a.body.into(),
                b: contact.b.body.into(),
                position: point.position.into(),
                normal: contact.normal.into(),
                separation: point.separation,
                impulse: point.impulse,
            }));
        }
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        unsafe { fill(&all, contacts, capacity, count) }
    })
}

/// Stores the pairs of the last step's events of one kind (one of `SinewEventKind`), in the order of pairs.
///
/// # Safety
/// `world` is null or a world that no other thread changes; `pairs` has room for `capacity`, `count` is null or points to a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_world_events(
    world: *const SinewWorld,
    kind: u32,
    pairs: *mut SinewPair,
    capacity: usize,
    count: *mut usize,
) -> SinewStatus {
    guard(|| {
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        let events = unsafe { shared(world, "world") }?.world.get()?.events();
        let pair = |a: BodyId, b: BodyId| SinewPair { a: a.into(), b: b.into() };
        let all: Outcome<Vec<SinewPair>> = match kind {
            kind if kind == SinewEventKind::Begin as u32 => {
                Ok(events.begin.iter().map(|&(a, b)| pair(a, b)).collect())
            }
            kind if kind == SinewEventKind::End as u32 => {
                Ok(events.end.iter().map(|&(a, b)| pair(a, b)).collect())
            }
            kind if kind == SinewEventKind::Hit as u32 => {
                Ok(events.hits.iter().map(|hit| pair(hit.a.body, hit.b.body)).collect())
            }
            kind => Err(error(SinewStatus::BadArgument, format!("there are no events of kind {kind}"))),
        };
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        unsafe { fill(&all?, pairs, capacity, count) }
    })
}
