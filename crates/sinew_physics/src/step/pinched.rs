//! Contacts of two shapes through particles between them: cloth under a foot, a rope under a wheel.
//!
//! Two surfaces push a massless ball between them along the line through its two touch points, which bisects their
//! normals. The ball stays there if that line is within both friction cones (the nip angle of roller mills), and it
//! transmits each surface's push to the other. Such particles are therefore points of a contact of the two shapes, with
//! that line as normal and the sum of both gaps as separation. The world's list contains these contacts from after
//! `touch` until `store`; at other times their group stores them.

use crate::activity::{Activity, follow};
use crate::arena::Arena;
use crate::body::Body;
use crate::body::material::{ContactMaterial, Material};
use crate::boxes::{Aabb, Overlap};
use crate::collide::{MAX_POINTS, Manifold, ManifoldPoint};
use crate::contact::filter::PairFilter;
use crate::contact::modifiers::Modifiers;
use crate::contact::proxies::{Owner, Proxies};
use crate::contact::tuning::{MARGIN, SAME_PART_COSINE};
use crate::contact::{Contact, ContactKey, ContactMemory};
use crate::context::StepContext;
use crate::particles::{AttachmentTarget, ParticleGroup, Pinched, distance_at_least, is_nipped};
use crate::step::collide::{approach_of, is_plain};
use crate::step::tuning::{BEARING_GAP, KEPT_POINT, MOST_PINCHED, POINT_SLOPE};
use core::cmp::Ordering;
use core::ops::ControlFlow;
use sinew_math::{Transform, Vec3, max, min};

/// Contacts of shapes that pinch particles between them, found in this step, and buffers for the search.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pinches {
    /// Number of the world's contacts that are not through particles.
    own: usize,
    /// Index of each group with such contacts, and the number of contacts.
    groups: Vec<(u32, usize)>,
    /// Largest speed of any point of the movable bodies, m/s.
    fastest: f32,
    near: Vec<Near>,
    found: Vec<Between>,
}

/// A shape near a group.
#[derive(Clone, Copy, Debug)]
struct Near {
    body: u32,
    shape: u32,
    bounds: Aabb,
    world_from_shape: Transform,
    is_active: bool,
}

/// A particle between two shapes.
#[derive(Clone, Copy, Debug)]
struct Between {
    key: ContactKey,
    particle: u32,
    /// Contact normal from A to B.
    normal: Vec3,
    point: ManifoldPoint,
}

/// Surface near a particle: its distance from the particle's surface, metres, and its outward normal, world.
#[derive(Clone, Copy, Debug)]
struct Facing {
    gap: f32,
    outward: Vec3,
}

/// Shapes of the world, and their pair filter.
pub(crate) struct Around<'a> {
    pub bodies: &'a Arena<Body>,
    pub proxies: &'a Proxies,
    pub activity: &'a Activity,
    pub filter: PairFilter<'a>,
    /// Number of the step.
    pub step: u64,
}

impl Pinches {
    /// Adds the contacts through particles of all awake groups to those of the world.
    pub fn find(
        &mut self,
        around: &Around<'_>,
        groups: &mut Arena<ParticleGroup>,
        contacts: &mut Vec<Contact>,
        modifiers: &mut Modifiers,
        context: &StepContext<'_>,
    ) {
        let bodies = around.bodies;
        self.own = contacts.len();
        self.groups.clear();
        if groups.is_empty() {
            return;
        }
        let movers = around.activity.movers().map(|index| bodies.at(index).fastest_point());
        self.fastest = movers.fold(0.0, max);
        for (index, group) in groups.iter_mut() {
            follow(bodies, group);
            if !group.is_awake() {
                continue;
            }
            self.list_near(group, around, context.dt);
            self.find_between(group, around, context.dt);
            let first = contacts.len();
            self.join(group, bodies, contacts, context);
            for (at, contact) in contacts.iter_mut().enumerate().skip(first) {
                let own = |contact: &Contact| material(bodies, group.material(), contact);
                let changed = modifiers.ask(bodies, contact, own, around.step);
                modifiers.set(at as u32, changed.unwrap_or_else(|| own(contact)));
            }
            self.groups.push((index, contacts.len() - first));
        }
    }

    /// Stores the contacts in their groups after the step.
    pub fn store(&mut self, groups: &mut Arena<ParticleGroup>, contacts: &mut Vec<Contact>) {
        let mut solved = contacts.drain(self.own..);
        for &(index, count) in &self.groups {
            let kept = &mut groups.at_mut(index).pinched.contacts;
            kept.clear();
            kept.extend(solved.by_ref().take(count));
        }
    }

