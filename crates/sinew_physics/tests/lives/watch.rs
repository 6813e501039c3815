//! Checks one world after each step, for conditions that hold for any calls.

use crate::actor::Actor;
use crate::life::{Ground, Life};
use crate::numbers::Temper;
use sinew_math::Vec3;
use sinew_physics::*;
use std::collections::{BTreeMap, BTreeSet};

/// Fault that a check found.
#[derive(Clone, Debug, PartialEq)]
pub enum Fault {
    Panic(String),
    NotFinite(String),
    /// A contact or overlap that begins twice or ends without a begin.
    Event(String),
    /// Bodies that are reported as touching but are far apart, or touches that never end.
    Touch(String),
    Below(String),
    /// A limb that moves away from its character, or an open joint.
    #[allow(dead_code, reason = "worlds without characters have none")]
    Limb(String),
    /// A rise of energy, as a share of the allowed rise.
    Energy(f32, String),
    /// A difference between worlds that must be equal.
    Differs(String),
}

impl Fault {
    /// Returns whether the other fault is of the same kind. A panic must have the same words, and a rise of energy must
    /// be at least half as large.
    pub fn is_like(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Panic(p), Self::Panic(q)) => words(p) == words(q),
            (Self::Energy(p, _), Self::Energy(q, _)) => *p >= 0.5 * q,
            _ => core::mem::discriminant(self) == core::mem::discriminant(other),
        }
    }
}

fn words(text: &str) -> String {
    text.chars().filter(|c| c.is_alphabetic()).take(60).collect()
}

type BodyPair = (BodyId, BodyId);
type ShapePair = (ShapeId, ShapeId);

#[derive(Default)]
pub struct Watch {
    touching: BTreeSet<BodyPair>,
    shapes: BTreeSet<ShapePair>,
    sensed: BTreeSet<BodyPair>,
    sensed_shapes: BTreeSet<ShapePair>,
    /// Number of steps for which a touching pair has been far apart.
    apart: BTreeMap<BodyPair, u32>,
    /// Number of steps for which a body has been below the floor without rising, and its height.
    below: BTreeMap<BodyId, (u32, f32)>,
    /// Number of steps since the last deed that changed the world.
    quiet: u32,
    energy: Option<(Energy, f32)>,
    /// Largest rise of energy, as a share of the allowed rise.
    pub rise: f32,
}

/// Returns the difference between the quantity that symplectic Euler conserves in free fall, `E + ½ h m g·v`, and the
/// energy `E`, J. Because of it a bounce raises `E`.
fn integrator_lag(world: &World) -> f32 {
    let def = world.def();
    let h = def.dt() / def.substeps as f32;
    let lag = |id| world.mass(id).mass * world.gravity_scale(id) * def.gravity.dot(world.velocity(id).linear);
    0.5 * h * world.body_ids().map(lag).sum::<f32>()
}

/// Number of steps after a deed in which energy is not checked.
const SETTLED: u32 = 30;
/// Allowed rise of energy in a step, as a share of the larger of the kinetic energy and 1 J/kg; and, for rounding, as a
/// share of the potential energy.
const RISE: f32 = 0.01;
const ROUNDING: f32 = 1e-5;
/// Allowed rise while bodies are pressed into each other, as a share of the larger of the kinetic energy and 1 J/kg.
const STRAINED: f32 = 2.0;
/// Overlap (metres), gap (metres) and overshoot (radians) above which `STRAINED` applies instead of `RISE`.
const OVERLAP: f32 = 5e-3;
const GAP: f32 = 1e-3;
const OVERSHOOT: f32 = 0.02;
/// Gap above which bodies surely do not touch, metres; and number of steps within which the end must be reported.
const FAR: f32 = 0.05;
const LATE: u32 = 3;
/// Depth of a whole body below the floor that is a fault, metres; and number of steps for which it is allowed.
const DEPTH: f32 = 0.05;
const PRESSED: u32 = 60;
/// Rise per step of a body that leaves the floor, metres.
const RISES: f32 = 1e-3;

fn fault<T>(fault: impl Fn(String) -> Fault, text: String) -> Result<T, Fault> {
    Err(fault(text))
}

fn noted<T: Ord + Copy + core::fmt::Debug>(
    open: &mut BTreeSet<T>,
    begin: &[T],
    end: &[T],
    what: &str,
) -> Result<(), Fault> {
    for pair in end {
        if !open.remove(pair) {
            return fault(Fault::Event, format!("{what} of {pair:?} ends without a begin"));
        }
    }
    for &pair in begin {
        if !open.insert(pair) {
            return fault(Fault::Event, format!("{what} of {pair:?} begins twice"));
        }
    }
    Ok(())
}

