//! Limits learned from the character's clips, within its anatomical limits.
//!
//! The rotations of each joint in all frames give a centre, a swing ellipse and a twist range that contain 99.5 % of
//! the rotations, plus a margin. Beyond the anatomical limits there is no margin: the learned limits exceed them only
//! as far as the clips' frames or the ellipse around these frames do.
//!
//! ```
//! use sinew_ragdoll::build::takes;
//! use sinew_ragdoll::settings::build_moving;
//! use sinew_ragdoll::{BuildOptions, LimitSource, Settings};
//!
//! let mannequin = sinew::mannequin::mannequin();
//! let analysis = sinew_anim::analyze(&mannequin.rig)?;
//! let takes = takes(&mannequin.rig, &mannequin.clips);
//! let options = BuildOptions { limits: LimitSource::Clips, ..BuildOptions::default() };
//! let (_, report) = build_moving(&mannequin.rig, &analysis, &takes, &options, &Settings::default())?;
//! let learned = report.bodies.iter().filter(|body| body.limits == LimitSource::Clips).count();
//! assert!(learned > 4, "{learned} joints have limits from the clips");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use super::{JointPlan, Twist, widened_cone};
use crate::build::bones::Anatomy;
use crate::def::RagdollJointDef;
use crate::fit::Fit;
use crate::tuning::{BEYOND_CLIPS, BIND_MARGIN, LEAST_RANGE, TWIST_MARGIN, WIDEST_SWING};
use sinew_anim::learned_limits::{COVERAGE, LearnedHinge, LearnedLimit, covered, learn_limit};
use sinew_math::limits::{hinge_angle, wrap};
use sinew_math::{Range, Rotation, SwingTwistLimit, Transform, Vec3, max, min, trig};
use sinew_physics::JointKind;

/// Factors on the observed swing, in the order in which they are tried.
const SWING_FACTORS: [f32; 4] = [1.15, 1.1, 1.05, 1.0];
/// Number of frames per added copy of the bind pose: the copies are twice the share that the coverage excludes, so that
/// the limits contain the bind pose.
const FRAMES_PER_BIND: usize = 100;
/// Number of directions in which a cone is compared to the anatomical one.
const DIRECTIONS: usize = 16;

/// Returns the joint with limits from the clips; `None` if the clips show too little of its motion. The mirrored motion
/// of its counterpart counts too: a motion that only one arm makes does not mean that the other cannot. `fits` and
/// `poses` are ordered as the plan's bodies; poses are in character space, one transform per body.
pub fn learned(
    plan: &JointPlan,
    twin: Option<&JointPlan>,
    fits: &[Fit],
    poses: &[Vec<Transform>],
    anatomy: Anatomy,
) -> Option<JointPlan> {
    let joint = &plan.def;
    let bind = turn(joint, &|body| fits[body].character_from_body);
    let mut turns: Vec<Rotation> = poses.iter().map(|pose| turn(joint, &|body| pose[body])).collect();
    if let Some(twin) = twin {
        turns.extend(poses.iter().map(|pose| mirrored(joint.kind, turn(&twin.def, &|body| pose[body]))));
    }
    turns.retain(|turn| turn.is_finite());
    if turns.is_empty() {
        return None;
    }
    let copies = turns.len().div_ceil(FRAMES_PER_BIND);
    turns.extend(core::iter::repeat_n(bind, copies));
    let def = match joint.kind {
        JointKind::Hinge { limit: Some(limit) } => {
            let range = hinge_range(limit, &turns, hinge_angle(bind))?;
            RagdollJointDef { kind: JointKind::Hinge { limit: Some(range) }, ..*joint }
        }
        JointKind::Ball { limit: Some(limit) } => {
            let learned = learn_limit(joint.child, Vec3::X, &turns).filter(is_wide_enough)?;
            match learned.hinge.filter(|_| anatomy == Anatomy::Creature) {
                Some(hinge) => hinged(joint, &learned, hinge, bind),
                None => Cone { joint, anatomical: limit, twisting: Twist::Free }.def(&learned, &turns, bind),
            }
        }
        JointKind::Universal { limit: Some(limit) } => {
            let learned = learn_limit(joint.child, Vec3::X, &turns).filter(is_wide_enough)?;
            Cone { joint, anatomical: limit, twisting: Twist::Locked }.def(&learned, &turns, bind)
        }
        _ => return None,
    };
    Some(JointPlan { def, widened: 0.0 })
}

/// Returns the joint rotation in a pose of the bodies.
fn turn(joint: &RagdollJointDef, pose: &dyn Fn(usize) -> Transform) -> Rotation {
    let parent = pose(joint.parent).rotation * joint.frame_parent.rotation;
    (parent.inverse() * (pose(joint.child).rotation * joint.frame_child.rotation)).normalize()
}

/// Mirrors a rotation to the other side: swing about z and twist change sign, and a hinge bends in the same direction.
fn mirrored(kind: JointKind, turn: Rotation) -> Rotation {
    match kind {
        JointKind::Hinge { .. } => turn,
        _ => Rotation { x: -turn.x, z: -turn.z, ..turn },
    }
}

fn is_wide_enough(limit: &LearnedLimit) -> bool {
    let [y, z] = limit.swing;
    limit.hinge.is_some() || max(y, z) >= LEAST_RANGE || limit.twist.hi - limit.twist.lo >= 2.0 * LEAST_RANGE
}

