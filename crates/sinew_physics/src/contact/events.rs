//! Events that a step tells of.

use crate::contact::hits::Hit;
use crate::id::{BodyId, GroupId, JointId, ShapeId};

/// Events of the last step. Every list is in the order of pairs: by the two body indices, the smaller one first, then
/// by the two shape numbers; so it is the same for any number of threads, and after a snapshot was loaded.
///
/// Two shapes **touch** while their surfaces overlap or meet, as the bodies lie when the step begins, and if they pushed each
/// other in the step before: those that a step brings together are told of by the next, also if they part at once. They go on touching until there is
/// a gap of half a millimetre, or 0.2 % of the smaller one's smallest extent if that is less. Two bodies touch while any of their shapes do. Each pair is told of once when it
/// begins and once when it ends, however it ends: a body that moved away, was put elsewhere or taken out (its id is stale
/// then), a filter or a pair that was changed, trouble that takes a body out of the simulation. Falling asleep ends nothing:
/// what sleeps goes on touching.
#[derive(Clone, Debug, Default, PartialEq)]
#[doc(alias = "collision events")]
#[doc(alias = "OnCollisionEnter")]
#[doc(alias = "CollisionEvent")]
pub struct Events {
    /// Pairs of bodies that began to touch, ghosts and what passes a one-way shape among them.
    pub begin: Vec<(BodyId, BodyId)>,
    /// Pairs of bodies that stopped.
    pub end: Vec<(BodyId, BodyId)>,
    /// Pairs of shapes that began to touch.
    pub shapes_begin: Vec<(ShapeId, ShapeId)>,
    /// Pairs of shapes that stopped.
    pub shapes_end: Vec<(ShapeId, ShapeId)>,
    /// Pairs of shapes that came in faster than [`WorldDef::hit_speed`](crate::WorldDef::hit_speed) and were stopped.
    pub hits: Vec<Hit>,
    /// Pairs of bodies of which one began to be inside a sensor of the other.
    ///
    /// A sensor sees the solid shapes of static, kinematic, dynamic and sleeping bodies, if one of the two bodies is not
    /// static. Sensors do not see each other.
    pub sensor_begin: Vec<(BodyId, BodyId)>,
    /// Pairs of bodies of which one stopped being inside a sensor of the other.
    pub sensor_end: Vec<(BodyId, BodyId)>,
    /// Pairs of shapes, one of them a sensor, of which one began to be inside the other.
    pub sensor_shapes_begin: Vec<(ShapeId, ShapeId)>,
    /// Pairs of shapes, one of them a sensor, of which one stopped being inside the other.
    pub sensor_shapes_end: Vec<(ShapeId, ShapeId)>,
    /// Bodies whose state became non-finite: rolled back to the step before, stopped and taken out of the simulation.
    pub quarantined: Vec<BodyId>,
    /// Bodies that were slowed to [`WorldDef::max_speed`](crate::WorldDef::max_speed) or [`WorldDef::max_turn`](crate::WorldDef::max_turn),
    /// by index: a force or an impulse was too large, or a fall too long.
    pub limited: Vec<BodyId>,
    /// Groups with particles whose state became non-finite: those stopped where they were before the step.
    pub rolled_back: Vec<GroupId>,
    /// Joints that broke, in the order of joint indices. They are there, but disabled.
    pub broken: Vec<JointId>,
}
