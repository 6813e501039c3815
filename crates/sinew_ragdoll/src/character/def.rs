//! Definition that characters of one kind share.

use super::clearance::Clearance;
use super::foot_bodies::FootBodies;
use super::in_world::InWorld;
use super::legs::Legs;
use super::moves::{MotionError, Moves, Pace};
use crate::def::RagdollDef;
use crate::drive::DriveMode;
use crate::garments::GarmentRig;
use crate::hand_over::SpeedBound;
use crate::mapping::Mapping;
use crate::ragdoll::BodySettings;
use crate::springs::SpringRig;
use sinew_anim::{
    AnimationSet, Animator, Clip, ClipId, Garment, LocalTransform, Rig, Springs, TrackDef, TrackId, rest_pose,
};
use sinew_math::{Affine, Vec3};
use std::sync::Arc;

/// Motion of a character over the ground while its looped clip plays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Locomotion {
    /// The character returns to the clip's start with each lap.
    InPlace,
    /// The character moves with the clip from lap to lap. A clip that ends where it began stays in place.
    ByClip,
    /// The character moves exactly as in the clip, from its start position: the clip is not raised onto its floor, no
    /// ground lifts the character, and its feet are not moved to the ground. For an animation that was made for this
    /// world.
    Exact,
    /// The clip walks on the spot; the character advances along its facing at this speed, m/s.
    Forward {
        /// Speed along the facing, m/s; negative walks backwards.
        speed: f32,
    },
}

/// Action of a limp character once it lies still.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AfterSettling {
    /// The character gets up by the clip that fits its pose; without such a clip it fades to its looped clip, standing.
    GetUp,
    /// The character stays where it is.
    StayDown,
}

/// First action of a character whose pose differs from the start of all get-up clips.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GettingReady {
    /// The character gets up without preparation: the difference is blended out during the clip.
    AtOnce,
    /// The character is rolled over and its limbs are driven to the start of the nearest clip, within bounds of force
    /// and time.
    RollOver,
}

/// Treatment of floor and feet during the transitions to a get-up clip and to the following clip.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GroundContact {
    /// Floor and feet are not treated: the pose difference decays smoothly in every joint, and limbs may pass through
    /// the floor. Default.
    #[default]
    AsBlended,
    /// The drawn skin stays out of the floor as far as it does in the poses before and after, and feet step to their
    /// new positions. Motions are faster then.
    Enforced,
}

/// First pose or clip of a new character.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Opening {
    /// The character plays its looped clip.
    Looped,
    /// The character stands in its rest pose; the looped clip plays after getting up.
    Rest,
}

/// Motions of a kind of character. Default: no motions, so that the character stands in its rest pose.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionSet {
    /// All motions, to which the indices below refer.
    pub clips: Vec<Clip>,
    /// Clip that loops while the character is animated; `None`: the character stands in its rest pose. Default none.
    pub looped: Option<usize>,
    /// Clips that loop at higher speeds than the looped one (a jog, a run), each with its locomotion. If
    /// [`Character::set_move`](super::Character::set_move) moves the character, the two with neighbouring speeds are
    /// blended, in step by their first events with the payload `left`. Clips that cover no ground are skipped. Default
    /// none.
    pub faster: Vec<(usize, Locomotion)>,
    /// Clip that loops at rest, if [`Character::set_move`](super::Character::set_move) moves the character; `None`: the
    /// looped clip stops. Default none.
    pub idle: Option<usize>,
    /// Clips that start lying and end standing. Their mirror images are used, too. Default none.
    pub get_ups: Vec<usize>,
    /// Clip moments for [`CharacterEvent::Clip`](super::CharacterEvent::Clip), each with the index of its clip: steps,
    /// punches. Default none.
    pub events: Vec<(usize, sinew_anim::ClipEvent)>,
    /// Locomotion of the looped clip. Default in place.
    pub locomotion: Locomotion,
    /// First pose or clip. Default: the looped clip.
    pub opening: Opening,
}

impl Default for MotionSet {
    fn default() -> Self {
        Self {
            clips: Vec::new(),
            looped: None,
            faster: Vec::new(),
            idle: None,
            get_ups: Vec::new(),
            events: Vec::new(),
            locomotion: Locomotion::InPlace,
            opening: Opening::Looped,
        }
    }
}

