//! Models from plain descriptions: boxes, balls, capsules, floors, meshes and their wire frames.

use crate::scene::{Line, LineDepth, Model, Pattern, RenderMaterial, ShadowCasting};
use sinew::math::{Rotation, Transform, Vec3, normalize_or, trig};
use sinew::physics::{Hull, Shape};

/// Number of segments around a ball or capsule. With 15° each the shape looks round at the sizes in pictures.
const AROUND: usize = 24;
/// Number of segments from the equator to a pole.
const TO_POLE: usize = 6;

/// Returns the surface of a shape. Boxes, hulls, meshes and height fields have flat faces, the others smooth normals. An infinite
/// half-space has no model: see [`plane`].
pub fn shape(shape: &Shape, world_from_shape: Transform, material: RenderMaterial) -> Model {
    let mut model = match *shape {
        Shape::Box { half_extents } => box_model(half_extents),
        Shape::Sphere { radius } => round_model(0.0, radius, radius),
        Shape::Capsule { half_height, radius } => round_model(half_height, radius, radius),
        Shape::TaperedCapsule { half_height, radius_bottom, radius_top } => {
            round_model(half_height, radius_bottom, radius_top)
        }
        Shape::Cylinder { half_height, radius } => frustum_model(half_height, radius, radius),
        Shape::Cone { half_height, radius } => frustum_model(half_height, radius, 0.0),
        Shape::Hull(ref hull) => hull_model(hull),
        Shape::Mesh(ref mesh) => triangle_model(mesh.corners_of_all()),
        Shape::HeightField(ref field) => triangle_model(field.triangles()),
        Shape::HalfSpace => Model::default(),
    };
    for position in &mut model.positions {
        *position = world_from_shape.point(*position);
    }
    for normal in &mut model.normals {
        *normal = world_from_shape.rotation * *normal;
    }
    Model { material, ..model }
}

/// Returns a ball with eight fields in alternating shades, so that its rotation is visible.
pub fn ball(radius: f32, world_from_ball: Transform, material: RenderMaterial) -> Model {
    let mut model = shape(&Shape::Sphere { radius }, world_from_ball, material);
    let shade = |vertex: usize| {
        let (ring, around) = (vertex / AROUND, vertex % AROUND);
        let quarter = around / (AROUND / 4);
        let dark = (quarter % 2 == 1) != (ring > TO_POLE);
        [if dark { 0.5 } else { 1.0 }; 3]
    };
    model.colors = (0..model.positions.len()).map(shade).collect();
    model
}

/// Returns a round rod with round ends from one point to another, world space, metres.
pub fn rod(from: Vec3, to: Vec3, radius: f32, material: RenderMaterial) -> Model {
    let along = to - from;
    let turn = Rotation::from_arc(Vec3::Y, normalize_or(along, Vec3::Y));
    let place = Transform::new((from + to) * 0.5, turn);
    shape(&Shape::Capsule { half_height: 0.5 * along.length(), radius }, place, material)
}

/// Returns a level floor of two colours (linear), `half_size` metres to each side of `center`, in squares of 1 m. The floor casts no
/// shadow.
pub fn floor(center: Vec3, half_size: f32, color: [f32; 3], other: [f32; 3]) -> Model {
    plane(Transform::from_translation(center), half_size, 1.0, [color, other])
}

/// Returns the plane y = 0 of a frame, `half_size` metres to each side, in squares of `tile` metres of two colours (linear). The plane
/// casts no shadow.
pub fn plane(world_from_plane: Transform, half_size: f32, tile: f32, colors: [[f32; 3]; 2]) -> Model {
    let [color, other] = colors;
    let corner = |x: f32, z: f32| world_from_plane.point(Vec3::new(x * half_size, 0.0, z * half_size));
    Model {
        positions: vec![corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)],
        indices: vec![0, 1, 2, 0, 2, 3],
        material: RenderMaterial {
            pattern: Pattern::Checker { size: tile, other },
            shadow: ShadowCasting::No,
            ..RenderMaterial::new(color)
        },
        ..Model::default()
    }
}

