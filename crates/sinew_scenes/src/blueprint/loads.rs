//! Loads of several jointed bodies that lie on, hang from or lean on standing bodies.

use super::figure::figure_at;
use super::{Blueprint, BlueprintJoint, stack_mass_ratio};
use crate::parts::{body, cuboid, tilt};
use core::f32::consts::FRAC_PI_2;
use sinew::math::{Rotation, Transform, Vec3, trig};
use sinew::physics::{BodyDef, JointKind, Shape};

/// Adds two boxes end to end on a horizontal surface at `place`, with the total length `2 half`, the total mass `mass`,
/// and a ball joint between them.
pub(crate) fn pair(scene: &mut Blueprint, place: Transform, half: f32, mass: f32) {
    let side = half * Vec3::new(0.45, 0.15, 0.3);
    let [a, b] = [-1.0, 1.0].map(|way| {
        let at = Transform::from_translation(Vec3::new(way * 0.5 * half, side.y, 0.0));
        let at = place * at;
        let def = BodyDef { rotation: at.rotation, ..cuboid(side, at.translation) };
        scene.body(weighing(def, 0.5 * mass))
    });
    scene.ball(a, b, place.point(Vec3::Y * side.y));
}

/// Adds a rope through these points, with one link between neighbouring points and total mass `mass`. Returns its first
/// link.
pub(crate) fn rope(scene: &mut Blueprint, points: &[Vec3], radius: f32, mass: f32) -> usize {
    let first = scene.bodies.len();
    let links = points.len() - 1;
    for (i, ends) in points.windows(2).enumerate() {
        let along = ends[1] - ends[0];
        // The adjacent ends of links do not collide, so links reach up to the joint.
        let half_height = 0.5 * along.length() - radius;
        let link = body(Shape::Capsule { half_height, radius }, 0.5 * (ends[0] + ends[1]));
        let rotation = Rotation::from_arc(Vec3::Y, along.normalize());
        let place = scene.body(weighing(BodyDef { rotation, ..link }, mass / links as f32));
        if i > 0 {
            scene.ball(place - 1, place, ends[0]);
        }
    }
    first
}

/// Points of a rope over a level top of half width `half` and down both sides, from −x to +x.
pub(crate) fn over(top: Vec3, half: f32, radius: f32) -> Vec<Vec3> {
    let out = half + radius;
    let link = 0.5 * out;
    let side = |way: f32, down: f32| top + Vec3::new(way * out, radius - down * link, 0.0);
    let left = [3.0, 2.0, 1.0].map(|down| side(-1.0, down));
    let across = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|at| top + Vec3::new(at * link, radius, 0.0));
    let right = [1.0, 2.0, 3.0].map(|down| side(1.0, down));
    [left.as_slice(), &across, &right].concat()
}

/// Adds a rope of four links of length `link` that hangs from a point of a body.
pub(crate) fn hanging(scene: &mut Blueprint, from: usize, at: Vec3, link: f32, mass: f32) {
    let points = [0.0, 1.0, 2.0, 3.0, 4.0].map(|down| at - Vec3::Y * (down * link));
    let first = rope(scene, &points, 0.1 * link, mass);
    scene.ball(from, first, at);
}

/// Adds a plank of two welded halves. The plank stands on the plane y = 0 and leans toward −x by `degrees` from the
/// vertical, and its upper edge touches a wall at `touch`; this determines its length.
pub(crate) fn leaning(scene: &mut Blueprint, touch: Vec3, degrees: f32, mass: f32) {
    let length = touch.y / trig::cos(degrees.to_radians());
    let half = Vec3::new(0.04, 0.25, 0.1) * length;
    let rotation = tilt(degrees);
    let middle = touch + rotation * Vec3::new(half.x, -2.0 * half.y, 0.0);
    let [a, b] = [-1.0, 1.0].map(|way| {
        let def = cuboid(half, middle + rotation * (Vec3::Y * (way * half.y)));
        scene.body(weighing(BodyDef { rotation, ..def }, 0.5 * mass))
    });
    let world_from_joint = Transform::new(middle, rotation);
    scene.joints.push(BlueprintJoint {
        a,
        b,
        world_from_joint,
        kind: JointKind::Fixed,
        friction_torque: 0.0,
    });
}

/// Adds a limp humanoid, `scale` times as large as a man, on its back along x, with its centre of mass over `place`.
pub(crate) fn figure(scene: &mut Blueprint, place: Transform, scale: f32) {
    /// Height of the humanoid's centre of mass above its soles, and half the depth of its chest, metres.
    const CENTER: f32 = 1.04;
    const BACK: f32 = 0.1;
    let on_its_back = Rotation::from_axis_angle(Vec3::X, -FRAC_PI_2);
    let along = Rotation::from_axis_angle(Vec3::Y, FRAC_PI_2) * on_its_back;
    let soles = Vec3::Y * (BACK * scale) - along * (Vec3::Y * (CENTER * scale));
    figure_at(scene, place * Transform::new(soles, along), scale);
}

/// Cubes of 0.5 m on top of each other.
pub(crate) fn stack(boxes: usize) -> Blueprint {
    let mut scene = stack_mass_ratio(boxes, 1.0);
    scene.bodies.iter_mut().for_each(|def| def.shapes[0].density = 1000.0);
    scene
}

/// Changes the density so that the body has the given mass.
fn weighing(mut def: BodyDef, mass: f32) -> BodyDef {
    let shape = &mut def.shapes[0];
    shape.density = mass / shape.shape.mass_properties(1.0).mass;
    def
}
