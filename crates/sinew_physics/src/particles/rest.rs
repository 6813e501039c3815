//! Rest of a particle group: its time at rest, and the number of its sleeping island.

use super::{AttachmentTarget, ParticleGroup};
use crate::body::def::{SleepThresholds, Sleeping};
use crate::body::shape::Shape;
use crate::boxes::Aabb;
use crate::id::BodyId;
use crate::particles::contact::distance_at_least;
use crate::particles::tuning::{BEARING, RESTING_SPEED, STRIKE_GAP, SUPPORT_MARGIN};
use sinew_math::{ReadError, Reader, Transform, Vec3, Writer};

/// Awake, asleep with its island, or woken since the last step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum GroupRest {
    /// Time for which all particles have been at rest, seconds.
    Awake { rest_time: f32 },
    /// Number of the sleeping island; its bodies wake with the group.
    Asleep { island: u32 },
    /// Woken since the last step: bodies that sleep with this island number wake in the next step.
    Roused { island: u32 },
}

impl Default for GroupRest {
    fn default() -> Self {
        Self::Awake { rest_time: 0.0 }
    }
}

/// Surroundings of a sleeping group, derived from the world.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SleepSupport {
    /// Index of a body that fell asleep with the group, if any did.
    pub partner: Option<u32>,
    /// Bounds of all particles with their radii and a margin.
    pub bounds: Aabb,
}

impl ParticleGroup {
    /// True unless the group sleeps.
    pub fn is_awake(&self) -> bool {
        !matches!(self.rest, GroupRest::Asleep { .. })
    }

    /// Permission for the group to fall asleep.
    pub fn sleeping(&self) -> Sleeping {
        self.sleeping
    }

    /// Sets the permission to fall asleep; the group wakes if it is revoked.
    pub fn set_sleeping(&mut self, sleeping: Sleeping) {
        self.sleeping = sleeping;
        if sleeping == Sleeping::Off {
            self.wake();
        }
    }

    /// Wakes the group, and in the next step the bodies that fell asleep with it. Restarts the time at rest of an awake
    /// group.
    pub fn wake(&mut self) {
        self.rest = match self.rest {
            GroupRest::Awake { .. } => GroupRest::default(),
            GroupRest::Asleep { island } | GroupRest::Roused { island } => GroupRest::Roused { island },
        };
    }

    /// Number of the island that the group sleeps with, or slept with until it was woken since the last step.
    pub(crate) fn slept_with(&self) -> Option<u32> {
        match self.rest {
            GroupRest::Awake { .. } => None,
            GroupRest::Asleep { island } | GroupRest::Roused { island } => Some(island),
        }
    }

    /// Index of a body that fell asleep with the group.
    pub(crate) fn partner(&self) -> Option<u32> {
        self.sleep_support.and_then(|support| support.partner)
    }

    /// Surroundings of the group while it sleeps.
    pub(crate) fn sleep_support(&self) -> Option<&SleepSupport> {
        self.sleep_support.as_ref().filter(|_| !self.is_awake())
    }

    /// Wakes the group because the bodies that fell asleep with it are awake.
    pub(crate) fn wake_particles(&mut self) {
        self.rest = GroupRest::default();
        self.sleep_support = None;
    }

    /// True if particles are attached to bodies; these bodies fall asleep only with the group.
    pub(crate) fn holds_bodies(&self) -> bool {
        self.attachments.iter().any(|a| matches!(a.target, AttachmentTarget::Body { .. }))
    }

    /// Bodies that particles are attached to or that carry backstops, once for each attachment and backstop.
    pub(crate) fn carriers(&self) -> impl Iterator<Item = BodyId> {
        let held = self.attachments.iter().filter_map(|a| match a.target {
            AttachmentTarget::Body { body, .. } => Some(body),
            AttachmentTarget::World(_) => None,
        });
        held.chain(self.backstops.iter().map(|backstop| backstop.body))
    }

    /// Puts the group to sleep with an island number and the index of a body that falls asleep with it.
    pub(crate) fn fall_asleep(&mut self, island: u32, partner: Option<u32>) {
        self.rest = GroupRest::Asleep { island };
        self.velocities.fill(Vec3::ZERO);
        self.places.copy_from_slice(&self.positions);
        self.begin_step();
        self.store_sleep_support(partner);
    }

    /// Stores the surroundings of the sleeping group: their bounds, and a body that fell asleep with the group.
    pub(crate) fn store_sleep_support(&mut self, partner: Option<u32>) {
        self.sleep_support =
            Some(SleepSupport { partner, bounds: self.bounds_of(&self.places).expand(SUPPORT_MARGIN) });
    }