impl Watch {
    /// Records that a deed has changed the world.
    pub fn disturb(&mut self) {
        self.quiet = 0;
    }

    /// Checks the world after a step.
    ///
    /// # Errors
    /// If a check fails.
    pub fn look(
        &mut self,
        life: &Life,
        actor: &mut Actor,
        seen: impl Fn(Velocity) -> Velocity,
    ) -> Result<(), Fault> {
        self.quiet += 1;
        finite(&actor.world, seen)?;
        self.events(actor.world.events())?;
        self.stale(actor)?;
        actor.more.look(&actor.world, life.temper, self.quiet)?;
        if life.temper == Temper::Calm {
            self.floor(life, actor)?;
            self.energy(actor)?;
        }
        Ok(())
    }

    /// Checks and records the events of a step.
    pub fn events(&mut self, events: &Events) -> Result<(), Fault> {
        noted(&mut self.touching, &events.begin, &events.end, "touch")?;
        noted(&mut self.shapes, &events.shapes_begin, &events.shapes_end, "touch of shapes")?;
        noted(&mut self.sensed, &events.sensor_begin, &events.sensor_end, "sensing")?;
        let (begin, end) = (&events.sensor_shapes_begin, &events.sensor_shapes_end);
        noted(&mut self.sensed_shapes, begin, end, "sensing of shapes")
    }

    /// Checks that touching and sensed pairs are near each other.
    fn stale(&mut self, actor: &Actor) -> Result<(), Fault> {
        let world = &actor.world;
        let dt = world.def().dt();
        let mut apart = BTreeMap::new();
        for &(a, b) in self.touching.iter().chain(&self.sensed) {
            if !(world.contains(a) && world.contains(b)) {
                let late = self.apart.get(&(a, b)).copied().unwrap_or(0) + 1;
                if late > LATE {
                    return fault(
                        Fault::Touch,
                        format!("{a:?} and {b:?} are reported as touching, but one was removed"),
                    );
                }
                apart.insert((a, b), late);
                continue;
            }
            let reach = |id: BodyId| FAR + world.velocity(id).linear.length() * dt * 2.0;
            let (p, q) = (world.bounds(a), world.bounds(b));
            let margin = Vec3::splat(reach(a) + reach(b));
            let near = (p.min - margin).cmple(q.max).all() && (q.min - margin).cmple(p.max).all();
            if !near {
                let late = self.apart.get(&(a, b)).copied().unwrap_or(0) + 1;
                if late > LATE {
                    return fault(
                        Fault::Touch,
                        format!("{a:?} and {b:?} are reported as touching, but are apart: {p:?} {q:?}"),
                    );
                }
                apart.insert((a, b), late);
            }
        }
        self.apart = apart;
        Ok(())
    }

    /// Checks that no body that the floor should carry is below it.
    fn floor(&mut self, life: &Life, actor: &Actor) -> Result<(), Fault> {
        let world = &actor.world;
        let reach = match life.ground {
            Ground::HalfSpace => f32::INFINITY,
            Ground::Box => 45.0,
            _ => return Ok(()),
        };
        let mut below = BTreeMap::new();
        if world.pair_function().is_none() {
            for id in world.body_ids().filter(|&id| is_borne(world, id, actor.floor)) {
                let (center, top) = (world.center_of_mass(id), world.bounds(id).max.y);
                let is_below = top < -DEPTH && center.x.abs() < reach && center.z.abs() < reach;
                if is_below {
                    let (steps, height) = self.below.get(&id).copied().unwrap_or((0, center.y));
                    let steps = if center.y > height + RISES { 0 } else { steps + 1 };
                    if steps > PRESSED {
                        return fault(Fault::Below, format!("{id:?} is below the floor, at {center}"));
                    }
                    below.insert(id, (steps, center.y));
                }
            }
        }
        self.below = below;
        Ok(())
    }

