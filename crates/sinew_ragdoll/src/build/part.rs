//! Body parts, as in the tables of anthropometry and joint ranges.
//!
//! ```
//! use sinew_anim::roles::{Role, Side as RoleSide};
//! use sinew_ragdoll::build::part::{Part, Side, part_of_role};
//!
//! let (part, side) = part_of_role(Role::LowerArm(RoleSide::Left));
//! assert_eq!((part, side), (Part::Forearm, Side::Left));
//! assert_eq!(part.continued_by(), [Part::Hand]);
//! assert!(part.is_limb() && side.sign() == 1.0);
//! ```

use sinew_anim::roles::{self, Role};

/// Kind of body part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Hips.
    Pelvis,
    /// Any bone of the trunk above the hips.
    Spine,
    /// Neck.
    Neck,
    /// Head.
    Head,
    /// Collar bone and shoulder blade (VRM `shoulder`).
    Clavicle,
    /// Upper arm.
    UpperArm,
    /// Forearm.
    Forearm,
    /// Hand with its fingers.
    Hand,
    /// Upper leg.
    Thigh,
    /// Lower leg.
    Shank,
    /// Foot.
    Foot,
    /// Toes.
    Toes,
    /// Bone of a tail.
    Tail,
    /// Bone of any other limb.
    Limb,
}

/// Side of the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The character's own left, +X.
    Left,
    /// The character's own right, −X.
    Right,
    /// Neither side.
    Middle,
}

impl Side {
    /// Returns the sign of x: +1 on the left, −1 on the right, 0 on the midline.
    pub fn sign(self) -> f32 {
        match self {
            Side::Left => 1.0,
            Side::Right => -1.0,
            Side::Middle => 0.0,
        }
    }
}

impl Part {
    /// Returns the parts that continue this one, the best first.
    pub fn continued_by(self) -> &'static [Part] {
        match self {
            Part::Pelvis => &[Part::Spine],
            Part::Spine => &[Part::Spine, Part::Neck, Part::Head],
            Part::Neck => &[Part::Neck, Part::Head],
            Part::Clavicle => &[Part::UpperArm],
            Part::UpperArm => &[Part::Forearm],
            Part::Forearm => &[Part::Hand],
            Part::Thigh => &[Part::Shank],
            Part::Shank => &[Part::Foot],
            Part::Foot => &[Part::Toes],
            Part::Head | Part::Hand | Part::Toes | Part::Tail | Part::Limb => &[],
        }
    }

    /// Returns true if the part belongs to the trunk.
    pub fn is_trunk(self) -> bool {
        matches!(self, Part::Pelvis | Part::Spine | Part::Clavicle)
    }

    /// Returns true if the part belongs to an arm or a leg.
    pub fn is_limb(self) -> bool {
        !self.is_trunk() && !matches!(self, Part::Neck | Part::Head)
    }
}

/// Returns the part and side of a role.
pub fn part_of_role(role: Role) -> (Part, Side) {
    let side = match role.side() {
        Some(roles::Side::Left) => Side::Left,
        Some(roles::Side::Right) => Side::Right,
        None => Side::Middle,
    };
    let part = match role {
        Role::Hips => Part::Pelvis,
        Role::Spine | Role::Chest | Role::UpperChest | Role::SpineSegment(_) => Part::Spine,
        Role::Neck => Part::Neck,
        Role::Head => Part::Head,
        Role::Shoulder(_) => Part::Clavicle,
        Role::UpperArm(_) => Part::UpperArm,
        Role::LowerArm(_) => Part::Forearm,
        Role::Hand(_) => Part::Hand,
        Role::UpperLeg(_) => Part::Thigh,
        Role::LowerLeg(_) => Part::Shank,
        Role::Foot(_) => Part::Foot,
        Role::Toes(_) => Part::Toes,
        Role::TailSegment(_) => Part::Tail,
        Role::LimbSegment { .. } => Part::Limb,
    };
    (part, side)
}
