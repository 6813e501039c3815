//! Drives of a ragdoll, which move its bodies in addition to gravity and contacts. Each body has one of four modes:
//! limp, muscle, pin to a world pose, or keyed by the animation. Modes blend over time, and strengths are limited to
//! human ones.
//!
//! | mode | acting | effect |
//! |---|---|---|
//! | limp | friction of the joint | falls |
//! | powered | a motor in the joint, toward the pose and at its speed, limited by the muscles' torque | holds a pose, not a position |
//! | pinned | the same, and a spring from the world to the body | holds a position; the force is reported |
//! | keyed | nothing: the body follows the animation | pushes obstacles, carries attached bodies |
//!
//! Changes are exponential with a half-life, so they do not depend on the step length: `x += (goal − x)(1 − 2^(−dt/T))`
//! for each number of a spring (stiffness, damping, cap).
//!
//! ```
//! # let rig = sinew::mannequin::mannequin().rig;
//! # let analysis = sinew_anim::analyze(&rig)?;
//! # let (def, _) = sinew_ragdoll::build(&rig, &analysis, &sinew_ragdoll::BuildOptions::default())?;
//! use sinew_physics::{Velocity, World, WorldDef};
//! use sinew_ragdoll::{BodyState, DriveMode, Drives, BodySettings, Muscle, Pin, Ragdoll};
//!
//! let mut world = World::new(WorldDef::default());
//! let pose: Vec<_> = def.bodies.iter().map(|body| body.character_from_body).collect();
//! let still = Velocity::default();
//! let start: Vec<_> =
//!     pose.iter().map(|&world_from_body| BodyState { world_from_body, velocity: still }).collect();
//! let ragdoll = Ragdoll::spawn(&mut world, &def, &start, &BodySettings::default());
//! let mut drives = Drives::new(&def);
//! drives.set_all(DriveMode::Powered(Muscle::STIFF), 0.0);
//! drives.set(0, DriveMode::Pinned(Muscle::STIFF, Pin::FIRM), 0.0); // it hangs by its pelvis
//! for _ in 0..60 {
//!     drives.apply(&mut world, &def, &ragdoll, &pose, &vec![still; pose.len()]);
//!     world.step();
//! }
//! let sunk = pose[0].translation - world.transform(ragdoll.bodies[0]).translation;
//! assert!(sunk.length() < 0.1, "{sunk}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod apply;
mod level;
mod save;
mod target;
mod torque;

use crate::def::RagdollDef;
use crate::tuning::{NO_STRENGTH, NUMBING_SPEED, WEAKNESS_FALLOFF};
use level::Level;
use sinew_math::{clamp, max};
use sinew_physics::{BodyId, JointId};
pub use torque::torque_caps;

/// A joint motor that acts as a muscle: it drives the joint toward the pose's rotation and angular velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Muscle {
    /// Natural frequency of the muscle with all bodies that the joint carries, Hz, at least 0.
    pub hertz: f32,
    /// Damping ratio; 1 is critical.
    pub damping_ratio: f32,
    /// Share of the largest torque of the joint ([`torque_caps`]) that the muscle may use, 0..=1.
    pub strength: f32,
}

impl Muscle {
    /// Follows with a lag and yields: 2 Hz, critically damped.
    pub const RELAXED: Self = Self { hertz: 2.0, damping_ratio: 1.0, strength: 1.0 };
    /// Follows like a person who expects no hit: 5 Hz, critically damped. Default.
    pub const ALIVE: Self = Self { hertz: 5.0, damping_ratio: 1.0, strength: 1.0 };
    /// Hardly yields: 20 Hz, overdamped.
    pub const STIFF: Self = Self { hertz: 20.0, damping_ratio: 2.0, strength: 1.0 };
}

impl Default for Muscle {
    fn default() -> Self {
        Self::ALIVE
    }
}

