//! Joints: positions, axes and limits.
//!
//! ```
//! # let rig = sinew::mannequin::mannequin().rig;
//! # let analysis = sinew_anim::analyze(&rig)?;
//! # let (def, _) = sinew_ragdoll::build(&rig, &analysis, &sinew_ragdoll::BuildOptions::default())?;
//! use sinew_physics::JointKind;
//!
//! let shin = def.bodies.iter().position(|body| body.role == "leftLowerLeg").expect("the body exists");
//! let knee = &def.joints[shin - 1]; // `joints[i].child == i + 1`
//! let JointKind::Hinge { limit: Some(range) } = knee.kind else { panic!("a knee is a hinge") };
//! let degrees = (range.hi - range.lo).to_degrees();
//! assert!((120.0..180.0).contains(&degrees), "{degrees}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod anatomy;
pub mod friction;
pub mod learned;
pub mod sample;
pub mod table;

use crate::build::bones::{Anatomy, Bones};
use crate::build::part::{Part, Side};
use crate::def::RagdollJointDef;
use crate::fit::Fit;
use crate::tuning::{BELIEVED, BENT, BIND_MARGIN, FRICTION_SHARE, WIDEST_SWING};
use anatomy::bind_from_anatomical;
use sinew_math::limits::hinge_angle;
use sinew_math::{
    Mat3, Range, Rotation, SwingTwistLimit, Transform, Vec3, any_orthonormal, max, min, normalize_or,
};
use sinew_physics::JointKind;
use table::{Axes, Cone, Entry, Motion, entry};

/// Source of joint limits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LimitSource {
    /// Table of ranges of motion.
    #[default]
    Anatomy,
    /// Motion of the character in its clips, within the table; joints that hardly move in the clips use the table
    /// alone.
    Clips,
}

/// A joint, and the corrections made to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointPlan {
    /// The joint, with frames relative to the two bodies.
    pub def: RagdollJointDef,
    /// Angle by which the bind pose exceeded the table's limits, radians; the limits were widened by it. 0 for most
    /// joints.
    pub widened: f32,
}

/// Returns the joint between every bone but the first and its parent, in the bones' order.
pub fn joints(bones: &Bones, fits: &[Fit], total_mass: f32) -> Vec<JointPlan> {
    let middles: Vec<_> = fits.iter().map(|fit| fit.character_from_body.translation).collect();
    let turned = bind_from_anatomical(bones, &middles);
    let strength = total_mass * bones.height / (75.0 * 1.75);
    (1..bones.list.len())
        .map(|child| {
            let parent = bones.list[child].parent.unwrap_or(0);
            let entry = entry(bones, child);
            let mut directions = [parent, child].map(|bone| bones.direction(bone, Some(middles[bone])));
            if bones.list[child].part == Part::Toes {
                // A foot slopes down from ankle to toes; toes are straight when they are parallel to the sole.
                directions[0] = turned[parent] * Vec3::Z;
            }
            let seen =
                Seen { side: bones.list[child].side, turned: [turned[parent], turned[child]], directions };
            let (frames, kind, widened) = if bones.list[child].is_prop {
                ([Rotation::IDENTITY; 2], JointKind::Fixed, 0.0)
            } else {
                seen.joint(&entry, bones.anatomy)
            };
            let pivot = bones.list[child].head;
            let [frame_parent, frame_child] = [(parent, frames[0]), (child, frames[1])]
                .map(|(body, frame)| fits[body].character_from_body.inverse() * Transform::new(pivot, frame));
            let friction_torque = FRICTION_SHARE * entry.torque * strength;
            let def = RagdollJointDef { parent, child, frame_parent, frame_child, kind, friction_torque };
            JointPlan { def, widened }
        })
        .collect()
}

/// A joint in the bind pose, in character axes. Arrays contain the parent's value, then the child's.
struct Seen {
    side: Side,
    /// Rotations from the anatomical pose to the bind pose.
    turned: [Rotation; 2],
    /// Unit vectors along the bones.
    directions: [Vec3; 2],
}

impl Seen {
    /// Returns the joint's frames on parent and child (character axes), its kind with limits, and the angle by which a
    /// limit was widened.
    fn joint(&self, entry: &Entry, anatomy: Anatomy) -> ([Rotation; 2], JointKind, f32) {
        match entry.motion {
            Motion::Ball(cone) => {
                let frames = self.cone_frames(entry.axes, cone);
                let joint = frames[0].inverse() * frames[1];
                let (limit, widened) = widened_cone(self.limit(cone), joint, Twist::Free);
                (frames, JointKind::Ball { limit: Some(limit) }, widened)
            }
            Motion::Universal(cone) => {
                let [parent, child] = self.cone_frames(entry.axes, cone);
                // A universal joint has no twist, so the twist of the bind pose is its zero.
                let (_, twist) = (parent.inverse() * child).swing_twist(Vec3::X);
                let frames = [parent, child * twist.inverse()];
                let joint = frames[0].inverse() * frames[1];
                let (limit, widened) = widened_cone(self.limit(cone), joint, Twist::Locked);
                (frames, JointKind::Universal { limit: Some(limit) }, widened)
            }
            Motion::Hinge(lo, hi) => {
                debug_assert!(anatomy == Anatomy::Human, "only the human table has hinges");
                let frames = self.hinge_frames(entry.axes);
                let angle = hinge_angle(frames[0].inverse() * frames[1]);
                let range = Range::degrees(lo, hi);
                let limit =
                    Range::new(min(range.lo, angle - BIND_MARGIN), max(range.hi, angle + BIND_MARGIN));
                // A straight limb at its stop is the normal standing pose, so only the angle beyond the table counts.
                (frames, JointKind::Hinge { limit: Some(limit) }, range.excess(angle))
            }
        }
    }

