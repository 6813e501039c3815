//! Runs a plan and checks the world.

use super::energy::{Energies, energies};
use super::plan::{Change, Frames, JointPlan, WorldPlan};
use crate::build::floor;
use sinew_math::{Reader, Writer};
use sinew_physics::*;

/// Largest rise of energy within a step, as a share of max(kinetic energy, 1 J/kg).
const ENERGY_GAIN: f64 = 0.01;
/// Allowed rise of energy from rounding of poses, as a share of the springs' energy.
const ROUNDING: f64 = 1e-5;
/// Largest number of steps without an energy check after a change that leaves joints open or beyond their stops. The
/// check resumes earlier if all joints have closed.
const SETTLING: u32 = 60;
/// Gap (metres) and overshoot (radians) below which a joint is closed.
const GAP_CLOSED: f32 = 1e-3;
const STOP_REACHED: f32 = 0.02;
/// Largest distance of bodies between which joints are created, metres. Joints of more distant bodies would have lever
/// arms of a hundred times the bodies' size.
const REACH: f32 = 10.0;
/// Number of steps after a save after which the world is compared with its restored copy.
const TWIN_STEPS: u32 = 60;
/// Linear speed (m/s) and angular speed (rad/s) of a body above which joint gaps are not checked.
const VIOLENT_LINEAR: f32 = 15.0;
const VIOLENT_ANGULAR: f32 = 30.0;

#[derive(Clone, Debug, PartialEq)]
pub enum Fault {
    NotFinite,
    Quarantined,
    /// Rise of energy in the step, as a share of the current energy.
    EnergyGain(f64),
    Restore,
    Panic(String),
}

impl Fault {
    pub fn same_kind(&self, other: &Self) -> bool {
        core::mem::discriminant(self) == core::mem::discriminant(other)
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// Step of the fault; 0 for a panic.
    pub step: u32,
    pub fault: Fault,
}

/// Measurements of a run without a fault.
#[derive(Clone, Copy, Debug, Default)]
pub struct Figures {
    /// Largest gap of an exact joint in steps without loops of joints and without fast bodies, metres.
    pub gap: f32,
    /// Largest rise of energy, like that of [`Fault::EnergyGain`].
    pub gain: f64,
    /// Number of steps whose energy was checked.
    pub watched: u32,
}

#[derive(Clone)]
struct Ids {
    bodies: Vec<Option<BodyId>>,
    joints: Vec<Option<JointId>>,
}

struct Run<'a> {
    plan: &'a WorldPlan,
    world: World,
    ids: Ids,
}

impl<'a> Run<'a> {
    fn new(plan: &'a WorldPlan) -> Self {
        let def = WorldDef { gravity: plan.gravity, sleeping: plan.sleeping, ..WorldDef::default() };
        let mut world = World::new(def);
        if plan.floor {
            floor(&mut world);
        }
        let bodies: Vec<_> = plan.bodies.iter().map(|body| world.add_body(&body.def())).collect();
        if plan.parted {
            for (i, &a) in bodies.iter().enumerate() {
                for &b in bodies[..i].iter().filter(|&&b| world.overlap(a, b) > 0.0).collect::<Vec<_>>() {
                    world.disable_pair(a, b);
                }
            }
            for joint in &plan.joints {
                world.disable_pair(bodies[joint.a], bodies[joint.b]);
            }
        }
        let bodies = bodies.into_iter().map(Some).collect();
        let ids = Ids { bodies, joints: vec![None; plan.joints.len()] };
        Self { plan, world, ids }
    }

    fn saved(&self) -> (Vec<u8>, Ids) {
        let mut w = Writer::new();
        self.world.save(&mut w);
        (w.into_bytes(), self.ids.clone())
    }

    /// Loads a saved run into a new world, so that the run continues from saved state only.
    fn restored(plan: &'a WorldPlan, (bytes, ids): (Vec<u8>, Ids)) -> Self {
        let mut world = World::new(WorldDef::default());
        world.load(&mut Reader::new(&bytes)).expect("the snapshot must load");
        Self { plan, world, ids }
    }

