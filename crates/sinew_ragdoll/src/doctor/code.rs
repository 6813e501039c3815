//! Kinds of findings.

/// Severity of a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// The ragdoll jitters, explodes or falls apart because of the defect.
    Error,
    /// The ragdoll is stable, but does not move like a body.
    Warning,
    /// A note for the user.
    Note,
}

impl Severity {
    /// Returns `error`, `warning` or `note`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Error => "error",
            Self::Warning => "warning",
            Self::Note => "note",
        }
    }
}

macro_rules! codes {
    ($($(#[$doc:meta])* $variant:ident $name:literal $severity:ident $cause:literal $fix:literal;)*) => {
        /// Kind of a finding.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub enum Code {
            $($(#[$doc])* $variant,)*
        }

        impl Code {
            /// Every code.
            pub const ALL: &'static [Self] = &[$(Self::$variant,)*];

            /// Returns the name of the code in reports.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name,)*
                }
            }

            /// Returns the usual severity of findings of this kind.
            pub fn severity(self) -> Severity {
                match self {
                    $(Self::$variant => Severity::$severity,)*
                }
            }

            /// Returns cause and consequence, as a phrase.
            pub fn cause(self) -> &'static str {
                match self {
                    $(Self::$variant => $cause,)*
                }
            }

            /// Returns the recommended action, one sentence.
            pub fn fix(self) -> &'static str {
                match self {
                    $(Self::$variant => $fix,)*
                }
            }
        }
    };
}

