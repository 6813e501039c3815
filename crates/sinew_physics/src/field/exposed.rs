//! What a shape exposes to a stream: panels of its surface, each with an area and where it lies.

use crate::shape::Shape;
use sinew_math::{Transform, Vec3, normalize_or};

/// Nodes of the two-point Gauss rule on −1..1.
const GAUSS: [f32; 2] = [-0.577_350_26, 0.577_350_26];

/// A piece of surface that a stream meets.
#[derive(Clone, Copy, Debug)]
pub(super) struct Panel {
    /// World, metres.
    pub point: Vec3,
    /// m². Of a flat one its own, of a round one what it shows to the stream.
    pub area: f32,
    /// Outward, of a flat one; a round one shows the same area to all sides.
    pub normal: Option<Vec3>,
}

impl Shape {
    /// Calls `visit` with panels that together have the shape's projected area in every direction: the faces of a box,
    /// each at its 2×2 Gauss points, so that spin is braked as well; a ball's disk; a capsule's disk and the strip of its
    /// cylinder that faces `stream` (m/s, world). A half-space has none, nor have meshes
    /// and height fields.
    pub(super) fn exposed(&self, at: &Transform, stream: Vec3, mut visit: impl FnMut(Panel)) {
        match *self {
            Self::Box { half_extents } => box_panels(half_extents, at, &mut visit),
            Self::Sphere { radius } => visit(disk(at.translation, radius)),
            Self::Capsule { half_height, radius } => {
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
            Self::HalfSpace | Self::Mesh(_) | Self::HeightField(_) => {}
        }
    }
}

fn disk(point: Vec3, radius: f32) -> Panel {
    Panel { point, area: core::f32::consts::PI * radius * radius, normal: None }
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

/// Force of a stream on a panel, N, and how it brakes, N·s/m: see [`Wind`](super::Wind).
pub(super) fn stream_force(panel: &Panel, stream: Vec3, density: f32, drag: f32, lift: f32) -> (Vec3, f32) {
    let speed = stream.length();
    if speed <= 0.0 {
        return (Vec3::ZERO, 0.0);
    }
    let along = stream / speed;
    let pressure = 0.5 * density * speed * speed * panel.area;
    // A full bound of the derivative: every part of the force is a product of two velocities.
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