    fn body(&self, body: usize) -> Option<BodyId> {
        self.ids.bodies[body].filter(|&id| self.world.contains(id))
    }

    fn joint(&self, joint: usize) -> Option<JointId> {
        self.ids.joints[joint].filter(|&id| self.world.contains_joint(id))
    }

    /// Applies the plan's changes of a step; returns true if there was one.
    fn change(&mut self, step: u32) -> bool {
        let plan = self.plan;
        let mut changed = false;
        for (j, joint) in plan.joints.iter().enumerate().filter(|(_, joint)| joint.born == step) {
            let (Some(a), Some(b)) = (self.body(joint.a), self.body(joint.b)) else { continue };
            if self.distance(a, b) > REACH {
                continue;
            }
            let def = joint.def(&self.world, a, b);
            self.ids.joints[j] = Some(self.world.add_joint(&def));
            changed = true;
        }
        for (_, change) in plan.changes.iter().filter(|(at, _)| *at == step) {
            changed |= self.apply(change).is_some();
        }
        changed
    }

    /// Applies a change; returns `None` if its object no longer exists.
    fn apply(&mut self, change: &Change) -> Option<()> {
        match change {
            Change::RemoveJoint(j) => self.world.remove_joint(self.joint(*j)?),
            Change::SetState(j, state) => self.world.set_joint_state(self.joint(*j)?, *state),
            Change::SetMotor(j, motor) => self.world.set_motor(self.joint(*j)?, *motor),
            Change::Redefine(j, joint, frames) => self.redefine(self.joint(*j)?, joint, *frames),
            Change::RemoveBody(b) => self.world.remove_body(self.body(*b)?),
            Change::Kick(b, kick) => {
                let body = self.body(*b).filter(|&body| self.world.kind(body) == BodyKind::Dynamic)?;
                let v = self.world.velocity(body);
                let linear = v.linear + kick.linear;
                self.world.set_velocity(body, Velocity { linear, angular: v.angular + kick.angular });
            }
            Change::Reload => {
                let (bytes, _) = self.saved();
                self.world.load(&mut Reader::new(&bytes)).expect("the snapshot must load");
            }
        }
        Some(())
    }

    fn redefine(&mut self, id: JointId, joint: &JointPlan, frames: Frames) {
        let old = self.world.joint(id);
        let mut def = joint.def(&self.world, old.body_a, old.body_b);
        if frames == Frames::Kept || self.distance(old.body_a, old.body_b) > REACH {
            (def.frame_a, def.frame_b) = (old.frame_a, old.frame_b);
        }
        self.world.set_joint(id, &JointDef { state: old.state, ..def });
    }

    fn distance(&self, a: BodyId, b: BodyId) -> f32 {
        (self.world.center_of_mass(a) - self.world.center_of_mass(b)).length()
    }

    fn step(&mut self, step: u32) -> bool {
        let changed = self.change(step);
        self.world.step();
        changed
    }

    fn fault(&self) -> Option<Fault> {
        if !self.world.events().quarantined.is_empty() {
            return Some(Fault::Quarantined);
        }
        let finite = self.world.body_ids().all(|id| {
            let v = self.world.velocity(id);
            self.world.transform(id).is_finite() && v.linear.is_finite() && v.angular.is_finite()
        });
        (!finite).then_some(Fault::NotFinite)
    }

    fn enabled_joints(&self) -> impl Iterator<Item = (JointId, JointDef)> {
        let joints = self.world.joint_ids().map(|id| (id, self.world.joint(id)));
        joints.filter(|(_, def)| def.state == JointState::Enabled)
    }

    /// True if a joint is open or beyond its stops.
    fn is_settling(&self) -> bool {
        self.enabled_joints().any(|(id, _)| {
            self.world.joint_gap(id) > GAP_CLOSED || self.world.joint_overshoot(id) > STOP_REACHED
        })
    }