/// Rig, ragdoll and motions of a kind of character. Immutable once shared.
#[derive(Clone, Debug)]
pub struct CharacterDef {
    /// The file's nodes, skins and meshes.
    pub rig: Rig,
    /// Bodies and joints. The mapping was built from these, so other bodies need another definition.
    pub ragdoll: RagdollDef,
    /// Action of a limp character once it lies still. Default get up.
    pub after_settling: AfterSettling,
    /// First action before a get-up. Default roll over.
    pub getting_ready: GettingReady,
    /// Treatment of the floor in transitions. Default as blended.
    pub ground_contact: GroundContact,
    /// Drive mode of the bodies while a character falls: powered, toward the pose with which its clips continue.
    /// Default limp.
    pub falling: DriveMode,
    /// Seconds after which a limp character gets up even if it still moves. Default 6.
    pub patience: f32,
    /// Surface and filter of the bodies.
    pub body_settings: BodySettings,
    /// Largest speeds that an animation hands over to the bodies.
    pub speed_bound: SpeedBound,
    /// Interaction with a world while clips move a character.
    pub in_world: InWorld,
    mapping: Mapping,
    rest: Vec<LocalTransform>,
    /// Bind pose in character space, metres.
    bind: Vec<Affine>,
    /// Legs, if the rig is a humanoid.
    legs: Option<Legs>,
    /// Points of the skin that reach the floor first.
    pub(super) clearance: Arc<Clearance>,
    pub(super) foot_bodies: Arc<FootBodies>,
    /// Springs, such as hair.
    springs: SpringRig,
    /// Garments, such as capes, which are cloth in the world.
    garments: GarmentRig,
    motions: MotionSet,
    /// Clips and stances built from the motions.
    moves: Arc<Moves>,
}

impl CharacterDef {
    /// Creates a character without motions, with the springs that the rig declares
    /// ([`set_springs`](Self::set_springs)). `bind_model` is `RigAnalysis::bind_model`.
    ///
    /// # Panics
    /// As [`Mapping::new`].
    pub fn new(rig: Rig, ragdoll: RagdollDef, bind_model: &[Affine]) -> Self {
        let mapping = Mapping::new(&rig, &ragdoll, bind_model);
        let root = mapping.character_from_model();
        let bind: Vec<Affine> = bind_model.iter().map(|&bind| root * bind).collect();
        Self {
            springs: SpringRig::new(&rig, &ragdoll, &mapping, bind_model, &rig.springs),
            garments: GarmentRig::default(),
            legs: Legs::of(&rig, &ragdoll, &bind),
            clearance: Arc::new(Clearance::of(&rig, &ragdoll, bind_model)),
            foot_bodies: Arc::new(FootBodies::of(&rig, &ragdoll, bind_model)),
            moves: Arc::new(Moves::none(&rig, &ragdoll, &mapping)),
            in_world: InWorld::of(&ragdoll),
            mapping,
            bind,
            motions: MotionSet::default(),
            rest: rest_pose(&rig),
            rig,
            ragdoll,
            after_settling: AfterSettling::GetUp,
            getting_ready: GettingReady::RollOver,
            ground_contact: GroundContact::default(),
            falling: DriveMode::Limp,
            patience: 6.0,
            body_settings: BodySettings::default(),
            speed_bound: SpeedBound::default(),
        }
    }

    /// Returns the fixed relations between rig and bodies.
    pub fn mapping(&self) -> &Mapping {
        &self.mapping
    }

    /// Sets the motions: builds all clips, and the mirror images of get-ups.
    ///
    /// # Errors
    /// If a clip cannot be played; the motions then do not change.
    ///
    /// # Panics
    /// If `looped`, `faster` or `get_ups` names a missing clip, or a channel moves a joint that the rig does not have.
    pub fn set_motions(&mut self, motions: MotionSet) -> Result<(), MotionError> {
        self.moves = Arc::new(Moves::new(self, &motions)?);
        self.motions = motions;
        Ok(())
    }

    /// Sets the first pose or clip of new characters. Existing characters keep the old definition.
    pub fn set_opening(&mut self, opening: Opening) {
        self.motions.opening = opening;
    }

    /// Replaces the rig's springs. Existing characters keep the old definition.
    ///
    /// # Panics
    /// If the springs name a missing joint or collider.
    pub fn set_springs(&mut self, springs: &Springs) {
        let bind_model = self.bind_model();
        self.springs = SpringRig::new(&self.rig, &self.ragdoll, &self.mapping, &bind_model, springs);
    }

    /// Returns the springs of this kind of character.
    pub fn springs(&self) -> &SpringRig {
        &self.springs
    }

