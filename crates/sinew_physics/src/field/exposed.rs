//! Surface panels of a shape exposed to a stream, each with an area and a position.

use crate::body::shape::Shape;
use crate::hull::Hull;
use crate::revolved::{TaperedCapsule, TruncatedCone};
use core::f32::consts::{FRAC_1_SQRT_2, FRAC_PI_2, PI};
use sinew_math::trig::{acos, asin, sin};
use sinew_math::{Transform, Vec3, clamp, max, normalize_or};

/// Nodes of the two-point Gauss rule on −1..1.
const GAUSS: [f32; 2] = [-0.577_350_26, 0.577_350_26];

/// A surface panel exposed to a stream.
#[derive(Clone, Copy, Debug)]
pub(super) struct Panel {
    /// Point at which the force acts, world, metres.
    pub point: Vec3,
    /// Area, m²: for a flat panel its own area, for a round one its projected area.
    pub area: f32,
    /// Outward unit normal of a flat panel; `None` for a round one, which has the same area from all sides.
    pub normal: Option<Vec3>,
}

/// Calls `visit` with panels whose projected areas add up to the shape's in every direction. A box has its faces at 2×2
/// Gauss points each, so that spin is also damped. A ball has its disk. A capsule has its disk and the strip of its
/// cylinder that faces `stream` (m/s, world); a tapered capsule likewise. Cylinders and cones have their ends and the
/// part of the side that faces the stream. A hull has its faces in triangles at three points each. Half-spaces, meshes
/// and height fields have none.
pub(super) fn exposed(shape: &Shape, at: &Transform, stream: Vec3, mut visit: impl FnMut(Panel)) {
    match *shape {
        Shape::Box { half_extents } => box_panels(half_extents, at, &mut visit),
        Shape::Sphere { radius } => visit(disk(at.translation, radius)),
        Shape::Capsule { half_height, radius } => {
            visit(disk(at.translation, radius));
            let axis = at.rotation * Vec3::Y;
            let across = normalize_or(axis * stream.dot(axis) - stream, Vec3::ZERO);
            for node in GAUSS {
                visit(Panel {
                    point: at.translation + axis * (node * half_height),
                    area: 2.0 * radius * half_height,
                    normal: Some(across),
                });
            }
        }
        Shape::Hull(ref hull) => hull_panels(hull, at, &mut visit),
        Shape::TaperedCapsule { half_height, radius_bottom, radius_top } => {
            tapered_panels(
                &TaperedCapsule::new(half_height, radius_bottom, radius_top),
                at,
                stream,
                &mut visit,
            );
        }
        Shape::Cylinder { half_height, radius } => {
            truncated_cone_panels(&TruncatedCone::cylinder(half_height, radius), at, stream, &mut visit);
        }
        Shape::Cone { half_height, radius } => {
            truncated_cone_panels(&TruncatedCone::cone(half_height, radius), at, stream, &mut visit);
        }
        Shape::HalfSpace | Shape::Mesh(_) | Shape::HeightField(_) => {}
    }
}

/// Visits the panels of a tapered capsule. Its outline seen along the stream consists of two disks and their common
/// tangents: a sector of each disk, and two right trapezoids between them.
fn tapered_panels(tapered: &TaperedCapsule, at: &Transform, stream: Vec3, visit: &mut impl FnMut(Panel)) {
    let axis = at.rotation * Vec3::Y;
    let along = normalize_or(stream, Vec3::ZERO);
    let sine = along.cross(axis).length();
    let [(low, bottom), (high, top)] = tapered.balls().map(|(center, radius)| (at.point(center), radius));
    let (apart, differ) = (2.0 * tapered.half_height * sine, bottom - top);
    if apart <= differ.abs() {
        let (center, radius) = if bottom > top { (low, bottom) } else { (high, top) };
        visit(disk(center, radius));
        return;
    }
    let lean = asin(clamp(differ / apart, -1.0, 1.0));
    for (point, radius, half_angle) in [(low, bottom, FRAC_PI_2 + lean), (high, top, FRAC_PI_2 - lean)] {
        visit(Panel { point, area: radius * radius * half_angle, normal: None });
    }
    let tangent = max(apart * apart - differ * differ, 0.0).sqrt();
    let across = normalize_or(axis * along.dot(axis) - along, Vec3::ZERO);
    for node in GAUSS {
        visit(Panel {
            point: at.translation + axis * (node * tapered.half_height),
            area: 0.5 * (bottom + top) * tangent / sine,
            normal: Some(across),
        });
    }
}

