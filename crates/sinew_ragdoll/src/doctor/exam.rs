//! A ragdoll with derived data for all checks.

use super::{Code, Finding, Repair};
use crate::build::bones::{Anatomy, Bone, Bones};
use crate::build::part::Part;
use crate::def::{RagdollDef, RagdollJointDef};
use crate::fit::Fit;
use crate::fit::patch::Selection;
use crate::limits::{JointPlan, joints};
use core::f32::consts::PI;
use sinew_anim::roles::Role;
use sinew_math::limits::hinge_angle;
use sinew_math::{Range, Rotation, SwingTwistLimit, Transform, Vec3, max, min};
use sinew_physics::JointKind;

/// A ragdoll with derived data.
pub(super) struct Exam<'a> {
    pub repair: &'a Repair,
    pub def: &'a RagdollDef,
    /// The bodies as bones of the build's stages; heads are the pivots of the definition.
    pub bones: Bones,
    pub fits: Vec<Fit>,
    /// Height, metres.
    pub size: f32,
}

/// Angles by which a joint rotation exceeds the joint's freedom, radians.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Beyond {
    /// Angle beyond the joint's limits.
    pub limit: f32,
    /// Rotation about locked directions.
    pub locked: f32,
}

impl<'a> Exam<'a> {
    pub fn new(repair: &'a Repair) -> Self {
        let def = &repair.def;
        let bones = bones_of(def);
        let fits = def.bodies.iter().map(|body| Fit {
            shape: body.shape.clone(),
            character_from_body: body.character_from_body,
            error: 0.0,
            area: 0.0,
            selection: Selection::Nothing,
        });
        Self { repair, def, bones, fits: fits.collect(), size: def.height }
    }

    /// Creates a finding about these bodies.
    pub fn finding(&self, code: Code, bodies: &[usize], evidence: String) -> Finding {
        Finding {
            code,
            severity: code.severity(),
            bodies: bodies.to_vec(),
            bones: bodies.iter().map(|&body| self.def.bodies[body].bone.clone()).collect(),
            evidence,
            fix: code.fix().to_owned(),
            fixed: false,
        }
    }

    /// Returns role and bone of a body; the bone only if its name differs.
    pub fn who(&self, body: usize) -> String {
        let body = &self.def.bodies[body];
        if body.role == body.bone { body.role.clone() } else { format!("{} ({})", body.role, body.bone) }
    }

    /// Names both bodies of a joint, the parent first.
    pub fn between(&self, joint: usize) -> String {
        let joint = &self.def.joints[joint];
        format!("{} and {}", self.who(joint.parent), self.who(joint.child))
    }

    /// Returns the joint's rotation when its child is rotated by `turn` (character axes) from the bind pose.
    pub fn turned(&self, joint: usize, turn: Rotation) -> Rotation {
        let joint = &self.def.joints[joint];
        let rotation = |body: usize| self.def.bodies[body].character_from_body.rotation;
        let parent = rotation(joint.parent) * joint.frame_parent.rotation;
        parent.inverse() * (turn * rotation(joint.child) * joint.frame_child.rotation)
    }

    /// Returns the anchors of the joint on parent and child in the bind pose, character space.
    pub fn anchors(&self, joint: usize) -> [Vec3; 2] {
        anchors(self.def, &self.def.joints[joint])
    }

    /// Returns the axes of the joint's frame on the parent, in character axes.
    pub fn axes(&self, joint: usize) -> Rotation {
        let joint = &self.def.joints[joint];
        self.def.bodies[joint.parent].character_from_body.rotation * joint.frame_parent.rotation
    }

    /// Returns the unit vector along a bone.
    pub fn direction(&self, body: usize) -> Vec3 {
        self.bones.direction(body, Some(self.def.bodies[body].character_from_body.translation))
    }

    pub fn part(&self, body: usize) -> Part {
        self.bones.list[body].part
    }

    /// Returns the anatomical joint: same pivot, with axes and range from the table.
    pub fn anatomical(&self, joint: usize) -> JointPlan {
        let mut plan = joints(&self.bones, &self.fits, self.def.total_mass)[joint];
        plan.def.kind = within_half_turns(plan.def.kind);
        plan
    }
}

/// Returns the kind with twists and hinges limited to half a turn each way. Room added near that end would wrap to the
/// other side.
fn within_half_turns(kind: JointKind) -> JointKind {
    let held = |range: Range| Range::new(max(range.lo, -PI), min(range.hi, PI));
    match kind {
        JointKind::Ball { limit } => JointKind::Ball {
            limit: limit.map(|limit| SwingTwistLimit { twist: held(limit.twist), ..limit }),
        },
        JointKind::Hinge { limit } => JointKind::Hinge { limit: limit.map(held) },
        kind => kind,
    }
}

