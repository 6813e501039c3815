//! Fields: gravity, attraction, wind, buoyancy and drag within a region.
//!
//! A field acts on dynamic bodies and particles in every substep, by their current position and velocity. It is plain
//! data ([`FieldDef`]), part of the world's snapshot, and evaluated in `integrate_velocity`, before solving. Forces of
//! several fields add up. An [`Explosion`] is an instantaneous field: see [`World::explode`](crate::World::explode).
//!
//! **Stiffness.** A damping field (wind, drag, water) is evaluated at the velocity at the start of the substep, so the
//! load on a held body is exact, and so is every terminal velocity. That is stable while `h b < m`, with `b = −∂F/∂v`.
//! If `h b` exceeds `m` (a silk leaf in a storm), the total force on the body is divided by `h b / m`. The body then
//! approaches its terminal velocity within the substep and never passes it. The same holds for torque.
//!
//! **Sleep.** A field acts on awake bodies and particles. Adding, changing or removing a field wakes all bodies and
//! particles that it reaches or reached. A body at rest in a constant field may fall asleep, as under gravity; in a
//! field that changes by itself (wind with gusts, a user function) it may not. Bodies that attract each other sleep and
//! wake together, and never sleep if there are particles; attracted particles do not sleep.
//!
//! Fields cost nothing in a world without fields.

mod buoyancy;
mod custom;
mod def;
mod drag;
mod explosion;
mod exposed;
mod gravity;
mod load;
mod mutual;
mod noise;
mod region;
mod snapshot;
mod target;
mod wind;

pub use buoyancy::Buoyancy;
pub use custom::{FieldFunction, FieldPoint, PARAMETERS};
pub use def::{FieldDef, FieldKind};
pub use drag::Drag;
pub use explosion::{Explosion, Occlusion};
pub use gravity::{PointGravity, UniformGravity};
pub use mutual::MutualGravity;
pub use region::{Fade, Region};
pub use sinew_geometry::submerged::{Submerged, WaterPlane, submerged_hull};
pub use wind::{Gusts, Wind};

pub(crate) use custom::Functions;
pub(crate) use load::{Load, least};
pub(crate) use mutual::{Attractor, attractor};
pub(crate) use target::{Form, Target};

use crate::activity::Activity;
use crate::arena::Arena;
use crate::body::Body;
use crate::body::def::WorldDef;
use crate::particles::ParticleGroup;
use sinew_math::Vec3;

/// Fields of a world, for a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fields<'a> {
    pub arena: &'a Arena<FieldDef>,
    pub functions: &'a Functions,
    /// The world's gravity, m/s².
    pub gravity: Vec3,
    /// Number of steps taken before this one.
    pub step: u64,
    /// Time at the beginning of the step, nanoseconds.
    pub nanoseconds: u64,
    /// True if the world has particles.
    particles: bool,
}

impl<'a> Fields<'a> {
    pub fn new(arena: &'a Arena<FieldDef>, functions: &'a Functions, def: &WorldDef, step: u64) -> Self {
        let nanoseconds = step.wrapping_mul(def.step_nanoseconds);
        Self { arena, functions, gravity: def.gravity, step, nanoseconds, particles: false }
    }

    /// Returns the fields, with `particles` set if the world has particle groups.
    pub fn among(self, groups: &Arena<ParticleGroup>) -> Self {
        Self { particles: groups.iter().next().is_some(), ..self }
    }

    pub fn is_empty(&self) -> bool {
        self.arena.iter().next().is_none()
    }

    /// Load of all fields except mutual attraction.
    pub fn load(&self, target: &Target<'_>) -> Load {
        let mut load = Load::default();
        for (_, field) in self.arena.iter() {
            field.act(target, self, &mut load);
        }
        load
    }

    /// Iterates over the fields with mutual attraction, each with its law.
    pub fn mutual(&self) -> impl Iterator<Item = (&'a FieldDef, &'a MutualGravity)> {
        self.arena.iter().filter_map(|(_, field)| match &field.kind {
            FieldKind::Mutual(law) => Some((field, law)),
            _ => None,
        })
    }

