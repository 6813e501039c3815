//! Builds hulls: the corners and faces from points, and the derived data from corners and faces.

use super::grid::{Grid, SIZES};
use super::mass::Integrals;
use super::quick;
use super::topology::{Outline, Plane};
use super::{Hull, HullError, MAX_FACES, MAX_VERTICES, merge, reach};
use crate::boxes::Aabb;
use sinew_math::{Vec3, max, max3, min, min3};

/// Largest numbers of corners, tried in this order. A hull of triangles with 66 corners has [`MAX_FACES`] faces.
const BUDGETS: [usize; 4] = [usize::MAX, MAX_VERTICES, 128, MAX_FACES / 2 + 2];
/// Distances from a face's plane, in grid steps, within which a corner counts as on the face; tried in this order. The
/// last one merges only exactly coplanar triangles, and always succeeds.
const TOLERANCES: [f64; 4] = [8.0, 2.0, 0.5, 0.0];
/// Distance by which merging faces may leave a corner outside the hull, as a share of the size.
const MOST_LOST: f32 = 4e-6;
/// Least thickness of a hull, as a share of its size.
const THINNEST: f32 = 1e-4;
/// Distance by which a corner may be outside a face, as a share of the size.
const CONVEX: f32 = 1e-5;
/// Rounding error of a height over a plane, as a share of the distance from the origin.
const ROUNDING: f32 = 1e-6;

pub(super) fn build(points: &[Vec3]) -> Result<Hull, HullError> {
    let grid = Grid::new(points)?;
    for budget in BUDGETS {
        if let Some(hull) = with_budget(&grid, budget)? {
            return Ok(hull);
        }
    }
    Err(HullError::TooThin)
}

/// Longest side of the bounds, metres.
fn size(bounds: &Aabb) -> f32 {
    let sides = bounds.max - bounds.min;
    max(max(sides.x, sides.y), sides.z)
}

/// Builds the hull with at most `budget` corners; `None` if it has too many faces.
fn with_budget(grid: &Grid, budget: usize) -> Result<Option<Hull>, HullError> {
    let mut corners: Vec<u32> =
        quick::hull(&grid.points, budget)?.iter().flat_map(|triangle| triangle.corners).collect();
    corners.sort_unstable();
    corners.dedup();
    let cloud: Vec<quick::Point> = corners.iter().map(|&i| grid.points[i as usize]).collect();
    let places: Vec<Vec3> = corners.iter().map(|&i| grid.place(i as usize)).collect();
    for tolerance in TOLERANCES {
        let exact = tolerance == 0.0;
        let faces = match merge::faces(&cloud, tolerance) {
            Ok(faces) => faces,
            Err(error) if exact => return Err(error),
            Err(_) => continue,
        };
        let Some((vertices, loops)) = numbered(&places, &faces) else { return Ok(None) };
        let Ok(hull) = from_faces(vertices, &loops) else { continue };
        let most = MOST_LOST * size(&hull.bounds) + ROUNDING * hull.bounding_radius;
        if exact || places.iter().all(|&p| hull.distance(p).0 <= most) {
            return Ok(Some(hull));
        }
    }
    Err(HullError::TooThin)
}

/// Returns the corners that faces use, and the faces by corner index; `None` if there are too many faces or corners.
/// Both lists are in a canonical order.
fn numbered(places: &[Vec3], faces: &merge::Faces) -> Option<(Vec<Vec3>, Vec<Vec<u8>>)> {
    let mut used: Vec<u32> = faces.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    if faces.len() > MAX_FACES || used.len() > MAX_VERTICES {
        return None;
    }
    let number = |i: &u32| used.binary_search(i).expect("the corner is used") as u8;
    let mut loops: Vec<Vec<u8>> = faces
        .iter()
        .map(|face| {
            let mut ring: Vec<u8> = face.iter().map(number).collect();
            let first = (0..ring.len()).min_by_key(|&k| ring[k]).unwrap_or(0);
            ring.rotate_left(first);
            ring
        })
        .collect();
    loops.sort_unstable();
    Some((used.iter().map(|&i| places[i as usize]).collect(), loops))
}

/// Builds a hull from its corners and the corners of each face, counter-clockwise from outside.
///
/// # Errors
/// A description of the problem, if the faces do not form a convex solid.
pub(super) fn from_faces(vertices: Vec<Vec3>, loops: &[Vec<u8>]) -> Result<Hull, &'static str> {
    let outline = Outline::new(loops, vertices.len())?;
    let low = vertices.iter().copied().fold(Vec3::splat(f32::INFINITY), min3);
    let high = vertices.iter().copied().fold(Vec3::splat(f32::NEG_INFINITY), max3);
    let bounds = Aabb { min: low, max: high };
    let size = size(&bounds);
    if !SIZES.contains(&f64::from(size)) {
        return Err("a hull is too small or too large");
    }
    let bounding_radius = vertices.iter().map(|v| v.length()).fold(0.0, max);
    let (mut planes, mut areas) = (Vec::with_capacity(loops.len()), Vec::with_capacity(loops.len()));
    for ring in loops {
        let (normal, area) = newell(&vertices, ring).ok_or("a face of a hull has no area")?;
        let on_face = ring.iter().map(|&i| normal.dot(vertices[usize::from(i)])).fold(f32::INFINITY, min);
        // The plane passes through the corner furthest along the normal, so that it bounds the hull except for
        // rounding.
        let offset = reach(&vertices, normal);
        if offset - on_face > CONVEX * size + ROUNDING * bounding_radius {
            return Err("a hull is not convex");
        }
        if offset + reach(&vertices, -normal) < THINNEST * size {
            return Err("a hull is too thin");
        }
        planes.push(Plane { normal, offset });
        areas.push(area);
    }
    let integrals = Integrals::new(&vertices, loops);
    let (volume, center, inertia) = integrals.solid().ok_or("a hull has no volume")?;
    let inner_radius = planes.iter().map(|plane| -plane.height(center)).fold(f32::INFINITY, min);
    let content_hash = super::bytes::hash(&vertices, loops);
    Ok(Hull {
        vertices,
        planes,
        outline,
        areas,
        bounds,
        volume,
        center,
        inertia,
        inner_radius,
        bounding_radius,
        content_hash,
    })
}

/// Returns the unit normal and the area of a polygon (Newell's sum), in `f64`, relative to its first corner; `None` if
/// it has no area.
fn newell(vertices: &[Vec3], ring: &[u8]) -> Option<(Vec3, f32)> {
    let corner = |k: usize| vertices[usize::from(ring[k])].to_array().map(f64::from);
    let from = corner(0);
    let arm = |k: usize| {
        let p = corner(k);
        [p[0] - from[0], p[1] - from[1], p[2] - from[2]]
    };
    let mut sum = [0.0; 3];
    for k in 1..ring.len() - 1 {
        let (a, b) = (arm(k), arm(k + 1));
        sum[0] += a[1] * b[2] - a[2] * b[1];
        sum[1] += a[2] * b[0] - a[0] * b[2];
        sum[2] += a[0] * b[1] - a[1] * b[0];
    }
    let length = (sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]).sqrt();
    let [x, y, z] = sum.map(|x| (x / length) as f32);
    (length > 0.0).then(|| (Vec3::new(x, y, z), (0.5 * length) as f32))
}
