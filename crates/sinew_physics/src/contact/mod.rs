//! Contacts: pairs of nearby shapes, with the solver's stored impulses.

pub(crate) mod disabled_pairs;
pub(crate) mod events;
pub(crate) mod filter;
pub(crate) mod hits;
pub(crate) mod modifiers;
pub(crate) mod near;
pub(crate) mod parts;
pub(crate) mod proxies;
pub(crate) mod recycled;
pub(crate) mod seams;
pub(crate) mod snapshot;
pub(crate) mod tracking;
pub(crate) mod tuning;

use crate::arena::Arena;
use crate::body::Body;
use crate::body::material::ContactMaterial;
use crate::boxes::AxisOf;
use crate::collide::{MAX_POINTS, Manifold, ManifoldPoint, SeparationCache};
use crate::contact::recycled::Recycled;
use core::cmp::Ordering;
use sinew_math::Vec3;

/// Key of a contact: body index and shape number of both shapes, the smaller body index first, and the part of their
/// contact. Contacts are always processed in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ContactKey {
    pub a: u32,
    pub b: u32,
    pub shape_a: u32,
    pub shape_b: u32,
    /// Number of the manifold among those of the two shapes, from 0; a pair of convex shapes has only one. Contacts
    /// through particles have the numbers from [`THROUGH_PARTICLES`] on.
    pub part: u32,
}

/// Compares the fields in order, two at a time.
impl Ord for ContactKey {
    fn cmp(&self, other: &Self) -> Ordering {
        let both = |first: u32, second: u32| u64::from(first) << 32 | u64::from(second);
        let order = |key: &Self| (both(key.a, key.b), both(key.shape_a, key.shape_b), key.part);
        order(self).cmp(&order(other))
    }
}

impl PartialOrd for ContactKey {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// First part number of contacts between two shapes through particles.
const THROUGH_PARTICLES: u32 = 1 << 31;

impl ContactKey {
    /// Key of contact `number` of the same two shapes through particles between them.
    pub fn through_particles(self, number: u32) -> Self {
        Self { part: THROUGH_PARTICLES | number, ..self }
    }

    /// True if particles are between the shapes: the shapes' geometry does not define the contact points.
    pub fn is_through_particles(self) -> bool {
        self.part >= THROUGH_PARTICLES
    }

    /// Key of two shapes, each given by body index and shape number, in either order; part 0.
    pub fn new(p: (u32, u32), q: (u32, u32)) -> Self {
        let (a, b) = if p.0 < q.0 { (p, q) } else { (q, p) };
        Self { a: a.0, b: b.0, shape_a: a.1, shape_b: b.1, part: 0 }
    }

    /// True if both keys belong to the same two shapes.
    pub fn is_of_pair(&self, other: Self) -> bool {
        Self { part: other.part, ..*self } == other
    }

    /// True if `body` is one of the two bodies.
    pub fn has(self, body: u32) -> bool {
        self.a == body || self.b == body
    }

    /// The other body of a pair.
    pub fn other(self, body: u32) -> u32 {
        if self.a == body { self.b } else { self.a }
    }
}

/// A pair of body indices, the smaller first.
pub(crate) fn ordered(a: u32, b: u32) -> (u32, u32) {
    if a < b { (a, b) } else { (b, a) }
}

/// Impulses of one manifold point, N·s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct PointImpulse {
    /// Impulse of the last substep and of the one before: warm starting uses both, so that an impact is not repeated.
    pub now: f32,
    pub before: f32,
    /// Sum over all substeps of the step.
    pub total: f32,
    /// Mean impulse over some substeps: the load at rest.
    pub lasting: f32,
}

/// Impulses that a contact keeps from step to step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ContactMemory {
    pub points: [PointImpulse; MAX_POINTS],
    /// Friction impulse at the manifold's centre, world vector, N·s.
    pub friction: Vec3,
    /// Impulse of twist friction about the normal, N·m·s.
    pub twist: f32,
    /// Impulse of rolling resistance, world vector, N·m·s.
    pub rolling: Vec3,
    /// Friction impulse of all substeps of the step, world vector, N·s.
    pub total_friction: Vec3,
}

impl ContactMemory {
    /// Copies the memory with zero total impulses.
    pub fn of_new_step(&self) -> Self {
        let points = self.points.map(|point| PointImpulse { total: 0.0, ..point });
        Self { points, total_friction: Vec3::ZERO, ..*self }
    }

    /// Scales the persistent impulses to substeps `times` as long; does not change the sums of the step.
    pub fn of_substeps(&self, times: f32) -> Self {
        if times == 1.0 {
            return *self;
        }
        let scaled = |point: PointImpulse| PointImpulse {
            now: point.now * times,
            before: point.before * times,
            lasting: point.lasting * times,
            ..point
        };
        Self {
            points: self.points.map(scaled),
            friction: self.friction * times,
            twist: self.twist * times,
            rolling: self.rolling * times,
            ..*self
        }
    }