/// Returns the range of a human's hinge from its motion, with a margin limited by its anatomy.
fn hinge_range(anatomical: Range, turns: &[Rotation], bind: f32) -> Option<Range> {
    let middle = anatomical.center();
    let angle = |&turn: &Rotation| middle + wrap(hinge_angle(turn) - middle);
    let shown = covered(turns.iter().map(angle).collect());
    (shown.hi - shown.lo >= LEAST_RANGE).then(|| {
        let lo = min(shown.lo, max(anatomical.lo, shown.lo - TWIST_MARGIN));
        let hi = max(shown.hi, min(anatomical.hi, shown.hi + TWIST_MARGIN));
        Range::new(min(lo, bind - BIND_MARGIN), max(hi, bind + BIND_MARGIN))
    })
}

/// Returns a hinge for a creature's joint that rotates about only one axis.
fn hinged(
    joint: &RagdollJointDef,
    learned: &LearnedLimit,
    hinge: LearnedHinge,
    bind: Rotation,
) -> RagdollJointDef {
    let onto_axis = Rotation::from_arc(Vec3::X, hinge.axis);
    let (parent, child) = (learned.center * onto_axis, onto_axis);
    // A hinge rotates only about its axis; the remaining bind rotation becomes part of the frame.
    let seen = parent.inverse() * bind * child;
    let (swing, twist) = seen.swing_twist(Vec3::X);
    let range = wider(hinge.range, TWIST_MARGIN);
    let angle = hinge_angle(twist);
    let range = Range::new(min(range.lo, angle - BIND_MARGIN), max(range.hi, angle + BIND_MARGIN));
    let kind = JointKind::Hinge { limit: Some(range) };
    turned(joint, parent * swing, child, kind)
}

/// Rotates the two frames of a joint, each in its own axes.
fn turned(joint: &RagdollJointDef, parent: Rotation, child: Rotation, kind: JointKind) -> RagdollJointDef {
    let turn =
        |frame: Transform, by: Rotation| Transform::new(frame.translation, (frame.rotation * by).normalize());
    RagdollJointDef {
        frame_parent: turn(joint.frame_parent, parent),
        frame_child: turn(joint.frame_child, child),
        kind,
        ..*joint
    }
}

/// A joint that swings, and its anatomical limits in its own frames.
struct Cone<'a> {
    joint: &'a RagdollJointDef,
    anatomical: SwingTwistLimit,
    twisting: Twist,
}

impl Cone<'_> {
    fn def(&self, learned: &LearnedLimit, turns: &[Rotation], bind: Rotation) -> RagdollJointDef {
        let (parent, mut child) = (learned.center * learned.frame, learned.frame);
        let limit = self.limit(learned, turns);
        let mut seen = parent.inverse() * bind * child;
        if self.twisting == Twist::Locked {
            let (_, twist) = seen.swing_twist(Vec3::X);
            child = child * twist.inverse();
            seen = parent.inverse() * bind * child;
        }
        let (limit, _) = widened_cone(limit, seen, self.twisting);
        let kind = match self.twisting {
            Twist::Free => JointKind::Ball { limit: Some(limit) },
            Twist::Locked => JointKind::Universal { limit: Some(limit) },
        };
        turned(self.joint, parent, child, kind)
    }

    /// Returns the widest learned cone that exceeds the anatomical one by no more than the clips do. The clips' excess
    /// is that of their frames or of the cone around these frames without a margin, whichever is larger.
    fn limit(&self, learned: &LearnedLimit, turns: &[Rotation]) -> SwingTwistLimit {
        let mut beyond: Vec<f32> = turns.iter().map(|&turn| self.beyond(turn)).collect();
        beyond.sort_unstable_by(f32::total_cmp);
        let frames = beyond[((beyond.len() - 1) as f32 * COVERAGE) as usize];
        let bare = cone(learned, 1.0);
        let shown = max(frames, self.farthest(learned, &bare)) + BEYOND_CLIPS;
        let widest = SWING_FACTORS.into_iter().map(|factor| cone(learned, factor));
        widest.into_iter().find(|limit| self.farthest(learned, limit) <= shown).unwrap_or(bare)
    }

    /// Returns the angle by which a rotation exceeds the anatomical limits, radians.
    fn beyond(&self, turn: Rotation) -> f32 {
        match self.twisting {
            Twist::Free => self.anatomical.overshoot(turn),
            Twist::Locked => max(-self.anatomical.swing_state(turn).slack, 0.0),
        }
    }

    /// Returns the angle by which the farthest rotation of a cone exceeds the anatomical limits, radians.
    fn farthest(&self, learned: &LearnedLimit, limit: &SwingTwistLimit) -> f32 {
        let frame = learned.frame;
        let mut farthest = 0.0;
        for step in 0..DIRECTIONS {
            let (sin, cos) = trig::sin_cos(core::f32::consts::TAU * step as f32 / DIRECTIONS as f32);
            let swing = Vec3::new(0.0, cos * limit.swing_y.hi, sin * limit.swing_z.hi);
            for twist in [limit.twist.lo, limit.twist.hi] {
                let edge = Rotation::from_scaled_axis(swing) * Rotation::from_axis_angle(Vec3::X, twist);
                farthest = max(farthest, self.beyond(learned.center * frame * edge * frame.inverse()));
            }
        }
        farthest
    }
}

/// Returns the learned cone with margins: `factor` on the swing, and the same share of the twist margin as of the swing
/// margin.
fn cone(learned: &LearnedLimit, factor: f32) -> SwingTwistLimit {
    let [y, z] =
        learned.swing.map(|half| Range::symmetric(min(max(half * factor, LEAST_RANGE), WIDEST_SWING)));
    let twist = wider(learned.twist, TWIST_MARGIN * (factor - 1.0) / (SWING_FACTORS[0] - 1.0));
    let twist = Range::new(min(twist.lo, -0.5 * LEAST_RANGE), max(twist.hi, 0.5 * LEAST_RANGE));
    SwingTwistLimit { swing_y: y, swing_z: z, twist }
}

fn wider(range: Range, by: f32) -> Range {
    Range::new(range.lo - by, range.hi + by)
}
