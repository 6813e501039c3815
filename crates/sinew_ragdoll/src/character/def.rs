//! Definition that characters of one kind share.

use super::clearance::Clearance;
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
    /// The character travels on with each lap. A clip that ends where it began stays in place.
    ByClip,
    /// Exactly as the clip has it, at the place where the character was put: the clip is not raised onto its floor, no ground lifts the character,
    /// and its feet are not moved to the ground. For an animation that was made for this very world.
    Exact,
    /// The clip walks on the spot; the character advances along its facing at this speed, m/s.
    Forward {
        /// m/s; negative walks backwards.
        speed: f32,
    },
}

/// Action of a limp character once it lies still.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AfterSettling {
    /// It gets up by the clip that fits its pose; without such a clip it fades to its looped clip, standing.
    GetUp,
    /// It stays where it is.
    StayDown,
}

/// First action of a character that lies unlike the start of all get-up clips.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GettingReady {
    /// Nothing: the difference is blended out during the clip.
    AtOnce,
    /// It is rolled over and its limbs are driven to the start of the nearest clip, within bounds of force and time.
    RollOver,
}

/// Treatment of floor and feet during the transitions to a get-up clip and to what follows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GroundContact {
    /// None: the pose difference decays smoothly in every joint, and limbs may pass through the floor. Default.
    #[default]
    AsBlended,
    /// The drawn skin stays out of the floor, as far as in the poses before and after, and feet step to their new
    /// places. Motions are quicker then.
    Enforced,
}

/// Pose or clip of a character before anything has happened to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Opening {
    /// It plays its looped clip.
    Looped,
    /// It stands in its rest pose; the looped clip plays after getting up.
    Rest,
}

/// Motions of a kind of character. Default: none, it stands in its rest pose.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionSet {
    /// All motions, for the indices below.
    pub clips: Vec<Clip>,
    /// The clip that loops while the character is animated; `None`: it stands in its rest pose. Default none.
    pub looped: Option<usize>,
    /// Clips that loop at higher speeds than the looped one (a jog, a run), each with its locomotion. If
    /// [`Character::set_move`](super::Character::set_move) moves the character, the two with neighbouring speeds are
    /// blended, in step by their first events with the payload `left`. Clips that cover no ground are skipped. Default
    /// none.
    pub faster: Vec<(usize, Locomotion)>,
    /// The clip that loops at rest, if [`Character::set_move`](super::Character::set_move) moves it; `None`: the looped
    /// clip stops. Default none.
    pub idle: Option<usize>,
    /// Clips that start lying and end standing. Their mirror images are used, too. Default none.
    pub get_ups: Vec<usize>,
    /// Clip moments for [`CharacterEvent::Clip`](super::CharacterEvent::Clip), each with the index of its clip: steps,
    /// punches. Default none.
    pub events: Vec<(usize, sinew_anim::ClipEvent)>,
    /// Default in place.
    pub locomotion: Locomotion,
    /// Default: the looped clip.
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
    /// Its bodies and joints; the mapping was built from these, so other bodies need another definition.
    pub ragdoll: RagdollDef,
    /// Default get up.
    pub after_settling: AfterSettling,
    /// Default roll over.
    pub getting_ready: GettingReady,
    /// Default as blended.
    pub ground_contact: GroundContact,
    /// Drive mode of its bodies while it falls: powered, toward the pose that its clips go on with. Default limp.
    pub falling: DriveMode,
    /// Seconds after which a limp character gets up even if it still moves. Default 6.
    pub patience: f32,
    /// Surface and filter of its bodies.
    pub body_settings: BodySettings,
    /// Bound on the speeds that an animation hands over.
    pub speed_bound: SpeedBound,
    /// Its share of a world while its clips move it.
    pub in_world: InWorld,
    mapping: Mapping,
    rest: Vec<LocalTransform>,
    /// Bind pose in character space, metres.
    bind: Vec<Affine>,
    /// Its legs, if it is a humanoid.
    legs: Option<Legs>,
    /// Points of its skin that meet the floor first.
    pub(super) clearance: Arc<Clearance>,
    /// Hair and the like, which swing.
    springs: SpringRig,
    /// Capes and the like, which are cloth in the world.
    garments: GarmentRig,
    motions: MotionSet,
    /// Clips and stances built from the motions.
    moves: Arc<Moves>,
}

