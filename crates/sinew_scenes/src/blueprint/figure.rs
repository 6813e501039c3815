//! Many humanoids of 15 bodies each.

use super::{Blueprint, BlueprintJoint, box_pyramid_of, damped, in_box, rotation};
use crate::parts::{body, cuboid, fixed, tilt};
use sinew::math::{Random, Range, Rotation, SwingTwistLimit, Transform, Vec3};
use sinew::physics::{BodyDef, JointKind, Shape, Sleeping};

/// 100 humanoids fall into a heap on strewn boxes.
pub fn ragdoll_pile() -> Blueprint {
    const LAYERS: usize = 5;
    let mut scene = Blueprint::new("ragdoll_pile", Sleeping::Off, 600);
    scene.body(fixed(cuboid(Vec3::new(50.0, 0.5, 50.0), Vec3::NEG_Y * 0.5)));
    let mut random = Random::new(1);
    for _ in 0..50 {
        let half_extents = in_box(&mut random, 0.2, 0.8);
        let x = random.range(-5.0, 5.0);
        let y = random.range(0.0, 0.5);
        let z = random.range(-6.0, 6.0);
        let mut obstacle = cuboid(half_extents, Vec3::new(x, y, z));
        obstacle.rotation = rotation(&mut random);
        scene.body(fixed(obstacle));
    }
    for i in 0..LAYERS * 20 {
        let (layer, z, x) = (i / 20, i / 4 % 5, i % 4);
        let base = Vec3::new((x as f32 - 1.5) * 2.0, 2.5 + 2.0 * layer as f32, (z as f32 - 2.0) * 2.0);
        figure(&mut scene, base, random.range(0.0, core::f32::consts::TAU));
    }
    scene
}

/// `count` humanoids in a column are thrown down onto each other and form a small heap.
pub fn ragdoll_column(count: usize) -> Blueprint {
    /// Initial downward speed, m/s.
    const DOWN: f32 = 8.0;
    let mut scene = Blueprint::new("ragdoll_column", Sleeping::Off, 60);
    scene.body(fixed(cuboid(Vec3::new(50.0, 0.5, 50.0), Vec3::NEG_Y * 0.5)));
    let mut random = Random::new(1);
    for i in 0..count {
        figure(&mut scene, Vec3::Y * 1.9 * i as f32, random.range(0.0, core::f32::consts::TAU));
    }
    for place in scene.dynamic().collect::<Vec<_>>() {
        scene.bodies[place].linear_velocity = Vec3::NEG_Y * DOWN;
    }
    scene
}

/// A pyramid of `layers` layers of unit cubes, and a humanoid that falls on the pyramid.
pub fn ragdoll_on_boxes(layers: usize) -> Blueprint {
    let mut scene = Blueprint { name: "ragdoll_on_boxes", steps: 60, ..box_pyramid_of(layers) };
    figure(&mut scene, Vec3::Y * (layers as f32 + 0.05), 0.0);
    scene
}

/// 300 humanoids fall on 10 × 10 boxes, three on each; each column of boxes is hit later than the one before.
///
/// Modelled on Box3D's `rain`, whose humanoids are created during the run and fall on triangle meshes. Here all start
/// in the air.
pub fn rain() -> Blueprint {
    const CELLS: usize = 10;
    /// Width of the cell of three humanoids, metres.
    const CELL: f32 = 15.0;
    let mut scene = Blueprint::new("rain", Sleeping::On, 600);
    let half = 0.5 * CELL * CELLS as f32;
    scene.body(fixed(cuboid(Vec3::new(half, 0.5, half), Vec3::NEG_Y * 0.5)));
    let place = |index: usize| (index as f32 + 0.5) * CELL - half;
    let cells = || (0..CELLS).flat_map(|row| (0..CELLS).map(move |column| (row, column)));
    for (row, column) in cells() {
        let mut obstacle = cuboid(Vec3::new(2.0, 0.5, 2.0), Vec3::new(place(column), 0.5, place(row)));
        obstacle.rotation = tilt(10.0);
        scene.body(fixed(obstacle));
    }
    let mut random = Random::new(1);
    for (row, column) in cells() {
        for i in 0..3 {
            let x = place(column) + 0.75 * (i as f32 - 1.0);
            let base = Vec3::new(x, 2.0 + 2.0 * column as f32, place(row));
            figure(&mut scene, base, random.range(0.0, core::f32::consts::TAU));
        }
    }
    scene
}

/// 8 humanoids with joint friction fall from 15 m on two by two cells of 15 m, each with a tilted box at its centre.
///
/// Modelled on Box3D's falling ragdolls, which verify repeatability by the step at which all sleep. Those fall on
/// meshes, and have springs in their joints.
pub fn ragdolls() -> Blueprint {
    const CELL: f32 = 15.0;
    /// Friction torque of a joint, N·m.
    const FRICTION: f32 = 5.0;
    let mut scene = Blueprint::new("ragdolls", Sleeping::On, 600);
    scene.body(fixed(cuboid(Vec3::new(CELL, 0.5, CELL), Vec3::NEG_Y * 0.5)));
    let cells =
        [(-0.5, -0.5), (0.5, -0.5), (-0.5, 0.5), (0.5, 0.5)].map(|(x, z)| Vec3::new(x, 0.0, z) * CELL);
    for cell in cells {
        let obstacle = cuboid(Vec3::new(2.0, 0.5, 2.0), cell + Vec3::Y * 0.5);
        scene.body(fixed(BodyDef { rotation: tilt(10.0), ..obstacle }));
    }
    let mut random = Random::new(1);
    for (cell, i) in cells.into_iter().flat_map(|cell| [0.0, 1.0].map(|i| (cell, i))) {
        let base = cell + Vec3::new(0.75 * (i - 0.5), 14.0, 0.0);
        figure(&mut scene, base, random.range(0.0, core::f32::consts::TAU));
    }
    for joint in &mut scene.joints {
        joint.friction_torque = FRICTION;
    }
    scene
}

