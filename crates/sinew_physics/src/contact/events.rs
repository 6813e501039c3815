//! Events reported by a step.

use crate::contact::hits::Hit;
use crate::id::{BodyId, GroupId, JointId, ShapeId};
use sinew_math::Vec3;

/// Events of the last step. Every list is in the order of pairs: by the two body indices, the smaller one first, then
/// by the two shape numbers. The order does not depend on the number of threads or on loading a snapshot.
///
/// Two shapes **touch** while their surfaces overlap at the start of the step, or if they pushed each other in the
/// previous step. Shapes that a step brings together are reported by the next step, even if they separate immediately.
/// Touching ends at a gap of half a millimetre, or 0.2 % of the smaller shape's smallest extent if that is less. Two
/// bodies touch while any of their shapes do. Each touch has exactly one begin and one end event, for each possible end
/// of the touch: motion, teleport, removal (the id is stale then), a filter or pair change, quarantine. Falling asleep
/// does not end a touch.
#[derive(Clone, Debug, Default, PartialEq)]
#[doc(alias = "collision events")]
#[doc(alias = "OnCollisionEnter")]
#[doc(alias = "CollisionEvent")]
pub struct Events {
    /// Pairs of bodies that started to touch, including ghosts and bodies that pass a one-way shape.
    pub begin: Vec<(BodyId, BodyId)>,
    /// Pairs of bodies that stopped touching.
    pub end: Vec<(BodyId, BodyId)>,
    /// Pairs of shapes that started to touch.
    pub shapes_begin: Vec<(ShapeId, ShapeId)>,
    /// Pairs of shapes that stopped touching.
    pub shapes_end: Vec<(ShapeId, ShapeId)>,
    /// Pairs of shapes that approached faster than [`WorldDef::hit_speed`](crate::WorldDef::hit_speed) and were
    /// stopped.
    pub hits: Vec<Hit>,
    /// Pairs of bodies of which one entered a sensor of the other.
    ///
    /// A sensor detects the solid shapes of static, kinematic, dynamic and sleeping bodies, unless both bodies are
    /// static. Sensors do not detect each other.
    pub sensor_begin: Vec<(BodyId, BodyId)>,
    /// Pairs of bodies of which one left a sensor of the other.
    pub sensor_end: Vec<(BodyId, BodyId)>,
    /// Pairs of a sensor and a shape that entered it.
    pub sensor_shapes_begin: Vec<(ShapeId, ShapeId)>,
    /// Pairs of a sensor and a shape that left it.
    pub sensor_shapes_end: Vec<(ShapeId, ShapeId)>,
    /// Bodies whose state became non-finite: reset to their state before the step, stopped and disabled.
    pub quarantined: Vec<BodyId>,
    /// Bodies that were slowed to [`WorldDef::max_speed`](crate::WorldDef::max_speed) or
    /// [`WorldDef::max_turn`](crate::WorldDef::max_turn), by index: a force or an impulse was too large, or a fall too
    /// long. Also kinematic bodies at 1e6 m/s or 1e6 rad/s, the largest components of their velocity.
    pub limited: Vec<BodyId>,
    /// Groups with particles whose state became non-finite: these particles stop at their positions before the step.
    pub rolled_back: Vec<GroupId>,
    /// Kinematic bodies that forces, impulses or explosions acted on since the last step, by index. These do not move
    /// kinematic bodies, but characters react to them. Forces of fields and lasting forces are not included.
    pub pushed: Vec<Push>,
    /// Joints that broke, in the order of joint indices. They still exist, but are disabled.
    pub broken: Vec<JointId>,
}

/// Impulse on a kinematic body in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Push {
    /// Body that was pushed.
    pub body: BodyId,
    /// Sum of the impulses, N·s, world axes.
    pub impulse: Vec3,
    /// Sum of the angular impulses about the centre of mass, N·m·s, world axes.
    pub angular_impulse: Vec3,
}
