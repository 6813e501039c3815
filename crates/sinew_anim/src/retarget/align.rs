//! Aligns two bodies: differences of their reference poses, role by role.

use crate::rig::JointIdx;
use crate::roles::{HUMANOID_ROLES, RigAnalysis, Role, Side};
use crate::tuning::{LEG_STANDS, SAME_UPRIGHT};
use sinew_math::{Mat3, Rotation, Transform, Vec3, direction};

/// Joints of two bodies with the same role.
pub(super) struct Pair {
    pub role: Role,
    /// Joint of the actor.
    pub from: JointIdx,
    /// Joint of the character.
    pub to: JointIdx,
    /// Correction of the rotation: `character = actor · correction`, each in its own body's axes.
    pub correction: Rotation,
}

/// Correspondence of the joints of two bodies.
pub(super) struct Alignment {
    /// Pairs in the order of the character's joints.
    pub pairs: Vec<Pair>,
    /// Roles that only the character has.
    pub unmatched: Vec<Role>,
}

/// A body in its reference pose, in its own axes, metres.
struct Stance<'a> {
    analysis: &'a RigAnalysis,
    joints: Vec<Transform>,
}

impl<'a> Stance<'a> {
    fn of(analysis: &'a RigAnalysis) -> Self {
        let root = analysis.character_from_file();
        let joints = analysis.bind_model.iter().map(|joint| (root * *joint).to_rigid()).collect();
        Self { analysis, joints }
    }

    fn joint(&self, role: Role) -> Option<JointIdx> {
        self.analysis.joint_with(role)
    }

    fn place(&self, role: Role) -> Option<Vec3> {
        self.joint(role).map(|joint| self.joints[joint].translation)
    }

    fn way(&self, from: Role, to: Role) -> Option<Vec3> {
        direction(self.place(to)? - self.place(from)?)
    }

    /// Joints of the spine above the pelvis, upward.
    fn spine(&self) -> Vec<(Role, JointIdx)> {
        let parts = [Role::Spine, Role::Chest, Role::UpperChest];
        parts.into_iter().filter_map(|role| Some((role, self.joint(role)?))).collect()
    }

    /// Returns the left and the up direction, from the hip joints and the trunk.
    fn trunk(&self) -> Option<(Vec3, Vec3)> {
        let left = self.way(Role::UpperLeg(Side::Right), Role::UpperLeg(Side::Left))?;
        let top = [Role::Neck, Role::Head].into_iter().find_map(|role| self.place(role))?;
        let up = top - self.place(Role::Hips)?;
        Some((left, direction(up - left * up.dot(left))?))
    }
}

impl Alignment {
    pub fn of(actor: &RigAnalysis, character: &RigAnalysis) -> Self {
        let (from, to) = (Stance::of(actor), Stance::of(character));
        let mut found = Self { pairs: Vec::new(), unmatched: Vec::new() };
        let trunk = trunk_turn(&from, &to);
        let mut turns: Vec<(Role, Rotation)> = Vec::new();
        for side in [Side::Left, Side::Right] {
            let [leg, arm] = limb_roles(side);
            turns.extend(leg_turns(&from, &to, trunk, leg));
            // Clavicles differ between rigs, so they only follow the trunk.
            turns.extend(chain_turns(&from, &to, trunk, [arm[1], arm[2], arm[3]]));
        }
        let turn_of = |role: Role| turns.iter().find(|(r, _)| *r == role).map_or(trunk, |&(_, turn)| turn);
        let in_spine = |role: Role| matches!(role, Role::Spine | Role::Chest | Role::UpperChest);
        let pair = |role: Role, a: JointIdx, b: JointIdx| Pair {
            role,
            from: a,
            to: b,
            correction: (from.joints[a].rotation.inverse() * turn_of(role).inverse() * to.joints[b].rotation)
                .normalize(),
        };
        for role in HUMANOID_ROLES.into_iter().filter(|&role| !in_spine(role)) {
            match (from.joint(role), to.joint(role)) {
                (Some(a), Some(b)) => found.pairs.push(pair(role, a, b)),
                (None, Some(_)) => found.unmatched.push(role),
                (_, None) => {}
            }
        }
        // Spines differ in length: their top joints correspond, the others in proportion.
        let (below, above) = (from.spine(), to.spine());
        for (k, &(role, joint)) in above.iter().enumerate() {
            match ((k + 1) * below.len()).div_ceil(above.len()).checked_sub(1) {
                Some(i) => found.pairs.push(pair(role, below[i].1, joint)),
                None => found.unmatched.push(role),
            }
        }
        found.pairs.sort_by_key(|pair| pair.to);
        found
    }
}

