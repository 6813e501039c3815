//! Roles of joints in a body.

/// Side of the character's own body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Side {
    /// The character's left, +X of the character frame.
    Left,
    /// The character's right, −X.
    Right,
}

impl Side {
    /// Returns the other side.
    pub fn mirror(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }
}

/// Role of a joint: a bone of the VRM 1 humanoid, or a part of the generic anatomy of a creature.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Role {
    /// Pelvis, the root of a humanoid's bodies.
    Hips,
    /// Lowest part of the spine above the pelvis.
    Spine,
    /// Second part of the spine.
    Chest,
    /// Third part of the spine.
    UpperChest,
    /// Neck.
    Neck,
    /// Head.
    Head,
    /// Clavicle.
    Shoulder(Side),
    /// Humerus.
    UpperArm(Side),
    /// Forearm.
    LowerArm(Side),
    /// Hand, from the wrist.
    Hand(Side),
    /// Thigh.
    UpperLeg(Side),
    /// Shank.
    LowerLeg(Side),
    /// Foot, from the ankle.
    Foot(Side),
    /// Toes.
    Toes(Side),
    /// Part `n` of a creature's trunk, from its root outward.
    SpineSegment(u16),
    /// Part `n` of a creature's tail, from the trunk outward.
    TailSegment(u16),
    /// Part of a creature's limb.
    LimbSegment {
        /// Index of the limb, counted from 0.
        limb: u16,
        /// Index of the part, from the trunk outward.
        segment: u16,
    },
}

/// Every role of the humanoid, parents before children.
pub const HUMANOID_ROLES: [Role; 22] = {
    use Role::{Chest, Foot, Hand, Head, Hips, LowerArm, LowerLeg, Neck, Shoulder, Spine, Toes};
    use Role::{UpperArm, UpperChest, UpperLeg};
    use Side::{Left, Right};
    [
        Hips,
        Spine,
        Chest,
        UpperChest,
        Neck,
        Head,
        Shoulder(Left),
        UpperArm(Left),
        LowerArm(Left),
        Hand(Left),
        Shoulder(Right),
        UpperArm(Right),
        LowerArm(Right),
        Hand(Right),
        UpperLeg(Left),
        LowerLeg(Left),
        Foot(Left),
        Toes(Left),
        UpperLeg(Right),
        LowerLeg(Right),
        Foot(Right),
        Toes(Right),
    ]
};

impl Role {
    /// Returns the VRM 1 humanoid bone name, or `spine_n`, `tail_n`, `limb_n_m`.
    pub fn name(self) -> String {
        let sided = |side: Side, part: &str| match side {
            Side::Left => format!("left{part}"),
            Side::Right => format!("right{part}"),
        };
        match self {
            Self::Hips => "hips".into(),
            Self::Spine => "spine".into(),
            Self::Chest => "chest".into(),
            Self::UpperChest => "upperChest".into(),
            Self::Neck => "neck".into(),
            Self::Head => "head".into(),
            Self::Shoulder(side) => sided(side, "Shoulder"),
            Self::UpperArm(side) => sided(side, "UpperArm"),
            Self::LowerArm(side) => sided(side, "LowerArm"),
            Self::Hand(side) => sided(side, "Hand"),
            Self::UpperLeg(side) => sided(side, "UpperLeg"),
            Self::LowerLeg(side) => sided(side, "LowerLeg"),
            Self::Foot(side) => sided(side, "Foot"),
            Self::Toes(side) => sided(side, "Toes"),
            Self::SpineSegment(n) => format!("spine_{n}"),
            Self::TailSegment(n) => format!("tail_{n}"),
            Self::LimbSegment { limb, segment } => format!("limb_{limb}_{segment}"),
        }
    }

    /// Returns the role of that name; `None` for a name that [`name`](Self::name) does not return.
    pub fn from_name(name: &str) -> Option<Self> {
        if let Some(role) = HUMANOID_ROLES.into_iter().find(|role| role.name() == name) {
            return Some(role);
        }
        let mut parts = name.split('_');
        let kind = parts.next()?;
        let numbers: Option<Vec<u16>> = parts.map(|part| part.parse().ok()).collect();
        match (kind, numbers?.as_slice()) {
            ("spine", &[n]) => Some(Self::SpineSegment(n)),
            ("tail", &[n]) => Some(Self::TailSegment(n)),
            ("limb", &[limb, segment]) => Some(Self::LimbSegment { limb, segment }),
            _ => None,
        }
    }

    /// Returns the side of a humanoid's limb; `None` on the midline and for generic roles.
    pub fn side(self) -> Option<Side> {
        match self {
            Self::Shoulder(side)
            | Self::UpperArm(side)
            | Self::LowerArm(side)
            | Self::Hand(side)
            | Self::UpperLeg(side)
            | Self::LowerLeg(side)
            | Self::Foot(side)
            | Self::Toes(side) => Some(side),
            _ => None,
        }
    }

    /// True if the role is on the character's left.
    pub fn is_left(self) -> bool {
        self.side() == Some(Side::Left)
    }

    /// True if the role is on the character's right.
    pub fn is_right(self) -> bool {
        self.side() == Some(Side::Right)
    }

    /// Returns the same role on the other side; a role without a side is its own mirror image.
    pub fn mirror(self) -> Self {
        match self {
            Self::Shoulder(side) => Self::Shoulder(side.mirror()),
            Self::UpperArm(side) => Self::UpperArm(side.mirror()),
            Self::LowerArm(side) => Self::LowerArm(side.mirror()),
            Self::Hand(side) => Self::Hand(side.mirror()),
            Self::UpperLeg(side) => Self::UpperLeg(side.mirror()),
            Self::LowerLeg(side) => Self::LowerLeg(side.mirror()),
            Self::Foot(side) => Self::Foot(side.mirror()),
            Self::Toes(side) => Self::Toes(side.mirror()),
            other => other,
        }
    }

    /// Returns the roles that may be the anatomical parent of this role, nearest first.
    pub(crate) fn anatomical_parents(self) -> &'static [Role] {
        use Role::{Chest, Hips, Neck, Spine, UpperChest};
        const TRUNK: &[Role] = &[UpperChest, Chest, Spine, Hips];
        macro_rules! sided {
            ($side:expr, $first:ident) => {
                match $side {
                    Side::Left => &[Role::$first(Side::Left), UpperChest, Chest, Spine, Hips],
                    Side::Right => &[Role::$first(Side::Right), UpperChest, Chest, Spine, Hips],
                }
            };
        }
        match self {
            Self::Spine => &[Hips],
            Chest => &[Spine, Hips],
            UpperChest => &[Chest, Spine, Hips],
            Neck | Self::Shoulder(_) => TRUNK,
            Self::Head => &[Neck, UpperChest, Chest, Spine, Hips],
            Self::UpperArm(side) => sided!(side, Shoulder),
            Self::LowerArm(side) => sided!(side, UpperArm),
            Self::Hand(side) => sided!(side, LowerArm),
            Self::UpperLeg(_) => &[Hips],
            Self::LowerLeg(side) => sided!(side, UpperLeg),
            Self::Foot(side) => sided!(side, LowerLeg),
            Self::Toes(side) => sided!(side, Foot),
            Hips | Self::SpineSegment(_) | Self::TailSegment(_) | Self::LimbSegment { .. } => &[],
        }
    }
}