/// Springs from the world to a body: one to its position (at the centre of mass) and one to its rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pin {
    /// Natural frequency with all bodies that are nearer to this pin than to other pins, Hz, at least 0.
    pub hertz: f32,
    /// Damping ratio; 1 is critical.
    pub damping_ratio: f32,
    /// Largest force along each axis, N, finite.
    pub max_force: f32,
    /// Largest torque about each axis, N·m, finite.
    pub max_torque: f32,
}

impl Pin {
    /// Keeps a body near its target: 3 Hz, at most 400 N and 100 N·m.
    pub const SOFT: Self = Self { hertz: 3.0, damping_ratio: 1.0, max_force: 400.0, max_torque: 100.0 };
    /// Holds a body at its target: 20 Hz, 10 kN and 2 kN·m.
    pub const FIRM: Self = Self { hertz: 20.0, damping_ratio: 1.0, max_force: 1e4, max_torque: 2e3 };
}

/// Mode of a drive, which determines what moves a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum DriveMode {
    /// Only the friction of the joint acts. Default.
    #[default]
    Limp,
    /// A muscle drives the joint to the parent. The first body has no such joint, and is limp.
    Powered(Muscle),
    /// A muscle drives the joint, and a pin pulls the body.
    Pinned(Muscle, Pin),
    /// The body follows the animation exactly, regardless of obstacles.
    Keyed,
}

/// Drive of a body, with the state of its blend to the mode.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Drive {
    mode: DriveMode,
    /// Half-life of the blend, seconds.
    half_life: f32,
    /// Time since the mode was set, seconds.
    since: f32,
    level: Level,
    /// Share of the muscle's strength lost to a hit, 0..=1.
    weakness: f32,
    /// True if the body is kinematic.
    keyed: bool,
    /// Joint of the body's pin.
    pin: Option<JointId>,
}

/// The drives of one ragdoll. They are plain data: [`apply`](Self::apply) writes motors and pins into a world,
/// [`release`](Self::release) removes them.
#[derive(Clone, Debug, PartialEq)]
pub struct Drives {
    /// Drive of each body.
    drives: Vec<Drive>,
    /// Largest torque of the joint to the parent of each body, N·m.
    torques: Vec<f32>,
    /// Static body that pins attach to.
    ground: Option<BodyId>,
    /// Seconds in which the weakness after a hit falls to `1/e`. Default 0.45.
    pub recovery: f32,
}

impl Drives {
    /// Creates drives for limp bodies, with the torques of [`torque_caps`].
    pub fn new(def: &RagdollDef) -> Self {
        Self::with_torques(def, torque_caps(def))
    }

    /// Creates drives for limp bodies. `torques`: largest muscle torque of the joint between each body and its parent,
    /// N·m; the first body's entry is ignored.
    ///
    /// # Panics
    /// If the number of entries is not the number of bodies, or one is negative or not finite.
    pub fn with_torques(def: &RagdollDef, torques: Vec<f32>) -> Self {
        assert_eq!(torques.len(), def.bodies.len(), "each body has a torque");
        assert!(
            torques.iter().all(|t| (0.0..f32::INFINITY).contains(t)),
            "torques must be finite and at least 0: {torques:?}"
        );
        Self { drives: vec![Drive::default(); def.bodies.len()], torques, ground: None, recovery: 0.45 }
    }

    /// Returns the drive mode of a body.
    pub fn mode(&self, body: usize) -> DriveMode {
        self.drives[body].mode
    }

    /// Returns the share of its strength that a body's muscle has, 0..=1: less than 1 after a hit.
    pub fn vigour(&self, body: usize) -> f32 {
        1.0 - self.drives[body].weakness
    }