    /// Updates and returns the time at rest of the group, seconds; negative infinity if the group is not calm.
    pub(crate) fn count_rest(&mut self, may: Sleeping, thresholds: &SleepThresholds, dt: f32) -> f32 {
        let stays = all_within(&self.positions, &self.places, thresholds.distance);
        let may = may == Sleeping::On && self.sleeping == Sleeping::On;
        let calm = may && stays && all_within(&self.positions, &self.drawn_from, RESTING_SPEED * dt);
        match &mut self.rest {
            GroupRest::Awake { rest_time } if calm => {
                *rest_time += dt;
                *rest_time
            }
            _ => {
                self.rest = GroupRest::default();
                f32::NEG_INFINITY
            }
        }
    }

    /// True if the group is awake and has been at rest for `time` seconds.
    pub(crate) fn has_rested(&self, time: f32) -> bool {
        matches!(self.rest, GroupRest::Awake { rest_time } if rest_time > 0.0 && rest_time >= time)
    }

    /// True if a particle is at least `distance` (m) from its position at the start of its time at rest.
    pub(crate) fn strays(&self, distance: f32) -> bool {
        !all_within(&self.positions, &self.places, distance)
    }

    /// Bounds of the particles' positions at the start of their time at rest, with the margin for touching shapes.
    pub(crate) fn left(&self) -> Aabb {
        self.bounds_of(&self.places).expand(STRIKE_GAP)
    }

    /// True if a particle that has moved by `distance` metres since its time at rest started was then on top of a
    /// resting body's shape; `down` is a unit vector.
    pub(crate) fn bore(&self, shape: &Shape, at: &Transform, distance: f32, down: Vec3) -> bool {
        let bounds = shape.aabb(at);
        (0..self.positions.len()).any(|i| {
            let (place, reach) = (self.places[i], self.radii[i] + STRIKE_GAP);
            if is_within(self.positions[i], place, distance) || distance_at_least(&bounds, place) > reach {
                return false;
            }
            let (away, outward) = shape.signed_distance(at, place);
            away <= reach && outward.dot(down) > BEARING
        })
    }

    /// Restarts the time at rest of each particle that has moved by at least `distance` metres.
    pub(crate) fn settle(&mut self, distance: f32) {
        for (position, place) in self.positions.iter().zip(&mut self.places) {
            if !is_within(*position, *place, distance) {
                *place = *position;
            }
        }
    }

    /// True if a shape is within `reach` metres of a free particle.
    pub(crate) fn is_near(&self, shape: &Shape, at: &Transform, reach: f32) -> bool {
        let bounds = shape.aabb(at);
        (0..self.positions.len()).any(|i| {
            let (position, radius) = (self.positions[i], self.radii[i]);
            self.attachment_of[i] == u32::MAX
                && distance_at_least(&bounds, position) - radius <= reach
                && shape.signed_distance(at, position).0 - radius <= reach
        })
    }

    pub(super) fn save_rest(&self, out: &mut Writer) {
        out.u8(u8::from(self.sleeping == Sleeping::Off));
        match self.rest {
            GroupRest::Awake { rest_time } => {
                out.u8(0);
                out.f32(rest_time);
            }
            GroupRest::Asleep { island } => {
                out.u8(1);
                out.u32(island);
            }
            GroupRest::Roused { island } => {
                out.u8(2);
                out.u32(island);
            }
        }
        // While the group sleeps, each particle is at its rest position.
        if !matches!(self.rest, GroupRest::Asleep { .. }) {
            self.places.iter().for_each(|&place| out.vec3(place));
        }
    }

    pub(super) fn load_rest(&mut self, input: &mut Reader<'_>) -> Result<(), ReadError> {
        self.sleeping = match input.u8()? {
            0 => Sleeping::On,
            1 => Sleeping::Off,
            _ => return Err(input.error("a group may sleep or not")),
        };
        self.rest = match input.u8()? {
            0 => {
                let rest_time = input.f32()?;
                if !rest_time.is_finite() {
                    return Err(input.error("a time of rest is not finite"));
                }
                GroupRest::Awake { rest_time }
            }
            1 => GroupRest::Asleep { island: input.u32()? },
            2 => GroupRest::Roused { island: input.u32()? },
            _ => return Err(input.error("a group is neither awake nor asleep")),
        };
        if !matches!(self.rest, GroupRest::Asleep { .. }) {
            for place in &mut self.places {
                *place = input.vec3()?;
            }
            if !self.places.iter().all(|place| place.is_finite()) {
                return Err(input.error("a place of rest is not finite"));
            }
        }
        Ok(())
    }
}

/// True if each point is nearer than `distance` to the other point with the same index.
fn all_within(points: &[Vec3], others: &[Vec3], distance: f32) -> bool {
    points.iter().zip(others).all(|(&point, &other)| is_within(point, other, distance))
}

fn is_within(point: Vec3, other: Vec3, distance: f32) -> bool {
    (point - other).length_squared() < distance * distance
}
