//! Rest of a particle group: its time at rest, and the island it sleeps in.

use super::{AttachmentTarget, ParticleGroup};
use crate::body::def::{SleepThresholds, Sleeping};
use crate::body::shape::Shape;
use crate::boxes::Aabb;
use crate::id::BodyId;
use crate::particles::contact::distance_at_least;
use crate::particles::tuning::{BEARING, BED_ROOM, RESTING_SPEED, STRIKE_GAP};
use sinew_math::{ReadError, Reader, Transform, Vec3, Writer};

/// Awake, asleep with the island it fell asleep with, or woken since.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum GroupRest {
    /// Seconds for which each particle has stayed in place.
    Awake { rest_time: f32 },
    /// Bodies that sleep under the same number wake with it.
    Asleep { island: u32 },
    /// Woken since the last step: bodies that sleep under that number wake in the next one.
    Roused { island: u32 },
}

impl Default for GroupRest {
    fn default() -> Self {
        Self::Awake { rest_time: 0.0 }
    }
}

/// A sleeping group's surroundings, which follow from the world.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bed {
    /// A body that fell asleep with it, if any did.
    pub partner: Option<u32>,
    /// Bounds of all particles with their radii and a margin.
    pub bounds: Aabb,
}

impl ParticleGroup {
    /// False while it sleeps.
    pub fn is_awake(&self) -> bool {
        !matches!(self.rest, GroupRest::Asleep { .. })
    }

    /// Permission to fall asleep.
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

    /// Wakes the group, and in the next step the bodies it fell asleep with. For an awake group it restarts the time at
    /// rest.
    pub fn wake(&mut self) {
        self.rest = match self.rest {
            GroupRest::Awake { .. } => GroupRest::default(),
            GroupRest::Asleep { island } | GroupRest::Roused { island } => GroupRest::Roused { island },
        };
    }

    /// Number of the island that it sleeps with, or slept with until it was woken since the last step.
    pub(crate) fn slept_with(&self) -> Option<u32> {
        match self.rest {
            GroupRest::Awake { .. } => None,
            GroupRest::Asleep { island } | GroupRest::Roused { island } => Some(island),
        }
    }

    /// A body that fell asleep with it.
    pub(crate) fn partner(&self) -> Option<u32> {
        self.bed.and_then(|bed| bed.partner)
    }

    /// Surroundings that it sleeps in.
    pub(crate) fn bed(&self) -> Option<&Bed> {
        self.bed.as_ref().filter(|_| !self.is_awake())
    }

    /// Wakes it, when those it slept with are awake.
    pub(crate) fn get_up(&mut self) {
        self.rest = GroupRest::default();
        self.bed = None;
    }

    /// True if it holds bodies, which then rest only when it does.
    pub(crate) fn holds_bodies(&self) -> bool {
        self.attachments.iter().any(|a| matches!(a.target, AttachmentTarget::Body { .. }))
    }

    /// Bodies that hold its particles or carry its backstops, once for each.
    pub(crate) fn carriers(&self) -> impl Iterator<Item = BodyId> {
        let held = self.attachments.iter().filter_map(|a| match a.target {
            AttachmentTarget::Body { body, .. } => Some(body),
            AttachmentTarget::World(_) => None,
        });
        held.chain(self.backstops.iter().map(|backstop| backstop.body))
    }

    /// Puts the group to sleep under an unused island number.
    pub(crate) fn fall_asleep(&mut self, island: u32, partner: Option<u32>) {
        self.rest = GroupRest::Asleep { island };
        self.velocities.fill(Vec3::ZERO);
        self.places.copy_from_slice(&self.positions);
        self.begin_step();
        self.lie_down(partner);
    }

    /// Records its island (or former island), and a body that fell asleep with it.
    pub(crate) fn lie_down(&mut self, partner: Option<u32>) {
        self.bed = Some(Bed { partner, bounds: self.bounds_of(&self.places).expand(BED_ROOM) });
    }

    /// Counts the time for which it has been calm, seconds; if it is not, less than any time.
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

    /// True if it has been calm for `time` seconds.
    pub(crate) fn has_rested(&self, time: f32) -> bool {
        matches!(self.rest, GroupRest::Awake { rest_time } if rest_time > 0.0 && rest_time >= time)
    }

    /// True if a particle is `distance` metres from where its time at rest started.
    pub(crate) fn strays(&self, distance: f32) -> bool {
        !all_within(&self.positions, &self.places, distance)
    }

    /// Bounds of everything that touched the particles where their time at rest started.
    pub(crate) fn left(&self) -> Aabb {
        self.bounds_of(&self.places).expand(STRIKE_GAP)
    }

    /// True if a particle that has strayed by `distance` metres touched a shape at rest from below before; `down` is a unit vector.
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

    /// Restarts the time at rest of each particle that has moved by `distance` metres.
    pub(crate) fn settle(&mut self, distance: f32) {
        for (position, place) in self.positions.iter().zip(&mut self.places) {
            if !is_within(*position, *place, distance) {
                *place = *position;
            }
        }
    }

    /// True if a shape comes within `reach` metres of a free particle.
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
        // Asleep, each particle is in place.
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

/// True if each point is nearer than `distance` to the one with the same index.
fn all_within(points: &[Vec3], others: &[Vec3], distance: f32) -> bool {
    points.iter().zip(others).all(|(&point, &other)| is_within(point, other, distance))
}

fn is_within(point: Vec3, other: Vec3, distance: f32) -> bool {
    (point - other).length_squared() < distance * distance
}