    /// Stored impulses for a new manifold of the same shapes. Points keep their impulses by feature. The impulses of
    /// removed points are divided equally among new points, because the load remains when the shapes tip from one
    /// corner to another. All impulses are dropped if the normal rotated by more than about 25°.
    pub fn matched(&self, old: &Manifold, new: &Manifold) -> Self {
        if new.count == 0 || old.count == 0 || old.normal.dot(new.normal) < 0.9 {
            return Self::default();
        }
        let same = |(p, q): (&ManifoldPoint, &ManifoldPoint)| p.feature == q.feature;
        if old.count == new.count && old.points().iter().zip(new.points()).all(same) {
            return *self;
        }
        let mut memory = Self { points: Default::default(), ..*self };
        let mut fresh = [true; MAX_POINTS];
        let mut lost = PointImpulse::default();
        for (point, impulse) in old.points().iter().zip(&self.points) {
            match new.points().iter().position(|p| p.feature == point.feature) {
                Some(i) => {
                    memory.points[i] = *impulse;
                    fresh[i] = false;
                }
                None => {
                    lost.now += impulse.now;
                    lost.before += impulse.before;
                    lost.total += impulse.total;
                    lost.lasting += impulse.lasting;
                }
            }
        }
        let fresh = &fresh[..new.count];
        let all = !fresh.contains(&true);
        let heirs = if all { new.count } else { fresh.iter().filter(|f| **f).count() };
        for (point, _) in memory.points.iter_mut().zip(fresh).filter(|(_, fresh)| all || **fresh) {
            point.now += lost.now / heirs as f32;
            point.before += lost.before / heirs as f32;
            point.total += lost.total / heirs as f32;
            point.lasting += lost.lasting / heirs as f32;
        }
        memory
    }
}

/// Effect of a contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Effect {
    /// The shapes push each other.
    #[default]
    Push,
    /// One of the shapes is a sensor.
    Sense,
    /// The shapes do not push each other.
    Pass,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Contact {
    pub key: ContactKey,
    pub manifold: Manifold,
    pub memory: ContactMemory,
    pub effect: Effect,
    /// True if one of the shapes is one-way: its decision lasts while the shapes touch.
    pub one_way: bool,
    /// True if this contact or an earlier part of its pair pushed in the last step.
    pub pushed: bool,
    /// True if its pair was reported as touching, or as a sensor pair.
    pub touching: bool,
    pub sensed: bool,
    /// True if the last one-way test disabled this contact.
    pub passes: bool,
    /// Largest approach speed of the contact's points at the start of the step, m/s.
    pub approach: f32,
    /// Last separating axis of the shapes. Not part of the state: it only speeds up the next search.
    pub apart: Option<AxisOf>,
    /// Guaranteed gap of the shapes at the time of `apart`, metres, if they had no points. Not part of the state.
    pub gap: f32,
    /// True if one of the shapes is a mesh or a height field.
    pub has_surface: bool,
    /// True if the contact only pushes, unless a surface changes. Derived from the surfaces and not part of the state.
    pub is_plain: bool,
    pub kept: Recycled,
}

impl Contact {
    pub fn new(key: ContactKey) -> Self {
        Self {
            key,
            manifold: Manifold::default(),
            memory: ContactMemory::default(),
            effect: Effect::Push,
            one_way: false,
            pushed: false,
            touching: false,
            sensed: false,
            passes: false,
            approach: 0.0,
            apart: None,
            gap: f32::NEG_INFINITY,
            has_surface: false,
            is_plain: false,
            kept: Recycled::default(),
        }
    }

    /// True if the contact has no points and nothing to report: equivalent to no contact.
    pub fn is_idle(&self) -> bool {
        self.manifold.count == 0 && !self.touching && !self.sensed
    }

    /// Separating axis and gap of the shapes, if known.
    pub fn parting(&self) -> SeparationCache {
        SeparationCache { axis: self.apart, gap: self.gap }
    }

    /// True if the solver solves this contact.
    pub fn pushes(&self) -> bool {
        self.manifold.count > 0 && self.effect == Effect::Push
    }

    /// True if the surfaces overlap or touch, to rounding.
    pub fn overlaps(&self) -> bool {
        self.manifold.points().iter().any(|point| point.separation <= 0.0)
    }

    /// True if the contact pushed in the last step that updated it.
    pub fn has_pushed(&self) -> bool {
        self.impulses().any(|(_, impulse)| impulse > 0.0)
    }

    /// World positions of the contact's points, metres, and the total normal impulse of each in the last step, N·s.
    pub fn impulses(&self) -> impl Iterator<Item = (Vec3, f32)> {
        let points = self.manifold.points().iter().zip(&self.memory.points);
        points.map(|(point, impulse)| (point.position, impulse.total))
    }

    /// Combined material of the two surfaces at the bodies' current poses.
    pub fn material(&self, bodies: &Arena<Body>) -> ContactMaterial {
        let sides = [(self.key.a, self.key.shape_a), (self.key.b, self.key.shape_b)];
        let sides = sides.map(|(body, shape)| (bodies.at(body), shape as usize));
        let [a, b] = sides.map(|(body, shape)| &body.surface(shape).material);
        let mut material = ContactMaterial::of(a, b);
        if a.runs() || b.runs() {
            let center = self.manifold.center();
            let [a, b] = sides.map(|(body, shape)| body.surface_velocity(shape, center));
            material.velocity = b.linear - a.linear;
            material.spin = b.angular - a.angular;
        }
        material
    }
}

/// Slices of contacts of the same two shapes, pair by pair.
pub(crate) fn pairs_of(contacts: &mut [Contact]) -> impl Iterator<Item = &mut [Contact]> {
    contacts.chunk_by_mut(|one, other| one.key.is_of_pair(other.key))
}

/// Length scale of contacts of shapes with the given smallest extent (m), metres: 5 mm, or 2 % of the extent if that is
/// less, so that small props are as firm as crates. The search margin is 4 times the slop. A fifth of the slop remains
/// as overlap, so that a resting contact keeps touching; a dead zone of the whole slop would let piles sink visibly.
pub(crate) fn slop(smallest_extent: f32) -> f32 {
    sinew_math::min(0.005, 0.02 * smallest_extent)
}