    /// True if a body is in a field that changes by itself, or in a field that attracts while the world has particles.
    pub fn keep_awake(&self, body: &Body) -> bool {
        let mut fields = self.arena.iter();
        fields.any(|(_, field)| {
            let pulls_particles = self.particles && matches!(field.kind, FieldKind::Mutual(_));
            (field.kind.changes_by_itself() || pulls_particles) && field.reaches(&Target::of_body(body))
        })
    }

    /// True if a particle of a group is in a field that changes by itself or in a field with mutual attraction.
    pub fn keep_group_awake(&self, group: &ParticleGroup) -> bool {
        let mut fields = self.arena.iter();
        fields.any(|(_, field)| {
            let stirs = field.kind.changes_by_itself() || matches!(field.kind, FieldKind::Mutual(_));
            stirs && field.reaches_group(group)
        })
    }

    /// Next sleeping body to wake, if any: bodies that attract each other wake together.
    pub fn next_to_wake(&self, bodies: &Arena<Body>, activity: &Activity) -> Option<u32> {
        self.mutual().find_map(|(field, _)| {
            let reached =
                |body: &Body| body.mass > 0.0 && !body.quarantined && field.reaches(&Target::of_body(body));
            let awake = self.particles || activity.active().any(|index| reached(bodies.at(index)));
            let mut sleepers = bodies.iter().filter(|(_, body)| !body.is_awake() && reached(body));
            if awake { sleepers.next().map(|(index, _)| index) } else { None }
        })
    }
}

impl FieldDef {
    /// True if the field has any effect on a body or particle.
    pub(crate) fn reaches(&self, target: &Target<'_>) -> bool {
        target.is_on(self.layers) && self.region.weight(target.center()) > 0.0
    }

    /// True if the field acts on a particle of a group.
    pub(crate) fn reaches_group(&self, group: &ParticleGroup) -> bool {
        (0..group.positions().len()).any(|i| self.reaches(&Target::of_particle(group, i)))
    }

    /// Strength of the field at a body or particle: 0 outside its region and on other layers, 1 at full strength.
    pub(crate) fn weight(&self, target: &Target<'_>) -> f32 {
        if target.is_on(self.layers) { self.region.weight(target.center()) } else { 0.0 }
    }

    /// Adds the field's load on a body or particle, except mutual attraction.
    pub(crate) fn act(&self, target: &Target<'_>, fields: &Fields<'_>, sum: &mut Load) {
        let weight = self.weight(target);
        if weight <= 0.0 {
            return;
        }
        let mut load = Load::default();
        match &self.kind {
            FieldKind::Uniform(field) => load.push(field.force(target)),
            FieldKind::Point(field) => load.push(field.force(target)),
            FieldKind::Mutual(_) => {}
            FieldKind::Wind(field) => field.act(target, fields.nanoseconds, &mut load),
            FieldKind::Drag(field) => field.act(target, &mut load),
            FieldKind::Buoyancy(field) => field.act(target, fields.gravity, &mut load),
            FieldKind::Custom { function, parameters } => {
                load.wrench = fields.functions.call(*function, target, fields, parameters);
            }
        }
        sum.add(&load, weight);
    }

    /// Potential energy of a body or particle in the field, J; 0 if the field has none.
    pub(crate) fn energy(&self, target: &Target<'_>, gravity: Vec3) -> f32 {
        if self.region != Region::Everywhere || !target.is_on(self.layers) {
            return 0.0;
        }
        match &self.kind {
            FieldKind::Uniform(field) => field.energy(target),
            FieldKind::Point(field) => field.energy(target),
            FieldKind::Buoyancy(field) => field.energy(target, gravity),
            FieldKind::Mutual(_) | FieldKind::Wind(_) | FieldKind::Drag(_) | FieldKind::Custom { .. } => 0.0,
        }
    }
}