    /// Sets the garments; their joints are removed from the springs. Existing characters keep the old definition.
    ///
    /// # Panics
    /// If the garments name a missing joint.
    pub fn set_garments(&mut self, garments: &[Garment]) {
        let bind_model = self.bind_model();
        self.garments = GarmentRig::new(&self.rig, &self.ragdoll, &self.mapping, &bind_model, garments);
        let mut is_worn = vec![false; self.rig.joints.len()];
        self.garments.joints().for_each(|joint| is_worn[joint] = true);
        let mut springs = self.springs.source().clone();
        springs.chains.iter_mut().for_each(|chain| chain.bones.retain(|bone| !is_worn[bone.joint]));
        springs.chains.retain(|chain| !chain.bones.is_empty());
        if springs != *self.springs.source() {
            self.set_springs(&springs);
        }
    }

    /// Returns the garments of this kind of character.
    pub fn garments(&self) -> &GarmentRig {
        &self.garments
    }

    /// Returns the bind pose of every joint in model space.
    pub(super) fn bind_model(&self) -> Vec<Affine> {
        let model_from_character = self.mapping.character_from_model().inverse();
        self.bind.iter().map(|&bind| model_from_character * bind).collect()
    }

    /// Returns the motions of this kind of character.
    pub fn motions(&self) -> &MotionSet {
        &self.motions
    }

    /// Returns the animation set of the characters' animators: the clips of [`motions`](Self::motions), and derived
    /// ones.
    pub fn set(&self) -> &AnimationSet {
        &self.moves.set
    }

    /// Returns the clip of that index in [`MotionSet::clips`], for an [`Animator`](sinew_anim::Animator).
    ///
    /// # Panics
    /// If there is no such clip.
    pub fn clip(&self, index: usize) -> ClipId {
        self.moves.clips[index]
    }

    /// Returns the animator of a new character, `phase` seconds into its looped clip if it opens with this clip.
    pub(super) fn opening(&self, phase: f32) -> Animator {
        let mut animator = Animator::new(self.set());
        if self.motions.opening == Opening::Looped {
            self.play_looped(&mut animator, phase);
        }
        animator.update(self.set(), 0.0);
        animator
    }

    /// Starts the looped clip, if there is one, `phase` seconds in.
    pub(super) fn play_looped(&self, animator: &mut Animator, phase: f32) -> Option<TrackId> {
        let clip = self.clip(self.motions.looped?);
        let sync_group = self.sync_group();
        Some(animator.play(self.set(), &TrackDef { start: phase, sync_group, ..TrackDef::new(clip) }))
    }

    /// Returns the locomotion clips, slowest first: the looped one, then faster ones.
    pub(super) fn paces(&self) -> &[Pace] {
        &self.moves.paces
    }

    /// Returns the sync group of the locomotion clips; none for a single clip.
    pub(super) fn sync_group(&self) -> Option<u8> {
        (self.paces().len() > 1).then_some(0)
    }

    /// Returns the displacement of the looped clip to the position of the character, character space, metres: onto the
    /// floor of the rest pose ([`raised`](Self::raised)), and to the character's origin if the clip begins elsewhere.
    pub(crate) fn shift(&self) -> Vec3 {
        self.moves.shift
    }

    /// Returns the height by which the looped clip is raised so that its lowest drawn point is on the floor of the rest
    /// pose, metres; usually 0.
    pub fn raised(&self) -> f32 {
        self.moves.raised.looped
    }

    pub(super) fn legs(&self) -> Option<&Legs> {
        self.legs.as_ref()
    }

    pub(super) fn clearance(&self) -> &Clearance {
        &self.clearance
    }

    pub(super) fn foot_bodies(&self) -> &FootBodies {
        &self.foot_bodies
    }

    pub(super) fn moves(&self) -> &Moves {
        &self.moves
    }

    /// Returns the bind pose of every joint in character space, metres.
    pub(crate) fn bind(&self) -> &[Affine] {
        &self.bind
    }

    /// Returns the rest pose of the file.
    pub fn rest(&self) -> &[LocalTransform] {
        &self.rest
    }

    /// Returns the index of the body that has this role or carries this joint (by name), merged joints included.
    pub fn body_named(&self, name: &str) -> Option<usize> {
        let bodies = &self.ragdoll.bodies;
        let carries = |joint: usize| self.rig.joints.get(joint).is_some_and(|joint| joint.name == name);
        bodies
            .iter()
            .position(|body| body.role == name)
            .or_else(|| bodies.iter().position(|body| body.bone == name))
            .or_else(|| bodies.iter().position(|body| body.merged.iter().any(|&joint| carries(joint))))
    }
}
