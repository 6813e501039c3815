//! Surfaces of one-sided triangles: meshes and height fields.
//!
//! Both kinds have the same queries (`Surface`): nearby triangles, closest point, entry of a line. `collide/triangles`
//! computes contacts.

mod build;
mod bvh;
mod height_field;
mod mesh;
mod saved;
mod triangle;

pub use build::Dropped;
pub(crate) use bvh::{Branch, DEPTH, Tree};
pub use height_field::{HeightField, HeightFieldDef, HeightFieldError};
pub use mesh::{MAX_COORDINATE, MAX_TRIANGLES, Mesh, MeshError};
pub use triangle::{Part, Triangle, closest_on_triangle, normal};

use crate::boxes::{Aabb, Overlap};
use sinew_math::Vec3;

/// Returns an edge as its two vertices, the smaller index first.
fn ordered(a: u32, b: u32) -> (u32, u32) {
    if a < b { (a, b) } else { (b, a) }
}

/// A shape that consists of one-sided triangles.
#[derive(Clone, Copy, Debug)]
pub enum Surface<'a> {
    /// Triangle mesh.
    Mesh(&'a Mesh),
    /// Height field: triangles over a grid.
    HeightField(&'a HeightField),
}

/// Point of a surface that is closest to another point.
#[derive(Clone, Copy, Debug)]
pub struct Closest {
    /// Square of the distance, m².
    pub square: f32,
    /// Closest point, in the surface's frame, metres.
    pub point: Vec3,
    /// Feature of the triangle that contains the point.
    part: Part,
    /// Triangle that contains the point.
    pub triangle: Triangle,
}

impl Closest {
    /// Returns the signed distance of the query point `p`, metres, negative behind the surface, and the unit outward
    /// normal at the closest point.
    pub fn signed(&self, p: Vec3) -> (f32, Vec3) {
        let (away, distance) = (p - self.point, self.square.sqrt());
        let height = self.triangle.height(p);
        let sign = if height < 0.0 { -1.0 } else { 1.0 };
        // If a face is closest, or if rounding dominates the direction between the points, the triangle's normal is
        // used.
        let precise = distance > 1e-5 * (1.0 + p.length());
        match self.part {
            Part::Face => (height, self.triangle.normal),
            _ if precise => (sign * distance, away * (sign / distance)),
            _ => (sign * distance, self.triangle.normal),
        }
    }

    /// Replaces `best` if the new point is nearer. If several triangles share the closest point, the triangle whose
    /// plane is furthest from `p` is used, because it decides correctly whether `p` is in front of the surface.
    fn improve(
        best: &mut Option<Self>,
        p: Vec3,
        limit: f32,
        (point, part): (Vec3, Part),
        triangle: impl FnOnce() -> Triangle,
    ) {
        const TIED: f32 = 1e-5;
        let square = (point - p).length_squared();
        let least = best.map_or(limit, |best| best.square);
        if square > least * (1.0 + TIED) || square > limit {
            return;
        }
        let new = Self { square, point, part, triangle: triangle() };
        let steeper = |best: &Self| new.triangle.height(p).abs() > best.triangle.height(p).abs();
        match best {
            Some(old) if square >= old.square * (1.0 - TIED) => {
                if steeper(old) {
                    *old = new;
                }
            }
            _ => *best = Some(new),
        }
    }
}

impl Surface<'_> {
    /// Calls `visit` with the triangles whose bounds overlap `region`, in a deterministic order.
    pub fn overlapping(&self, region: &Aabb, mut visit: impl FnMut(Triangle)) {
        match self {
            Self::Mesh(mesh) => mesh.tree().overlapping(region, |places| {
                for place in places {
                    if triangle::bounds(&mesh.corners(place)).overlaps(region) {
                        visit(mesh.triangle(place));
                    }
                }
            }),
            Self::HeightField(field) => field.overlapping(region, visit),
        }
    }

    /// Returns the point closest to `p`, if it is nearer than `reach`, metres.
    pub fn closest(&self, p: Vec3, reach: f32) -> Option<Closest> {
        let limit = reach * reach;
        match self {
            Self::Mesh(mesh) => {
                let mut best: Option<Closest> = None;
                mesh.tree().nearest(p, limit, |places| {
                    for place in places {
                        let found = closest_on_triangle(&mesh.corners(place), p);
                        Closest::improve(&mut best, p, limit, found, || mesh.triangle(place));
                    }
                    best.map_or(limit, |best| best.square * 1.0001)
                });
                best
            }
            Self::HeightField(field) => field.closest(p, reach),
        }
    }

    /// Returns the share of `direction` (≥ 0, may exceed 1) at which a line from `origin` enters the surface from its
    /// outside, and the surface's normal there.
    pub fn enter(&self, origin: Vec3, direction: Vec3) -> Option<(f32, Vec3)> {
        match self {
            Self::Mesh(mesh) => {
                let mut best: Option<(f32, u32)> = None;
                mesh.tree().along(origin, direction, f32::MAX, |places| {
                    for place in places {
                        if let Some(share) = triangle::enter_triangle(&mesh.corners(place), origin, direction)
                            && best.is_none_or(|(least, _)| share < least)
                        {
                            best = Some((share, place));
                        }
                    }
                    best.map_or(f32::MAX, |(share, _)| share)
                });
                best.map(|(share, place)| (share, mesh.triangle(place).normal))
            }
            Self::HeightField(field) => field.enter(origin, direction),
        }
    }
}