/// Returns the edges of a shape: all edges of boxes, hulls and the triangles of surfaces; for balls and capsules three great circles and
/// the sides; none for a half-space.
pub fn wire(shape: &Shape, world_from_shape: Transform, color: [f32; 3], depth: LineDepth) -> Vec<Line> {
    let mut segments = Vec::new();
    match *shape {
        Shape::Hull(ref hull) => {
            segments.extend(hull.edges().map(|ends| ends.map(|corner| hull.vertices()[corner])));
        }
        Shape::Box { half_extents } => box_edges(half_extents, &mut segments),
        Shape::Sphere { radius } => capsule_edges(0.0, radius, &mut segments),
        Shape::Capsule { half_height, radius } => capsule_edges(half_height, radius, &mut segments),
        Shape::TaperedCapsule { half_height, radius_bottom, radius_top } => {
            tapered_edges(half_height, radius_bottom, radius_top, &mut segments);
        }
        Shape::Cylinder { half_height, radius } => {
            frustum_edges([(-half_height, radius), (half_height, radius)], &mut segments);
        }
        Shape::Cone { half_height, radius } => {
            frustum_edges([(-half_height, radius), (half_height, 0.0)], &mut segments);
        }
        Shape::Mesh(ref mesh) => triangle_edges(mesh.corners_of_all(), &mut segments),
        Shape::HeightField(ref field) => triangle_edges(field.triangles(), &mut segments),
        Shape::HalfSpace => {}
    }
    let line = |[from, to]: [Vec3; 2]| Line {
        from: world_from_shape.point(from),
        to: world_from_shape.point(to),
        color,
        depth,
    };
    segments.into_iter().map(line).collect()
}

/// Returns the axes of a frame, `length` metres each: x red, y green, z blue.
pub fn axes(frame: Transform, length: f32, depth: LineDepth) -> [Line; 3] {
    [(Vec3::X, [0.8, 0.05, 0.05]), (Vec3::Y, [0.05, 0.55, 0.05]), (Vec3::Z, [0.05, 0.15, 0.85])]
        .map(|(axis, color)| Line { from: frame.translation, to: frame.point(axis * length), color, depth })
}

/// Returns lines of curves in the colours of [`curve_color`]; each curve consists of pieces with two ends.
pub fn curves<'a>(curves: impl IntoIterator<Item = &'a [[Vec3; 2]]>) -> Vec<Line> {
    let of = |(number, pieces): (usize, &'a [[Vec3; 2]])| {
        let color = curve_color(number);
        pieces.iter().map(move |&[from, to]| Line { from, to, color, depth: LineDepth::Tested })
    };
    curves.into_iter().enumerate().flat_map(of).collect()
}

/// Returns the linear colour of curve number `number` of several that are compared.
pub fn curve_color(number: usize) -> [f32; 3] {
    CURVES[number % CURVES.len()]
}

/// Colours that are bright and distinct on the sky and on the dark plate of a caption (the colour-blind safe palette of Okabe and Ito):
/// blue, vermilion, yellow, bluish green, reddish purple.
const CURVES: [[f32; 3]; 5] =
    [[0.0, 0.17, 0.45], [0.67, 0.11, 0.0], [0.87, 0.78, 0.05], [0.0, 0.34, 0.17], [0.60, 0.19, 0.39]];

fn box_corner(i: usize, half: Vec3) -> Vec3 {
    let sign = |bit: usize| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
    Vec3::new(sign(0) * half.x, sign(1) * half.y, sign(2) * half.z)
}

/// Corners of the faces −x +x −y +y −z +z, counter-clockwise from outside; bit 0 of a corner is x, 1 y, 2 z.
const BOX_FACES: [[u32; 4]; 6] =
    [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];

fn box_model(half: Vec3) -> Model {
    Model {
        positions: (0..8).map(|i| box_corner(i, half)).collect(),
        indices: BOX_FACES.iter().flat_map(|&[a, b, c, d]| [a, b, c, a, c, d]).collect(),
        ..Model::default()
    }
}

fn hull_model(hull: &Hull) -> Model {
    let mut indices = Vec::new();
    for face in hull.faces() {
        let corners: Vec<u32> = face.corners().map(|corner| corner as u32).collect();
        indices.extend(corners[1..].windows(2).flat_map(|side| [corners[0], side[0], side[1]]));
    }
    Model { positions: hull.vertices().to_vec(), indices, ..Model::default() }
}

