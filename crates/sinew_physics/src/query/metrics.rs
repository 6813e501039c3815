//! Measurements of a world: energies, momenta, overlaps of bodies.

use super::{BodyKinds, OverlapWith, Probe, QueryFilter};
use crate::body::contact_rule::ContactRule;
use crate::body::def::BodyKind;
use crate::body::shape::Sensing;
use crate::boxes::{Aabb, Overlap};
use crate::collide::collide_all;
use crate::contact::{ContactKey, ordered};
use crate::id::{BodyId, GroupId};
use crate::world::World;
use sinew_math::{Vec3, max};

/// Energy, joules.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// Kinetic energy of motion and spin, joules.
    pub kinetic: f32,
    /// Potential energy, joules: of height in uniform gravity (0 at the origin), and of stretched springs, including
    /// joints.
    pub potential: f32,
}

impl Energy {
    /// Sum of kinetic and potential energy, joules.
    pub fn total(self) -> f32 {
        self.kinetic + self.potential
    }
}

/// Linear and angular momentum.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Momentum {
    /// Linear momentum, N·s.
    pub linear: Vec3,
    /// Angular momentum about the world's origin, N·m·s.
    pub angular: Vec3,
}

impl World {
    /// Kinetic and potential energy of one body, joules.
    #[track_caller]
    pub fn body_energy(&self, id: BodyId) -> Energy {
        let body = self.expect(id);
        let weight = self.def.gravity * (body.mass * body.gravity_scale);
        Energy { kinetic: body.kinetic_energy(), potential: -weight.dot(body.center()) }
    }

    /// Kinetic and potential energy of one particle group, joules.
    #[track_caller]
    pub fn group_energy(&self, id: GroupId) -> Energy {
        let group = self.particles(id);
        let mut sum = Energy::default();
        for i in 0..group.positions().len() {
            let mass = group.masses()[i];
            sum.kinetic += 0.5 * mass * group.velocities()[i].length_squared();
            sum.potential -= mass * group.gravity_scale() * self.def.gravity.dot(group.positions()[i]);
        }
        sum.potential += group.elastic_energy();
        sum
    }

    /// Energy of all dynamic bodies, particles and springs, and their energy in the world's fields
    /// ([`field_energy`](Self::field_energy)), joules.
    pub fn energy(&self) -> Energy {
        let bodies = self.body_ids().map(|id| self.body_energy(id));
        let groups = self.group_ids().map(|id| self.group_energy(id));
        let of_joint = |id| Energy { kinetic: 0.0, potential: self.joint_energy(id) };
        let joints = self.joint_ids().map(of_joint);
        let of_field = |id| Energy { kinetic: 0.0, potential: self.field_energy(id) };
        let fields = self.field_ids().map(of_field);
        bodies.chain(groups).chain(joints).chain(fields).fold(Energy::default(), |sum, energy| Energy {
            kinetic: sum.kinetic + energy.kinetic,
            potential: sum.potential + energy.potential,
        })
    }

    /// Momentum of all dynamic bodies and all particles.
    pub fn momentum(&self) -> Momentum {
        let mut sum = Momentum::default();
        for (_, body) in self.bodies.iter().filter(|(_, body)| body.kind == BodyKind::Dynamic) {
            let p = body.velocity.linear * body.mass;
            sum.linear += p;
            sum.angular += body.center().cross(p) + body.inertia_mul(body.velocity.angular);
        }
        for (_, group) in self.groups.iter() {
            for i in 0..group.positions().len() {
                let p = group.velocities()[i] * group.masses()[i];
                sum.linear += p;
                sum.angular += group.positions()[i].cross(p);
            }
        }
        sum
    }

    /// Deepest overlap of two bodies, metres; 0 if they do not overlap.
    #[track_caller]
    pub fn overlap(&self, a: BodyId, b: BodyId) -> f32 {
        let (body_a, body_b) = (self.expect(a), self.expect(b));
        let mut deepest = 0.0;
        for (i, s) in body_a.shapes.iter().enumerate() {
            for (j, t) in body_b.shapes.iter().enumerate() {
                let (from_s, from_t) = (body_a.world_from_shape(i), body_b.world_from_shape(j));
                if !Overlap::<Aabb>::overlaps(&s.shape.aabb(&from_s), &t.shape.aabb(&from_t)) {
                    continue;
                }
                collide_all(&s.shape, &from_s, &t.shape, &from_t, 0.0, |manifold| {
                    for point in manifold.points() {
                        deepest = max(deepest, -point.separation);
                    }
                });
            }
        }
        deepest
    }

    /// Bodies that `id` touches or nearly touches, in the order of contacts.
    #[track_caller]
    pub fn neighbors(&self, id: BodyId) -> impl Iterator<Item = BodyId> {
        self.expect(id);
        let pushing = self.contacts_at(id.index).filter(|contact| contact.pushes());
        let mut keys: Vec<ContactKey> =
            pushing.map(|contact| ContactKey { part: 0, ..contact.key }).collect();
        keys.sort_unstable();
        keys.dedup();
        let other = move |key: ContactKey| key.other(id.index);
        keys.into_iter().map(other).map(|index| self.bodies.id(index))
    }

    /// Depth of the deepest overlap of a body with static bodies, metres, at its current pose. Static bodies do not
    /// stop a kinematic body: for one, this is how deep its motion moves it into the static world.
    #[track_caller]
    pub fn penetration(&self, id: BodyId) -> f32 {
        if self.expect(id).kind == BodyKind::Kinematic {
            return self.led_penetration(id);
        }
        // A pair with several contacts is tested several times; a list without duplicates would need memory.
        self.contacts_at(id.index)
            .filter(|contact| contact.pushes())
            .map(|contact| contact.key.other(id.index))
            .map(|index| self.bodies.id(index))
            .filter(|&other| self.kind(other) == BodyKind::Static)
            .fold(0.0, |deepest, other| max(deepest, self.overlap(id, other)))
    }

    /// [`penetration`](Self::penetration) of a kinematic body, which has no contacts with static ones.
    fn led_penetration(&self, id: BodyId) -> f32 {
        let body = self.expect(id);
        let (mut deepest, mut near) = (0.0, Vec::new());
        for (number, s) in body.shapes.iter().enumerate() {
            let surface = body.surface(number);
            if surface.sensing == Sensing::Sensor || surface.rule == ContactRule::Ghost {
                continue;
            }
            let filter = QueryFilter { meets: surface.filter, ..QueryFilter::of(BodyKinds::STATIC) };
            let is_solid = |other: BodyId, shape: u32| {
                self.expect(other).surface(shape as usize).rule != ContactRule::Ghost
                    && self.parted.disabled.binary_search(&ordered(id.index, other.index)).is_err()
            };
            let around = Probe::from(s.shape.aabb(&body.world_from_shape(number)));
            self.query().filter(filter).accept(is_solid).all(&OverlapWith(around), &mut near);
            near.dedup_by_key(|shape| shape.body);
            deepest = near.iter().map(|shape| self.overlap(id, shape.body)).fold(deepest, max);
        }
        deepest
    }

    /// Iterates over the shapes of a body with their world poses, for drawing.
    #[track_caller]
    pub fn shapes(
        &self,
        id: BodyId,
    ) -> impl Iterator<Item = (crate::body::shape::Shape, sinew_math::Transform)> {
        let body = self.expect(id);
        body.shapes.iter().enumerate().map(|(i, s)| (s.shape.clone(), body.world_from_shape(i)))
    }
}
