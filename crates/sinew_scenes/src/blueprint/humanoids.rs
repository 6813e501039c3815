//! The ragdoll of the mannequin as plain data, from which other engines and MuJoCo can build it.

use super::{Blueprint, BlueprintJoint};
use crate::mannequin::mannequin;
use crate::parts::{cuboid, fixed, floor};
use sinew::anim::analyze;
use sinew::math::{Random, Range, Rotation, SwingTwistLimit, Transform, Vec3, clamp, min};
use sinew::physics::{BodyDef, JointKind, Material, Shape, ShapeDef, Sleeping};
use sinew::ragdoll::{BuildOptions, RagdollDef, RagdollJointDef, build};

/// Friction coefficient of all bodies in these scenes: that of a ragdoll's bodies.
const FRICTION: f32 = 0.7;

/// Initial gap between a humanoid and the ground, metres.
const ABOVE: f32 = 0.05;

/// Half width of the pit of a heap of 100, metres: 16 humanoids fit in the pit side by side.
const PIT: f32 = 3.6;
/// Spacing of humanoids in a heap, metres, limited by the reach of their arms.
const APART: f32 = 1.8;

/// The mannequin's ragdoll with plain capsules. In its bind pose all joints are at zero, as blueprints require. A hinge
/// whose range excludes zero starts at the nearer end of its range.
pub fn humanoid() -> RagdollDef {
    let rig = mannequin().rig;
    let analysis = analyze(&rig).expect("the mannequin has a skin");
    let (mut def, _) = build(&rig, &analysis, &BuildOptions::default()).expect("the rig can be built");
    for body in &mut def.bodies {
        // Masses stay unchanged, because other engines have no tapered capsules.
        if let Shape::TaperedCapsule { half_height, radius_bottom, radius_top } = body.shape {
            body.shape = Shape::Capsule { half_height, radius: 0.5 * (radius_bottom + radius_top) };
        }
    }
    for joint in &def.joints {
        let turn = Rotation::from_axis_angle(Vec3::X, start_angle(joint.kind));
        let turned = joint.frame_parent * Transform::new(Vec3::ZERO, turn);
        let parent = def.bodies[joint.parent].character_from_body;
        let at = parent * turned * joint.frame_child.inverse();
        def.bodies[joint.child].character_from_body = Transform::new(at.translation, at.rotation.normalize());
    }
    def
}

/// Start angle of a joint's twist or hinge, radians.
fn start_angle(kind: JointKind) -> f32 {
    match kind {
        JointKind::Hinge { limit: Some(range) } => clamp(0.0, range.lo, range.hi),
        JointKind::Ball { limit: Some(limit) } => clamp(0.0, limit.twist.lo, limit.twist.hi),
        _ => 0.0,
    }
}

/// Limits of a humanoid in a blueprint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Limits {
    /// The ragdoll's own limits and joint friction.
    Own,
    /// Limits that every engine supports: round cones with the mean width of the ellipse, hinges, and no joint
    /// friction.
    Common,
}

/// A humanoid that lies on its back; sleeping is off.
pub fn humanoid_lying() -> Blueprint {
    let mut scene = Blueprint::new("humanoid_lying", Sleeping::Off, 600);
    scene.body(made_of_flesh(floor()));
    let on_its_back = Rotation::from_axis_angle(Vec3::X, -core::f32::consts::FRAC_PI_2);
    figure(&mut scene, &humanoid(), Transform::new(Vec3::Y * ABOVE, on_its_back), Limits::Own);
    scene
}

/// `count` humanoids fall into a pit and form one heap that does not sleep.
pub fn humanoid_pile(count: usize) -> Blueprint {
    heap("humanoid_pile", count, Limits::Own)
}

/// 100 humanoids fall into a pit and form one heap, with limits that every engine supports.
pub fn crowd_pile() -> Blueprint {
    heap("crowd_pile", 100, Limits::Common)
}

/// Builds a heap in layers, in a pit as wide as the heap is high.
fn heap(name: &'static str, count: usize, limits: Limits) -> Blueprint {
    let mut scene = Blueprint::new(name, Sleeping::Off, 600);
    scene.body(made_of_flesh(floor()));
    let side = if count > 30 { 4 } else { 2 };
    let half = PIT * side as f32 / 4.0;
    for out in [-1.0, 1.0].map(|side| side * (half + 0.5)) {
        for (x, z) in [(out, 0.0), (0.0, out)] {
            let along = |at: f32| if at == 0.0 { half + 1.0 } else { 0.5 };
            let wall = cuboid(Vec3::new(along(x), 2.0, along(z)), Vec3::new(x, 2.0, z));
            scene.body(made_of_flesh(fixed(wall)));
        }
    }
    let def = humanoid();
    let height = def.height + 0.3;
    let mut random = Random::new(1);
    let place = |index: usize| (index as f32 - 0.5 * (side - 1) as f32) * APART;
    for i in 0..count {
        let (layer, z, x) = (i / (side * side), i / side % side, i % side);
        let base = Vec3::new(place(x), ABOVE + height * layer as f32, place(z));
        let yaw = Rotation::from_axis_angle(Vec3::Y, random.range(0.0, core::f32::consts::TAU));
        figure(&mut scene, &def, Transform::new(base, yaw), limits);
    }
    scene
}

