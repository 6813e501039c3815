//! Animation as plain data and stateless jobs: rig, clips, poses, roles, captured motion.
//!
//! ```
//! use sinew_anim::{Channel, Clip, Interpolation, Joint, LocalTransform, Property, Rig, Wrap, rest_pose, sample};
//!
//! let arm = Joint { name: "arm".into(), parent: None, rest: LocalTransform::default(), source: 0 };
//! let rig = Rig { joints: vec![arm], ..Rig::default() };
//! // Up by 2 units in a second.
//! let up = Channel {
//!     joint: 0,
//!     property: Property::Translation,
//!     interpolation: Interpolation::Linear,
//!     times: vec![0.0, 1.0],
//!     values: vec![0.0, 0.0, 0.0, 0.0, 2.0, 0.0],
//! };
//! let clip = Clip { name: "up".into(), duration: 1.0, channels: vec![up] };
//! let mut pose = rest_pose(&rig);
//! sample(&clip, &rig, 0.25, Wrap::Clamp, &mut pose);
//! assert_eq!(pose[0].translation.y, 0.5);
//! ```
//!
//! A [`Rig`] has joints, skins and meshes, and a [`Clip`] moves its joints; [`analyze`] finds the body part of each
//! joint, and an [`Animator`] plays clips with transitions and layers.
//!
//! This crate depends on no physics, files or renderer. Rotations are [`sinew_math::Rotation`], times are seconds,
//! lengths are **file units** until [`roles`] gives metres per unit.
#![forbid(unsafe_code)]

pub mod animator;
pub mod built;
pub mod cleanup;
pub mod clip;
pub mod contact;
pub mod event;
pub mod garments;
pub mod ik;
pub mod learned_limits;
pub mod legs;
mod playback;
pub mod pose;
pub mod retarget;
pub mod riders;
pub mod rig;
pub mod roles;
pub mod set;
pub mod skinning;
pub mod springs;
mod tuning;
pub mod weights;

pub use animator::{Animator, Easing, EndAction, Track, TrackDef, TrackId, Transition};
pub use built::{BuiltClip, ClipBuildError, ClipBuildOptions, ClipError, Cursor, Fill};
pub use clip::reduce::{KeyBound, KeyError, Reduced, reduce_keys};
pub use clip::root_motion::{AxisExtraction, MotionTrack, RootMotionOptions, extract_root_motion};
pub use clip::sample::{SampleCache, Wrap, sample, sample_cached};
pub use clip::take::Take;
pub use clip::{Channel, Clip, Interpolation, Property};
pub use clip::{reduce, root_motion, sample, take};
pub use contact::FootContact;
pub use event::{ClipEvent, EventPolicy, FiredBy, FiredEvent, Footstep, FootstepMerger, FootstepSource};
pub use garments::{Garment, GarmentColumn, guess_garments};
pub use playback::blend_space::{weights_on_line, weights_on_plane};
pub use playback::inertial::{Decay, Inertia, Motion};
pub use playback::playhead::{Crossing, LoopMode, Passage, Playhead};
pub use playback::sync::{Markers, Phase};
pub use playback::{blend_space, inertial, playhead, sync};
pub use pose::{
    BlendLayer, BlendOptions, Blender, JointVelocity, Mask, ModelPose, Pose, RotationMean, Skeleton,
    WeightedPose, blend, crossfade, joint_velocities, local_to_model, rest_pose, smoothstep,
};
pub use rig::{Joint, JointIdx, LocalTransform, Primitive, Rig, RigMesh, Skin, TextureImage};
pub use roles::{
    Animal, Basis, Correction, CorrectionError, Gait, Hints, KeptBone, NoSkin, RigAnalysis, Role, RoleGuess,
    Side, UnitGuess, analyze, analyze_corrected, analyze_hinted, analyze_skeleton, characters,
};
pub use set::{AnimatedClip, AnimationSet, ClipId, MaskId};
pub use skinning::{skin_palette, skin_vertices};
pub use springs::{SpringBone, SpringChain, SpringCollider, SpringLimit, SpringLink, Springs, guess_springs};
pub use tuning::MAX_SPEED;