    /// Lists the shapes that a group may touch within the step.
    fn list_near(&mut self, group: &ParticleGroup, &Around { bodies, proxies, .. }: &Around<'_>, dt: f32) {
        let around = group.bounds().expand(MARGIN + (group.fastest() + self.fastest) * dt);
        self.near.clear();
        let _ = proxies.overlapping(&around, |Owner { body: index, shape }| {
            let body = bodies.at(index);
            let surface = body.surface(shape as usize);
            if !body.quarantined && group.meets(bodies.id(index), surface) && is_plain(surface) {
                let world_from_shape = body.world_from_shape(shape as usize);
                let bounds = body.shapes[shape as usize].shape.aabb(&world_from_shape);
                // The test makes the list independent of the trees, which are not part of the state.
                if bounds.overlaps(&around) {
                    let is_active = body.is_active();
                    self.near.push(Near { body: index, shape, bounds, world_from_shape, is_active });
                }
            }
            ControlFlow::<()>::Continue(())
        });
        self.near.sort_unstable_by_key(|near| (near.body, near.shape));
    }

    /// Lists the particles of a group that are, now or within the step, between two shapes, one of which is active.
    fn find_between(&mut self, group: &ParticleGroup, &Around { bodies, filter, .. }: &Around<'_>, dt: f32) {
        self.found.clear();
        let reach = MARGIN + 2.0 * self.fastest * dt;
        for (at, near) in self.near.iter().enumerate().filter(|(_, near)| near.is_active) {
            for i in 0..group.positions().len() {
                let Some(facing) = near.facing(bodies, group, i, reach) else { continue };
                for (other_at, other) in self.near.iter().enumerate() {
                    // Skips a pair of active shapes that is found from the other side.
                    if other.body == near.body || other.is_active && other_at < at {
                        continue;
                    }
                    let Some(opposite) = other.facing(bodies, group, i, reach - facing.gap) else { continue };
                    let pair = [(near, facing), (other, opposite)];
                    if let Some(between) = between(bodies, group, i, pair, dt)
                        && filter.lets_meet(bodies, between.key)
                    {
                        self.found.push(between);
                    }
                }
            }
        }
        self.found.sort_unstable_by_key(|between| (between.key, between.particle));
    }

    /// Makes contacts of the listed particles, up to [`MOST_PINCHED`] per pair, and computes the load of each particle.
    fn join(
        &mut self,
        group: &mut ParticleGroup,
        bodies: &Arena<Body>,
        contacts: &mut Vec<Contact>,
        context: &StepContext<'_>,
    ) {
        let count = group.positions().len();
        let Pinched { contacts: old, loads } = &mut group.pinched;
        loads.clear();
        loads.resize(count, 0.0);
        contacts.reserve(MOST_PINCHED as usize * self.near.len());
        for pair in self.found.chunk_by_mut(|one, other| one.key == other.key) {
            let mut rest = pair;
            for number in 0..MOST_PINCHED {
                let Some(deepest) = rest.iter().copied().min_by(Between::deeper) else { break };
                let is_part = |normal: Vec3| normal.dot(deepest.normal) >= SAME_PART_COSINE;
                // Sorts the points of the current part first, by particle.
                rest.sort_unstable_by_key(|between| (!is_part(between.normal), between.particle));
                let count = rest.partition_point(|between| is_part(between.normal));
                let (part, others) = core::mem::take(&mut rest).split_at_mut(count);
                let key = deepest.key.through_particles(number);
                let goes_on =
                    |contact: &Contact| contact.key.is_of_pair(key) && is_part(contact.manifold.normal);
                let known = old.iter().position(goes_on).map(|at| old.remove(at));
                let manifold = spread(part, &deepest, known.as_ref());
                let memory = known.map_or_else(ContactMemory::default, |known| {
                    known.memory.matched(&known.manifold, &manifold)
                });
                share_load(part, &deepest, &memory, context.h, loads);
                let approach = approach_of(bodies.at(key.a), bodies.at(key.b), &manifold);
                contacts.push(Contact { manifold, memory, approach, ..Contact::new(key) });
                rest = others;
            }
        }
    }
}

impl Between {
    /// Compares depths, for an order that begins with the deepest.
    fn deeper(&self, other: &Self) -> Ordering {
        self.point.separation.total_cmp(&other.point.separation)
    }

    /// Height above `deepest`, metres: the difference of their separations.
    fn above(&self, deepest: &Self) -> f32 {
        self.point.separation - deepest.point.separation
    }
}

impl Near {
    /// Gap and normal of the surface at a particle; `None` if the gap exceeds `reach` (m).
    fn facing(&self, bodies: &Arena<Body>, group: &ParticleGroup, i: usize, reach: f32) -> Option<Facing> {
        let (position, radius) = (group.positions()[i], group.radii()[i]);
        if distance_at_least(&self.bounds, position) > radius + reach {
            return None;
        }
        let shape = &bodies.at(self.body).shapes[self.shape as usize].shape;
        let at = self.world_from_shape.inverse_point(position);
        let (distance, normal) = shape.ball_distance(at, radius, radius + reach);
        let gap = distance - radius;
        (gap <= reach).then(|| Facing { gap, outward: self.world_from_shape.rotation * normal })
    }
}