    /// Returns the joint axes in the anatomical pose, as a rotation.
    fn basis(&self, axes: Axes) -> Rotation {
        // Mirroring in x keeps the x component of a rotation axis and negates the other two.
        let mirror = if self.side == Side::Right { -1.0 } else { 1.0 };
        let (x, y) = match axes {
            Axes::Upright => (Vec3::Y, Vec3::X),
            Axes::Hanging => (-Vec3::Y, -Vec3::X),
            Axes::Palm => (-Vec3::Y, -Vec3::Z * mirror),
            Axes::Sole => (-Vec3::Y, Vec3::X),
            Axes::Bind => {
                let x = self.directions[1];
                let forward = Vec3::Z - x * x.z;
                (x, normalize_or(forward, any_orthonormal(x)))
            }
        };
        Rotation::from_mat3(&Mat3::from_cols(x, y, x.cross(y)))
    }

    /// Returns frames that coincide at the centre of the cone.
    fn cone_frames(&self, axes: Axes, cone: Cone) -> [Rotation; 2] {
        let basis = self.basis(axes);
        if axes == Axes::Bind {
            return [basis, basis];
        }
        let [y, z] = cone.center.map(f32::to_radians);
        let center = Rotation::from_scaled_axis(Vec3::new(0.0, y, z * self.mirror()));
        [self.turned[0] * basis * center, self.turned[1] * basis]
    }

    /// Returns −1 on the right side, where swing about z and twist change sign, and otherwise 1.
    fn mirror(&self) -> f32 {
        if self.side == Side::Right { -1.0 } else { 1.0 }
    }

    fn limit(&self, cone: Cone) -> SwingTwistLimit {
        let [y, z] = cone.half.map(|half| Range::symmetric(half.to_radians()));
        let [lo, hi] = cone.twist;
        let twist = if self.side == Side::Right { Range::degrees(-hi, -lo) } else { Range::degrees(lo, hi) };
        SwingTwistLimit { swing_y: y, swing_z: z, twist }
    }

    /// Returns frames with the hinge's axis as x, and angle 0 where the two bones are in line.
    fn hinge_frames(&self, axes: Axes) -> [Rotation; 2] {
        let [along_parent, along_child] = self.directions;
        let anatomical = self.turned[0] * (self.basis(axes) * Vec3::Y);
        let bend = along_parent.cross(along_child);
        let shown = normalize_or(bend, anatomical);
        let is_bent = along_parent.dot(along_child) < BENT;
        let axis = if is_bent && shown.dot(anatomical) > BELIEVED { shown } else { anatomical };
        [along_parent, along_child].map(|along| {
            let y = normalize_or(along - axis * axis.dot(along), any_orthonormal(axis));
            Rotation::from_mat3(&Mat3::from_cols(axis, y, axis.cross(y)))
        })
    }
}

/// Twist of a joint: free within its limit, or locked.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Twist {
    Free,
    Locked,
}

/// Returns the limit extended to include the joint rotation `joint` (the bind pose), and the angle by which this
/// rotation exceeded the limit, radians.
fn widened_cone(limit: SwingTwistLimit, joint: Rotation, twisting: Twist) -> (SwingTwistLimit, f32) {
    let mut wide = limit;
    let (swing, twist) = SwingTwistLimit::angles(joint);
    let angle = swing.length();
    let mut beyond = 0.0;
    if angle > 1e-4 {
        let cone = limit.cone_angle(swing.y / angle, swing.z / angle);
        beyond = max(angle - cone, 0.0);
        let factor = max(1.0, (angle + BIND_MARGIN) / cone);
        let stretched =
            |r: Range| Range::new(max(r.lo * factor, -WIDEST_SWING), min(r.hi * factor, WIDEST_SWING));
        wide.swing_y = stretched(limit.swing_y);
        wide.swing_z = stretched(limit.swing_z);
    }
    if twisting == Twist::Free {
        beyond = max(beyond, limit.twist.excess(twist));
        wide.twist =
            Range::new(min(limit.twist.lo, twist - BIND_MARGIN), max(limit.twist.hi, twist + BIND_MARGIN));
    }
    (wide, beyond)
}