fn made_of_flesh(mut def: BodyDef) -> BodyDef {
    for shape in &mut def.shapes {
        shape.material = Material { friction: FRICTION, ..Material::DEFAULT };
    }
    def
}

/// Adds a humanoid with the rotation of `stand`, its lowest point at the height of `stand`.
fn figure(scene: &mut Blueprint, def: &RagdollDef, stand: Transform, limits: Limits) {
    let turned =
        |index: usize| Transform::new(Vec3::ZERO, stand.rotation) * def.bodies[index].character_from_body;
    let lowest =
        (0..def.bodies.len()).map(|i| def.bodies[i].shape.aabb(&turned(i)).min.y).fold(f32::INFINITY, min);
    let lift = Transform::from_translation(stand.translation - Vec3::Y * lowest);
    let first = scene.bodies.len();
    for (index, body) in def.bodies.iter().enumerate() {
        let at = lift * turned(index);
        let mut placed = made_of_flesh(BodyDef {
            position: at.translation,
            rotation: at.rotation.normalize(),
            angular_damping: 0.05,
            shapes: vec![ShapeDef::new(body.shape.clone())],
            mass: Some(body.mass),
            ..BodyDef::default()
        });
        placed.user_data = index as u64;
        scene.body(placed);
    }
    for joint in &def.joints {
        let turn = Rotation::from_axis_angle(Vec3::X, start_angle(joint.kind));
        let frame = joint.frame_parent * Transform::new(Vec3::ZERO, turn);
        let world_from_joint = lift * turned(joint.parent) * frame;
        scene.joints.push(BlueprintJoint {
            a: first + joint.parent,
            b: first + joint.child,
            world_from_joint: Transform::new(
                world_from_joint.translation,
                world_from_joint.rotation.normalize(),
            ),
            kind: kind(joint, limits),
            friction_torque: if limits == Limits::Own { joint.friction_torque } else { 0.0 },
        });
    }
    scene.apart.extend(def.disabled_pairs.iter().map(|&(a, b)| (first + a, first + b)));
}

/// Returns the joint's kind with its start pose as zero, with the requested limits.
fn kind(joint: &RagdollJointDef, limits: Limits) -> JointKind {
    let start = start_angle(joint.kind);
    let from_start = |range: Range| Range::new(range.lo - start, range.hi - start);
    match (joint.kind, limits) {
        (JointKind::Hinge { limit }, _) => JointKind::Hinge { limit: limit.map(from_start) },
        (JointKind::Ball { limit: Some(limit) }, Limits::Own) => {
            JointKind::Ball { limit: Some(SwingTwistLimit { twist: from_start(limit.twist), ..limit }) }
        }
        (JointKind::Ball { limit: Some(limit) }, Limits::Common) => {
            JointKind::Ball { limit: Some(rounded(&limit, from_start(limit.twist))) }
        }
        // The twist is locked. Other engines have a range for it, which may be small.
        (JointKind::Universal { limit: Some(limit) }, Limits::Common) => {
            JointKind::Ball { limit: Some(rounded(&limit, Range::symmetric(LOCKED))) }
        }
        (kind, _) => kind,
    }
}

/// Range of a locked twist, radians (1°).
const LOCKED: f32 = 0.0175;

/// Replaces an elliptic cone by a round one of the same area, to first order.
fn rounded(limit: &SwingTwistLimit, twist: Range) -> SwingTwistLimit {
    let half = |range: Range| 0.5 * (range.hi - range.lo);
    let cone = Range::symmetric((half(limit.swing_y) * half(limit.swing_z)).sqrt());
    SwingTwistLimit { swing_y: cone, swing_z: cone, twist }
}

/// Indices in a blueprint of the first body of each humanoid.
pub fn roots(scene: &Blueprint) -> Vec<usize> {
    scene.dynamic().filter(|&place| scene.joints.iter().all(|joint| joint.b != place)).collect()
}