fn triangle_model(triangles: impl Iterator<Item = [Vec3; 3]>) -> Model {
    let positions: Vec<Vec3> = triangles.flatten().collect();
    Model { indices: (0..positions.len() as u32).collect(), positions, ..Model::default() }
}

fn triangle_edges(triangles: impl Iterator<Item = [Vec3; 3]>, segments: &mut Vec<[Vec3; 2]>) {
    segments.extend(triangles.flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]]));
}

fn box_edges(half: Vec3, segments: &mut Vec<[Vec3; 2]>) {
    for i in 0..8usize {
        for bit in (0..3).filter(|bit| i >> bit & 1 == 0) {
            segments.push([box_corner(i, half), box_corner(i | 1 << bit, half)]);
        }
    }
}

/// A ring of a solid of revolution: its radius and height, and the latitude of the normal there.
struct Ring {
    radius: f32,
    y: f32,
    latitude: f32,
}

/// Returns capsules and balls as rings from the lower to the upper pole; where the side meets a ball, each of the two has a ring.
fn round_model(half_height: f32, bottom: f32, top: f32) -> Model {
    let lean = side_latitude(half_height, bottom, top);
    let pole = core::f32::consts::FRAC_PI_2;
    let arc = |center: f32, radius: f32, from: f32, to: f32| {
        (0..=TO_POLE).map(move |i| {
            let latitude = from + (to - from) * (i as f32 / TO_POLE as f32);
            let (sin, cos) = trig::sin_cos(latitude);
            Ring { radius: radius * cos, y: center + radius * sin, latitude }
        })
    };
    lathe(arc(-half_height, bottom, -pole, lean).chain(arc(half_height, top, lean, pole)))
}

/// Returns the latitude of the normals on the straight side of a tapered capsule, radians.
fn side_latitude(half_height: f32, bottom: f32, top: f32) -> f32 {
    if half_height > 0.0 { trig::asin((bottom - top) / (2.0 * half_height)) } else { 0.0 }
}

/// Returns cylinders and cones: flat ends, and a side whose rings have separate normals.
fn frustum_model(half_height: f32, bottom: f32, top: f32) -> Model {
    let pole = core::f32::consts::FRAC_PI_2;
    let lean = trig::atan2(bottom - top, 2.0 * half_height);
    let ring = |radius: f32, y: f32, latitude: f32| Ring { radius, y, latitude };
    let (low, high) = (-half_height, half_height);
    lathe(
        [
            ring(0.0, low, -pole),
            ring(bottom, low, -pole),
            ring(bottom, low, lean),
            ring(top, high, lean),
            ring(top, high, pole),
            ring(0.0, high, pole),
        ]
        .into_iter(),
    )
}

/// Returns the surface through rings around y, from the lowest to the highest.
fn lathe(rings: impl Iterator<Item = Ring>) -> Model {
    let mut model = Model::default();
    for Ring { radius, y, latitude } in rings {
        let (sin, cos) = trig::sin_cos(latitude);
        for i in 0..AROUND {
            let [x, z] = circle(i);
            model.positions.push(Vec3::new(x * radius, y, z * radius));
            model.normals.push(Vec3::new(x * cos, sin, z * cos));
        }
    }
    for ring in 0..model.positions.len() / AROUND - 1 {
        for i in 0..AROUND {
            let next = (i + 1) % AROUND;
            let [a, b] = [ring * AROUND + i, ring * AROUND + next].map(|v| v as u32);
            let [c, d] = [a, b].map(|v| v + AROUND as u32);
            model.indices.extend([a, c, d, a, d, b]);
        }
    }
    model
}

/// Returns point `i` of [`AROUND`] points on the unit circle, x and z.
fn circle(i: usize) -> [f32; 2] {
    let (sin, cos) = trig::sin_cos(core::f32::consts::TAU * (i % AROUND) as f32 / AROUND as f32);
    [cos, sin]
}

