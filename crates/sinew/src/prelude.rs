//! The names that most programs need: `use sinew::prelude::*`.

pub use sinew_anim::{Clip, Rig, analyze};
pub use sinew_math::{
    Random, Range, ReadError, Reader, Rotation, SwingTwistLimit, Transform, Vec3, Writer, trig,
};
pub use sinew_physics::particles::{
    AttachmentDef, AttachmentTarget, BlobDef, ClothDef, GroupDef, RopeDef, StrandDef,
};
pub use sinew_physics::ray::Ray;
pub use sinew_physics::stage::NoProfiler;
pub use sinew_physics::{
    Aabb, BodyDef, BodyHit, BodyId, BodyKind, BodyKinds, BodyPenetration, BodyRef, BodySurface, Buoyancy,
    ContactRule, ContainsPoint, Corrections, DebugDraw, DrawKind, Events, Explosion, FieldDef, FieldId,
    FieldKind, Filter, ForceDef, Forces, GroupId, HeightField, HeightFieldDef, JointCollision, JointDef,
    JointId, JointKind, JointState, LockedAxes, MassProperties, MassUpdate, Material, Motor, MoverDef,
    MoverGround, MoverId, NearestTo, NearestToShape, Obb, ObjectId, OneWay, OverlapWith, PenetrationOf,
    PhysicsObject, Probe, Quality, Query, QueryFilter, QueryKind, Region, Sensing, Sensors, Serial, Shape,
    ShapeCast, ShapeDef, ShapeId, SixDof, Sleeping, Softness, Spring, Strength, Threads, Update, Velocity,
    Wind, World, WorldDef,
};
#[cfg(feature = "ragdoll")]
pub use sinew_ragdoll::{
    BodySettings, BodyState, BuildOptions, Character, CharacterDef, CharacterEvent, Detail, Grab, GrabPoint,
    Grip, Limb, MotionSet, Part, Preset, Ragdoll, RagdollDef, State, build,
};
