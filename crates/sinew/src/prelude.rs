//! The names that most programs need: `use sinew::prelude::*`.

pub use sinew_anim::{Clip, Rig, analyze};
pub use sinew_math::{Range, ReadError, Reader, Rotation, SwingTwistLimit, Transform, Vec3, Writer};
pub use sinew_physics::ray::Ray;
pub use sinew_physics::{
    Aabb, BodyDef, BodyHit, BodyId, BodyKind, BodyKinds, BodyPenetration, BodySurface, ContainsPoint,
    Corrections, DebugDraw, DrawKind, FieldDef, FieldKind, Filter, Forces, GroupId, JointDef, JointId,
    JointKind, Material, MoverDef, MoverGround, MoverId, NearestTo, NearestToShape, Obb, ObjectId,
    OverlapWith, PenetrationOf, PhysicsObject, Probe, Quality, Query, QueryFilter, Question, Sensing,
    Sensors, Shape, ShapeCast, ShapeDef, ShapeId, Sleeping, Update, Velocity, World, WorldDef,
};
#[cfg(feature = "ragdoll")]
pub use sinew_ragdoll::{
    BuildOptions, Character, CharacterDef, MotionSet, Part, Preset, Ragdoll, RagdollDef, build,
};
