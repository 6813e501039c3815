//! Contacts: pairs of shapes that are near each other, with what the solver remembers of them.

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

/// Key of a contact: body index and shape number of both shapes, the smaller body index first, and which part of their contact.
/// Sorting by it is the order in which everything about contacts happens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ContactKey {
    pub a: u32,
    pub b: u32,
    pub shape_a: u32,
    pub shape_b: u32,
    /// Number of the manifold among those of the two shapes, from 0; a pair of convex shapes has only one. From [`THROUGH_PARTICLES`] on: of those through
    /// particles.
    pub part: u32,
}

/// Field by field, two at a time.
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

/// First number of the parts that are contacts of two shapes through particles between them.
const THROUGH_PARTICLES: u32 = 1 << 31;

impl ContactKey {
    /// Key of the contact of that number of two shapes through particles between them.
    pub fn through_particles(self, number: u32) -> Self {
        Self { part: THROUGH_PARTICLES | number, ..self }
    }

    /// True if particles lie between the shapes: their geometry does not say where its points are.
    pub fn is_through_particles(self) -> bool {
        self.part >= THROUGH_PARTICLES
    }

    /// Key of two shapes, each given by body and shape number, in whatever order; part 0.
    pub fn new(p: (u32, u32), q: (u32, u32)) -> Self {
        let (a, b) = if p.0 < q.0 { (p, q) } else { (q, p) };
        Self { a: a.0, b: b.0, shape_a: a.1, shape_b: b.1, part: 0 }
    }

    /// True if it is one of the manifolds of the same two shapes.
    pub fn is_of_pair(&self, other: Self) -> bool {
        Self { part: other.part, ..*self } == other
    }

    /// True if a body is one of the two.
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
    /// Impulses of the last substep and the one before: an impact must not be repeated, so warm starting looks at both.
    pub now: f32,
    pub before: f32,
    /// Sum over all substeps of the step.
    pub total: f32,
    /// Mean over some substeps: the load at rest.
    pub lasting: f32,
}

/// Impulses that a contact carries from step to step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ContactMemory {
    pub points: [PointImpulse; MAX_POINTS],
    /// Friction at the manifold's centre as a world vector, N·s.
    pub friction: Vec3,
    /// About the normal, N·m·s.
    pub twist: f32,
    /// Rolling resistance, world vector, N·m·s.
    pub rolling: Vec3,
    /// Friction of all substeps of the step, world vector, N·s.
    pub total_friction: Vec3,
}

impl ContactMemory {
    /// With nothing given yet.
    pub fn of_new_step(&self) -> Self {
        let points = self.points.map(|point| PointImpulse { total: 0.0, ..point });
        Self { points, total_friction: Vec3::ZERO, ..*self }
    }

    /// Impulses that last from substep to substep as those of substeps `times` as long; the sums of the step stay.
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

    /// Memory that a new manifold of the same shapes starts with. Points keep their impulses by feature; those of points that
    /// are gone go to the new ones in equal parts, since the load stays when the shapes tip from one corner to another.
    /// Nothing is kept if the normal turned by more than about 25°.
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
    /// It pushes.
    #[default]
    Push,
    /// One of the shapes only senses.
    Sense,
    /// The shapes pass through each other.
    Pass,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Contact {
    pub key: ContactKey,
    pub manifold: Manifold,
    pub memory: ContactMemory,
    pub effect: Effect,
    /// One of the shapes is solid from one side: what is decided stays while they touch.
    pub one_way: bool,
    /// It pushed in the last step, or the parts before it did.
    pub pushed: bool,
    /// Its pair was told of as touching, or as one with a sensor.
    pub touching: bool,
    pub sensed: bool,
    /// A shape that is solid from one side let the other pass when it was last decided.
    pub passes: bool,
    /// Speed at which its points came in when the step began, m/s.
    pub approach: f32,
    /// Separating axis of the shapes when they were last looked at. Not part of the state: it decides nothing but how soon that is
    /// found again.
    pub apart: Option<AxisOf>,
    /// Gap that surely was between them then, metres, if they had no points. Not part of the state, either.
    pub gap: f32,
    /// One of the shapes is a mesh or a height field.
    pub has_surface: bool,
    /// It does nothing but push, as long as neither surface is changed. Not part of the state: it follows from them.
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

    /// It has no points, and nothing is to be told of it: as good as none.
    pub fn is_idle(&self) -> bool {
        self.manifold.count == 0 && !self.touching && !self.sensed
    }

    /// Separating axis and gap of its shapes, as far as they are known.
    pub fn parting(&self) -> SeparationCache {
        SeparationCache { axis: self.apart, gap: self.gap }
    }

    /// True if the solver has to do with it.
    pub fn pushes(&self) -> bool {
        self.manifold.count > 0 && self.effect == Effect::Push
    }

    /// Surfaces overlap or touch, to rounding.
    pub fn overlaps(&self) -> bool {
        self.manifold.points().iter().any(|point| point.separation <= 0.0)
    }

    /// It pushed in the last step in which it was looked at.
    pub fn has_pushed(&self) -> bool {
        self.impulses().any(|(_, impulse)| impulse > 0.0)
    }

    /// World positions of its points, m, and all that each got along the normal in the last step, N·s.
    pub fn impulses(&self) -> impl Iterator<Item = (Vec3, f32)> {
        let points = self.manifold.points().iter().zip(&self.memory.points);
        points.map(|(point, impulse)| (point.position, impulse.total))
    }

    /// Contact material of its two surfaces, as the bodies lie now.
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

/// The parts of one pair after those of another.
pub(crate) fn pairs_of(contacts: &mut [Contact]) -> impl Iterator<Item = &mut [Contact]> {
    contacts.chunk_by_mut(|one, other| one.key.is_of_pair(other.key))
}

/// Length that contacts are scaled by: 5 mm, or 2 % of the smallest extent of either shape, so that small props are as
/// solid as crates. Points are looked for within 4 of it; a fifth of it is left overlapping, so that a contact at rest
/// keeps touching (a dead zone of all of it lets piles settle deep).
pub(crate) fn slop(smallest_extent: f32) -> f32 {
    sinew_math::min(0.005, 0.02 * smallest_extent)
}