fn capsule_edges(half_height: f32, radius: f32, segments: &mut Vec<[Vec3; 2]>) {
    let up = Vec3::Y * half_height;
    for i in 0..AROUND {
        let [[c, s], [c1, s1]] = [circle(i), circle(i + 1)].map(|p| p.map(|v| v * radius));
        let rim = [Vec3::new(c, 0.0, s), Vec3::new(c1, 0.0, s1)];
        segments.push(rim.map(|p| p + up));
        if half_height > 0.0 {
            segments.push(rim.map(|p| p - up));
        }
        let shift = if i < AROUND / 2 { up } else { -up };
        segments.push([Vec3::new(c, s, 0.0) + shift, Vec3::new(c1, s1, 0.0) + shift]);
        segments.push([Vec3::new(0.0, s, c) + shift, Vec3::new(0.0, s1, c1) + shift]);
    }
    if half_height > 0.0 {
        for side in [Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z].map(|axis| axis * radius) {
            segments.push([side - up, side + up]);
        }
    }
}

/// Adds rings of the given heights and radii, and four lines between them.
fn frustum_edges(ends: [(f32, f32); 2], segments: &mut Vec<[Vec3; 2]>) {
    let at = |(y, radius): (f32, f32), i: usize| {
        let [x, z] = circle(i);
        Vec3::new(x * radius, y, z * radius)
    };
    for end in ends.into_iter().filter(|(_, radius)| *radius > 0.0) {
        segments.extend((0..AROUND).map(|i| [at(end, i), at(end, i + 1)]));
    }
    segments.extend((0..AROUND).step_by(AROUND / 4).map(|i| ends.map(|end| at(end, i))));
}

/// Adds edges of the side, and the arcs of the two balls in two planes.
fn tapered_edges(half_height: f32, bottom: f32, top: f32, segments: &mut Vec<[Vec3; 2]>) {
    let lean = side_latitude(half_height, bottom, top);
    let at = |center: f32, radius: f32, latitude: f32| {
        let (sin, cos) = trig::sin_cos(latitude);
        (center + radius * sin, radius * cos)
    };
    frustum_edges([at(-half_height, bottom, lean), at(half_height, top, lean)], segments);
    let pole = core::f32::consts::FRAC_PI_2;
    for (center, radius, pole) in [(-half_height, bottom, -pole), (half_height, top, pole)] {
        let step = |i: usize| at(center, radius, lean + (pole - lean) * (i as f32 / TO_POLE as f32));
        for i in 0..TO_POLE {
            for side in [Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z] {
                segments.push([step(i), step(i + 1)].map(|(y, r)| side * r + Vec3::Y * y));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew::math::Rotation;
    use std::sync::Arc;

    /// Six times the volume inside, by the divergence theorem: positive if all faces point outward.
    fn volume(model: &Model) -> f32 {
        let point = |i: u32| model.positions[i as usize];
        model.indices.chunks_exact(3).map(|t| point(t[0]).dot(point(t[1]).cross(point(t[2])))).sum::<f32>()
            / 6.0
    }

    #[test]
    fn solids_are_closed_and_face_outward() {
        let place = Transform::new(Vec3::new(1.0, -2.0, 0.5), Rotation::from_axis_angle(Vec3::X, 0.7));
        let half_extents = Vec3::new(0.5, 0.25, 1.0);
        let tetrahedron = Hull::new(&[Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z]).expect("a solid");
        let pi = core::f32::consts::PI;
        for (shape, expected, tolerance) in [
            (Shape::Box { half_extents }, 1.0, 1e-4),
            (Shape::Hull(Arc::new(tetrahedron)), 1.0 / 6.0, 1e-4),
            (Shape::Sphere { radius: 0.5 }, pi / 6.0, 0.02),
            (Shape::Capsule { half_height: 0.4, radius: 0.5 }, pi / 6.0 + pi * 0.2, 0.04),
            (
                Shape::TaperedCapsule { half_height: 0.4, radius_bottom: 0.5, radius_top: 0.5 },
                pi / 6.0 + pi * 0.2,
                0.04,
            ),
            (Shape::Cylinder { half_height: 0.5, radius: 0.5 }, pi * 0.25, 0.02),
            (Shape::Cone { half_height: 0.5, radius: 0.5 }, pi / 12.0, 0.02),
        ] {
            let model = super::shape(&shape, place, RenderMaterial::default());
            assert!((volume(&model) - expected).abs() < tolerance, "{shape:?}: {}", volume(&model));
            assert!(!wire(&shape, place, [1.0; 3], LineDepth::Tested).is_empty());
        }
    }
}
