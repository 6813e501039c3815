//! Fall quality: the contract's metrics, computed from queries to the world only.
//!
//! ```
//! # let rig = sinew::mannequin::mannequin().rig;
//! # let analysis = sinew_anim::analyze(&rig)?;
//! # let (def, _) = sinew_ragdoll::build(&rig, &analysis, &sinew_ragdoll::BuildOptions::default())?;
//! use sinew_ragdoll::{Verdict, drop_test};
//!
//! let report = drop_test(&def);
//! println!("joints gape by {:.1e} m at most", report.drop.joint_gap_max_m);
//! assert_eq!(report.verdict, Verdict::Good, "{:?}", report.reasons);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod balance;
mod drop_test;
mod faults;
mod gate;
mod meter;
mod plausible;
mod rising;
mod verdict;

pub use drop_test::{DropReport, Fallen, drop_test};
pub use faults::{Fault, fallen_out, faults_of_bake, faults_of_ragdoll, toppled};
pub use gate::{Bar, GateReport, Miss, gate, gate_on, random_fall, random_ground, random_pose};
pub use meter::QualityMeter;
pub use plausible::Doubt;
pub use rising::{RisingQuality, measure_rising};
pub use verdict::{Verdict, judge, judge_bake};

/// Metrics of a character's falls. Times are seconds of world time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FallQuality {
    /// Largest rise of kinetic and potential energy of all dynamic bodies within one step, minus the work of motors,
    /// pins and kinematic bodies in this step. It is a share of the kinetic energy before the step, or of 1 J per kg of
    /// the character if that is more. Pushes between steps do not count.
    pub energy_gain_max: f32,
    /// Work of the pushes, of motors, pins and kinematic bodies, J.
    pub work_in_j: f32,
    /// Largest distance between the two anchors of a joint, metres.
    pub joint_gap_max_m: f32,
    /// 99th percentile of this distance over joints and steps, metres.
    pub joint_gap_p99_m: f32,
    /// Largest angle beyond a joint limit, degrees.
    pub limit_overshoot_max_deg: f32,
    /// 99th percentile of this angle over joints and steps, degrees.
    pub limit_overshoot_p99_deg: f32,
    /// Deepest overlap with a static body while limp, metres.
    pub penetration_max_m: f32,
    /// Deepest overlap with a static body once settled, until the next fall, metres.
    pub penetration_rest_max_m: f32,
    /// Deepest overlap of two bodies of the character that are meant to collide and that no joint connects, metres.
    pub nonadjacent_overlap_max_m: f32,
    /// Time of the first contact with the world after the character went limp.
    pub first_contact_s: Option<f32>,
    /// Start of the first half second in which every body is below 0.05 rad/s and 2 cm/s.
    pub settled_s: Option<f32>,
    /// Time when the character was first animated again.
    pub up_s: Option<f32>,
    /// Fastest spin of a body once settled, until the next fall, rad/s.
    pub settled_omega_max: Option<f32>,
    /// Time when all bodies first slept.
    pub asleep_s: Option<f32>,
    /// Time from the first step in which every body was below 0.3 m/s until the bodies sleep, seconds.
    pub calm_to_asleep_s: Option<f32>,
    /// Number of bodies with a non-finite state, summed over the steps.
    pub nan: u32,
}
