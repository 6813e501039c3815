//! Debug drawing: a world as lines, for any renderer.

use crate::body::def::BodyKind;
use crate::body::shape::Shape;
use crate::draw::{DebugDraw, DrawKind};
use crate::revolved::{TaperedCapsule, TruncatedCone};
use crate::world::World;
use sinew_math::{Transform, Vec3, trig};

/// Number of line segments of a full circle.
const SEGMENTS: usize = 16;
/// Half side of the square that represents a half-space, metres.
const PLANE_SIZE: f32 = 10.0;

impl World {
    /// Draws shapes, joints, springs, contacts, and objects.
    #[doc(alias = "debug render")]
    #[doc(alias = "gizmos")]
    pub fn draw(&self, out: &mut dyn DebugDraw) {
        for (_, body) in self.bodies.iter() {
            let kind = match body.kind {
                BodyKind::Static => DrawKind::Static,
                BodyKind::Kinematic => DrawKind::Kinematic,
                BodyKind::Dynamic if body.is_awake() => DrawKind::Awake,
                BodyKind::Dynamic => DrawKind::Asleep,
            };
            for (i, s) in body.shapes.iter().enumerate() {
                draw_shape(&s.shape, &body.world_from_shape(i), kind, out);
            }
        }
        for (_, joint) in self.joints.iter() {
            if joint.leaves_all_free() && self.bodies.at(joint.a).kind != BodyKind::Dynamic {
                let end = |body: u32, frame: Transform| self.bodies.at(body).world_from_principal * frame;
                let wanted = joint.drive.motor.map_or(Vec3::ZERO, |motor| motor.target.translation);
                let goal = end(joint.a, joint.frame_a).point(wanted);
                out.line(end(joint.b, joint.frame_b).translation, goal, DrawKind::Joint);
                continue;
            }
            for (body, frame) in [(joint.a, joint.frame_a), (joint.b, joint.frame_b)] {
                let pose = self.bodies.at(body).world_from_principal;
                out.line(pose.translation, pose.point(frame.translation), DrawKind::Joint);
            }
        }
        for (_, group) in self.groups.iter() {
            for spring in group.springs() {
                let [a, b] = [spring.a, spring.b].map(|i| group.positions()[i as usize]);
                out.line(a, b, DrawKind::Spring);
            }
        }
        for contact in self.contacts_in_order().filter(|contact| contact.touching) {
            for point in contact.manifold.points() {
                out.line(point.position, point.position + contact.manifold.normal * 0.1, DrawKind::Contact);
            }
        }
        self.draw_objects(out);
    }
}

fn draw_shape(shape: &Shape, pose: &Transform, kind: DrawKind, out: &mut dyn DebugDraw) {
    let mut line = |from: Vec3, to: Vec3| out.line(pose.point(from), pose.point(to), kind);
    let mut triangle = |corners: [Vec3; 3]| (0..3).for_each(|k| line(corners[k], corners[(k + 1) % 3]));
    match *shape {
        Shape::Mesh(ref mesh) => mesh.corners_of_all().for_each(&mut triangle),
        Shape::HeightField(ref field) => field.triangles().for_each(&mut triangle),
        Shape::Box { half_extents } => draw_box(half_extents, &mut line),
        Shape::Sphere { radius } => draw_capsule(0.0, radius, &mut line),
        Shape::Capsule { half_height, radius } => draw_capsule(half_height, radius, &mut line),
        Shape::Hull(ref hull) => {
            for [from, to] in hull.edges() {
                line(hull.vertices()[from], hull.vertices()[to]);
            }
        }
        Shape::TaperedCapsule { half_height, radius_bottom, radius_top } => {
            draw_tapered(&TaperedCapsule::new(half_height, radius_bottom, radius_top), &mut line);
        }
        Shape::Cylinder { half_height, radius } => {
            draw_truncated_cone(&TruncatedCone::cylinder(half_height, radius), 0.0, &mut line);
        }
        Shape::Cone { half_height, radius } => {
            draw_truncated_cone(&TruncatedCone::cone(half_height, radius), 0.0, &mut line);
        }
        Shape::HalfSpace => {
            let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
            let corner = |i: usize| Vec3::new(corners[i % 4].0, 0.0, corners[i % 4].1) * PLANE_SIZE;
            for i in 0..4 {
                line(corner(i), corner(i + 1));
            }
        }
    }
}