/// Rotation that puts a body's length along x instead of y.
fn across() -> Rotation {
    tilt(90.0)
}

/// Adds a standing humanoid with its arms stretched out sideways: 15 bodies and 14 joints. Its soles are at `base`;
/// without `yaw` (radians about y) it faces +z, with its left toward +x.
fn figure(scene: &mut Blueprint, base: Vec3, yaw: f32) {
    figure_at(scene, Transform::new(base, Rotation::from_axis_angle(Vec3::Y, yaw)), 1.0);
}

/// Adds a humanoid as [`figure`] does, at any rotation and scaled by `scale`.
pub(super) fn figure_at(scene: &mut Blueprint, stand: Transform, scale: f32) {
    let mut figure = Figure { scene, stand, scale };
    let pelvis = figure.cuboid([0.15, 0.09, 0.09], [0.0, 0.95, 0.0]);
    let chest = figure.cuboid([0.17, 0.18, 0.10], [0.0, 1.28, 0.0]);
    let head = figure.capsule(0.10, 0.04, [0.0, 1.62, 0.0], Rotation::IDENTITY);
    figure.cone(pelvis, chest, [0.0, 1.07, 0.0], Vec3::Y, 30.0, 30.0);
    figure.cone(chest, head, [0.0, 1.47, 0.0], Vec3::Y, 40.0, 45.0);
    for side in [1.0, -1.0] {
        figure.leg(pelvis, side);
        figure.arm(chest, side);
    }
}

/// Builder of a humanoid.
struct Figure<'a> {
    scene: &'a mut Blueprint,
    /// World from the humanoid's own frame.
    stand: Transform,
    /// Factor of all lengths.
    scale: f32,
}

impl Figure<'_> {
    fn leg(&mut self, pelvis: usize, side: f32) {
        let x = 0.10 * side;
        let thigh = self.capsule(0.07, 0.13, [x, 0.66, 0.0], Rotation::IDENTITY);
        let shin = self.capsule(0.055, 0.145, [x, 0.26, 0.0], Rotation::IDENTITY);
        let foot = self.cuboid([0.045, 0.03, 0.11], [x, 0.03, 0.04]);
        self.cone(pelvis, thigh, [x, 0.86, 0.0], Vec3::NEG_Y, 50.0, 20.0);
        self.hinge(thigh, shin, [x, 0.46, 0.0], Vec3::X, (0.0, 130.0));
        self.hinge(shin, foot, [x, 0.06, 0.0], Vec3::X, (-30.0, 30.0));
    }

    fn arm(&mut self, chest: usize, side: f32) {
        let upper = self.capsule(0.05, 0.10, [0.34 * side, 1.40, 0.0], across());
        let fore = self.capsule(0.042, 0.098, [0.64 * side, 1.40, 0.0], across());
        let hand = self.cuboid([0.07, 0.02, 0.04], [0.86 * side, 1.40, 0.0]);
        self.cone(chest, upper, [0.18 * side, 1.40, 0.0], Vec3::X * side, 80.0, 45.0);
        self.hinge(upper, fore, [0.495 * side, 1.40, 0.0], Vec3::NEG_Y * side, (0.0, 135.0));
        self.cone(fore, hand, [0.785 * side, 1.40, 0.0], Vec3::X * side, 30.0, 10.0);
    }

    fn cuboid(&mut self, half_extents: [f32; 3], at: [f32; 3]) -> usize {
        self.place(cuboid(self.scale * Vec3::from(half_extents), self.scale * Vec3::from(at)))
    }

    fn capsule(&mut self, radius: f32, half_height: f32, at: [f32; 3], rotation: Rotation) -> usize {
        let [half_height, radius] = [half_height, radius].map(|length| self.scale * length);
        let capsule = body(Shape::Capsule { half_height, radius }, self.scale * Vec3::from(at));
        self.place(BodyDef { rotation, ..capsule })
    }

    fn place(&mut self, def: BodyDef) -> usize {
        let pose = self.stand * Transform::new(def.position, def.rotation);
        self.scene.body(damped(BodyDef { position: pose.translation, rotation: pose.rotation, ..def }))
    }

    /// Adds a ball joint with a round cone about `axis`; angles in degrees.
    fn cone(&mut self, a: usize, b: usize, at: [f32; 3], axis: Vec3, cone: f32, twist: f32) {
        let [cone, twist] = [cone, twist].map(|half| Range::symmetric(half.to_radians()));
        let limit = SwingTwistLimit { swing_y: cone, swing_z: cone, twist };
        self.joint(a, b, at, axis, JointKind::Ball { limit: Some(limit) });
    }

    /// Adds a hinge about `axis` with a range in degrees.
    fn hinge(&mut self, a: usize, b: usize, at: [f32; 3], axis: Vec3, (lo, hi): (f32, f32)) {
        self.joint(a, b, at, axis, JointKind::Hinge { limit: Some(Range::degrees(lo, hi)) });
    }

    fn joint(&mut self, a: usize, b: usize, at: [f32; 3], axis: Vec3, kind: JointKind) {
        let frame = Transform::new(self.scale * Vec3::from(at), Rotation::from_arc(Vec3::X, axis));
        let world_from_joint = self.stand * frame;
        self.scene.joints.push(BlueprintJoint { a, b, world_from_joint, kind, friction_torque: 0.0 });
    }
}
