//! Animation as plain data and stateless jobs: rig, clips, poses, roles, captured motion.
//!
//! Nothing here knows physics, files or a renderer. Rotations are [`sinew_math::Rotation`], times are seconds, lengths
//! are **file units** until [`roles`] has told how many metres one is.
#![forbid(unsafe_code)]

pub mod animator;
pub mod blend_space;
pub mod built;
pub mod cleanup;
pub mod clip;
pub mod contact;
pub mod event;
pub mod ik;
pub mod inertial;
pub mod learned_limits;
pub mod legs;
pub mod playhead;
pub mod pose;
pub mod reduce;
pub mod retarget;
pub mod rig;
pub mod roles;
pub mod root_motion;
pub mod sample;
pub mod set;
pub mod skinning;
pub mod sync;
pub mod take;

pub use animator::{Animator, Easing, EndAction, MAX_SPEED, Track, TrackDef, TrackId, Transition};
pub use blend_space::{weights_on_line, weights_on_plane};
pub use built::{BuildError, BuildOptions, BuiltClip, ClipError, Cursor, Fill};
pub use clip::{Channel, Clip, Interpolation, Property};
pub use contact::FootContact;
pub use event::{Event, EventPolicy, FiredBy, FiredEvent, Footstep, FootstepMerger, FootstepSource};
pub use inertial::{Decay, Inertia, Motion};
pub use playhead::{Crossing, LoopMode, Passage, Playhead};
pub use pose::{
    BlendLayer, BlendOptions, Blender, JointVelocity, Mask, ModelPose, Pose, RotationMean, Skeleton,
    WeightedPose, blend, crossfade, joint_velocities, local_to_model, rest_pose, smoothstep,
};
pub use reduce::{KeyBound, KeyError, Reduced, reduce_keys};
pub use rig::{Joint, JointIdx, LocalTransform, Mesh, Primitive, Rig, Skin, Texture};
pub use roles::{
    Basis, Correction, CorrectionError, Gait, Hints, KeptBone, NoSkin, RigAnalysis, Role, RoleGuess, Side,
    UnitGuess, analyze, analyze_corrected, analyze_hinted, analyze_skeleton, characters,
};
pub use root_motion::{AxisMotion, MotionTrack, RootMotionOptions, extract_root_motion};
pub use sample::{SampleCache, Wrap, sample, sample_cached};
pub use set::{AnimatedClip, AnimationSet, ClipId, MaskId};
pub use skinning::{skin_palette, skin_vertices};
pub use sync::{Markers, Phase};
pub use take::Take;