/// Returns the anchors of a joint on parent and child in the bind pose, character space.
pub(super) fn anchors(def: &RagdollDef, joint: &RagdollJointDef) -> [Vec3; 2] {
    let point = |body: usize, frame: Transform| def.bodies[body].character_from_body.point(frame.translation);
    [point(joint.parent, joint.frame_parent), point(joint.child, joint.frame_child)]
}

/// Returns the angle by which the bind pose of a joint is beyond its limits, radians.
pub(crate) fn beyond_at_bind(def: &RagdollDef, joint: &RagdollJointDef) -> f32 {
    let frame =
        |body: usize, frame: Transform| def.bodies[body].character_from_body.rotation * frame.rotation;
    let seen = frame(joint.parent, joint.frame_parent).inverse() * frame(joint.child, joint.frame_child);
    beyond(&joint.kind, seen).limit
}

/// Returns the angles by which the joint rotation `frame_a⁻¹ frame_b` exceeds the joint's freedom, radians.
pub(super) fn beyond(kind: &JointKind, seen: Rotation) -> Beyond {
    let (swing, twist) = seen.swing_twist(Vec3::X);
    let swung = swing.to_scaled_axis().length();
    match kind {
        JointKind::Ball { limit } => {
            Beyond { limit: limit.map_or(0.0, |limit| limit.overshoot(seen)), locked: 0.0 }
        }
        JointKind::Universal { limit } => Beyond {
            limit: limit.map_or(0.0, |limit| swing_excess(&limit, seen)),
            locked: twist.twist_angle(Vec3::X).abs(),
        },
        JointKind::Hinge { limit } => {
            Beyond { limit: limit.map_or(0.0, |range| range.excess(hinge_angle(twist))), locked: swung }
        }
        _ => Beyond { limit: 0.0, locked: seen.angle_to(Rotation::IDENTITY) },
    }
}

/// Returns the angle by which the swing alone is outside the cone, radians.
pub(super) fn swing_excess(limit: &SwingTwistLimit, seen: Rotation) -> f32 {
    max(0.0, -limit.swing_state(seen).slack)
}

/// Returns the angle, radians, at most π, by which the child of a joint can rotate about `axis` of its own joint frame
/// before it reaches a limit. The rotation starts from `bind`, the joint's rotation in the bind pose. The twist of a
/// universal joint is ignored, because a swing of more than half a turn contains some twist.
pub fn limit_reach(kind: &JointKind, bind: Rotation, axis: Vec3) -> f32 {
    const STEP: f32 = 0.02;
    let is_free = |angle: f32| {
        let seen = bind * Rotation::from_axis_angle(axis, angle);
        beyond(kind, seen).limit <= 1e-5
    };
    let mut inside = 0.0;
    while inside < core::f32::consts::PI {
        if !is_free(inside + STEP) {
            // The stop is within the step.
            let (mut low, mut high) = (inside, inside + STEP);
            for _ in 0..16 {
                let middle = 0.5 * (low + high);
                if is_free(middle) {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            return low;
        }
        inside += STEP;
    }
    core::f32::consts::PI
}

/// Returns the bodies of a definition as bones.
pub(crate) fn bones_of(def: &RagdollDef) -> Bones {
    let list: Vec<Bone> = def
        .bodies
        .iter()
        .enumerate()
        .map(|(index, body)| {
            // An unknown role counts as a limb of its own.
            let unknown = Role::LimbSegment { limb: u16::MAX, segment: index as u16 };
            let role = Role::from_name(&body.role).unwrap_or(unknown);
            let joint = index.checked_sub(1).map(|joint| &def.joints[joint]);
            let head = joint.map_or(body.character_from_body.translation, |joint| anchors(def, joint)[1]);
            let bone = Bone::new(body.joint, role, joint.map(|joint| joint.parent), head);
            let is_fixed = joint.is_some_and(|joint| joint.kind == JointKind::Fixed);
            let is_prop = is_fixed && matches!(Role::from_name(&body.role), Some(Role::LimbSegment { .. }));
            Bone { merged: body.merged.clone(), confidence: body.confidence, is_prop, ..bone }
        })
        .collect();
    let has = |part: Part| list.iter().any(|bone| bone.part == part);
    let limbs = [Part::UpperArm, Part::Forearm, Part::Thigh, Part::Shank];
    let is_human = has(Part::Pelvis) && limbs.into_iter().any(has);
    let anatomy = if is_human { Anatomy::Human } else { Anatomy::Creature };
    Bones::new(list, anatomy, def.height)
}
