//! Fields: what pulls, blows, floats and brakes wherever it reaches.
//!
//! A field acts on dynamic bodies and on particles alike, in every substep, by where they are and how they move in it. It is
//! plain data ([`FieldDef`]), part of the world's snapshot, and evaluated in `integrate_velocity`, before anything is
//! solved. Forces of several fields add up. An [`Explosion`] is a field that acts for an instant: see
//! [`World::explode`](crate::World::explode).
//!
//! **Stiffness.** Where a field brakes (wind, drag, water), its force `F` is taken at the velocity with which the substep
//! begins: the load of wind on a body that something holds is then the right one, and so is every steady speed. That is
//! stable while `h b < m`, with `b = −∂F/∂v`; where it is more (a leaf of silk in a storm), all force on the body is
//! divided by `h b / m`, so that it comes near its steady speed within the substep and never passes it. Likewise torque.
//!
//! **Sleep.** A field acts on what is awake. Adding, changing and removing one wakes what it reaches or reached. What lies
//! still in a field that does not change may fall asleep in it, as under gravity; in one that changes by itself (wind with
//! gusts, a user's function) it does not. Bodies that attract each other sleep and wake together, and not at all where there are
//! particles; particles that are attracted do not sleep.
//!
//! A world without fields pays nothing for them.

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

/// The fields of a world, as a step sees them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fields<'a> {
    pub arena: &'a Arena<FieldDef>,
    pub functions: &'a Functions,
    /// The world's gravity, m/s².
    pub gravity: Vec3,
    /// Steps taken before this one.
    pub step: u64,
    /// Time at the beginning of the step.
    pub nanoseconds: u64,
    /// There are particles.
    particles: bool,
}

impl<'a> Fields<'a> {
    pub fn new(arena: &'a Arena<FieldDef>, functions: &'a Functions, def: &WorldDef, step: u64) -> Self {
        let nanoseconds = step.wrapping_mul(def.step_nanoseconds);
        Self { arena, functions, gravity: def.gravity, step, nanoseconds, particles: false }
    }

    /// With what is there beside the bodies.
    pub fn among(self, groups: &Arena<ParticleGroup>) -> Self {
        Self { particles: groups.iter().next().is_some(), ..self }
    }

    pub fn is_empty(&self) -> bool {
        self.arena.iter().next().is_none()
    }

    /// Load of all fields that do not couple bodies.
    pub fn load(&self, target: &Target<'_>) -> Load {
        let mut load = Load::default();
        for (_, field) in self.arena.iter() {
            field.act(target, self, &mut load);
        }
        load
    }

    /// Fields in which bodies attract each other, each with its law.
    pub fn mutual(&self) -> impl Iterator<Item = (&'a FieldDef, &'a MutualGravity)> {
        self.arena.iter().filter_map(|(_, field)| match &field.kind {
            FieldKind::Mutual(law) => Some((field, law)),
            _ => None,
        })
    }

    /// True if a body lies in a field that changes by itself, or attracts particles.
    pub fn keep_awake(&self, body: &Body) -> bool {
        let mut fields = self.arena.iter();
        fields.any(|(_, field)| {
            let pulls_particles = self.particles && matches!(field.kind, FieldKind::Mutual(_));
            (field.kind.changes_by_itself() || pulls_particles) && field.reaches(&Target::of_body(body))
        })
    }

    /// True if a particle of a group lies in a field that changes by itself, or attracts.
    pub fn keep_group_awake(&self, group: &ParticleGroup) -> bool {
        let mut fields = self.arena.iter();
        fields.any(|(_, field)| {
            let stirs = field.kind.changes_by_itself() || matches!(field.kind, FieldKind::Mutual(_));
            stirs && field.reaches_group(group)
        })
    }

    /// Sleeper that is to wake next, as long as there is one: what attracts and is attracted wakes together.
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
    /// True if it acts on something at all.
    pub(crate) fn reaches(&self, target: &Target<'_>) -> bool {
        target.is_on(self.layers) && self.region.weight(target.center()) > 0.0
    }

    /// True if it acts on a particle of a group.
    pub(crate) fn reaches_group(&self, group: &ParticleGroup) -> bool {
        (0..group.positions().len()).any(|i| self.reaches(&Target::of_particle(group, i)))
    }

    /// Strength where something is: 0 outside of its region and on other layers, 1 where it is full.
    pub(crate) fn weight(&self, target: &Target<'_>) -> f32 {
        if target.is_on(self.layers) { self.region.weight(target.center()) } else { 0.0 }
    }

    /// Adds what it does to something, but for what couples bodies.
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

    /// Energy that something has in it, J, as far as it has one.
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