impl CharacterDef {
    /// A character without motions, with the springs that the rig states ([`set_springs`](Self::set_springs)). `bind_model` is `RigAnalysis::bind_model`.
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

    /// The fixed relations between rig and bodies.
    pub fn mapping(&self) -> &Mapping {
        &self.mapping
    }

    /// Sets its motions: builds all clips, and the mirror images of get-ups.
    ///
    /// # Errors
    /// If a clip cannot be played; the motions are unchanged then.
    ///
    /// # Panics
    /// If `looped`, `faster` or `get_ups` names a missing clip, or a channel moves a joint that the rig does not have.
    pub fn set_motions(&mut self, motions: MotionSet) -> Result<(), MotionError> {
        self.moves = Arc::new(Moves::new(self, &motions)?);
        self.motions = motions;
        Ok(())
    }

    /// Sets what a character does at first. Existing characters keep the old definition.
    pub fn set_opening(&mut self, opening: Opening) {
        self.motions.opening = opening;
    }

    /// Replaces its rig's springs. Existing characters keep the old definition.
    ///
    /// # Panics
    /// If they name a missing joint or collider.
    pub fn set_springs(&mut self, springs: &Springs) {
        let bind_model = self.bind_model();
        self.springs = SpringRig::new(&self.rig, &self.ragdoll, &self.mapping, &bind_model, springs);
    }

    /// Springs of this kind of character.
    pub fn springs(&self) -> &SpringRig {
        &self.springs
    }

    /// Sets its garments; their joints are removed from its springs. Existing characters keep the old definition.
    ///
    /// # Panics
    /// If they name a missing joint.
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

    /// Garments of this kind of character.
    pub fn garments(&self) -> &GarmentRig {
        &self.garments
    }

    /// Bind pose of every joint in model space.
    pub(super) fn bind_model(&self) -> Vec<Affine> {
        let model_from_character = self.mapping.character_from_model().inverse();
        self.bind.iter().map(|&bind| model_from_character * bind).collect()
    }

    /// Motions of this kind of character.
    pub fn motions(&self) -> &MotionSet {
        &self.motions
    }

    /// Animation set of its characters' animators: the clips of [`motions`](Self::motions), and derived ones.
    pub fn set(&self) -> &AnimationSet {
        &self.moves.set
    }

    /// The clip of that index in [`MotionSet::clips`], for an [`Animator`](sinew_anim::Animator).
    ///
    /// # Panics
    /// If there is no such clip.
    pub fn clip(&self, index: usize) -> ClipId {
        self.moves.clips[index]
    }

    /// The animator of a new character, with its looped clip if it opens by that, `phase` seconds in.
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

    /// Locomotion clips, slowest first: the looped one, then faster ones.
    pub(super) fn paces(&self) -> &[Pace] {
        &self.moves.paces
    }

    /// Sync group of its locomotion clips; none for a single clip.
    pub(super) fn sync_group(&self) -> Option<u8> {
        (self.paces().len() > 1).then_some(0)
    }

    /// Displacement by which its looped clip is brought to the place of the character, character space, metres: onto the
    /// floor of the rest pose ([`raised`](Self::raised)), and to its origin if the clip begins elsewhere.
    pub(crate) fn shift(&self) -> Vec3 {
        self.moves.shift
    }

    /// Height by which its looped clip is raised so that its lowest drawn point stands on the floor of the rest pose,
    /// metres; usually 0.
    pub fn raised(&self) -> f32 {
        self.moves.raised.looped
    }

    pub(super) fn legs(&self) -> Option<&Legs> {
        self.legs.as_ref()
    }

    pub(super) fn clearance(&self) -> &Clearance {
        &self.clearance
    }

    pub(super) fn moves(&self) -> &Moves {
        &self.moves
    }

    /// Bind pose of every joint in character space, metres.
    pub(crate) fn bind(&self) -> &[Affine] {
        &self.bind
    }

    /// Rest pose of the file.
    pub fn rest(&self) -> &[LocalTransform] {
        &self.rest
    }

    /// Index of the body that has this role or carries this joint (by name), merged joints included.
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