    fn is_violent(&self) -> bool {
        self.world
            .body_ids()
            .map(|id| self.world.velocity(id))
            .any(|v| v.linear.length() > VIOLENT_LINEAR || v.angular.length() > VIOLENT_ANGULAR)
    }

    /// True if no joint closes a loop; all bodies that are not dynamic count as one ground.
    fn is_forest(&self) -> bool {
        let bodies: Vec<BodyId> = self.world.body_ids().collect();
        let node = |id: BodyId| match self.world.kind(id) {
            BodyKind::Dynamic => bodies.iter().position(|&b| b == id).expect("the body is in the world"),
            _ => bodies.len(),
        };
        let mut tree: Vec<usize> = (0..=bodies.len()).collect();
        for (_, def) in self.enabled_joints() {
            let (a, b) = (tree[node(def.body_a)], tree[node(def.body_b)]);
            if a == b {
                return false;
            }
            tree.iter_mut().filter(|t| **t == a).for_each(|t| *t = b);
        }
        true
    }

    /// Returns the largest gap of exact joints, metres.
    fn gap(&self) -> f32 {
        self.enabled_joints()
            .filter(|(_, def)| def.weld.is_none() && def.limit_softness.is_none())
            .map(|(id, _)| self.world.joint_gap(id))
            .fold(0.0, sinew_math::max)
    }
}

/// Checks the energy from step to step.
#[derive(Default)]
struct Meter {
    before: Energies,
    /// Number of further steps in which the last change may release energy.
    settling: u32,
}

impl Meter {
    /// Returns the rise of energy in the last step as a share of max(kinetic energy, 1 J/kg), or `None` while the last
    /// change may still release energy.
    fn rise(&mut self, run: &Run<'_>, changed: bool) -> Option<f64> {
        let now = energies(&run.world);
        let before = core::mem::replace(&mut self.before, now);
        if changed {
            self.settling = SETTLING;
        } else if self.settling > 0 {
            self.settling = if run.is_settling() { self.settling - 1 } else { 0 };
        }
        let rise = now.total - before.total - ROUNDING * now.elastic;
        (self.settling == 0).then(|| rise / f64::max(before.kinetic, now.mass))
    }
}

/// Runs a plan for some steps.
pub fn check(plan: &WorldPlan, steps: u32) -> Result<Figures, Failure> {
    let run = || watched(plan, steps);
    std::panic::catch_unwind(std::panic::AssertUnwindSafe(run)).unwrap_or_else(|cause| {
        let text = cause.downcast_ref::<String>().cloned();
        let text = text.or_else(|| cause.downcast_ref::<&str>().map(|s| (*s).to_owned()));
        Err(Failure { step: 0, fault: Fault::Panic(text.unwrap_or_default()) })
    })
}

fn watched(plan: &WorldPlan, steps: u32) -> Result<Figures, Failure> {
    let mut run = Run::new(plan);
    let mut figures = Figures::default();
    let mut meter = Meter::default();
    let mut saved = None;
    for step in 0..steps {
        if step == plan.save_at {
            saved = Some(run.saved());
        }
        let changed = run.step(step) || step == 0;
        let fail = |fault| Err(Failure { step, fault });
        if let Some(fault) = run.fault() {
            return fail(fault);
        }
        let rise = meter.rise(&run, changed);
        if let Some(rise) = rise.filter(|_| plan.passive) {
            figures.watched += 1;
            figures.gain = f64::max(figures.gain, rise);
            if rise > ENERGY_GAIN {
                return fail(Fault::EnergyGain(rise));
            }
        }
        if meter.settling == 0 && !run.is_violent() && run.is_forest() {
            figures.gap = sinew_math::max(figures.gap, run.gap());
        }
        if step + 1 == plan.save_at + TWIN_STEPS
            && let Some(saved) = saved.take()
        {
            let mut twin = Run::restored(plan, saved);
            (plan.save_at..=step).for_each(|step| _ = twin.step(step));
            if twin.world.hash() != run.world.hash() {
                return fail(Fault::Restore);
            }
        }
    }
    Ok(figures)
}