/// Visits the panels of a truncated cone: the ends, each at four points that integrate squares exactly, and the vector
/// area of the part of the side whose normals face the stream.
fn truncated_cone_panels(cone: &TruncatedCone, at: &Transform, stream: Vec3, visit: &mut impl FnMut(Panel)) {
    let (up, side_x, side_z) = (at.rotation * Vec3::Y, at.rotation * Vec3::X, at.rotation * Vec3::Z);
    for (radius, end) in [(cone.bottom, -1.0), (cone.top, 1.0)] {
        let center = at.translation + up * (end * cone.half_height);
        for way in [side_x, -side_x, side_z, -side_z] {
            let point = center + way * (radius * FRAC_1_SQRT_2);
            visit(Panel { point, area: 0.25 * PI * radius * radius, normal: Some(up * end) });
        }
    }
    let side = cone.side_normal();
    let against = -normalize_or(stream, Vec3::ZERO);
    let along_axis = against.dot(up);
    let flat = against - up * along_axis;
    let facing = flat.length();
    let out = normalize_or(flat, side_x);
    // The normal at the angle φ from `out` faces the stream where `cos φ > −(tan of the slope) × (along / across)`.
    let half_angle = if facing > 1e-6 {
        acos(clamp(-(side.y * along_axis) / (side.x * facing), -1.0, 1.0))
    } else if side.y * along_axis > 0.0 {
        PI
    } else {
        0.0
    };
    let vector_area = out * (2.0 * side.x * sin(half_angle)) + up * (2.0 * side.y * half_angle);
    let length = vector_area.length();
    if length <= 0.0 {
        return;
    }
    // The area of a ring per radian is the radius times the slant length.
    let slant = 2.0 * cone.half_height / side.x;
    for node in GAUSS {
        let y = node * cone.half_height;
        visit(Panel {
            point: at.translation + up * y,
            area: 0.5 * slant * cone.radius_at(y) * length,
            normal: Some(vector_area / length),
        });
    }
}

fn disk(point: Vec3, radius: f32) -> Panel {
    Panel { point, area: PI * radius * radius, normal: None }
}

/// Visits each triangle of a hull at three interior points, which integrate squares exactly (Strang and Fix 1973).
fn hull_panels(hull: &Hull, at: &Transform, visit: &mut impl FnMut(Panel)) {
    for face in hull.faces() {
        let normal = Some(at.rotation * face.normal());
        let mut corners = face.corners().map(|corner| hull.vertices()[corner]);
        let (Some(first), Some(mut last)) = (corners.next(), corners.next()) else { continue };
        for corner in corners {
            let area = (last - first).cross(corner - first).length() / 6.0;
            let sum = first + last + corner;
            for node in [first, last, corner] {
                visit(Panel { point: at.point((sum + node * 3.0) / 6.0), area, normal });
            }
            last = corner;
        }
    }
}

fn box_panels(half: Vec3, at: &Transform, visit: &mut impl FnMut(Panel)) {
    for k in 0..3 {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        for side in [-1.0, 1.0] {
            let mut normal = Vec3::ZERO;
            normal[k] = side;
            let outward = at.rotation * normal;
            for u in GAUSS {
                for v in GAUSS {
                    let mut point = normal * half[k];
                    point[i] = u * half[i];
                    point[j] = v * half[j];
                    visit(Panel { point: at.point(point), area: half[i] * half[j], normal: Some(outward) });
                }
            }
        }
    }
}

/// Returns the force of a stream on a sheet face from either side, N, and the damping coefficient, N·s/m, for a vector
/// area in m²: see [`Wind`](super::Wind).
pub(super) fn face_force(area: Vec3, stream: Vec3, density: f32, drag: f32, lift: f32) -> (Vec3, f32) {
    let (size, speed) = (area.length(), stream.length());
    if size <= 0.0 || speed <= 0.0 {
        return (Vec3::ZERO, 0.0);
    }
    let normal = area / size;
    let through = stream.dot(normal);
    let pressure = 0.5 * density * size * through.abs();
    let aside = normal * speed * sign(through) - stream * (through.abs() / speed);
    let force = normal * (pressure * drag * through) + aside * (pressure * lift);
    (force, density * size * (drag * through.abs() + lift * speed))
}

fn sign(x: f32) -> f32 {
    if x < 0.0 { -1.0 } else { 1.0 }
}

/// Returns the force of a stream on a panel, N, and the damping coefficient, N·s/m: see [`Wind`](super::Wind).
pub(super) fn stream_force(panel: &Panel, stream: Vec3, density: f32, drag: f32, lift: f32) -> (Vec3, f32) {
    let speed = stream.length();
    if speed <= 0.0 {
        return (Vec3::ZERO, 0.0);
    }
    let along = stream / speed;
    let pressure = 0.5 * density * speed * speed * panel.area;
    // An upper bound of the derivative: every term of the force is a product of two velocities.
    let brake = density * speed * panel.area;
    match panel.normal {
        None => (along * (pressure * drag), brake * drag),
        Some(normal) => {
            let facing = -along.dot(normal);
            if facing <= 0.0 {
                return (Vec3::ZERO, 0.0);
            }
            let aside = -normal - along * facing;
            ((along * drag + aside * lift) * (pressure * facing), brake * (drag + lift))
        }
    }
}