codes! {
    /// A size, pose or limit is not a number.
    NotFinite "not-finite" Error
        "a number is not finite, so that nothing can be computed from it"
        "Build the definition anew from its rig.";
    /// A mass or inertia is not positive.
    MassNotPositive "mass-not-positive" Error
        "a body without mass cannot be moved by any force, or moves without end"
        "Give it the mass that its part has in a body of this weight.";
    /// The character is a giant or a dwarf because its unit was mistaken.
    WrongUnit "wrong-unit" Error
        "a length in the wrong unit makes gravity look slow or fast, and breaks every tolerance"
        "Scale all lengths to metres.";
    /// Joint frames were left at their default.
    IdentityFrames "identity-frames" Error
        "the zero of the joint is not the bind pose, so that its limits are broken at the start"
        "Turn the frames so that they agree in the bind pose and meet at the bone's head.";
    /// The two anchors of a joint differ.
    AnchorsApart "anchors-apart" Error
        "the joint is torn open at the start and snaps shut"
        "Move the anchor of the parent to that of the child.";
    /// The pivot is not at the start of the bone.
    PivotOffBone "pivot-off-bone" Error
        "the bone swings about a point outside itself, as a hip that hangs on the middle of the pelvis"
        "Move the pivot to the head of the bone.";
    /// The bind pose is beyond a limit.
    LimitViolatedAtBind "limit-violated-at-bind" Error
        "the limit pushes from the first step on"
        "Widen the limit until it holds the bind pose with 2° to spare.";
    /// Two colliding bodies overlap at the start.
    OverlapAtStart "overlap-at-start" Error
        "contacts push the bodies apart at the first step: the ragdoll explodes"
        "Leave out contacts between the two.";
    /// The ragdoll moves although nothing pushes it.
    MovesByItself "moves-by-itself" Error
        "something in it pushes without end"
        "Widen limits that the bind pose strains, or leave out the deepest contact there.";
    /// A joint can turn without end.
    LimitsMissing "limits-missing" Warning
        "without limits elbows bend backwards and heads turn round"
        "Give it the range that the joint has in a body.";
    /// All joints have the same limit.
    LimitsAllAlike "limits-all-alike" Warning
        "a default limit on every joint lets knees bend sideways and holds hips back"
        "Give each joint the range that it has in a body.";
    /// A limit is too narrow for a solver to hold without jitter.
    LimitTooNarrow "limit-too-narrow" Warning
        "a range of a few degrees has both stops at work at once: it jitters, and is meant to be locked"
        "Lock that direction.";
    /// A knee or elbow bends backwards.
    BendsBothWays "bends-both-ways" Warning
        "the range of a knee or elbow lies on both sides of straight"
        "Let it bend one way only.";
    /// Left and right have different ranges.
    LimitsNotMirrored "limits-not-mirrored" Warning
        "the two sides do not have the same range, as when signs were copied and not mirrored"
        "Take the mirror image of the other side's range.";
    /// A contact between a pair prevents a joint from using its range.
    CollisionFightsLimit "collision-fights-limit" Warning
        "the joint allows what the contact forbids, so that the two push against each other"
        "Leave out contacts between the two.";
    /// Limbs and trunk have no contact.
    NoSelfCollision "no-self-collision" Warning
        "limbs sink into the trunk, because all pairs of them are left out"
        "Let the pairs collide that do not overlap in the bind pose.";
    /// A shape is too small to have an effect.
    TinyShape "tiny-shape" Warning
        "so thin a shape sinks into everything and falls through meshes"
        "Give it a thickness in proportion to the character.";
    /// A shape is larger than any body part.
    HugeShape "huge-shape" Warning
        "the shape holds more than its body part, and collides with everything"
        "Fit it to the length of its bone.";
    /// Left and right have different shapes.
    SidesDiffer "sides-differ" Warning
        "the two sides have shapes of different sizes, so that the body limps"
        "Take the mirror image of the other side's shape.";
    /// The head has no body.
    HeadWithoutBody "head-without-body" Warning
        "the last bone of a chain got no body, so that the head falls through floors"
        "Give the head a body; with the rig at hand it is done here.";
    /// A limb, or its end, has no body.
    LimbWithoutBody "limb-without-body" Warning
        "a limb got no body, as when only the first child of a bone is looked at"
        "Give the limb its bodies; with the rig at hand it is done here.";
    /// Neighbours have very different masses.
    MassRatio "mass-ratio" Warning
        "a light body beside a heavy one is thrown about by it in most solvers"
        "Make the lighter one heavier, the total kept.";
    /// The mass is too small or too large for the size.
    MassImplausible "mass-implausible" Warning
        "a character of this size does not have this mass, so that everything hits it too hard or too softly"
        "Scale all masses to those of a body of this size.";
    /// An inertia does not match shape and mass.
    InertiaOutOfProportion "inertia-out-of-proportion" Warning
        "the body turns too easily or too slowly for its mass and size"
        "Take the inertia of its shape at its mass.";
    /// A spring oscillates faster than a step can follow.
    StiffnessAboveNyquist "stiffness-above-nyquist" Warning
        "a spring that swings faster than twice per two substeps cannot be followed"
        "Lower it to half of what the substep can follow, or take more substeps.";
    /// Skin is far from every body that moves it.
    SkinUncovered "skin-uncovered" Warning
        "skin that no shape is near lies in floors and walls: hair, clothes or gear without a body, or a limb that got none"
        "Give what sticks out a body (`--body`), say that it is no part of the body (`--ignore`), or enlarge the shape there.";
    /// A fall stretches the skin.
    SkinTorn "skin-torn" Warning
        "joints move skin that no body near it carries, so that it stays behind when the body falls"
        "Give the joint that stays behind a body (`--body`), or say what it is (`--role`).";
    /// Left and right differ.
    SkinLopsided "skin-lopsided" Warning
        "the two sides got bodies of different length, size or mass, so that it falls to one side"
        "Set shape, scale or mass of both by the role without its side, or give the missing part a body.";
    /// A part is attached to a body from which its skin does not grow.
    LimbApart "limb-apart" Warning
        "the rig has a part of a limb beside the body, as controls of inverse kinematics do, and it was hung elsewhere"
        "Say with `--role` which part of a human's limb it is, or leave it without a body (`--no-body`).";
    /// The drawn size differs from the bound size.
    DrawnResized "drawn-resized" Warning
        "the nodes' own transforms scale the skin otherwise than its bind matrices, so that it sinks in or floats"
        "Apply scales in the modelling tool and export the rig anew.";
    /// The skin is in the floor, or above it.
    SkinOffFloor "skin-off-floor" Warning
        "a part of the skin without a shape around it lies in the floor, or a shape outside the skin keeps it above"
        "Give that part a body (`--body`), leave it out (`--ignore`), or change the shape's `scale` in settings.";
    /// The ragdoll lies still without touching anything.
    RestsInAir "rests-in-air" Warning
        "it came to rest on nothing"
        "Report it with the file: a ragdoll that is not held must fall.";
    /// The rig's unit was not a metre.
    UnitInferred "unit-inferred" Note
        "the file's unit is not a metre, so that its length was inferred from the size of the body"
        "Give `unit_scale` or `height` in settings (`--unit`, `--height`) if it is another.";
    /// The role of a bone is little more than a guess.
    RoleUncertain "role-uncertain" Note
        "name and shape of the rig do not show clearly which part of the body a bone is"
        "Check whether the role is right, and edit the definition if it is not.";
}