    /// Changes the mode of a body: half of the change happens within `half_life` seconds, all of it immediately if that
    /// is 0. A body that changes to keyed is pinned with increasing strength.
    ///
    /// # Panics
    /// If the body does not exist, or a number is negative or not finite, or a strength exceeds 1.
    pub fn set(&mut self, body: usize, mode: DriveMode, half_life: f32) {
        let sound = |x: f32| (0.0..f32::INFINITY).contains(&x);
        assert!(
            sound(half_life),
            "the half-life must be finite and at least 0, not {half_life} s (body {body})"
        );
        let (muscle, pin) = match mode {
            DriveMode::Limp | DriveMode::Keyed => (None, None),
            DriveMode::Powered(muscle) => (Some(muscle), None),
            DriveMode::Pinned(muscle, pin) => (Some(muscle), Some(pin)),
        };
        assert!(
            muscle.is_none_or(|m| sound(m.hertz)
                && sound(m.damping_ratio)
                && (0.0..=1.0).contains(&m.strength)),
            "the numbers of a muscle must be finite and at least 0: {mode:?} (body {body})"
        );
        assert!(
            pin.is_none_or(|p| [p.hertz, p.damping_ratio, p.max_force, p.max_torque].into_iter().all(sound)),
            "the numbers of a pin must be finite and at least 0: {mode:?} (body {body})"
        );
        let drive = &mut self.drives[body];
        if drive.mode != mode {
            (drive.mode, drive.since) = (mode, 0.0);
        }
        drive.half_life = half_life;
        if half_life == 0.0 {
            // Change immediately, because the drive of limp bodies does not advance.
            drive.level = Level::of(mode);
        }
    }

    /// Like [`set`](Self::set), for all bodies.
    pub fn set_all(&mut self, mode: DriveMode, half_life: f32) {
        for body in 0..self.drives.len() {
            self.set(body, mode, half_life);
        }
    }

    /// Like [`set`](Self::set), for a body and all its descendants: an arm, or all bodies above the waist.
    pub fn set_from(&mut self, def: &RagdollDef, body: usize, mode: DriveMode, half_life: f32) {
        for other in (body..self.drives.len()).filter(|&other| hangs_on(def, other, body)) {
            self.set(other, mode, half_life);
        }
    }

    /// Returns true if the joint is one of the drives' pins.
    pub(crate) fn is_pin(&self, joint: JointId) -> bool {
        self.drives.iter().any(|drive| drive.pin == Some(joint))
    }

    /// Limits the weakness of a body to `weakness`, a share of its strength.
    pub(crate) fn steady(&mut self, body: usize, weakness: f32) {
        let drive = &mut self.drives[body];
        drive.weakness = sinew_math::min(drive.weakness, weakness);
    }

    /// Weakens muscles and pins at the body that an impulse of `impulse` N·s hit, half as much one joint away, and so
    /// on. An impulse that would move the whole ragdoll at 0.2 m/s removes all strength at that body. The caller
    /// applies the impulse itself.
    pub fn hit(&mut self, def: &RagdollDef, body: usize, impulse: f32) {
        let mass: f32 = def.bodies.iter().map(|body| body.mass.mass).sum();
        let weakness = clamp(impulse.abs() / (NUMBING_SPEED * mass), 0.0, 1.0);
        for (other, drive) in self.drives.iter_mut().enumerate() {
            let mut here = weakness;
            for _ in 0..joints_between(def, body, other) {
                here *= WEAKNESS_FALLOFF;
            }
            if here > NO_STRENGTH {
                drive.weakness = max(drive.weakness, here);
            }
        }
    }
}

/// Returns the parent of a body; `None` for the first.
fn parent(def: &RagdollDef, body: usize) -> Option<usize> {
    body.checked_sub(1).map(|joint| def.joints[joint].parent)
}

/// Returns true if a body is `ancestor` or a descendant of it.
pub(crate) fn hangs_on(def: &RagdollDef, body: usize, ancestor: usize) -> bool {
    core::iter::successors(Some(body), |&at| parent(def, at)).any(|at| at == ancestor)
}

/// Returns the number of joints on the path from one body to another.
fn joints_between(def: &RagdollDef, mut a: usize, mut b: usize) -> usize {
    let mut count = 0;
    // Parents precede their children, so the later of two bodies cannot be the ancestor.
    while a != b {
        let later = if a > b { &mut a } else { &mut b };
        *later = parent(def, *later).expect("only the first body has no parent");
        count += 1;
    }
    count
}