/// Returns the rotation from the actor's reference trunk to the character's. If both stand upright, only the lines
/// through the hip joints are aligned, because a spine's lean depends on the rig.
fn trunk_turn(from: &Stance<'_>, to: &Stance<'_>) -> Rotation {
    let Some(((left, up), (new_left, new_up))) = from.trunk().zip(to.trunk()) else {
        return Rotation::IDENTITY;
    };
    if up.dot(new_up) > SAME_UPRIGHT && left.dot(new_left) > SAME_UPRIGHT {
        return Rotation::from_arc(left, new_left);
    }
    let frame = |left: Vec3, up: Vec3| Mat3::from_cols(left, up, left.cross(up));
    Rotation::from_mat3_lossy(&(frame(new_left, new_up) * frame(left, up).transpose()))
}

/// Returns the rotations that align the two bones of a limb with those of the other body. Each rotation applies after
/// the previous one; the third joint gets the rotation of the second bone.
fn chain_turns(
    from: &Stance<'_>,
    to: &Stance<'_>,
    trunk: Rotation,
    [upper, lower, end]: [Role; 3],
) -> [(Role, Rotation); 3] {
    let onto = |before: Rotation, a: Role, b: Role| match from.way(a, b).zip(to.way(a, b)) {
        Some((old, new)) => (Rotation::from_arc(before * old, new) * before).normalize(),
        None => before,
    };
    let first = onto(trunk, upper, lower);
    let second = onto(first, lower, end);
    [(upper, first), (lower, second), (end, second)]
}

/// Returns the rotations of a leg, like those of an arm. Feet that stand in both reference poses stay flat, and only
/// their headings are aligned.
fn leg_turns(from: &Stance<'_>, to: &Stance<'_>, trunk: Rotation, roles: [Role; 4]) -> Vec<(Role, Rotation)> {
    let [upper, lower, foot, toes] = roles;
    let [thigh, shank, (_, along)] = chain_turns(from, to, trunk, [upper, lower, foot]);
    let turn = match from.way(foot, toes).zip(to.way(foot, toes)) {
        None => trunk,
        Some((old, new)) => {
            let heading = |v: Vec3| direction(Vec3::new(v.x, 0.0, v.z));
            let stands = |body: &Stance<'_>| {
                [[lower, upper], [foot, lower]]
                    .iter()
                    .all(|&[a, b]| body.way(a, b).is_some_and(|way| way.y > LEG_STANDS))
            };
            match heading(trunk * old).zip(heading(new)) {
                Some((a, b)) if stands(from) && stands(to) => Rotation::from_arc(a, b) * trunk,
                _ => Rotation::from_arc(along * old, new) * along,
            }
        }
    };
    vec![thigh, shank, (foot, turn), (toes, turn)]
}

/// Roles of the leg and the arm of a side, from the trunk outward.
fn limb_roles(side: Side) -> [[Role; 4]; 2] {
    use Role::{Foot, Hand, LowerArm, LowerLeg, Shoulder, Toes, UpperArm, UpperLeg};
    [
        [UpperLeg(side), LowerLeg(side), Foot(side), Toes(side)],
        [Shoulder(side), UpperArm(side), LowerArm(side), Hand(side)],
    ]
}