    /// Checks that energy rises by no more than the work done and the allowed error.
    fn energy(&mut self, actor: &Actor) -> Result<(), Fault> {
        let world = &actor.world;
        let (now, lag) = (world.energy(), integrator_lag(world));
        let Some((before, lag_before)) = self.energy.replace((now, lag)) else { return Ok(()) };
        if self.quiet < SETTLED || actor.more.drives() || !is_passive(world) || is_torn(world) {
            return Ok(());
        }
        let mass: f32 = world.body_ids().map(|id| world.mass(id).mass).sum();
        let all: f32 = world.body_ids().map(|id| world.body_energy(id).potential.abs()).sum();
        let work = world.work();
        let rise = now.total() - before.total() - sinew_math::max(work.total(), 0.0);
        let rise = sinew_math::min(rise, rise + lag - lag_before);
        let share = if is_strained(world) { STRAINED } else { RISE };
        let allowed =
            share * sinew_math::max(before.kinetic, mass) + ROUNDING * (all + before.potential.abs());
        self.rise = sinew_math::max(self.rise, rise / allowed);
        if rise > allowed {
            let text = format!(
                "the energy rose by {rise} J, allowed {allowed} J: before {before:?}, now {now:?}, work {work:?}"
            );
            return Err(Fault::Energy(rise / allowed, text));
        }
        Ok(())
    }

    /// Checks that every contact and overlap that began has ended, after all objects were removed.
    ///
    /// # Errors
    /// If a contact or overlap did not end.
    pub fn end(&self) -> Result<(), Fault> {
        let open = self.touching.len() + self.shapes.len() + self.sensed.len() + self.sensed_shapes.len();
        if open == 0 {
            return Ok(());
        }
        let text =
            format!("{:?} {:?} {:?} {:?}", self.touching, self.shapes, self.sensed, self.sensed_shapes);
        fault(Fault::Touch, format!("all bodies are removed, but some are reported as touching: {text}"))
    }
}

fn finite(world: &World, seen: impl Fn(Velocity) -> Velocity) -> Result<(), Fault> {
    for id in world.body_ids() {
        let (pose, velocity) = (world.transform(id), seen(world.velocity(id)));
        if !(pose.is_finite() && velocity.linear.is_finite() && velocity.angular.is_finite()) {
            return fault(Fault::NotFinite, format!("{id:?}: {pose:?} {velocity:?}"));
        }
    }
    for id in world.group_ids() {
        let group = world.particles(id);
        if !group.positions().iter().chain(group.velocities()).all(|v| v.is_finite()) {
            return fault(Fault::NotFinite, format!("{id:?}"));
        }
    }
    for id in world.mover_ids() {
        if !world.mover(id).position().is_finite() {
            return fault(Fault::NotFinite, format!("{id:?}: {:?}", world.mover(id).position()));
        }
    }
    Ok(())
}

/// Returns whether nothing prevents a body from resting on the floor.
fn is_borne(world: &World, id: BodyId, floor: BodyId) -> bool {
    let plain = |shape: ShapeId| {
        world.sensing(shape) == Sensing::Solid
            && world.filter(shape) == Filter::default()
            && world.contact_rule(shape) == ContactRule::Push
    };
    let pressed = |other: BodyId| world.kind(other) == BodyKind::Kinematic;
    id != floor
        && world.kind(id) == BodyKind::Dynamic
        && world.shape_ids(id).count() > 0
        && world.shape_ids(id).all(plain)
        && world.joints_of(id).next().is_none()
        && !world.neighbors(id).any(pressed)
}

/// Returns whether all sources of energy in the world are counted by the check.
fn is_passive(world: &World) -> bool {
    let is_still = |id: BodyId| {
        let runs = |shape: ShapeId| {
            let material = world.material(shape);
            material.surface_velocity != Vec3::ZERO || material.surface_spin != Vec3::ZERO
        };
        world.forces_of(id).next().is_none() && !world.shape_ids(id).any(runs)
    };
    let is_plain = |id: JointId| {
        let def = world.joint(id);
        def.state == JointState::Disabled
            || def.spring.is_none()
                && def.weld.is_none()
                && def.limit_softness.is_none()
                && def.soft_zone.is_none()
    };
    world.field_ids().next().is_none()
        && world.group_ids().next().is_none()
        && world.object_ids().next().is_none()
        && world.body_ids().all(is_still)
        && world.joint_ids().all(is_plain)
}

/// Returns whether shapes overlap deeply: contacts that separate them lift weights, which adds energy.
fn is_strained(world: &World) -> bool {
    world.contacts().any(|contact| contact.points().iter().any(|point| point.separation < -OVERLAP))
}

/// Returns whether joints are open. A joint cannot close if it connects bodies that cannot move.
fn is_torn(world: &World) -> bool {
    let enabled = |id: &JointId| world.joint(*id).state == JointState::Enabled;
    let open = |id: JointId| world.joint_gap(id) > GAP || world.joint_overshoot(id) > OVERSHOOT;
    world.joint_ids().filter(enabled).any(open)
}
