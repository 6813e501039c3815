//! Contacts: pairs of shapes that are near each other, with what the solver remembers of them.

use crate::collide::{MAX_POINTS, Manifold};
use crate::shape::Material;
use sinew_math::{Vec3, max};

/// Which two shapes: body index and shape number of each, the smaller body index first, and which part of their contact. Sorting by it is the order
/// in which everything about contacts happens.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct ContactKey {
    pub a: u32,
    pub b: u32,
    pub shape_a: u32,
    pub shape_b: u32,
    /// Which of several manifolds of the two, from 0; a pair of convex shapes has only one.
    pub part: u32,
}

impl ContactKey {
    /// Whether it is one of the manifolds of the same two shapes.
    pub fn is_of_pair(&self, other: Self) -> bool {
        Self { part: other.part, ..*self } == other
    }
}

/// A pair of body indices, the smaller first.
pub(crate) fn ordered(a: u32, b: u32) -> (u32, u32) {
    if a < b { (a, b) } else { (b, a) }
}

/// Impulses of one manifold point over a substep, N·s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct PointImpulse {
    /// Of the last substep and the one before: an impact must not be repeated, so warm starting looks at both.
    pub now: f32,
    pub before: f32,
    /// Mean over some substeps: the load at rest.
    pub lasting: f32,
}

/// What a contact carries from step to step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ContactMemory {
    pub points: [PointImpulse; MAX_POINTS],
    /// Friction at the manifold's centre as a world vector, N·s.
    pub friction: Vec3,
    /// About the normal, N·m·s.
    pub twist: f32,
    /// Rolling resistance, world vector, N·m·s.
    pub rolling: Vec3,
}

impl ContactMemory {
    /// What a new manifold of the same shapes starts with. Points keep their impulses by feature; those of points that
    /// are gone go to the new ones in equal parts, since the load stays when the shapes tip from one corner to another.
    /// Nothing is kept if the normal turned by more than about 25°.
    pub fn matched(&self, old: &Manifold, new: &Manifold) -> Self {
        if new.count == 0 || old.count == 0 || old.normal.dot(new.normal) < 0.9 {
            return Self::default();
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
            point.lasting += lost.lasting / heirs as f32;
        }
        memory
    }
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Contact {
    pub key: ContactKey,
    pub manifold: Manifold,
    pub memory: ContactMemory,
    /// Surfaces overlap or touch.
    pub touching: bool,
    /// One of the shapes only senses.
    pub sensor: bool,
}

impl Contact {
    pub fn new(key: ContactKey) -> Self {
        Self {
            key,
            manifold: Manifold::default(),
            memory: ContactMemory::default(),
            touching: false,
            sensor: false,
        }
    }

    /// Whether the solver has to do with it.
    pub fn pushes(&self) -> bool {
        self.manifold.count > 0 && !self.sensor
    }
}

/// The parts of one pair after those of another.
pub(crate) fn pairs_of(contacts: &mut [Contact]) -> impl Iterator<Item = &mut [Contact]> {
    contacts.chunk_by_mut(|one, other| one.key.is_of_pair(other.key))
}

/// Combined surface of two materials.
pub(crate) fn combine(a: &Material, b: &Material) -> Material {
    Material {
        friction: (a.friction * b.friction).sqrt(),
        restitution: max(a.restitution, b.restitution),
        rolling: max(a.rolling, b.rolling),
    }
}

/// Length that contacts are scaled by: 5 mm, or 2 % of the smallest extent of either shape, so that small props are as
/// solid as crates. Points are looked for within 4 of it; a fifth of it is left overlapping, so that a contact at rest
/// keeps touching (a dead zone of all of it lets piles settle deep).
pub(crate) fn slop(smallest_extent: f32) -> f32 {
    sinew_math::min(0.005, 0.02 * smallest_extent)
}