fn draw_box(h: Vec3, line: &mut dyn FnMut(Vec3, Vec3)) {
    let corner = |bits: u32| {
        let sign = |bit: u32| if bits & bit == 0 { -1.0 } else { 1.0 };
        Vec3::new(h.x * sign(1), h.y * sign(2), h.z * sign(4))
    };
    for bits in 0..8 {
        for axis in [1, 2, 4] {
            if bits & axis == 0 {
                line(corner(bits), corner(bits | axis));
            }
        }
    }
}

/// Draws rings at both ends, and the outline in two planes through the axis.
fn draw_capsule(half_height: f32, radius: f32, line: &mut dyn FnMut(Vec3, Vec3)) {
    let at = |i: usize| {
        let (sin, cos) = on_circle(i);
        (sin * radius, cos * radius)
    };
    for i in 0..SEGMENTS {
        let ((s0, c0), (s1, c1)) = (at(i), at(i + 1));
        for y in [-half_height, half_height] {
            line(Vec3::new(c0, y, s0), Vec3::new(c1, y, s1));
        }
        // The upper half of the outline is raised, the lower one lowered; straight sides connect them.
        let lift = if s0 + s1 > 0.0 { half_height } else { -half_height };
        line(Vec3::new(c0, s0 + lift, 0.0), Vec3::new(c1, s1 + lift, 0.0));
        line(Vec3::new(0.0, s0 + lift, c0), Vec3::new(0.0, s1 + lift, c1));
    }
    for side in [-radius, radius] {
        line(Vec3::new(side, -half_height, 0.0), Vec3::new(side, half_height, 0.0));
        line(Vec3::new(0.0, -half_height, side), Vec3::new(0.0, half_height, side));
    }
}

/// Returns sine and cosine of corner `i` of a full circle.
fn on_circle(i: usize) -> (f32, f32) {
    trig::sin_cos(i as f32 * (2.0 * core::f32::consts::PI / SEGMENTS as f32))
}

/// Draws rings at both ends and four lines between them; `middle` is the height of the centre of the cone, metres.
fn draw_truncated_cone(cone: &TruncatedCone, middle: f32, line: &mut dyn FnMut(Vec3, Vec3)) {
    let ends = [(middle - cone.half_height, cone.bottom), (middle + cone.half_height, cone.top)];
    let corner = |(y, radius): (f32, f32), i: usize| {
        let (sin, cos) = on_circle(i);
        Vec3::new(cos * radius, y, sin * radius)
    };
    for i in 0..SEGMENTS {
        for end in ends.into_iter().filter(|(_, radius)| *radius > 0.0) {
            line(corner(end, i), corner(end, i + 1));
        }
        if i % (SEGMENTS / 4) == 0 {
            line(corner(ends[0], i), corner(ends[1], i));
        }
    }
}

/// Draws the side of a tapered capsule, and arcs of its two end balls in two planes through the axis.
fn draw_tapered(tapered: &TaperedCapsule, line: &mut dyn FnMut(Vec3, Vec3)) {
    let (side, middle) = tapered.side();
    draw_truncated_cone(&side, middle, line);
    let lean = trig::asin(tapered.side_normal().y);
    let quarter = core::f32::consts::FRAC_PI_2;
    for ((center, radius), pole) in tapered.balls().into_iter().zip([-quarter, quarter]) {
        let at = |i: usize| {
            let (sin, cos) = trig::sin_cos(lean + (pole - lean) * (i as f32 / (SEGMENTS / 4) as f32));
            (sin * radius + center.y, cos * radius)
        };
        for i in 0..SEGMENTS / 4 {
            let ((y0, r0), (y1, r1)) = (at(i), at(i + 1));
            for side in [-1.0, 1.0] {
                line(Vec3::new(side * r0, y0, 0.0), Vec3::new(side * r1, y1, 0.0));
                line(Vec3::new(0.0, y0, side * r0), Vec3::new(0.0, y1, side * r1));
            }
        }
    }
}
