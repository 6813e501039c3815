//! Merges triangles of a hull that are in one plane, within a tolerance, into polygons.

use super::HullError;
use super::quick::{self, Point, Triangle, side};

/// Faces of a hull, each by its corner indices, counter-clockwise from outside.
pub(super) type Faces = Vec<Vec<u32>>;

/// Returns the faces of the hull of `points`; corners within `tolerance` (grid steps) of a face's plane count as on the
/// face. At least three faces meet at every corner. With a tolerance of 0, the hull loses no volume.
///
/// # Errors
/// If no solid remains.
pub(super) fn faces(points: &[Point], tolerance: f64) -> Result<Faces, HullError> {
    let mut used: Vec<u32> = (0..points.len() as u32).collect();
    loop {
        let cloud: Vec<Point> = used.iter().map(|&i| points[i as usize]).collect();
        let triangles = quick::hull(&cloud, usize::MAX)?;
        let regions = Regions::grow(&cloud, &triangles, tolerance);
        let (corners, kept) = regions.corners(cloud.len());
        if kept.len() == corners {
            let faces = regions.faces(&cloud, tolerance);
            let named = faces.into_iter().map(|face| face.into_iter().map(|i| used[i as usize]).collect());
            return Ok(named.collect());
        }
        // Drops the other points, which are on a face or an edge, and builds the hull of the rest.
        used = kept.into_iter().map(|i| used[i as usize]).collect();
    }
}

/// Regions of triangles, one per face.
struct Regions<'a> {
    triangles: &'a [Triangle],
    /// Region of each triangle, as the index of the region's first triangle.
    region: Vec<u32>,
}

const NONE: u32 = u32::MAX;

impl<'a> Regions<'a> {
    /// Grows regions from the largest triangles; each absorbs its neighbours while they are in its plane.
    fn grow(points: &[Point], triangles: &'a [Triangle], tolerance: f64) -> Self {
        let mut order: Vec<u32> = (0..triangles.len() as u32).collect();
        let area = |i: u32| triangles[i as usize].plane.length;
        order.sort_by(|&i, &j| area(j).total_cmp(&area(i)).then(i.cmp(&j)));
        let mut region = vec![NONE; triangles.len()];
        for seed in order {
            if region[seed as usize] != NONE {
                continue;
            }
            let plane = &triangles[seed as usize].plane;
            let fits = |t: &Triangle| {
                let near = |i: u32| plane.distance(points[i as usize]).abs() <= tolerance;
                t.plane.faces_like(plane) && t.corners.into_iter().all(near)
            };
            region[seed as usize] = seed;
            let mut open = vec![seed];
            while let Some(index) = open.pop() {
                for next in triangles[index as usize].neighbors {
                    if region[next as usize] == NONE && fits(&triangles[next as usize]) {
                        region[next as usize] = seed;
                        open.push(next);
                    }
                }
            }
        }
        Self { triangles, region }
    }

    /// Returns the number of corners of all triangles, and the corners where three or more faces meet, ascending.
    fn corners(&self, points: usize) -> (usize, Vec<u32>) {
        let mut meet: Vec<(u32, u32)> = Vec::with_capacity(3 * self.triangles.len());
        for (triangle, &region) in self.triangles.iter().zip(&self.region) {
            meet.extend(triangle.corners.map(|corner| (corner, region)));
        }
        meet.sort_unstable();
        meet.dedup();
        let mut faces = vec![0; points];
        for (corner, _) in meet {
            faces[corner as usize] += 1;
        }
        let kept = (0..points as u32).filter(|&i| faces[i as usize] >= 3).collect();
        (faces.iter().filter(|&&count| count > 0).count(), kept)
    }

    /// Returns the outlines of the regions. The triangles of a region with a dent deeper than the tolerance, or without
    /// a simple outline, stay separate.
    fn faces(&self, points: &[Point], tolerance: f64) -> Faces {
        let mut members: Vec<(u32, u32)> =
            self.region.iter().enumerate().map(|(i, &region)| (region, i as u32)).collect();
        members.sort_unstable();
        let mut faces = Vec::new();
        for group in members.chunk_by(|a, b| a.0 == b.0) {
            let plane = &self.triangles[group[0].0 as usize].plane;
            let outline = self.outline(group).filter(|outline| {
                let count = outline.len();
                (0..count).all(|k| {
                    let corners = [k, (k + 1) % count, (k + 2) % count].map(|k| points[outline[k] as usize]);
                    plane.bulge(corners) >= -tolerance
                })
            });
            match outline {
                Some(outline) => faces.push(outline),
                None => faces.extend(group.iter().map(|&(_, t)| self.triangles[t as usize].corners.to_vec())),
            }
        }
        faces
    }

    /// Returns the outline of a region, if it is one ring that contains each corner once.
    fn outline(&self, group: &[(u32, u32)]) -> Option<Vec<u32>> {
        let mut sides: Vec<[u32; 2]> = Vec::new();
        for &(region, t) in group {
            let triangle = &self.triangles[t as usize];
            let outer = |&k: &usize| self.region[triangle.neighbors[k] as usize] != region;
            sides.extend((0..3).filter(outer).map(|k| side(triangle, k)));
        }
        sides.sort_unstable();
        if sides.windows(2).any(|pair| pair[0][0] == pair[1][0]) {
            return None;
        }
        let mut ring = Vec::with_capacity(sides.len());
        let mut at = sides.first()?[0];
        for _ in 0..sides.len() {
            ring.push(at);
            at = sides[sides.binary_search_by_key(&at, |s| s[0]).ok()?][1];
        }
        (at == ring[0] && ring.len() == sides.len() && is_each_once(&ring)).then_some(ring)
    }
}

fn is_each_once(ring: &[u32]) -> bool {
    let mut sorted = ring.to_vec();
    sorted.sort_unstable();
    sorted.windows(2).all(|pair| pair[0] != pair[1])
}