/// Contact point of a particle between two shapes; `None` unless they nip it now or within the step.
fn between(
    bodies: &Arena<Body>,
    group: &ParticleGroup,
    i: usize,
    [(near, facing), (other, opposite)]: [(&Near, Facing); 2],
    dt: f32,
) -> Option<Between> {
    let (mut facing, mut opposite) = (facing, opposite);
    match group.holder_of(i) {
        None => {}
        // The particle counts as a ball on the body that it is attached to.
        Some(AttachmentTarget::Body { body, .. }) if body.index == near.body => {
            facing = Facing { gap: 0.0, outward: -opposite.outward };
        }
        Some(AttachmentTarget::Body { body, .. }) if body.index == other.body => {
            opposite = Facing { gap: 0.0, outward: -facing.outward };
        }
        Some(_) => return None,
    }
    let along = facing.outward - opposite.outward;
    let cosine = 0.5 * along.length();
    let friction = |near: &Near| {
        let surface = bodies.at(near.body).surface(near.shape as usize);
        ContactMaterial::of(&group.material(), &surface.material).static_friction
    };
    if !is_nipped(facing.outward.dot(opposite.outward), min(friction(near), friction(other))) {
        return None;
    }
    let normal = along / (2.0 * cosine);
    let position = group.positions()[i];
    let velocity = |near: &Near| {
        let body = bodies.at(near.body);
        body.velocity.at(position - body.center())
    };
    let separation = (facing.gap + opposite.gap) / cosine;
    let closing = max((velocity(near) - velocity(other)).dot(normal), 0.0);
    if separation > MARGIN + closing * dt {
        return None;
    }
    let key = ContactKey::new((near.body, near.shape), (other.body, other.shape));
    let point = ManifoldPoint {
        position: position + normal * (0.5 * (opposite.gap - facing.gap)),
        separation,
        feature: i as u32,
    };
    let sign = if key.a == near.body { 1.0 } else { -1.0 };
    Some(Between { key, particle: i as u32, normal: normal * sign, point })
}

/// Selects distant points of a part, the deepest first. Each further point is as far as possible from the selected
/// ones, minus its lack of depth; points of the previous step are preferred.
fn spread(part: &[Between], deepest: &Between, known: Option<&Contact>) -> Manifold {
    let mut manifold = Manifold { normal: deepest.normal, count: 1, ..Manifold::default() };
    manifold.points[0] = deepest.point;
    let was_one = |point: &ManifoldPoint| {
        known.is_some_and(|known| known.manifold.points().iter().any(|old| old.feature == point.feature))
    };
    while manifold.count < MAX_POINTS {
        let score = |between: &Between| {
            let apart = |chosen: &ManifoldPoint| (chosen.position - between.point.position).length();
            let distance = manifold.points().iter().map(apart).fold(f32::INFINITY, min);
            let kept = if was_one(&between.point) { KEPT_POINT } else { 0.0 };
            distance - POINT_SLOPE * between.above(deepest) + kept
        };
        let scored = part.iter().map(|between| (score(between), between));
        let Some((score, best)) = scored.reduce(|best, next| if next.0 > best.0 { next } else { best })
        else {
            break;
        };
        // A selected point has distance zero.
        if score <= KEPT_POINT {
            break;
        }
        manifold.points[manifold.count] = best.point;
        manifold.count += 1;
    }
    manifold
}

/// Distributes the recent force of a contact over its particles; adds it to `loads`, N.
fn share_load(part: &[Between], deepest: &Between, memory: &ContactMemory, h: f32, loads: &mut [f32]) {
    let force = memory.points.iter().fold(0.0, |sum, point| sum + point.lasting) / h;
    let bearing = || part.iter().filter(|between| between.above(deepest) < BEARING_GAP);
    let share = force / bearing().count() as f32;
    bearing().for_each(|between| loads[between.particle as usize] += share);
}

/// Material of two surfaces with particles between them: friction is the smaller of both.
fn material(bodies: &Arena<Body>, particles: Material, contact: &Contact) -> ContactMaterial {
    let key = contact.key;
    let [a, b] = [(key.a, key.shape_a), (key.b, key.shape_b)].map(|(body, shape)| {
        ContactMaterial::of(&particles, &bodies.at(body).surface(shape as usize).material)
    });
    ContactMaterial {
        friction: min(a.friction, b.friction),
        static_friction: min(a.static_friction, b.static_friction),
        restitution: min(a.restitution, b.restitution),
        rolling: max(a.rolling, b.rolling),
        // Surface velocities act as if no particles were between the surfaces.
        ..contact.material(bodies)
    }
}
